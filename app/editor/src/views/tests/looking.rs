//! Tests of what a person does to look closer at meshes: cutting them, picking an element, and
//! measuring.

use super::*;
use crate::kept::{Kept, KeptEdit, Shelf};

fn front(list: Vec<Pinned>) -> Harness<'static, Shown> {
    let mut harness = harness(list);
    harness.state_mut().viewer.meshes.camera.look_from(StandardView::Front);
    settle(&mut harness);
    harness
}

fn red_and_green() -> Vec<Pinned> {
    // Green is nearer, and smaller.
    vec![pinned("a.mesh", Value::new(squares(DVec3::Y, DVec3::X)))]
}

/// Where a point of the model is in the window.
fn place_of(harness: &Harness<Shown>, title: &str, point: DVec3) -> egui::Pos2 {
    let rect = harness.get_by_label_contains(&format!("3D view of {title}")).rect();
    let aspect = f64::from(rect.width()) / f64::from(rect.height());
    let at = harness.state().viewer.meshes.camera.project(point, aspect).unwrap();
    rect.center() + 0.5 * rect.size() * egui::vec2(at.x as f32, -at.y as f32)
}

fn click(harness: &mut Harness<Shown>, at: egui::Pos2) {
    harness.hover_at(at);
    // So long that it is no second click of the one before.
    (0..30).for_each(|_| harness.step());
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    harness.step();
    // The answer comes from a thread.
    settle(harness);
}

/// How many pixels of the picture a color has, about.
fn count(image: &RgbaImage, is_it: impl Fn(i32, i32, i32) -> bool) -> usize {
    let is_it = |pixel: &&image::Rgba<u8>| {
        let [r, g, b, _] = pixel.0.map(i32::from);
        is_it(r, g, b)
    };
    image.pixels().filter(is_it).count()
}

#[test]
fn a_plane_cuts_away_what_is_before_it_and_a_flip_what_is_behind() {
    let mut harness = front(red_and_green());
    let is_green = |image: &RgbaImage| count(image, |r, g, b| g > 100 && r < 60 && b < 60) > 500;
    let is_red = |image: &RgbaImage| count(image, |r, g, b| r > 100 && g < 60 && b < 60) > 500;
    let image = picture(&mut harness);
    assert!(is_green(&image) && is_red(&image));
    // X cuts through the middle, across the axis that points at the viewer.
    let at = place_of(&harness, "a.mesh", DVec3::ZERO);
    harness.hover_at(at);
    harness.step();
    harness.key_press(egui::Key::X);
    let cut = picture(&mut harness);
    let section = harness.state().viewer.meshes.settings.section;
    assert!(section.is_on && section.normal == DVec3::Z, "{section:?}");
    assert!(!is_green(&cut) && is_red(&cut));
    harness.key_press(egui::Key::F);
    let flipped = picture(&mut harness);
    assert!(is_green(&flipped) && !is_red(&flipped));
    // What is cut away is not picked.
    click(&mut harness, at);
    let picked = harness.state().viewer.picked.clone().unwrap();
    assert_eq!(picked.domain, Domain::Face);
    assert!(picked.index < 2, "the near square: {picked:?}");
    harness.key_press(egui::Key::X);
    assert!(is_red(&picture(&mut harness)));
}

fn shifted(by: f64) -> TriMesh {
    let mut mesh = cube(DVec3::ZERO);
    mesh.positions.iter_mut().for_each(|point| point.x += by);
    mesh
}

#[test]
fn outlines_of_two_meshes_lie_over_each_other() {
    let list = vec![
        pinned("a.mesh", Value::new(cube(DVec3::ZERO))),
        pinned("b.mesh", Value::new(shifted(0.25))),
    ];
    // So large that no name lies over them.
    let render = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let mut harness = harness_with(list, render, egui::vec2(900.0, 700.0));
    harness.state_mut().viewer.meshes.camera.look_from(StandardView::Front);
    let is_orange = |r: i32, g: i32, b: i32| r > 220 && (80..140).contains(&g) && b < 60;
    let is_blue = |r: i32, g: i32, b: i32| r < 60 && (160..220).contains(&g) && b > 220;
    let both = |harness: &mut Harness<Shown>| {
        let image = picture(harness);
        [count(&image, is_orange), count(&image, is_blue)]
    };
    assert_eq!(both(&mut harness), [0, 0]);
    let settings = &mut harness.state_mut().viewer.meshes.settings;
    (settings.section.is_on, settings.section.normal) = (true, DVec3::Z);
    settings.arrangement = Arrangement::Wipe;
    let [orange, blue] = both(&mut harness);
    // Each a square of which some 2.5 pixels of width are seen; the wipe shows all of both.
    assert!(orange > 300 && blue > 300, "{orange} {blue}");
    harness.state_mut().viewer.meshes.settings.section.has_all_outlines = false;
    let [fewer_orange, fewer_blue] = both(&mut harness);
    let counts = [orange, fewer_orange, blue, fewer_blue];
    assert!(fewer_orange < orange * 3 / 4 && fewer_blue < blue * 3 / 4, "{counts:?}");
    harness.state_mut().viewer.meshes.settings.section.has_all_outlines = true;
    harness.state_mut().viewer.meshes.settings.arrangement = Arrangement::SideBySide;
    let [orange, blue] = both(&mut harness);
    assert!(orange > 200 && blue > 200, "{orange} {blue}");
}

