//! Plans: what a good map becomes, and that a bad one is refused with every problem at once.

use std::path::Path;

use mve_core::testing::{plan_options, registry};
use mve_core::{FileHashes, Map, Plan, PlanOptions, assign};
use serde_json::json;

fn plan_in(folder: &Path, text: &str, repeat: u32) -> Result<Plan, Vec<String>> {
    let map = Map::parse(text).unwrap();
    let files = FileHashes::new();
    let output_folder = Some(folder);
    let options = PlanOptions { output_folder, repeat, ..plan_options(folder, &files) };
    Plan::new(&map, &registry(), &options).map_err(|p| p.iter().map(|p| p.to_string()).collect())
}

fn plan(text: &str) -> Result<Plan, Vec<String>> {
    plan_in(Path::new("/nowhere"), text, 0)
}

const CHAIN: &str = r#"{"mve": 1, "nodes": {
    "last": {"module": "Add", "params": {"amount": 3}},
    "first": {"module": "Add", "params": {"amount": 2}}},
    "links": ["first.sum -> last.a"]}"#;

#[test]
fn nodes_come_in_running_order() {
    let names: Vec<_> = plan(CHAIN).unwrap().nodes.into_iter().map(|node| node.name).collect();
    assert_eq!(names, ["first", "last"]);
}

#[test]
fn every_problem_is_listed_at_once() {
    let problems = plan(
        r#"{"mve": 1, "nodes": {
            "a": {"module": "Add", "params": {"amount": 1000, "amuont": 1}},
            "b": {"module": "Ad"},
            "c": {"module": "Echo"},
            "d": {"module": "Write", "params": {"path": "../x.txt"}},
            "e": {"module": "Read", "params": {"path": "missing.txt"}},
            "f": {"module": "Pick", "params": {"how": {"Scaled": {"by": "two"}}}},
            "g h": {"module": "Echo"}},
          "links": ["c.text -> a.a", "c.txet -> d.text", "x.y -> a.a", "c.text -> c.say",
                    "c.text -> d.path"]}"#,
    )
    .unwrap_err();
    let expected = [
        "a.amount: 1000 is not a number from -100 to 100",
        "a.amuont: there is no parameter of this name; did you mean \"amount\"?",
        "b: there is no module \"Ad\"; did you mean \"Add\"?",
        "a.a: takes Number, but \"c.text\" gives Text",
        "Echo has no such output; it has text; did you mean \"text\"?",
        "there is no node \"x\"",
        "c: the links run in a circle: c -> c",
        "d.path: link \"c.text -> d.path\": this parameter must be set in the map",
        "e.path: /nowhere/missing.txt: there is no such file",
        "f.how.by: \"two\" is not a number",
        "g h: a node's name cannot",
    ];
    for text in expected {
        assert!(problems.iter().any(|p| p.contains(text)), "{text}\nis not in {problems:#?}");
    }
}

#[test]
fn a_circle_is_named() {
    let problems = plan(
        r#"{"mve": 1, "nodes": {"a": {"module": "Add"}, "b": {"module": "Add"},
            "c": {"module": "Add"}},
            "links": ["a.sum -> b.a", "b.sum -> c.a", "c.sum -> b.amount"]}"#,
    )
    .unwrap_err();
    assert!(problems[0].contains("circle: c -> b -> c"), "{problems:?}");
}

#[test]
fn output_names_are_filled_in_and_may_not_meet() {
    let map = |one: &str, two: &str| {
        format!(
            r#"{{"mve": 1, "nodes": {{"e": {{"module": "Echo", "params": {{"say": "../x/y"}}}},
            "p": {{"module": "Pick"}},
            "one": {{"module": "Write", "params": {{"path": "{one}"}}}},
            "two": {{"module": "Write", "params": {{"path": "{two}"}}}}}},
            "links": ["e.text -> one.text", "e.text -> two.text"]}}"#
        )
    };
    let good = plan(&map("{e.say}-{p.how}-{p.how.by}.txt", "b/{step}.txt")).unwrap();
    let written = |name: &str| good.find(name).unwrap().writes[0].to_str().unwrap().to_owned();
    assert_eq!(written("one"), "..-x-y-Scaled-2.txt");
    assert_eq!(written("two"), format!("b/{}.txt", good.id.short()));
    assert!(plan(&map("a.txt", "./a.txt")).unwrap_err()[0].contains("writes \"a.txt\" too"));
    assert!(plan(&map("a.txt", "a.txt/b.txt")).unwrap_err()[0].contains("as a folder, which"));
    assert!(plan(&map("{e.sya}", "b")).unwrap_err()[0].contains("no such parameter"));
    assert!(plan(&map("{e.say", "b")).unwrap_err()[0].contains("do not pair"));
}

#[test]
fn a_map_does_not_overwrite_what_it_reads() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.txt"), "a").unwrap();
    let text = r#"{"mve": 1, "nodes": {"r": {"module": "Read", "params": {"path": "a.txt"}},
        "w": {"module": "Write", "params": {"path": "a.txt"}}}, "links": ["r.text -> w.text"]}"#;
    let problems = plan_in(folder.path(), text, 0).unwrap_err();
    assert!(problems[0].contains("would overwrite"), "{problems:?}");
}

