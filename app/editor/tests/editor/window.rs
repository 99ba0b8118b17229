//! Drives the window by the names that a screen reader says.

use crate::hand::Hand;
use eframe::egui::{Key, Modifiers};
use mve_core::NodeStatus;

/// A cube of twelve triangles, in a file.
pub fn cube(folder: &std::path::Path) -> std::path::PathBuf {
    let path = folder.join("cube.obj");
    let corners = (0..8).map(|i| format!("v {} {} {}\n", i & 1, (i >> 1) & 1, (i >> 2) & 1));
    let faces =
        [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]];
    let faces = faces.map(|[a, b, c, d]| format!("f {a} {b} {c}\nf {a} {c} {d}\n"));
    let text: String = corners.chain(faces).collect();
    std::fs::write(&path, text).expect("the folder takes files");
    path
}

#[test]
fn the_map_is_built_by_hand_run_read_and_undone() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let path = cube(folder.path());
    let mut hand = Hand::new(folder.path());
    hand.add("ObjLoader");
    hand.type_into("path", &path.display().to_string());
    hand.add("Simplificator");
    hand.add("MeshComparer");
    hand.add("ObjSaver");
    hand.type_into("path", "small.obj");
    hand.point_at("canvas");
    hand.press(Key::L);
    hand.link("output obj_loader.mesh", "input simplificator.mesh");
    hand.link("output obj_loader.mesh", "input mesh_comparer.original");
    hand.link("output simplificator.mesh", "input mesh_comparer.simplified");
    hand.link("output simplificator.mesh", "input obj_saver.mesh");
    let map = hand.map();
    assert_eq!(map.nodes.len(), 4);
    assert_eq!(map.links.len(), 4, "{:?}", map.links);
    assert_eq!(hand.problems(), Vec::<String>::new());

    hand.click("\u{25b6} Run");
    hand.wait_for_the_run();
    for name in map.nodes.keys() {
        let ended = hand.editor().session().runner.ended(name);
        let status = ended.map(|ended| ended.record.status.clone());
        assert_eq!(status, Some(NodeStatus::Done), "{name}");
    }
    assert!(hand.output_folder().join("small.obj").is_file());
    hand.click("node mesh_comparer");
    hand.click("Values");
    let distance = hand.editor().session().runner.value("mesh_comparer", "value");
    let distance = mve_editor::views::brief_text(&distance.expect("it was measured"));
    assert!(distance.parse::<f64>().is_ok_and(|distance| distance >= 0.0), "{distance}");
    assert!(hand.sees(&distance), "the table of values shows {distance}");

    hand.point_at("canvas");
    while hand.editor().session().document.undo_label().is_some() {
        hand.press_with(Modifiers::COMMAND, Key::Z);
    }
    assert!(hand.map().nodes.is_empty());
}

#[test]
fn nodes_are_dragged_and_the_search_closes() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    hand.add("Box");
    hand.add("MeshInfo");
    let before = hand.map().layout["box"];
    let from = hand.place_of("node box") + eframe::egui::vec2(-60.0, -40.0);
    hand.drag(from, from + eframe::egui::vec2(100.0, 60.0));
    let after = hand.map().layout["box"];
    assert!((after[0] - before[0] - 100.0).abs() <= 10.0, "{before:?} {after:?}");
    assert!((after[1] - before[1] - 60.0).abs() <= 10.0, "{before:?} {after:?}");

    hand.click("+ Module");
    assert!(hand.sees("search modules"));
    hand.press(Key::Escape);
    assert!(!hand.sees("search modules"));
}

#[test]
fn nodes_of_the_shipped_maps_stand_apart() {
    let maps = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps");
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let theses = maps.join("theses");
    let found = [maps, theses].map(|maps| std::fs::read_dir(maps).expect("maps are shipped"));
    let paths = found.into_iter().flatten().map(|entry| entry.expect("can be read").path());
    for path in paths.filter(|path| path.is_file()) {
        let mut hand = Hand::with_map(folder.path(), &path);
        hand.step();
        if std::env::var_os("UPDATE").is_some() {
            hand.click_last("canvas");
            hand.press(Key::L);
            hand.press_with(Modifiers::COMMAND, Key::S);
        }
        nodes_stand_apart(&hand, &path.display().to_string());
    }
}

