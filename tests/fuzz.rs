//! Broken maps: whatever a file says, loading and planning it gives a plan or problems.

use std::path::Path;

use mve_core::testing::plan_options;
use mve_core::{FileHashes, Map, Plan, Program};
use mve_modules::registry;
use mve_tests::maps;
use proptest::prelude::*;
use serde_json::Value as Json;

/// Loads, saves, checks and plans a map, and its programs, as `mve check` does.
fn digest(text: &str) {
    let Ok(map) = Map::parse(text) else { return };
    assert_eq!(map.to_text(), text);
    let mut changed = map.clone();
    changed.title.push('x');
    let saved = changed.to_text();
    let again = Map::parse(&saved).expect("what was saved loads");
    assert_eq!(again.to_text(), saved);
    let (folder, files) = (Path::new("/nowhere"), FileHashes::new());
    if let Err(problems) = Plan::new(&map, &registry(), &plan_options(folder, &files)) {
        assert!(problems.iter().any(|problem| problem.is_error()));
        assert!(problems.iter().all(|problem| problem.message.len() > 5));
    }
    for name in map.programs.keys() {
        if let Err(problems) = Program::new(&map, name, &registry(), folder) {
            assert!(!problems.is_empty());
        }
    }
}

fn texts() -> Vec<String> {
    maps().iter().map(|path| std::fs::read_to_string(path).expect("a map")).collect()
}

/// Every place in a JSON value, as a path.
fn places(json: &Json, here: String, all: &mut Vec<String>) {
    match json {
        Json::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(i, item)| places(item, format!("{here}/{i}"), all));
        }
        Json::Object(fields) => {
            let escape = |name: &str| name.replace('~', "~0").replace('/', "~1");
            fields.iter().for_each(|(name, f)| places(f, format!("{here}/{}", escape(name)), all));
        }
        _ => {}
    }
    all.push(here);
}

/// Values that stand where others should.
fn odd_value() -> impl Strategy<Value = Json> {
    prop_oneof![
        Just(Json::Null),
        Just(Json::from(true)),
        Just(Json::from(-1)),
        Just(Json::from(1e300)),
        Just(Json::from(u64::MAX)),
        Just(Json::from("")),
        Just(Json::from("../../x")),
        Just(Json::from("{a.b}{step}{")),
        Just(Json::from("\u{0}\u{202e}é")),
        Just(Json::from("model.mesh -> model.mesh")),
        Just(serde_json::json!([])),
        Just(serde_json::json!([[[]], {}])),
        Just(serde_json::json!({ "module": "Box", "params": { "segments": null } })),
        Just(serde_json::json!({ "Quadric": { "Quadric": {} } })),
        any::<i64>().prop_map(Json::from),
        ".{0,12}".prop_map(Json::from),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn changed_bytes(
        which in any::<prop::sample::Index>(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3u8), 1..6),
    ) {
        let texts = texts();
        let mut bytes = texts[which.index(texts.len())].clone().into_bytes();
        for (place, byte, how) in edits {
            let place = place.index(bytes.len());
            match how {
                0 => bytes[place] = byte,
                1 => bytes.insert(place, byte),
                _ => bytes.truncate(place.max(1)),
            }
        }
        digest(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn changed_values(
        which in any::<prop::sample::Index>(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), odd_value()), 1..4),
    ) {
        let texts = texts();
        let mut json: Json = serde_json::from_str(&texts[which.index(texts.len())]).expect("a map");
        for (place, value) in edits {
            let mut all = Vec::new();
            places(&json, String::new(), &mut all);
            if let Some(target) = json.pointer_mut(&all[place.index(all.len())]) {
                *target = value;
            }
        }
        digest(&json.to_string());
    }

    #[test]
    fn any_text(text in "\\PC{0,200}") {
        digest(&text);
    }
}

#[test]
fn deep_and_long_files_end() {
    digest(&"[".repeat(100_000));
    digest(&format!("{{\"mve\": 1, \"nodes\": {}1{}", "{\"a\":".repeat(100), "}".repeat(101)));
    let many: Vec<_> = (0..3000).map(|i| format!("\"n{i}\": {{\"module\": \"Print\"}}")).collect();
    let links: Vec<_> = (0..3000).map(|i| format!("\"n{i}.x -> n{}.y\"", i + 1)).collect();
    let (many, links) = (many.join(","), links.join(","));
    digest(&format!("{{\"mve\": 1, \"nodes\": {{{many}}}, \"links\": [{links}]}}"));
}