fn drag_plane(harness: &mut Harness<Shown>, from: egui::Pos2, to: egui::Pos2) {
    let alt = egui::Modifiers::ALT;
    harness.event(egui::Event::ModifiersChanged(alt));
    harness.drag_at(from);
    harness.step();
    for share in [0.5, 1.0] {
        harness.hover_at(from + (to - from) * share);
        harness.step();
    }
    harness.drop_at(to);
    harness.event(egui::Event::ModifiersChanged(egui::Modifiers::NONE));
    settle(harness);
}

#[test]
fn a_plane_is_dragged_and_moved_in_steps() {
    let mut harness = front(vec![pinned("box.mesh", Value::new(cube(DVec3::ZERO)))]);
    let settings = &mut harness.state_mut().viewer.meshes.settings;
    (settings.section.is_on, settings.section.normal) = (true, DVec3::X);
    settle(&mut harness);
    let offset = |harness: &Harness<Shown>| harness.state().viewer.meshes.settings.section.offset;
    let middle = place_of(&harness, "box.mesh", DVec3::splat(0.5));
    harness.hover_at(middle);
    harness.step();
    harness.key_press(egui::Key::CloseBracket);
    settle(&mut harness);
    assert!((offset(&harness).unwrap() - 0.51).abs() < 1e-9);
    let before = harness.state().viewer.meshes.camera;
    let to = place_of(&harness, "box.mesh", DVec3::new(0.75, 0.5, 0.5));
    drag_plane(&mut harness, middle, to);
    let moved = offset(&harness).unwrap();
    assert!((moved - 0.76).abs() < 0.02, "{moved}");
    assert_eq!(harness.state().viewer.meshes.camera, before, "the camera stays");
}

#[test]
fn a_click_picks_an_element_that_is_read_copied_and_named_by_its_number() {
    let field = Field {
        name: "depth".to_owned(),
        unit: "mm".to_owned(),
        domain: Domain::Face,
        values: vec![1.0, 0.1 + 0.2, 0.0, 0.0],
    };
    let mut list = red_and_green();
    list.push(pinned("a.field", Value::new(field)));
    let render = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let mut harness = harness_with(list, render, egui::vec2(900.0, 700.0));
    harness.state_mut().viewer.meshes.camera.look_from(StandardView::Front);
    settle(&mut harness);
    let at = place_of(&harness, "a.mesh", DVec3::new(-0.2, 0.2, 1.0));
    click(&mut harness, at);
    let picked = |harness: &Harness<Shown>| harness.state().viewer.picked.clone();
    let of = |domain, index| Some(PickedElement { title: "a.mesh".to_owned(), domain, index });
    assert_eq!(picked(&harness), of(Domain::Face, 1));
    harness.get_by_label("of a.mesh");
    harness.get_by_label("0.3 mm");
    harness.get_by_label("0, 2, 3");
    // Near a corner the vertex is meant, to the last bit.
    let at = place_of(&harness, "a.mesh", DVec3::new(1.0, 1.0, 0.0));
    click(&mut harness, at - egui::vec2(4.0, -4.0));
    assert_eq!(picked(&harness), of(Domain::Vertex, 6));
    harness.get_by_label("1, 1, 0");
    harness.get_by_label("Copy values").click();
    let mut copied = String::new();
    for _ in 0..3 {
        harness.step();
        for command in &harness.output().platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                copied.clone_from(text);
            }
        }
    }
    assert_eq!(copied, "vertex\t6\ta.mesh\nposition\t1\t1\t0");
    // Another number is gone to.
    harness.get_by_label("face").click();
    settle(&mut harness);
    assert_eq!(picked(&harness), of(Domain::Face, 2), "the first face around the vertex");
    harness.get_by_label("vertex").click();
    settle(&mut harness);
    assert_eq!(picked(&harness), of(Domain::Vertex, 4), "its first vertex");
    harness.get_by_label("face").click();
    settle(&mut harness);
    let number = harness.get_by_label("number of the element");
    number.click();
    settle(&mut harness);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.step();
    harness.event(egui::Event::Text("0".to_owned()));
    harness.step();
    harness.key_press(egui::Key::Enter);
    settle(&mut harness);
    assert_eq!(picked(&harness), of(Domain::Face, 0));
    let target = harness.state().viewer.meshes.camera.target;
    assert!(target.distance(DVec3::new(1.0 / 6.0, -1.0 / 6.0, 1.0)) < 1e-12, "{target}");
    // Beside the mesh there is nothing.
    let rect = harness.get_by_label_contains("3D view of a.mesh").rect();
    click(&mut harness, rect.left_top() + egui::vec2(6.0, 60.0));
    assert_eq!(picked(&harness), None);
    assert!(harness.query_by_label("of a.mesh").is_none(), "it is read no longer");
}

