//! What the window says is so, and what is looked at can be read: driven by the names that a screen
//! reader says.

use crate::hand::Hand;
use crate::window::cube;
use eframe::egui::{Key, Modifiers};
use mve_modules::data::TriMesh;

/// A box whose mesh waits for a minute before it is cut.
const SLOW: &str = r#"{"mve": 1, "nodes": {
    "box": {"module": "Box"},
    "slow": {"module": "Wait", "params": {"seconds": 60}},
    "cut": {"module": "Simplificator", "params": {"target_faces": 400}}},
    "links": ["box.mesh -> slow.mesh", "slow.mesh -> cut.mesh"]}"#;

fn n_faces(hand: &Hand, node: &str) -> usize {
    hand.value::<TriMesh>(node, "mesh").faces.len()
}

fn type_value(hand: &mut Hand, field: &str, from: &str, to: &str) {
    hand.click(&format!("{field}: {from}"));
    hand.type_text(to);
    hand.press(Key::Enter);
}

#[test]
fn on_edit_the_last_value_counts_also_when_it_is_typed_during_a_run() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::with_text(folder.path(), SLOW);
    hand.click("on edit");
    type_value(&mut hand, "cut.target_faces", "400", "350");
    hand.wait_until_it_works("slow");
    type_value(&mut hand, "cut.target_faces", "350", "300");
    type_value(&mut hand, "slow.seconds", "60", "0");
    hand.wait_until_up_to_date();
    assert_eq!(n_faces(&hand, "cut"), 300);
    // A run that a person asked for goes on to its end; then the change runs.
    hand.click("on edit");
    type_value(&mut hand, "slow.seconds", "0", "2");
    hand.press(Key::F5);
    hand.wait_until_it_works("slow");
    hand.click("on edit");
    type_value(&mut hand, "cut.target_faces", "300", "200");
    hand.wait_until_up_to_date();
    assert_eq!(n_faces(&hand, "cut"), 200);
}

#[test]
fn a_stopped_run_and_a_changed_file_are_not_up_to_date() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::with_text(folder.path(), SLOW);
    hand.click("\u{25b6} Run");
    hand.wait_until_it_works("slow");
    hand.click("\u{23f9} Stop");
    hand.wait_for_the_run();
    assert!(hand.sees("slow was stopped before it was done: Run (F5) starts it again."));

    let path = cube(folder.path());
    let mut hand = Hand::new(folder.path());
    hand.drop_file(&path);
    hand.problems();
    hand.press(Key::F5);
    hand.wait_until_up_to_date();
    assert!(!hand.sees("Ready to run (F5)."));
    let text = std::fs::read_to_string(&path).expect("it is there");
    std::fs::write(&path, text + "v 9 9 9\n").expect("the folder takes files");
    hand.wait_until_something_is_to_be_run();
    assert!(hand.sees("Ready to run (F5)."));
    // Without a hand that moves, the window looks at files again within two seconds.
    hand.step();
    assert!(hand.next_frame_wanted() <= std::time::Duration::from_secs(2));
}

#[test]
fn a_copy_takes_no_result_away() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"}, "info": {"module": "MeshInfo"}},
        "links": ["box.mesh -> info.mesh"]}"#;
    let mut hand = Hand::with_run(folder.path(), map);
    assert!(hand.sees("Unpin box.mesh"));
    hand.click_at("node box", 0.5, 0.05);
    hand.point_within("node box", 0.5, 0.05);
    hand.press_with(Modifiers::COMMAND, Key::D);
    assert!(hand.map().nodes.contains_key("box-2"));
    assert!(hand.sees("Unpin box.mesh") && !hand.sees("Unpin box-2.mesh"));
    assert_eq!(n_faces(&hand, "box"), 768);
    assert!(hand.description("node box").starts_with("done"));
    assert_eq!(hand.description("node box-2"), "has not run yet");
    // Each step back and forth selects what was selected there.
    let selected = |hand: &Hand| {
        let items = hand.editor().session().document.selection().iter();
        items.map(|item| format!("{item:?}")).collect::<Vec<_>>()
    };
    assert_eq!(selected(&hand), ["Node(\"box-2\")"]);
    hand.press_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(selected(&hand), ["Node(\"box\")"]);
    hand.press_with(Modifiers::COMMAND, Key::Y);
    assert_eq!(selected(&hand), ["Node(\"box-2\")"]);
}

