//! What a person keeps of looking at meshes: views by name, the size of their pictures, distances.
//! Driven by the names that a screen reader says.

use crate::hand::Hand;
use eframe::egui::{Key, Modifiers};
use mve_editor::kept::Shelf;
use mve_editor::views::{Projection, StandardView};

const MAP: &str = "{\"mve\": 1, \"nodes\": {\"box\": {\"module\": \"Box\"},\n\
    \"bend\": {\"module\": \"Curvature\"}},   \"links\": [\"box.mesh -> bend.mesh\"]}\n";

/// A window on a map that has run, with its mesh and a field in view.
fn looking(folder: &std::path::Path) -> Hand {
    let path = folder.join("map.json");
    std::fs::write(&path, MAP).expect("the folder takes files");
    open(folder, &path)
}

fn open(folder: &std::path::Path, path: &std::path::Path) -> Hand {
    let mut hand = Hand::with_map(folder, path);
    hand.press(Key::F5);
    hand.wait_until_up_to_date();
    hand.unpin_all();
    hand.pin("box", "mesh");
    hand.pin("bend", "mean");
    hand.wait_for_the_views();
    hand.step();
    hand
}

fn kept(hand: &Hand, shelf: Shelf) -> Vec<String> {
    hand.editor().session().document.extras().kept.on(shelf).keys().cloned().collect()
}

const PICTURE: &str = "3D view of box.mesh: drag turns, shift and drag moves, wheel zooms";

#[test]
fn a_view_is_kept_by_name_and_looked_from_tomorrow() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = looking(folder.path());
    let meshes = |hand: &Hand| {
        let meshes = &hand.editor().session().viewer.meshes;
        (meshes.camera, meshes.settings.scale.high, meshes.settings.section.is_on)
    };
    hand.point_within(PICTURE, 0.5, 0.5);
    hand.press_with(Modifiers::COMMAND, Key::Num3);
    hand.press(Key::Num5);
    hand.press(Key::X);
    hand.type_number("offset of the plane", "0.125");
    hand.type_number("maximum of the colors", "2.5");
    hand.wait_for_the_views();
    let section = hand.editor().session().viewer.meshes.settings.section;
    assert_eq!(section.offset, Some(0.125));
    let seen = meshes(&hand);
    assert_eq!((seen.0.projection, seen.1, seen.2), (Projection::Orthographic, Some(2.5), true));
    hand.click_last("View");
    hand.replace_text("name of the view to keep", "front, error 0-1 %");
    hand.click("Keep view");
    assert_eq!(kept(&hand, Shelf::Views), ["front, error 0-1 %"]);

    // Everything is another way, and comes back by one click.
    hand.click("Top (7)");
    hand.click("Perspective");
    hand.point_within(PICTURE, 0.5, 0.5);
    hand.press(Key::Escape);
    hand.press(Key::X);
    hand.type_number("maximum of the colors", "7");
    assert_ne!(meshes(&hand), seen);
    hand.click_last("View");
    hand.click("front, error 0-1 %");
    assert_eq!(meshes(&hand), seen);

    hand.click("Rename view front, error 0-1 %");
    hand.replace_text("new name of view front, error 0-1 %", "left");
    hand.press(Key::Enter);
    assert_eq!(kept(&hand, Shelf::Views), ["left"]);
    hand.press(Key::Escape);
    hand.press_with(Modifiers::COMMAND, Key::S);
    let path = folder.path().join("map.json");
    drop(hand);
    let mut hand = open(folder.path(), &path);
    assert_ne!(meshes(&hand), seen);
    hand.click_last("View");
    hand.click("left");
    assert_eq!(meshes(&hand), seen);
    hand.click("Remove view left");
    assert_eq!(kept(&hand, Shelf::Views), Vec::<String>::new());
}