fn nodes_stand_apart(hand: &Hand, what: &str) {
    let session = hand.editor().session();
    let sizes: Vec<_> = session.canvas.sizes().collect();
    let place = |name: &str| {
        let node = mve_editor::document::Item::Node(name.to_owned());
        session.document.position(&node).expect("it is a node")
    };
    for (nth, (a, [width_a, height_a])) in sizes.iter().enumerate() {
        for (b, [width_b, height_b]) in &sizes[..nth] {
            let ([ax, ay], [bx, by]) = (place(a), place(b));
            let is_beside = ax + width_a <= bx || bx + width_b <= ax;
            let is_above = ay + height_a <= by || by + height_b <= ay;
            assert!(is_beside || is_above, "{what}: {a} covers {b}");
        }
    }
}

#[test]
fn nodes_without_a_place_stand_apart_and_the_map_is_as_it_was() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    // Nodes of many rows, of which the map says nothing.
    let map = r#"{"mve": 1, "nodes": {"vase": {"module": "Vase"}, "box": {"module": "Box"},
        "a": {"module": "Simplificator"}, "b": {"module": "Smooth"}, "c": {"module": "Smooth"}},
        "links": ["vase.mesh -> a.mesh", "box.mesh -> b.mesh", "vase.mesh -> c.mesh"]}"#;
    let mut hand = Hand::with_text(folder.path(), map);
    hand.step();
    nodes_stand_apart(&hand, "at once");
    assert!(!hand.editor().session().document.is_dirty());
}

#[test]
fn a_copy_comes_to_a_free_place_in_sight() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"}, "smooth": {"module": "Smooth"}},
        "layout": {"box": [0, 0], "smooth": [0, 600]}}"#;
    let mut hand = Hand::with_text(folder.path(), map);
    hand.step();
    hand.click_at("node smooth", 0.5, 0.05);
    hand.point_within("node smooth", 0.5, 0.05);
    hand.press_with(Modifiers::COMMAND, Key::D);
    hand.step();
    assert!(hand.sees("node smooth-2"));
    nodes_stand_apart(&hand, "copied");
    let [x, y] = hand.map().layout["smooth-2"];
    assert!(x.hypot(y - 600.0) < 600.0, "it is near: {x} {y}");
}

#[test]
fn nodes_stay_readable_when_a_view_opens_below_them() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let nodes: Vec<_> = (0..6).map(|n| format!("\"b{n}\": {{\"module\": \"Box\"}}")).collect();
    let places: Vec<_> = (0..6).map(|n| format!("\"b{n}\": [0, {}]", 220 * n)).collect();
    let (nodes, places) = (nodes.join(", "), places.join(", "));
    let map = format!(r#"{{"mve": 1, "nodes": {{{nodes}}}, "layout": {{{places}}}}}"#);
    let mut hand = Hand::with_text(folder.path(), &map);
    hand.step();
    let before = hand.height_of("node b2");
    hand.click("\u{25b6} Run");
    hand.wait_until_up_to_date();
    hand.step();
    assert!(!hand.editor().session().pinned.is_empty());
    let after = hand.height_of("node b2");
    assert!((after - before).abs() < 0.5, "{before} {after}");
}

#[test]
fn words_typed_into_a_number_are_said_to_be_none() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    hand.add("Vase");
    let number = |hand: &Hand| hand.map().nodes["vase"].params.get("segments").cloned();
    hand.type_number("segments", "many");
    assert_eq!(number(&hand), None);
    assert!(hand.sees("segments: \u{201c}many\u{201d} is no number; it stays 64"));
    hand.type_number("segments", "1 0");
    assert_eq!(number(&hand), Some(10.into()));
}

