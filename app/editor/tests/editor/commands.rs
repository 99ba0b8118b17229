//! Outside programs of a map: shown and asked for before they run.

use eframe::egui::Key;

use crate::hand::Hand;

const MAP: &str = r#"{"mve": 1, "nodes": {
    "box": {"module": "Box", "params": {"segments": 8}},
    "call": {"module": "Command", "params": {"command": ["touch", "PLACE"]}}},
    "links": ["box.mesh -> call.mesh"],
    "programs": {"p": {"axes": [{"box.segments": [1, 2]}]}}}"#;

const QUESTION: &str = "Run outside programs?";

#[test]
fn outside_programs_run_once_a_person_has_seen_them() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let place = folder.path().join("touched");
    let command = format!("touch {}", place.display());
    let map = MAP.replace("PLACE", place.to_str().expect("it is text"));
    let mut hand = Hand::with_text(folder.path(), &map);
    // Nothing is wrong with it: Run asks.
    assert_eq!(hand.problems(), Vec::<String>::new());
    hand.step();
    assert!(hand.sees("Ready to run (F5); asks before it runs an outside program."));
    assert_eq!(hand.description("node call"), "has not run yet");
    hand.click("on edit");
    hand.click("box.segments: 8");
    hand.type_text("4");
    hand.press(Key::Enter);
    hand.problems();
    hand.wait_for_the_run();
    assert!(!hand.sees(QUESTION) && !place.exists());
    hand.press(Key::F5);
    hand.wait_for_the_run();
    hand.step();
    assert!(hand.sees(QUESTION) && hand.sees(&command) && !place.exists());
    hand.click("Cancel");
    assert!(!hand.sees(QUESTION));
    hand.press(Key::F5);
    hand.wait_for_the_run();
    hand.step();
    hand.click("Run the rest without them");
    hand.wait_for_the_run();
    assert!(hand.editor().session().runner.value("box", "mesh").is_some());
    assert!(!place.exists());
    hand.press(Key::F5);
    hand.wait_for_the_run();
    hand.step();
    hand.click("Run them");
    hand.wait_for_the_run();
    assert!(place.exists() && !hand.sees(QUESTION));
    // Once for the map: also for a run on edit.
    std::fs::remove_file(&place).expect("it is there");
    hand.click("box.segments: 4");
    hand.type_text("5");
    hand.press(Key::Enter);
    hand.wait_until_up_to_date();
    assert!(place.exists() && !hand.sees(QUESTION));
}
