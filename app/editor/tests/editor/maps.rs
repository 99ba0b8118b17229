//! Maps of nodes: made, opened in a tab, changed there, unpacked; and loops.

use eframe::egui::{Key, Modifiers};
use mve_core::{FileHashes, Map, Plan, testing::plan_options};
use mve_editor::document::{Document, Edit};
use mve_modules::registry;

use crate::hand::Hand;

const CHAIN: &str = r#"{"mve": 1, "nodes": {
    "box": {"module": "Box", "params": {"segments": 4}},
    "cut": {"module": "Simplificator", "params": {"target_faces": 20}},
    "smooth": {"module": "Smooth", "params": {"steps": 2}},
    "info": {"module": "MeshInfo"}},
  "links": ["box.mesh -> cut.mesh", "cut.mesh -> smooth.mesh", "smooth.mesh -> info.mesh"],
  "programs": {"p": {"axes": [{"cut.target_faces": [20, 40]}]}}}"#;

/// The keys of a plan, by what runs.
fn keys(map: &Map) -> Vec<(String, String)> {
    let files = FileHashes::new();
    let registry = registry().with_maps_of(map, std::path::Path::new(""));
    let options = plan_options(std::path::Path::new(""), &files);
    let plan = Plan::new(map, &registry, &options).unwrap();
    let key = |node: &mve_core::PlanNode| (node.info.module.id.to_owned(), node.key.to_string());
    let mut keys: Vec<_> = plan.nodes.iter().map(key).collect();
    keys.retain(|(module, _)| module != "group");
    keys.sort();
    keys
}

#[test]
fn a_map_of_nodes_does_what_they_did_and_unpacks_to_them() {
    let mut document = Document::from_text(CHAIN).unwrap();
    let before = keys(document.map());
    let nodes = vec!["cut".to_owned(), "smooth".to_owned()];
    document.apply(&[Edit::MakeMap { nodes, name: None }], &registry()).unwrap();
    let map = document.map();
    assert_eq!(map.nodes.keys().collect::<Vec<_>>(), ["box", "info", "group"]);
    let links: Vec<String> = map.links.iter().map(ToString::to_string).collect();
    assert_eq!(links, ["box.mesh -> group.mesh", "group.mesh -> info.mesh"]);
    assert_eq!(keys(map), before);
    // What a program varied is a parameter of the map now.
    assert_eq!(map.programs["p"].axes[0].keys().collect::<Vec<_>>(), ["group.target_faces"]);
    assert_eq!(map.maps["group"].parameters["target_faces"].paths(), ["cut.target_faces"]);
    let again = Map::parse(document.text()).unwrap();
    assert_eq!((again.problems(), again.to_text().as_str()), (&[][..], document.text()));
    let known = registry().with_maps_of(document.map(), std::path::Path::new(""));
    document.apply(&[Edit::Unpack { node: "group".to_owned() }], &known).unwrap();
    let map = document.map();
    assert_eq!(keys(map), before);
    assert_eq!(map.programs["p"].axes[0].keys().collect::<Vec<_>>(), ["cut.target_faces"]);
    assert!(map.maps.is_empty());
    document.undo();
    document.undo();
    assert_eq!(document.text(), CHAIN);
}

#[test]
fn a_hand_makes_a_map_changes_it_in_its_tab_and_runs_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = Hand::with_text(folder.path(), CHAIN);
    hand.step();
    hand.click_at("node cut", 0.5, 0.05);
    hand.point_within("node cut", 0.5, 0.05);
    hand.press_with(Modifiers::COMMAND, Key::G);
    hand.step();
    assert!(hand.map().maps.contains_key("group"), "{}", hand.map().to_text());
    // One change by hand inside.
    hand.click_at("node group", 0.5, 0.05);
    hand.point_within("node group", 0.5, 0.05);
    hand.press(Key::Enter);
    hand.step();
    assert_eq!(hand.editor().session().title(), "\u{25b8} group");
    assert!(hand.sees("node cut"));
    hand.click_at("node cut", 0.5, 0.05);
    hand.step();
    hand.type_number("target faces", "30");
    hand.step();
    hand.press_with(Modifiers::COMMAND, Key::S);
    hand.step();
    let saved = Map::load(&folder.path().join("map.json")).unwrap();
    assert_eq!(saved.maps["group"].nodes["cut"].params["target_faces"], 30);
    assert!(!hand.editor().session().document.is_dirty());
    hand.press_with(Modifiers::COMMAND, Key::W);
    hand.step();
    assert_eq!(hand.map().maps["group"].nodes["cut"].params["target_faces"], 30);
    hand.click("\u{25b6} Run");
    hand.wait_for_the_run();
    assert_eq!(hand.problems(), Vec::<String>::new());
    let faces = |hand: &Hand| hand.editor().session().counts("info")[0];
    assert_eq!(faces(&hand), ("faces", 30));
}

