//! The panel without a window: what it makes of a dragged parameter, and where steps go.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use mve_core::{Map, ProgramSpec};
use serde_json::json;

use super::run::check::check;
use super::*;

fn map(programs: Json) -> Arc<Map> {
    let text = json!({
        "mve": 1,
        "nodes": {
            "make": {"module": "Box", "params": {"segments": 8}},
            "cut": {"module": "Simplificator"},
        },
        "links": ["make.mesh -> cut.mesh"],
        "programs": programs,
    });
    Arc::new(Map::parse(&text.to_string()).unwrap())
}

fn vary(map: &Arc<Map>, node: &str, param: &str) -> (String, ProgramSpec) {
    let registry = mve_modules::registry();
    let here = Path::new(".");
    let map_file = Some(Path::new("box.json"));
    let folder = here.to_owned();
    let counts = Box::new(|node: &str| match node {
        "cut" => vec![("faces", 69_451)],
        _ => Vec::new(),
    });
    let output_folder = here;
    let (registry, allowed) = (&registry, &BTreeSet::new());
    let scene = ProgramScene { map, folder, map_file, registry, output_folder, allowed, counts };
    let mut panel = ProgramPanel::new(Arc::new(|| ()));
    match panel.vary(node, param, &scene).remove(0) {
        ProgramAction::SetProgram { name, spec: Some(spec) } => (name, spec),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_dragged_parameter_becomes_an_axis_of_two_values() {
    let (name, spec) = vary(&map(json!({})), "make", "segments");
    assert_eq!(name, "sweep");
    assert_eq!(json!(spec), json!({"axes": [{"make.segments": [8, 16]}]}));
}

#[test]
fn an_axis_of_counts_halves_what_comes_in() {
    let (_, spec) = vary(&map(json!({})), "cut", "target_faces");
    assert_eq!(json!(spec), json!({"axes": [{"cut.target_faces": [34_726, 17_363, 8_681]}]}));
    let programs = json!({"old": {"axes": [{"cut.target_faces": [34_726, 17_363, 8_681]}]}});
    let (_, spec) = vary(&map(programs), "cut", "target_faces");
    assert_eq!(spec.axes[0]["cut.target_faces"][3], json!(4_340));
    // One that is given is halved too: twice as many as 34,726 are more than there are.
    let mut given = Map::clone(&map(json!({})));
    let cut = given.nodes.get_mut("cut").unwrap();
    cut.params.insert("target_faces".to_owned(), json!(34_726));
    let (_, spec) = vary(&Arc::new(given), "cut", "target_faces");
    assert_eq!(json!(spec), json!({"axes": [{"cut.target_faces": [34_726, 17_363, 8_682]}]}));
    let programs = json!({"old": {"axes": [{"cut.target_faces": [34_726]}]}});
    let (_, spec) = vary(&map(programs), "cut", "target_faces");
    assert_eq!(spec.axes[0]["cut.target_faces"][1], json!(17_363));
}

#[test]
fn a_parameter_that_is_varied_gets_one_more_value() {
    let programs = json!({"old": {"axes": [{"make.segments": [1, 4]}], "note": [1]}});
    let (name, spec) = vary(&map(programs), "make", "segments");
    assert_eq!(name, "old");
    assert_eq!(json!(spec), json!({"axes": [{"make.segments": [1, 4, 16]}], "note": [1]}));
}

#[test]
fn a_step_is_loaded_in_an_order_that_works() {
    let params = [("b.way.weight", json!(1)), ("b.way", json!("A")), ("b.module", json!("M"))];
    let params = params.into_iter().map(|(path, value)| (path.to_owned(), value)).collect();
    let step = mve_core::Step { id: String::new(), repeat: 0, params };
    let ProgramAction::LoadStep(params) = load_step(&step) else { panic!() };
    let paths: Vec<_> = params.iter().map(|(_, path, _)| path.as_str()).collect();
    assert_eq!(paths, ["module", "way", "way.weight"]);
}

#[test]
fn results_go_where_the_command_puts_them() {
    let (map, registry) = (map(json!({})), Registry::new());
    let folder = |map_file: Option<&str>, program| {
        let (folder, output_folder) = (PathBuf::new(), Path::new("mve-out"));
        let map_file = map_file.map(Path::new);
        let (registry, counts) = (&registry, Box::new(|_: &str| Vec::new()));
        let (map, allowed) = (&map, &BTreeSet::new());
        let scene =
            ProgramScene { map, folder, map_file, registry, output_folder, allowed, counts };
        scene.store_folder(program)
    };
    assert_eq!(folder(Some("vase.json"), "costs"), Path::new("mve-out/vase-costs"));
    assert_eq!(folder(None, "a/b"), Path::new("mve-out/map-a-b"));
}

#[test]
fn results_of_another_map_of_this_name_are_told() {
    let base = tempfile::tempdir().unwrap();
    let text = r#"{"mve": 1, "nodes": {"a": {"module": "Echo"}}, "programs": {"p": {}}}"#;
    let registry = mve_core::testing::registry();
    let map = Arc::new(mve_core::Map::parse(text).unwrap());
    let subject = |folder: &str, map_file: Option<&str>| {
        let folder = base.path().join(folder);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("m.json"), text).unwrap();
        let map_file = map_file.map(|file| folder.join(file));
        let (map, name) = (Arc::clone(&map), "p".to_owned());
        let (registry, store) = (registry.clone(), base.path().join("store"));
        ProgramSubject { map, name, folder, map_file, registry, store }
    };
    let first = check(subject("one", Some("m.json")));
    assert_eq!(first.trouble, None);
    let store = mve_core::Store::open(&base.path().join("store")).unwrap();
    let cancel = mve_core::CancelToken::new();
    let options = mve_core::testing::program_options(&cancel);
    mve_core::run_program(&first.program.unwrap(), &store, &options).unwrap();
    assert_eq!(check(subject("one", Some("m.json"))).trouble, None);
    let trouble = check(subject("two", Some("m.json"))).trouble.unwrap();
    assert!(trouble.contains("one/m.json") && trouble.contains("another map"), "{trouble}");
    assert_eq!(check(subject("two", None)).trouble, None);
}

#[test]
fn the_file_of_a_map_is_found_from_where_the_window_was_started() {
    let text = r#"{"mve": 1, "nodes": {"a": {"module": "Echo"}}, "programs": {"p": {}}}"#;
    let map = Arc::new(mve_core::Map::parse(text).unwrap());
    let folder = PathBuf::from("maps");
    let map_file = Some(folder.join("m.json"));
    let (name, registry) = ("p".to_owned(), mve_core::testing::registry());
    let store = PathBuf::from("no-such-folder");
    let subject = ProgramSubject { map, name, folder, map_file, registry, store };
    let program = check(subject).program.unwrap();
    assert_eq!(program.map_file, "m.json");
    assert_eq!(program.map_path, std::env::current_dir().unwrap().join("maps/m.json"));
}