#[test]
fn keys_know_content_and_parameters_and_not_places() {
    let read = |folder: &Path, name: &str| {
        let map = format!(
            r#"{{"mve": 1, "nodes": {{"r": {{"module": "Read", "params": {{"path": "{name}"}}}}}}}}"#
        );
        plan_in(folder, &map, 0).unwrap().nodes[0].key
    };
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    std::fs::write(one.path().join("a"), "same").unwrap();
    std::fs::write(two.path().join("b"), "same").unwrap();
    std::fs::write(two.path().join("c"), "other").unwrap();
    assert_eq!(read(one.path(), "a"), read(two.path(), "b"));
    assert_ne!(read(one.path(), "a"), read(two.path(), "c"));

    let last = |amount: &str| {
        let chain = CHAIN.replace("\"amount\": 2", &format!("\"amount\": {amount}"));
        plan(&chain).unwrap().find("last").unwrap().key
    };
    assert_eq!(last("2"), last("2.0"));
    assert_ne!(last("2"), last("2.5")); // what comes before counts
}

#[test]
fn a_repeat_is_a_step_of_its_own() {
    let ids = [0, 1].map(|repeat| plan_in(Path::new("/"), CHAIN, repeat).unwrap().id);
    assert_ne!(ids[0], ids[1]);
}

#[test]
fn assignments_reach_into_choices() {
    let mut map = Map::parse(r#"{"mve": 1, "nodes": {"p": {"module": "Pick"}}}"#).unwrap();
    let mut set = |path: &str, value| {
        assign(&mut map, &registry(), path, value).map_err(|p| p.to_string())?;
        Ok::<_, String>(map.nodes["p"].params.clone())
    };
    let nested = json!({"how": {"Scaled": {"by": 5}}});
    assert_eq!(json!(set("p.how.by", json!(5)).unwrap()), nested);
    assert_eq!(json!(set("p.how", json!("Scaled")).unwrap()), nested); // keeps what is under it
    assert_eq!(json!(set("p.how", json!("Zero")).unwrap()), json!({"how": "Zero"}));
    assert!(set("p.how.by", json!(1)).unwrap_err().contains("of Zero"));
    set("p.module", json!("Echo")).unwrap();
    assert!(set("p.how", json!("Zero")).unwrap_err().contains("no parameter \"how\""));
    assert!(set("q.how", json!(1)).unwrap_err().contains("there is no node \"q\""));
    assert!(set("p", json!(1)).unwrap_err().contains("write node.param"));
}

#[test]
fn what_is_set_to_no_effect_is_told() {
    use mve_core::testing::settings_of;
    use mve_core::{Condition, Listed, Module, ModuleList, Param, Registry};

    const FAR: Condition = Condition::Is { param: "say", value: "far" };
    const BY: Param<f64> = Param::number("by", "How far.", 1.0).only_where(FAR);
    const MOST: Param<Option<f64>> = Param::maybe_number("most", "At most.", None);
    const PART: Param<f64> =
        Param::number("part", "Else.", 0.5).only_where(Condition::IsOff { param: "most" });
    const SAY: Param<String> = Param::text("say", "What.", "near");
    static GO: Module = Module {
        id: "Go",
        summary: "Goes.",
        inputs: &[],
        outputs: &[],
        params: &[SAY.spec(), BY.spec(), MOST.spec(), PART.spec()],
        run: |_| Ok(()),
    };
    static LIST: ModuleList =
        ModuleList { category: "test", modules: &[Listed { item: &GO, source: 1 }] };

    let warnings = |params: serde_json::Value| {
        settings_of(GO.params, params.as_object().unwrap());
        let text = json!({"mve": 1, "nodes": {"n": {"module": "Go", "params": params}}});
        let files = FileHashes::new();
        let options = plan_options(Path::new("/"), &files);
        let map = Map::parse(&text.to_string()).unwrap();
        let plan = Plan::new(&map, &Registry::new().with(&[&LIST], "test"), &options).unwrap();
        plan.warnings.iter().map(|warning| warning.to_string()).collect::<Vec<_>>()
    };
    let none = [""; 0];
    assert_eq!(warnings(json!({})), none);
    assert_eq!(warnings(json!({"say": "far", "by": 2, "part": 0.1, "most": null})), none);
    let expected = "n.by: has no effect: it counts only where say is far";
    assert_eq!(warnings(json!({"by": 2})), [expected]);
    let expected = "n.part: has no effect: it counts only where most is off";
    assert_eq!(warnings(json!({"part": 0.1, "most": 3})), [expected]);
}

#[test]
fn a_mistyped_path_names_the_entry_and_what_was_meant() {
    let mut map = Map::parse(r#"{"mve": 1, "nodes": {"n": {"module": "Pick"}}}"#).unwrap();
    let mut said = |path: &str| assign(&mut map, &registry(), path, json!(1)).unwrap_err().message;
    let expected = "there is no parameter \"bi\" of Scaled; did you mean \"by\"?";
    assert_eq!(said("n.how.bi"), expected);
    assert_eq!(said("n.how.x"), "there is no parameter \"x\" of Scaled");
    assert_eq!(said("n.ho"), "there is no parameter \"ho\"; did you mean \"how\"?");
}

#[test]
fn a_node_that_cannot_be_read_is_one_problem() {
    for part in [r#""modul": "Add""#, r#""module": "Add", "repeat": {"times": "x"}"#] {
        let text = CHAIN.replace(r#""module": "Add", "params": {"amount": 2}"#, part);
        let problems = plan(&text).unwrap_err();
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert!(problems[0].starts_with("first"), "{problems:?}");
    }
}