#[test]
fn a_vertex_that_is_cut_away_is_not_picked() {
    let mut harness = front(red_and_green());
    let near_corner =
        |harness: &Harness<Shown>| place_of(harness, "a.mesh", DVec3::new(0.97, 0.97, 0.0));
    let picked = |harness: &Harness<Shown>| {
        harness.state().viewer.picked.clone().map(|picked| (picked.domain, picked.index))
    };
    let at = near_corner(&harness);
    click(&mut harness, at);
    assert_eq!(picked(&harness), Some((Domain::Vertex, 6)));
    harness.state_mut().viewer.picked = None;
    let section = &mut harness.state_mut().viewer.meshes.settings.section;
    (section.is_on, section.normal, section.offset) = (true, DVec3::X, Some(0.98));
    settle(&mut harness);
    // The controls of the plane take some of the picture's height.
    let at = near_corner(&harness);
    click(&mut harness, at);
    assert!(matches!(picked(&harness), Some((Domain::Face, 2 | 3))), "{:?}", picked(&harness));
}

#[test]
fn what_is_known_of_an_element_covers_nothing_beside_its_picture() {
    let mut harness = front(red_and_green());
    let at = place_of(&harness, "a.mesh", DVec3::new(-0.2, 0.2, 1.0));
    click(&mut harness, at);
    for size in [[400.0, 300.0], [400.0, 170.0], [220.0, 200.0]] {
        harness.set_size(size.into());
        settle(&mut harness);
        let picture = harness.get_by_label_contains("3D view of a.mesh").rect();
        for name in ["number of the element", "face", "vertex", "Go to it"] {
            let shown = harness.get_by_label(name).rect();
            assert!(picture.contains_rect(shown), "{size:?} {name}: {shown} in {picture}");
        }
    }
    harness.set_size(egui::vec2(140.0, 200.0));
    settle(&mut harness);
    assert!(harness.query_by_label("of a.mesh").is_none());
}

#[test]
fn meshes_of_unlike_size_fill_a_picture_each() {
    let mut large = cube(DVec3::ZERO);
    large.positions.iter_mut().for_each(|point| *point *= 1000.0);
    let list =
        vec![pinned("a.mesh", Value::new(cube(DVec3::ZERO))), pinned("b.mesh", Value::new(large))];
    let render = create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let mut harness = harness_with(list, render, egui::vec2(900.0, 400.0));
    settle(&mut harness);
    // Half of the diagonal of each picture is seen in one place of it.
    harness.get_by_label_contains("diagonal 1.73205");
    harness.get_by_label_contains("diagonal 1732.05");
    let gray = |image: &RgbaImage| {
        let left = image::imageops::crop_imm(image, 0, 60, 440, 300).to_image();
        count(&left, |r, g, b| r > 100 && (r - g).abs() < 12 && (g - b).abs() < 12)
    };
    let each = gray(&picture(&mut harness));
    // A click meets the small one in its own picture.
    let rect = harness.get_by_label_contains("3D view of a.mesh").rect();
    click(&mut harness, rect.center());
    let picked = harness.state().viewer.picked.clone().unwrap();
    assert_eq!(picked.title, "a.mesh");
    harness.state_mut().viewer.picked = None;
    // A hand moves the plane by as much as is seen: here the picture is some two units wide.
    let settings = &mut harness.state_mut().viewer.meshes.settings;
    (settings.section.is_on, settings.section.normal) = (true, DVec3::X);
    settings.section.offset = Some(0.5);
    settle(&mut harness);
    let middle = harness.get_by_label_contains("3D view of a.mesh").rect().center();
    drag_plane(&mut harness, middle, middle + egui::vec2(20.0, 0.0));
    let offset = harness.state().viewer.meshes.settings.section.offset.unwrap();
    assert!(offset > 0.51 && offset < 1.0, "{offset}");
    harness.state_mut().viewer.meshes.settings.section.is_on = false;
    settle(&mut harness);
    harness.get_by_label("One scale").click();
    settle(&mut harness);
    assert!(harness.query_by_label_contains("diagonal").is_none());
    let one = gray(&picture(&mut harness));
    assert!(each > 10_000 && one < each / 20, "{each} {one}");
}

