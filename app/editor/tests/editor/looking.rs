//! What a person keeps of looking at meshes: views by name, the size of their pictures, distances.
//! Driven by the names that a screen reader says.

use crate::hand::Hand;
use eframe::egui::{Key, Modifiers};
use mve_editor::kept::Shelf;
use mve_editor::views::{Projection, StandardView};
use mve_modules::data::TriMesh;

const MAP: &str = "{\"mve\": 1, \"nodes\": {\"box\": {\"module\": \"Box\"},\n\
    \"bend\": {\"module\": \"Curvature\"}},   \"links\": [\"box.mesh -> bend.mesh\"]}\n";

/// A window on a map that has run, with its mesh and a field in view.
fn looking(folder: &std::path::Path) -> Hand {
    look(Hand::with_run(folder, MAP))
}

/// Another window on that map, as it was saved.
fn open(folder: &std::path::Path) -> Hand {
    let mut hand = Hand::with_map(folder, &folder.join("map.json"));
    hand.press(Key::F5);
    hand.wait_until_up_to_date();
    look(hand)
}

fn look(mut hand: Hand) -> Hand {
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
    drop(hand);
    let mut hand = open(folder.path());
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
    measure(&mut hand, [0.45, 0.55]);
    assert_eq!(kept(&hand, Shelf::Distances), ["distance 1"]);
    assert!(hand.sees("Distances"));
    // Distances are free in space: they stay when the mesh is another one.
    let n_faces = |hand: &Hand| {
        let mesh = hand.editor().session().pinned_values()[0].value.clone();
        mesh.and_then(|mesh| mesh.get::<TriMesh>()).map(|mesh| mesh.faces.len())
    };
    let before = (n_faces(&hand), distances(&hand));
    hand.click_at("node box", 0.5, 0.05);
    hand.type_number("segments", "3");
    hand.press(Key::F5);
    hand.wait_until_up_to_date();
    hand.wait_for_the_views();
    let after = (n_faces(&hand), distances(&hand));
    assert!(before.0 != after.0 && before.1 == after.1 && after.1.len() == 1, "{after:?}");
    hand.point_at("canvas");
    hand.press_with(Modifiers::COMMAND, Key::Z);
    assert_ne!(hand.editor().session().document.text(), MAP);
    hand.press_with(Modifiers::COMMAND, Key::Z);
    assert!(hand.editor().session().viewer.meshes.settings.distances.is_empty());
    hand.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(kept(&hand, Shelf::Views), Vec::<String>::new());
    assert_eq!(hand.editor().session().document.text(), MAP);
}

fn distances(hand: &Hand) -> Vec<mve_editor::views::Distance> {
    hand.editor().session().viewer.meshes.settings.distances.clone()
}

/// Clicks two points at half of the height of the picture.
fn measure(hand: &mut Hand, places: [f32; 2]) {
    for x in places {
        hand.click_at(PICTURE, x, 0.5);
        hand.wait_for_the_views();
    }
}

#[test]
fn all_distances_come_back_by_one_undo_and_escape_means_what_has_the_keys() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = looking(folder.path());
    hand.click("Measure");
    measure(&mut hand, [0.45, 0.55]);
    measure(&mut hand, [0.4, 0.5]);
    assert_eq!(distances(&hand).len(), 2);
    let is_measuring = |hand: &Hand| hand.editor().session().viewer.meshes.settings.is_measuring;
    // A menu and a dialog close by Escape; the tool stays.
    hand.click("Distances");
    assert!(hand.sees("Remove all distances"));
    hand.press(Key::Escape);
    assert!(!hand.sees("Remove all distances") && is_measuring(&hand));
    hand.click("Picture…");
    hand.press(Key::Escape);
    assert!(!hand.sees("Save picture") && is_measuring(&hand));
    // So does what is typed in a field.
    hand.click_at("node box", 0.5, 0.05);
    hand.click_number("segments");
    hand.press(Key::Escape);
    assert!(is_measuring(&hand));
    hand.click("Distances");
    hand.click("Remove all distances");
    assert!(distances(&hand).is_empty());
    hand.press(Key::Escape);
    hand.point_at("canvas");
    hand.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(distances(&hand).len(), 2);
    hand.point_within(PICTURE, 0.5, 0.5);
    hand.press(Key::Escape);
    assert!(!is_measuring(&hand));
}

#[test]
fn a_picture_says_when_it_takes_the_place_of_a_kept_view() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = looking(folder.path());
    hand.click_last("View");
    hand.replace_text("name of the view to keep", "front");
    hand.press(Key::Enter);
    hand.press(Key::Escape);
    hand.click("Picture…");
    hand.replace_text("keep as view", "fron");
    assert!(!hand.sees_beginning("The view"));
    hand.replace_text("keep as view", "front");
    assert!(hand.sees("The view front is there and is replaced."));
    hand.click("view of the picture: as it is seen");
    hand.click("front");
    assert!(hand.sees("The view front has pictures like this one from now on."));
    hand.click("Cancel");
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

    let mut hand = open(folder.path());
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
    hand.wait_for_the_views();
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
