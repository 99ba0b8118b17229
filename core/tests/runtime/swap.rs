//! A program that puts one module in the place of another.

use std::path::Path;

use mve_core::testing::registry;
use mve_core::{Map, Program};

#[test]
fn a_program_varies_modules_with_their_parameters() {
    let text = r#"{"mve": 1, "nodes": {"n": {"module": "Add"}},
        "programs": {"p": {"steps": [{"n.amount": 2, "n.module": "Add"},
            {"n.how.by": 3, "n.module": "Pick"}, {"n.module": "Pock"}]}}}"#;
    let problems =
        Program::new(&Map::parse(text).unwrap(), "p", &registry(), Path::new("/")).err().unwrap();
    let problems: Vec<_> = problems.iter().map(ToString::to_string).collect();
    let expected = "program \"p\": n: there is no module \"Pock\"; did you mean \"Pick\"?";
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert!(problems[0].starts_with(expected), "{problems:?}");
}