#[test]
fn the_viewer_keeps_its_height_while_a_value_is_missing() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let path = cube(folder.path());
    let mut hand = Hand::new(folder.path());
    hand.drop_file(&path);
    hand.press(Key::F5);
    hand.wait_until_up_to_date();
    hand.wait_for_the_views();
    let before = hand.height_of("3D view of");
    assert!(before > 200.0, "{before}");
    let text = std::fs::read_to_string(&path).expect("it is there");
    std::fs::write(&path, "no mesh").expect("the folder takes files");
    hand.press(Key::F5);
    hand.wait_for_the_run();
    (0..10).for_each(|_| hand.step());
    std::fs::write(&path, text).expect("the folder takes files");
    hand.press(Key::F5);
    hand.wait_until_up_to_date();
    hand.wait_for_the_views();
    assert_eq!(hand.height_of("3D view of"), before);
}

#[test]
fn an_output_without_content_is_not_chosen_and_says_what_it_is() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    // Hausdorff distances draw no images.
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"}, "ball": {"module": "Vase"},
        "far": {"module": "MeshComparer"}},
        "links": ["box.mesh -> far.original", "ball.mesh -> far.simplified"]}"#;
    let mut hand = Hand::with_run(folder.path(), map);
    let pinned: Vec<_> = hand.editor().session().pinned.iter().cloned().collect();
    let values =
        pinned.iter().map(|port| hand.editor().session().runner.value(&port.node, &port.port));
    let viewer = &hand.editor().session().viewer;
    assert!(values.flatten().all(|value| !viewer.is_empty(&value)), "{pinned:?}");
    hand.pin("far", "difference_images");
    assert!(hand.sees("no image"));
    hand.click("Unpin far.difference_images");
    assert!(!hand.sees("no image"));
}

#[test]
fn a_file_that_was_written_is_named_by_its_path_and_seconds_stay_when_a_value_is_known() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"},
        "save": {"module": "ObjSaver", "params": {"path": "a/box.obj"}}},
        "links": ["box.mesh -> save.mesh"]}"#;
    let mut hand = Hand::with_run(folder.path(), map);
    hand.click_at("node save", 0.5, 0.05);
    let written = hand.output_folder().join("a/box.obj");
    assert!(written.is_file());
    assert!(hand.sees(&format!("wrote {}", written.display())));
    let runner = |hand: &Hand| hand.editor().session().runner.seconds("box");
    let measured = runner(&hand);
    assert!(measured.is_some());
    hand.press(Key::F5);
    hand.wait_for_the_run();
    assert!(hand.description("node box").starts_with("done; its outputs were known"));
    assert_eq!(runner(&hand), measured);
}

#[test]
fn a_node_that_warned_says_so() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"},
        "cut": {"module": "Simplificator", "params": {"target_faces": 0}}},
        "links": ["box.mesh -> cut.mesh"]}"#;
    let hand = Hand::with_run(folder.path(), map);
    assert!(!hand.description("node box").contains("warned"));
    let said = hand.description("node cut");
    assert!(said.contains("warned: stopped at 4 faces, 0 were asked for"), "{said}");
}

#[test]
fn the_list_of_keys_has_those_of_every_part() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    hand.press(Key::F1);
    for keys in ["Ctrl + Q", "drag on empty canvas", "1, 3, 7, 0", "W"] {
        assert!(hand.sees(keys), "{keys}");
    }
}

#[test]
fn colors_of_a_field_leave_out_extremes_and_their_ends_can_be_typed() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"vase": {"module": "Vase"},
        "bend": {"module": "Curvature"}}, "links": ["vase.mesh -> bend.mesh"]}"#;
    let mut hand = Hand::with_run(folder.path(), map);
    hand.unpin_all();
    hand.pin("vase", "mesh");
    hand.pin("bend", "mean");
    hand.wait_for_the_views();
    hand.step();
    assert!(hand.sees("color by: Automatic"));
    // One percent of the values may lie beyond each end, where nothing else is asked for.
    let shown = hand.editor().session().viewer.meshes.range().expect("a field is shown");
    let field = hand.value::<mve_modules::data::Field>("bend", "mean");
    let mut values = field.values.clone();
    values.sort_unstable_by(f64::total_cmp);
    let below = values.iter().filter(|value| **value < shown[0]).count();
    let above = values.iter().filter(|value| **value > shown[1]).count();
    let percent = values.len() / 100;
    for beyond in [below, above] {
        assert!(beyond <= percent, "{beyond} of {} lie beyond an end", values.len());
    }
    assert!(below + above > 0, "the vase has extremes");
    hand.type_number("maximum of the colors", "2.5");
    let high = |hand: &Hand| hand.editor().session().viewer.meshes.settings.scale.high;
    assert_eq!(high(&hand), Some(2.5));
    // The menu stays open while its settings are changed, and an end begins with what it is.
    hand.click("Range");
    hand.click("Maximum");
    assert_eq!(high(&hand), None);
    let present = hand.editor().session().viewer.meshes.range().expect("a field is shown");
    hand.click("Maximum");
    assert_eq!(high(&hand), Some(present[1]));
    hand.click("0 %");
    let is_open = |hand: &Hand| hand.sees("Reverse the colors");
    assert!(is_open(&hand), "a click on a setting leaves the menu open");
    // Also where the end is typed in the menu.
    hand.type_last_number("maximum of the colors", "1.5");
    assert!(is_open(&hand), "so does typing");
    assert_eq!(high(&hand), Some(1.5));
    // One that crosses the other given end is refused in words, and so the ends stay.
    hand.click("Minimum");
    let ends = hand.editor().session().viewer.meshes.range();
    hand.type_last_number("maximum of the colors", "-50");
    assert!(hand.sees_beginning("maximum of the colors: -50 is not above the minimum"));
    assert_eq!(hand.editor().session().viewer.meshes.range(), ends);
    hand.press(Key::Escape);
    assert!(!is_open(&hand));
}