#[test]
fn a_number_typed_where_off_stands_switches_on_and_escape_gives_up() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    hand.add("Simplificator");
    let param = |hand: &Hand, name| hand.map().nodes["simplificator"].params.get(name).cloned();
    hand.click("simplificator.target_faces: off");
    hand.type_text("2000");
    hand.press(Key::Enter);
    assert_eq!(param(&hand, "target_faces"), Some(2000.into()));
    assert_eq!(param(&hand, "ratio"), None);
    hand.click("simplificator.target_faces: 2000");
    hand.type_text("7");
    hand.press(Key::Escape);
    assert_eq!(param(&hand, "target_faces"), Some(2000.into()));
    // What is typed takes the place of what was there, and counts before the run that a key starts.
    hand.click("simplificator.target_faces: 2000");
    hand.type_text("300");
    hand.press(Key::F5);
    assert_eq!(param(&hand, "target_faces"), Some(300.into()));
    hand.wait_for_the_run();
    hand.click("simplificator.target_faces: 300");
    hand.type_text("off");
    hand.press(Key::Enter);
    assert_eq!(param(&hand, "target_faces"), Some(serde_json::Value::Null));
}

#[test]
fn a_note_is_written_when_it_is_made_and_edited_by_a_double_click() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    hand.add("Box");
    hand.point_within("canvas", 0.5, 0.8);
    hand.press(Key::N);
    hand.type_text("hello bmh");
    hand.click_at("canvas", 0.1, 0.1);
    let notes = |hand: &Hand| {
        let extras = hand.editor().session().document.extras();
        extras.notes.values().map(|note| note.text.clone()).collect::<Vec<_>>()
    };
    assert_eq!(notes(&hand), ["hello bmh"]);
    assert_eq!(hand.map().nodes["box"].mode, mve_core::NodeMode::Active);
    hand.double_click("note hello bmh");
    hand.type_text("bye");
    hand.click_at("canvas", 0.1, 0.1);
    assert_eq!(notes(&hand), ["bye"]);
}

#[test]
fn a_map_is_not_saved_over_another_without_a_question() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let path = folder.path().join("other.json");
    std::fs::write(&path, "{\"mve\": 1}").expect("the folder takes files");
    let mut hand = Hand::new(folder.path());
    hand.add("Box");
    let ctrl_shift = Modifiers::COMMAND | Modifiers::SHIFT;
    hand.press_with(ctrl_shift, Key::S);
    hand.replace_text("path of the file", &path.display().to_string());
    hand.press(Key::Enter);
    let text = || std::fs::read_to_string(&path).expect("it is there");
    assert_eq!(text(), "{\"mve\": 1}");
    hand.click("Replace the file");
    assert!(text().contains("\"Box\""));
}

#[test]
fn a_map_that_was_open_is_opened_again() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand =
        Hand::with_text(folder.path(), r#"{"mve": 1, "nodes": {"a": {"module": "Box"}}}"#);
    hand.press_with(Modifiers::COMMAND, Key::W);
    assert!(hand.map().nodes.is_empty());
    hand.click("File");
    hand.click_beginning("Open recent");
    hand.click("map.json");
    assert!(hand.map().nodes.contains_key("a"));
}

#[test]
fn dropped_files_are_opened_or_read() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    let mesh = cube(folder.path());
    hand.drop_file(&mesh);
    let nodes = hand.map().nodes.clone();
    assert_eq!(nodes.len(), 1);
    assert_eq!(nodes["obj_loader"].params["path"], mesh.display().to_string());
    hand.drop_file(&folder.path().join("notes.txt"));
    assert_eq!(hand.map().nodes, nodes);
    let map = folder.path().join("map.json");
    std::fs::write(&map, r#"{"mve": 1, "nodes": {"a": {"module": "Box"}}}"#)
        .expect("it is written");
    hand.drop_file(&map);
    assert_eq!(hand.editor().session().document.path(), Some(map.as_path()));
    assert!(hand.map().nodes.contains_key("a"));
}