#[test]
fn undoing_what_was_kept_brings_back_the_bytes_of_the_map() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = looking(folder.path());
    assert_eq!(hand.editor().session().document.text(), MAP);
    hand.click_last("View");
    hand.replace_text("name of the view to keep", "a");
    hand.press(Key::Enter);
    hand.press(Key::Escape);
    // Two points of the mesh: it is seen in the middle of the picture.
    hand.click("Measure");
    for x in [0.45, 0.55] {
        hand.click_at(PICTURE, x, 0.5);
        for _ in 0..20 {
            std::thread::sleep(std::time::Duration::from_millis(5));
            hand.step();
        }
    }
    assert_eq!(kept(&hand, Shelf::Distances), ["distance 1"]);
    assert!(hand.sees("Distances"));
    // Distances are free in space: they stay when the mesh is another one.
    hand.press(Key::F5);
    hand.wait_for_the_run();
    assert_eq!(hand.editor().session().viewer.meshes.settings.distances.len(), 1);
    assert_ne!(hand.editor().session().document.text(), MAP);
    hand.press_with(Modifiers::COMMAND, Key::Z);
    assert!(hand.editor().session().viewer.meshes.settings.distances.is_empty());
    hand.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(kept(&hand, Shelf::Views), Vec::<String>::new());
    assert_eq!(hand.editor().session().document.text(), MAP);
}

/// Fills in the box and waits for the picture.
fn save_picture(hand: &mut Hand, path: &std::path::Path) -> image::RgbaImage {
    hand.replace_text("path of the picture", &path.display().to_string());
    hand.click("Save picture");
    let written = format!("wrote {}", path.display());
    let start = std::time::Instant::now();
    while !hand.sees(&written) {
        assert!(start.elapsed().as_secs() < 60, "it takes too long");
        hand.step();
    }
    image::open(path).expect("it is a picture").to_rgba8()
}

#[test]
fn a_figure_is_made_again_tomorrow_from_the_view_that_was_kept_with_it() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = looking(folder.path());
    hand.point_within(PICTURE, 0.5, 0.5);
    hand.press(Key::Num3);
    hand.press(Key::X);
    hand.wait_for_the_views();
    hand.click("Picture…");
    hand.type_number("width of the picture", "400");
    hand.type_number("height of the picture", "300");
    hand.replace_text("keep as view", "figure 1");
    let first = save_picture(&mut hand, &folder.path().join("first.png"));
    assert_eq!(first.dimensions(), (400, 300));
    assert_eq!(kept(&hand, Shelf::Views), ["figure 1"]);
    hand.press_with(Modifiers::COMMAND, Key::S);
    drop(hand);

    let mut hand = open(folder.path(), &folder.path().join("map.json"));
    let camera = hand.editor().session().viewer.meshes.camera;
    hand.click("Picture…");
    hand.click("view of the picture: as it is seen");
    hand.click("figure 1");
    let again = save_picture(&mut hand, &folder.path().join("again.png"));
    assert!(again == first, "the same figure, pixel for pixel");
    assert_eq!(hand.editor().session().viewer.meshes.camera, camera, "the window stays as it is");
    let mut corner = camera;
    corner.look_from(StandardView::Corner);
    assert_eq!(camera.yaw_rad, corner.yaw_rad);
}

#[test]
fn an_element_is_gone_to_by_its_number_and_the_keys_are_listed() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = looking(folder.path());
    hand.point_within(PICTURE, 0.5, 0.5);
    hand.press(Key::G);
    assert!(hand.sees("of box.mesh"));
    hand.press_with(Modifiers::COMMAND, Key::A);
    hand.type_text("7");
    hand.press(Key::Enter);
    let picked = hand.editor().session().viewer.picked.clone().expect("it was picked");
    assert_eq!((picked.title.as_str(), picked.index), ("box.mesh", 7));
    let mesh = hand.value::<mve_modules::data::TriMesh>("box", "mesh");
    let target = hand.editor().session().viewer.meshes.camera.target;
    assert_eq!(target, mesh.positions[7]);
    hand.press(Key::F1);
    for keys in ["Ctrl + 1, 3, 7", "click", "G", "M", "X", "Alt + drag, [ and ]", "F"] {
        assert!(hand.sees(keys), "{keys}");
    }
}