#[test]
fn meshes_are_opened_by_path_and_looked_at_side_by_side() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let first = cube(folder.path());
    let second = folder.path().join("second.OBJ");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(&second, text).expect("the folder takes files");
    let mut hand = Hand::with_files(folder.path(), vec![first.clone(), second.clone()]);
    hand.wait_until_up_to_date();
    assert_eq!(hand.map().nodes["obj_loader"].params["path"], first.display().to_string());
    assert_eq!([n_faces(&hand, "obj_loader"), n_faces(&hand, "obj_loader-2")], [12, 1]);
    assert!(hand.sees("Unpin obj_loader.mesh") && hand.sees("Unpin obj_loader-2.mesh"));

    hand.press_with(Modifiers::COMMAND, Key::O);
    hand.replace_text("path to open", &first.display().to_string());
    hand.press(Key::Enter);
    hand.wait_until_up_to_date();
    assert_eq!(n_faces(&hand, "obj_loader-3"), 12);
    assert!(hand.sees("Unpin obj_loader-3.mesh"));
    // What is neither says so, without words of a parser.
    let other = folder.path().join("notes.txt");
    std::fs::write(&other, "no map").expect("the folder takes files");
    hand.drop_file(&other);
    let said = format!("{}: neither a map nor a file that a module reads (", other.display());
    assert!(hand.sees_beginning(&said));
}

#[test]
fn a_viewer_keeps_its_height_whatever_is_in_it() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"}, "bend": {"module": "Curvature"}},
        "links": ["box.mesh -> bend.mesh"]}"#;
    let mut hand = Hand::with_run(folder.path(), map);
    hand.unpin_all();
    // More than half of the window has room for.
    hand.pin("bend", "mean");
    hand.pin("bend", "gaussian");
    hand.step();
    let top = hand.place_of("Unpin bend.mean").y;
    for _ in 0..3 {
        hand.wait_for_the_views();
        hand.press(Key::F5);
        hand.wait_until_up_to_date();
    }
    assert!(hand.sees("median"));
    assert_eq!(hand.place_of("Unpin bend.mean").y, top);
}

#[test]
fn a_mesh_is_looked_at_first_and_no_picture_of_differences() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"},
        "render": {"module": "Render"}},
        "links": ["box.mesh -> render.mesh"]}"#;
    let mut hand = Hand::with_run(folder.path(), map);
    hand.step();
    assert!(hand.sees("Unpin box.mesh"));
    assert!(!hand.sees("Unpin render.images"));
}

#[test]
fn a_bypassed_node_shows_what_passes_through_and_a_muted_one_nothing() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"},
        "cut": {"module": "Simplificator", "params": {"target_faces": 12}}},
        "links": ["box.mesh -> cut.mesh"]}"#;
    let mut hand = Hand::with_run(folder.path(), map);
    hand.unpin_all();
    hand.pin("cut", "mesh");
    hand.wait_for_the_views();
    let n_shown = |hand: &Hand| {
        let shown = hand.editor().session().pinned_values();
        let mesh = shown[0].value.as_ref().and_then(|value| value.get::<TriMesh>());
        mesh.map(|mesh| mesh.faces.len())
    };
    assert_eq!(n_shown(&hand), Some(12));
    hand.click_at("node cut", 0.5, 0.05);
    hand.point_within("node cut", 0.5, 0.05);
    hand.press(Key::B);
    hand.problems();
    assert_eq!(n_shown(&hand), Some(768));
    // The inspector reads the same.
    let port = mve_core::PortRef { node: "cut".to_owned(), port: "mesh".to_owned() };
    let said = |hand: &Hand| Some(hand.editor().session().value_out_of(&port)?.summary());
    assert!(said(&hand).is_some_and(|text| text.starts_with("768 faces")));
    hand.press(Key::M);
    hand.problems();
    assert_eq!(n_shown(&hand), None);
    assert_eq!(said(&hand), None);
    assert_eq!(hand.description("node cut"), "does not run: it is muted");
}