#[test]
fn a_loop_is_made_and_its_table_is_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let map = r#"{"mve": 1, "nodes": {"box": {"module": "Box", "params": {"segments": 4}},
        "smooth": {"module": "Smooth"}, "info": {"module": "MeshInfo"}},
        "links": ["box.mesh -> smooth.mesh", "smooth.mesh -> info.mesh"]}"#;
    let mut hand = Hand::with_text(folder.path(), map);
    hand.step();
    hand.click_at("node smooth", 0.5, 0.05);
    hand.step();
    hand.click("Repeat…");
    hand.step();
    assert_eq!(hand.map().nodes["smooth"].repeat.as_ref().and_then(|r| r.times), Some(3));
    hand.click("\u{25b6} Run");
    hand.wait_for_the_run();
    assert_eq!(hand.problems(), Vec::<String>::new());
    let session = hand.editor().session();
    assert!(session.runner.value("smooth", "mesh").is_some());
    assert!(session.runner.ended("smooth/3").is_some());
    hand.click("Once only");
    hand.step();
    assert_eq!(hand.map().nodes["smooth"].repeat, None);
}

/// The map of the first node of this name, in its own tab.
fn open_inside(hand: &mut Hand, node: &str) {
    hand.step();
    hand.click_at(node, 0.5, 0.05);
    hand.point_within(node, 0.5, 0.05);
    hand.press(Key::Enter);
    hand.step();
}

fn shipped(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps").join(name)
}

#[test]
fn a_part_of_a_map_has_no_problems_but_its_own_and_says_where_it_runs() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = Hand::with_map(folder.path(), &shipped("loops.json"));
    open_inside(&mut hand, "node angles");
    assert_eq!(hand.editor().session().title(), "\u{25b8} smoothed");
    assert_eq!(hand.problems(), Vec::<String>::new());
    hand.step();
    assert!(hand.sees_beginning("This is a part of another map"));
    let why = "does not run: it takes a value from outside: it runs in the map around this one";
    assert_eq!(hand.description("node smooth"), why);
    hand.press(Key::F5);
    assert!(!hand.editor().session().runner.is_running());
    // What is wrong in it is told all the same.
    let edit = Edit::SetParam {
        node: "smooth".to_owned(),
        path: "steps".to_owned(),
        value: Some("many".into()),
    };
    hand.edit(&[edit]);
    let problems = hand.problems();
    assert!(problems.len() == 1 && problems[0].starts_with("smooth.steps: "), "{problems:?}");
}

#[test]
fn a_loop_shows_its_rounds_and_takes_the_seconds_of_what_is_inside() {
    let folder = tempfile::tempdir().unwrap();
    let mut hand = Hand::with_map(folder.path(), &shipped("loops.json"));
    hand.step();
    assert!(hand.sees("angles.steps: 1, 4, 16"));
    assert!(hand.sees("coarser.share: 0.6"));
    hand.click("\u{25b6} Run");
    hand.wait_for_the_run();
    let session = hand.editor().session();
    let inside = session.runner.all_ended().filter(|(name, _)| name.starts_with("coarser/"));
    let inside: f64 = inside
        .filter(|(name, _)| name.matches('/').count() == 2)
        .filter_map(|(_, ended)| ended.record.seconds)
        .sum();
    let said = session.runner.seconds("coarser").unwrap();
    assert!(said >= 0.99 * inside && inside > 0.0, "{said} {inside}");
}