#[test]
fn distances_are_measured_by_two_clicks_and_stay() {
    let mut harness = front(red_and_green());
    let corners = [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)];
    let places = corners.map(|corner| place_of(&harness, "a.mesh", corner));
    click(&mut harness, places[0]);
    harness.get_by_label("of a.mesh");
    harness.key_press(egui::Key::M);
    settle(&mut harness);
    harness.get_by_label_contains("Click the first point");
    assert!(harness.query_by_label("of a.mesh").is_none(), "it would hide what to click");
    harness.state_mut().viewer.picked = None;
    click(&mut harness, places[0]);
    harness.get_by_label_contains("Click the second point");
    click(&mut harness, places[1]);
    harness.get_by_label_contains("Click the first point");
    let Some(ViewerAction::Keep(edits)) = harness.state_mut().action.take() else {
        panic!("{:?}", harness.state().action)
    };
    let [edit @ KeptEdit::Put { shelf: Shelf::Distances, name, content }] = edits.as_slice() else {
        panic!("{edits:?}")
    };
    assert_eq!(name, "distance 1");
    let expected = r#"{"ends":[[-1.0,-1.0,0.0],[1.0,1.0,0.0]],"of":"a.mesh"}"#;
    let expected: serde_json::Value = serde_json::from_str(expected).unwrap();
    assert_eq!(content, &expected);
    assert_eq!(harness.state().viewer.picked, None, "the tool takes the clicks");
    let mut kept = Kept::default();
    kept.edit(edit).unwrap();
    harness.state_mut().viewer.meshes.set_kept(&kept);
    harness.key_press(egui::Key::Escape);
    settle(&mut harness);
    assert!(!harness.state().viewer.meshes.settings.is_measuring);
    let image = picture(&mut harness);
    let yellow = count(&image, |r, g, b| r > 220 && (160..220).contains(&g) && b < 90);
    assert!(yellow > 60, "a line from corner to corner: {yellow}");
    // Another mesh has but a pale line.
    let title = std::mem::replace(&mut harness.state_mut().pinned[0].title, "b.mesh".to_owned());
    let image = picture(&mut harness);
    let yellow = count(&image, |r, g, b| r > 220 && (160..220).contains(&g) && b < 90);
    assert_eq!(yellow, 0);
    harness.state_mut().pinned[0].title = title;
    harness.get_by_label("Distances").click();
    settle(&mut harness);
    // Two by two.
    harness.get_by_label("2.82843");
    harness.get_by_label("Remove distance 1").click();
    settle(&mut harness);
    let remove = KeptEdit::Remove { shelf: Shelf::Distances, name: "distance 1".to_owned() };
    assert_eq!(harness.state().action, Some(ViewerAction::Keep(vec![remove])));
}

#[test]
fn opposite_views_have_keys() {
    let mut harness = front(red_and_green());
    let at = place_of(&harness, "a.mesh", DVec3::ZERO);
    harness.hover_at(at);
    harness.step();
    for (key, towards) in [
        (egui::Key::Num1, DVec3::NEG_Z),
        (egui::Key::Num3, DVec3::NEG_X),
        (egui::Key::Num7, DVec3::NEG_Y),
    ] {
        harness.key_press_modifiers(egui::Modifiers::COMMAND, key);
        settle(&mut harness);
        let back = harness.state().viewer.meshes.camera.axes().back;
        assert!(back.distance(towards) < 1e-12, "{back}");
    }
}
