//! Muted and bypassed nodes: what is left of the plan, and what is told.

use std::path::Path;

use mve_core::testing::registry;
use mve_core::{
    CommandScope, FileHashes, Map, OutputScope, Plan, PlanOptions, Problem, Program, schema,
};

fn plan(text: &str) -> Result<Plan, Vec<Problem>> {
    let options = PlanOptions {
        map_folder: Path::new("/nowhere"),
        output_folder: None,
        output_scope: OutputScope::Folder,
        command_scope: CommandScope::Nothing,
        repeat: 0,
        files: &FileHashes::new(),
    };
    Plan::new(&Map::parse(text).unwrap(), &registry(), &options)
}

fn names(plan: &Plan) -> Vec<&str> {
    plan.nodes.iter().map(|node| node.name.as_str()).collect()
}

fn warnings(plan: &Plan) -> Vec<String> {
    plan.warnings.iter().map(Problem::to_string).collect()
}

/// `first -> second -> third`, and a saver of the text of `echo` that is named after `second`.
fn chain(first: &str, second: &str, echo: &str) -> String {
    format!(
        r#"{{"mve": 1, "nodes": {{
            "first": {{"module": "Add", "mode": "{first}"}},
            "second": {{"module": "Add", "mode": "{second}", "params": {{"amount": 5}}}},
            "third": {{"module": "Add"}},
            "echo": {{"module": "Echo", "mode": "{echo}"}},
            "save": {{"module": "Write", "params": {{"path": "{{second.amount}}.txt"}}}}}},
          "links": ["first.sum -> second.a", "second.sum -> third.a", "echo.text -> save.text"]}}"#
    )
}

#[test]
fn a_muted_node_takes_those_along_that_need_it() {
    let plan = plan(&chain("active", "active", "muted")).unwrap();
    assert_eq!(names(&plan), ["first", "second", "third"]);
    let told = ["echo: is muted", "save.text: is left out: needs echo.text, which is muted"];
    assert_eq!(warnings(&plan), told);
}

#[test]
fn an_optional_input_of_a_muted_node_is_as_if_unlinked() {
    let muted = plan(&chain("active", "muted", "active")).unwrap();
    assert_eq!(names(&muted), ["first", "third", "echo", "save"]);
    assert_eq!(warnings(&muted), ["second: is muted"]);
    let alone = plan(r#"{"mve": 1, "nodes": {"third": {"module": "Add"}}}"#).unwrap();
    assert_eq!(muted.find("third").unwrap().key, alone.nodes[0].key);
    // Names of files may quote what does not run.
    assert_eq!(muted.find("save").unwrap().writes[0].to_str(), Some("5.txt"));
}

#[test]
fn a_bypassed_node_passes_on_what_it_gets() {
    let bypassed = plan(&chain("active", "bypassed", "active")).unwrap();
    let direct = plan(
        r#"{"mve": 1, "nodes": {"first": {"module": "Add"}, "third": {"module": "Add"}},
            "links": ["first.sum -> third.a"]}"#,
    );
    let direct = direct.unwrap();
    assert_eq!(bypassed.find("third").unwrap().key, direct.find("third").unwrap().key);
    assert_eq!(warnings(&bypassed), ["second: is bypassed"]);
    // Two in a row, with nothing before them: the optional input is as if unlinked.
    let both = plan(&chain("bypassed", "bypassed", "active")).unwrap();
    let alone = plan(r#"{"mve": 1, "nodes": {"third": {"module": "Add"}}}"#).unwrap();
    assert_eq!(both.find("third").unwrap().key, alone.nodes[0].key);
}

#[test]
fn an_output_without_an_input_of_its_type_acts_as_muted() {
    let plan = plan(&chain("active", "active", "bypassed")).unwrap();
    assert_eq!(names(&plan), ["first", "second", "third"]);
    let told =
        "save.text: is left out: needs echo.text, which is bypassed and has nothing to pass on";
    assert_eq!(warnings(&plan)[1], told);
}

#[test]
fn what_is_wrong_with_a_muted_node_stops_nothing() {
    let text = r#"{"mve": 1, "nodes": {
        "a": {"module": "Nowhere", "mode": "muted"},
        "b": {"module": "Read", "mode": "muted", "params": {"path": "missing.txt"}},
        "c": {"module": "Add", "mode": "bypassed", "params": {"amount": 1000}},
        "d": {"module": "Add"}},
      "links": ["c.sum -> c.a", "c.sum -> d.a", "a.x -> d.amount"]}"#;
    assert_eq!(names(&plan(text).unwrap()), ["d"]);
    let problems =
        plan(&text.replace("{\"module\": \"Add\"}", "{\"module\": \"Add\", \"mode\": \"muted\"}"));
    let problems = problems.unwrap_err();
    assert_eq!(
        problems.last().unwrap().to_string(),
        "no node runs: each is muted or bypassed, or needs one that is"
    );
    let odd = plan(r#"{"mve": 1, "nodes": {"a": {"module": "Add", "mode": "loud"}}}"#).unwrap_err();
    assert_eq!(odd[0].to_string(), "a.mode: \"loud\" is not \"active\", \"muted\" or \"bypassed\"");
}

#[test]
fn a_program_may_set_what_is_muted() {
    let text = chain("active", "muted", "active").replace(
        "\"links\"",
        r#""programs": {"p": {"axes": [{"second.amount": [1, 2]}, {"first.amount": [3, 4]}]}}, "links""#,
    );
    let text = text.replace("{second.amount}", "{second.amount}-{first.amount}");
    let map = Map::parse(&text).unwrap();
    let program = Program::new(&map, "p", &registry(), Path::new("/nowhere")).unwrap();
    assert_eq!(program.steps.len(), 4);
    assert_eq!(program.warnings.len(), 1);
    assert!(program.warnings[0].message.starts_with("is muted"), "{:?}", program.warnings);
}

#[test]
fn the_mode_is_written_only_where_it_says_something() {
    let mut map = Map::parse(&chain("active", "muted", "bypassed")).unwrap();
    map.title = "changed".to_owned();
    let text = map.to_text();
    assert!(text.contains(r#""second": { "module": "Add", "mode": "muted", "params""#), "{text}");
    assert!(text.contains(r#""first": { "module": "Add" }"#), "{text}");
    let schema = schema(&registry());
    let node = &schema["properties"]["nodes"]["additionalProperties"]["properties"];
    assert_eq!(node["mode"]["enum"][1], "muted");
}
