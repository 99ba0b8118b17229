//! What nodes show, hold and suggest.

use eframe::egui::{Key, vec2};
use mve_editor::document::Item;

use crate::hand::Hand;
use crate::window::cube;

#[test]
fn a_node_shows_a_picture_of_what_it_gives() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    hand.add("Box");
    hand.point_at("canvas");
    let size = |hand: &Hand| {
        let session = hand.editor().session();
        session.canvas.sizes().next().map(|(_, size)| size).expect("there is a node")
    };
    let before = size(&hand);
    hand.press(Key::P);
    assert!(hand.sees("picture of box: not run yet"));
    assert!(size(&hand)[1] > before[1] + 100.0);
    hand.click("\u{25b6} Run");
    hand.wait_for_the_run();
    hand.wait_for_the_pictures();
    assert!(hand.sees("picture of box"));
    // It is a part of the map, and undone like one.
    let pictured = |hand: &Hand| hand.map().extra.get("canvas").map(ToString::to_string);
    assert_eq!(pictured(&hand).as_deref(), Some(r#"{"pictured":["box"]}"#));
    hand.point_at("canvas");
    hand.press(Key::P);
    assert_eq!((pictured(&hand), size(&hand)), (None, before));
    hand.unpin_all();
    hand.click("View");
    hand.click("Pictures on all nodes");
    hand.step();
    assert!(hand.sees("picture of box"));
    assert_eq!(pictured(&hand), None);
}

#[test]
fn a_bypassed_node_shows_and_counts_what_passes_through() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"},
        "cut": {"module": "Simplificator", "params": {"target_faces": 12}},
        "last": {"module": "Simplificator"}},
        "links": ["box.mesh -> cut.mesh", "cut.mesh -> last.mesh"]}"#;
    let mut hand = Hand::with_run(folder.path(), map);
    hand.unpin_all();
    let faces = |hand: &Hand| hand.editor().session().counts("last")[0];
    assert_eq!(faces(&hand), ("faces", 12));
    hand.click_at("node cut", 0.5, 0.05);
    hand.point_within("node cut", 0.5, 0.05);
    hand.press(Key::P);
    hand.wait_for_the_pictures();
    assert!(hand.sees("picture of cut"));
    hand.press(Key::B);
    hand.problems();
    hand.wait_for_the_pictures();
    assert_eq!(faces(&hand), ("faces", 768));
    assert!(hand.sees("picture of cut"), "that of the box");
    hand.press(Key::M);
    hand.problems();
    assert!(hand.sees("picture of cut: is muted"));
    assert!(hand.editor().session().counts("last").is_empty());
}

#[test]
fn a_path_goes_on_with_the_names_in_its_folder() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let path = cube(folder.path());
    std::fs::write(folder.path().join("cube.txt"), "no mesh").expect("the folder takes files");
    let mut hand = Hand::new(folder.path());
    hand.add("ObjLoader");
    hand.replace_text("path", &format!("{}/cu", folder.path().display()));
    let start = std::time::Instant::now();
    while !hand.sees("cube.obj") {
        assert!(start.elapsed().as_secs() < 60, "nothing is offered");
        hand.step();
    }
    assert!(!hand.sees("cube.txt"));
    hand.press(Key::Tab);
    hand.press(Key::Enter);
    let given = |hand: &Hand| hand.map().nodes["obj_loader"].params["path"].clone();
    assert_eq!(given(&hand), path.display().to_string());
    assert!(!hand.sees("cube.obj"), "a whole name goes on with nothing");
    // A name is clicked, too.
    hand.replace_text("path", &format!("{}/", folder.path().display()));
    while !hand.sees("cube.obj") {
        assert!(start.elapsed().as_secs() < 60, "nothing is offered");
        hand.step();
    }
    let at = hand.place_of("cube.obj");
    hand.drag(at, at);
    hand.press(Key::Enter);
    assert_eq!(given(&hand), path.display().to_string());
}

#[test]
fn a_frame_keeps_a_node_that_is_moved_a_little_over_its_edge() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    hand.add("Box");
    hand.point_at("canvas");
    hand.press(Key::G);
    hand.type_text("Group");
    hand.press(Key::Enter);
    let place = |hand: &Hand, item: &Item| {
        hand.editor().session().document.position(item).expect("it is there")
    };
    let node = Item::Node("box".to_owned());
    // 20 units of space are around the node.
    hand.drag_held("node box", vec2(60.0, 0.0));
    let before = place(&hand, &node);
    hand.drag_held("frame Group", vec2(0.0, 80.0));
    let after = place(&hand, &node);
    assert_eq!(before[0], after[0]);
    assert!(after[1] >= before[1] + 40.0, "{before:?} {after:?}");
    // With its middle outside it stays where it is.
    hand.drag_held("node box", vec2(400.0, 0.0));
    let before = place(&hand, &node);
    hand.drag_held("frame Group", vec2(0.0, 80.0));
    assert_eq!(place(&hand, &node), before);
}

#[test]
fn a_number_of_faces_begins_with_half_of_those_that_come_in() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::with_files(folder.path(), vec![cube(folder.path())]);
    hand.add("Simplificator");
    hand.point_at("canvas");
    hand.press(Key::L);
    hand.link("output obj_loader.mesh", "input simplificator.mesh");
    hand.click("\u{25b6} Run");
    hand.wait_for_the_run();
    hand.click_at("node simplificator", 0.5, 0.05);
    hand.click("whether target faces is on");
    assert_eq!(hand.map().nodes["simplificator"].params["target_faces"], 6);
}

#[test]
fn the_edge_of_a_panel_is_grabbed_on_both_sides() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::with_files(folder.path(), vec![cube(folder.path())]);
    hand.wait_for_the_run();
    hand.wait_for_the_views();
    let height = |hand: &Hand| hand.height_of("3D view of");
    let mut before = height(&hand);
    // The canvas leaves 5 points free above the edge of the viewer.
    for below in [2.0, 8.0] {
        let edge = hand.point_within("canvas", 0.5, 1.0) + vec2(0.0, below);
        hand.drag(edge, edge - vec2(0.0, 30.0));
        let after = height(&hand);
        assert!(after > before + 20.0, "{below} below the canvas: {before} {after}");
        before = after;
    }
}
