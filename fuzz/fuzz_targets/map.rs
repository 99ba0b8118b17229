//! Any text as a map: it is saved as it was, and planned, or what is wrong with it is said.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use mve_core::testing::plan_options;
use mve_core::{FileHashes, Map, Plan, Program};
use mve_modules::registry;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let Ok(map) = Map::parse(text) else { return };
    assert_eq!(map.to_text(), text);
    let (folder, files) = (Path::new("/nowhere"), FileHashes::new());
    if let Err(problems) = Plan::new(&map, &registry(), &plan_options(folder, &files)) {
        assert!(problems.iter().any(|problem| problem.is_error()));
    }
    for name in map.programs.keys() {
        if let Err(problems) = Program::new(&map, name, &registry(), folder) {
            assert!(!problems.is_empty());
        }
    }
});