#[test]
fn a_number_out_of_range_is_said_and_a_frame_is_named_when_it_is_made() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::new(folder.path());
    hand.add("Vase");
    hand.type_number("segments", "99999999999");
    assert!(hand.sees_beginning("segments: 99999999999 is not within 3 and "));
    assert_eq!(hand.map().nodes["vase"].params.get("segments"), None);
    hand.click_at("node vase", 0.5, 0.05);
    hand.point_within("node vase", 0.5, 0.05);
    hand.press(Key::G);
    hand.type_text("Vases");
    hand.press(Key::Enter);
    let frames = &hand.editor().session().document.extras().frames;
    assert_eq!(frames.values().map(|frame| frame.title.as_str()).collect::<Vec<_>>(), ["Vases"]);
}

#[test]
fn a_picture_of_the_meshes_is_saved_in_any_size() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut hand = Hand::with_files(folder.path(), vec![cube(folder.path())]);
    hand.wait_until_up_to_date();
    hand.wait_for_the_views();
    let path = folder.path().join("cube.png");
    hand.click("Picture…");
    hand.replace_text("path of the picture", &path.display().to_string());
    hand.type_number("width of the picture", "640");
    hand.type_number("height of the picture", "800");
    hand.click("Transparent background");
    hand.click("Save picture");
    let written = format!("wrote {}", path.display());
    let start = std::time::Instant::now();
    while !hand.sees(&written) {
        assert!(start.elapsed().as_secs() < 60, "it takes too long");
        hand.step();
    }
    let picture = image::open(&path).expect("it is a picture").to_rgba8();
    assert_eq!(picture.dimensions(), (640, 800));
    // The cube is in the middle, and nothing in a corner.
    assert_eq!(picture.get_pixel(320, 400).0[3], 255);
    assert_eq!(picture.get_pixel(630, 10).0[3], 0);
}

#[test]
fn a_node_is_found_put_on_a_wire_and_set_with_others() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box"}, "info": {"module": "MeshInfo"},
        "cut": {"module": "Simplificator"}, "cut-2": {"module": "Simplificator"}},
        "links": ["box.mesh -> info.mesh"],
        "layout": {"box": [0, 0], "info": [700, 0], "cut": [300, 400], "cut-2": [600, 400]}}"#;
    let mut hand = Hand::with_text(folder.path(), map);
    hand.problems();
    hand.press_with(Modifiers::COMMAND, Key::F);
    hand.replace_text("find a node", "MESHINFO");
    hand.press(Key::Enter);
    let selected = hand.editor().session().document.selection().clone();
    assert_eq!(selected, [mve_editor::document::Item::Node("info".to_owned())].into());

    hand.point_at("canvas");
    hand.press(Key::Home);
    let wire = hand.place_of("output box.mesh").lerp(hand.place_of("input info.mesh"), 0.5);
    let middle = hand.place_of("node cut");
    hand.drag_held("node cut", wire - middle);
    let links: Vec<String> = hand.map().links.iter().map(ToString::to_string).collect();
    assert_eq!(links, ["cut.mesh -> info.mesh", "box.mesh -> cut.mesh"]);

    hand.point_at("canvas");
    hand.press_with(Modifiers::COMMAND, Key::A);
    assert!(hand.sees("2 Simplificator"));
    hand.click("whether target faces is on");
    for cut in ["cut", "cut-2"] {
        assert!(hand.map().nodes[cut].params.contains_key("target_faces"), "{cut}");
    }
}

#[test]
fn keys_that_nothing_reads_are_warned_of_with_their_line() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let map = "{\"mve\": 1, \"nodes\": {\n\"box\": {\"module\": \"Box\",\n\"flavor\": {}}}}";
    let mut hand = Hand::with_text(folder.path(), map);
    let problems = hand.problems();
    let [said] = problems.as_slice() else { panic!("{problems:?}") };
    assert!(said.contains("flavor"), "{said}");
    let line = |hand: &Hand, n| hand.sees_beginning(&format!("{said} (line {n}, column "));
    assert!(line(&hand, 2) || line(&hand, 3));
    hand.click_at("node box", 0.5, 0.05);
    assert!(hand.sees_beginning(said), "the node says it too");
}
