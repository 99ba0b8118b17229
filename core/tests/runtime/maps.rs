//! Maps as nodes of maps, loops, and inputs that take many links.

use std::path::Path;

use mve_core::testing::{plan_options, registry_with_maps as registry, run_options};
use mve_core::{
    CancelToken, FileHashes, Keep, Map, NodeStatus, Plan, Program, RunOptions, RunOutcome, assign,
    run,
};
use serde_json::{Value as Json, json};

fn map(parts: Json) -> Map {
    let mut map = json!({"mve": 1});
    map.as_object_mut().unwrap().extend(parts.as_object().unwrap().clone());
    Map::parse(&map.to_string()).unwrap()
}

fn plan_in(folder: &Path, map: &Map) -> Result<Plan, Vec<String>> {
    let files = FileHashes::new();
    let options = plan_options(folder, &files);
    let said = |problems: Vec<mve_core::Problem>| {
        let errors = problems.into_iter().filter(|problem| problem.is_error());
        errors.map(|problem| problem.to_string()).collect()
    };
    Plan::new(map, &registry(), &options).map_err(said)
}

fn plan(parts: Json) -> Result<Plan, Vec<String>> {
    plan_in(Path::new("/nowhere"), &map(parts))
}

fn outcome(plan: &Plan) -> RunOutcome {
    let folder = tempfile::tempdir().unwrap();
    let cancel = CancelToken::new();
    let options = RunOptions { keep: Keep::All, ..run_options(folder.path(), &cancel) };
    run(plan, &options)
}

fn number(outcome: &RunOutcome, node: &str, output: &str) -> f64 {
    let outcome = &outcome.nodes[node];
    assert_eq!(outcome.record.status, NodeStatus::Done, "{node}");
    *outcome.outputs[output].get::<f64>().unwrap()
}

/// A map that adds twice: `a`, and twice `by`.
fn twice() -> Json {
    json!({
        "nodes": {
            "in": {"module": "MapInput", "params": {"name": "a"}},
            "one": {"module": "Add"}, "two": {"module": "Add"},
            "out": {"module": "MapOutput", "params": {"name": "sum"}}},
        "links": ["in.value -> one.a", "one.sum -> two.a", "two.sum -> out.value"],
        "parameters": {"by": ["one.amount", "two.amount"]}
    })
}

/// `first -> twice -> last`.
fn with_twice(params: Json) -> Json {
    json!({
        "nodes": {"first": {"module": "Add", "params": {"amount": 10}},
                  "t": {"module": "twice", "params": params},
                  "last": {"module": "Add", "params": {"amount": 100}}},
        "links": ["first.sum -> t.a", "t.sum -> last.a"],
        "maps": {"twice": twice()}
    })
}

#[test]
fn a_map_is_a_node_with_the_keys_of_what_is_inside() {
    let inner = plan(with_twice(json!({"by": 3}))).unwrap();
    let names: Vec<&str> = inner.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names.len(), 5, "{names:?}");
    let outcome = outcome(&inner);
    assert_eq!(number(&outcome, "last", "sum"), 116.0);
    assert_eq!(number(&outcome, "t", "sum"), 16.0);
    assert_eq!(number(&outcome, "t/one", "sum"), 13.0);
    let seconds = |name: &str| outcome.nodes[name].record.seconds.unwrap();
    assert_eq!(seconds("t"), seconds("t/one") + seconds("t/two"));
    let flat = plan(json!({
        "nodes": {"first": {"module": "Add", "params": {"amount": 10}},
                  "x": {"module": "Add", "params": {"amount": 3}},
                  "y": {"module": "Add", "params": {"amount": 3}},
                  "last": {"module": "Add", "params": {"amount": 100}}},
        "links": ["first.sum -> x.a", "x.sum -> y.a", "y.sum -> last.a"]
    }));
    let key = |plan: &Plan, name: &str| plan.find(name).unwrap().key;
    assert_eq!(key(&inner, "last"), key(&flat.unwrap(), "last"));
}

#[test]
fn what_nothing_sets_is_as_the_inner_map_has_it() {
    let outcome = outcome(&plan(with_twice(json!({}))).unwrap());
    assert_eq!(number(&outcome, "last", "sum"), 112.0);
    let said = plan(with_twice(json!({"bye": 3}))).unwrap_err();
    assert_eq!(said, ["t.bye: there is no parameter of this name; did you mean \"by\"?"]);
    let said = plan(with_twice(json!({"by": 1e9}))).unwrap_err();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].starts_with("t.by: 1000000000"), "{said:?}");
}

#[test]
fn links_into_a_map_are_checked_by_its_ports() {
    let mut wrong = with_twice(json!({}));
    wrong["links"] = json!(["first.sum -> t.b", "t.sun -> last.a"]);
    let said = plan(wrong).unwrap_err();
    assert!(said[0].contains("twice has no such input; it takes a, by"), "{said:?}");
    assert!(said[1].contains("twice has no such output; it has sum"), "{said:?}");
    let mut wrong = with_twice(json!({}));
    wrong["nodes"]["first"] = json!({"module": "Echo"});
    wrong["links"] = json!(["first.text -> t.a", "t.sum -> last.a"]);
    let said = plan(wrong).unwrap_err();
    assert!(said[0].starts_with("t/one.a: takes Number, but \"first.text\""), "{said:?}");
}

#[test]
fn a_problem_inside_has_its_line() {
    let text = "{\"mve\": 1, \"nodes\": {\"t\": {\"module\": \"m\"}},\n\"maps\": {\"m\":\n\
                {\"nodes\": {\n\"x\": {\"module\": \"Add\", \"params\": {\n\"amount\": 1e9}}}}}}";
    let map = Map::parse(text).unwrap();
    let files = FileHashes::new();
    let options = plan_options(Path::new("/nowhere"), &files);
    let problems = Plan::new(&map, &registry(), &options).unwrap_err();
    assert!(problems[0].to_string().starts_with("t/x.amount: "), "{}", problems[0]);
    assert_eq!(map.position_of(&problems[0]).unwrap().to_string(), "line 5, column 1");
}

/// A map whose parameters are none runs alone, and says so; as a node it does not.
#[test]
fn parameters_of_a_map_are_checked_where_it_is_alone_too() {
    let mut parts = twice();
    let alone = |parts: &Json| -> Vec<String> {
        let warnings = plan(parts.clone()).unwrap().warnings;
        let told = warnings.iter().filter(|problem| problem.message.contains("another map"));
        told.map(ToString::to_string).collect()
    };
    parts["nodes"]["in"] = json!({"module": "Add"});
    parts["links"][0] = json!("in.sum -> one.a");
    assert_eq!(alone(&parts), [""; 0]);
    parts["parameters"] = json!({
        "by": ["one.amuont", "two.amount"], "far": "tow.amount", "form": "amount", "none": []});
    let end = "; as a node of another map, this one would not run";
    let expected = [
        "by: \"one.amuont\" is no parameter of Add; did you mean \"amount\"?",
        "far: \"tow.amount\": the map has no node \"tow\"; did you mean \"two\"?",
        "form: \"amount\" is not of the form node.parameter",
        "none: names no parameter of a node",
    ];
    assert_eq!(alone(&parts), expected.map(|message| format!("{message}{end}")));
    let map = map(parts.clone());
    let files = FileHashes::new();
    let options = plan_options(Path::new("/nowhere"), &files);
    let warnings = Plan::new(&map, &registry(), &options).unwrap().warnings;
    let place = warnings.iter().find(|problem| problem.message.contains("tow")).unwrap();
    assert!(map.position_of(place).is_some());
    let outer = json!({"nodes": {"t": {"module": "twice"}}, "maps": {"twice": parts}});
    let said = plan(outer).unwrap_err();
    assert!(said[0].starts_with("t/by: \"one.amuont\" is no parameter of Add"), "{said:?}");
    assert_eq!(said.len(), expected.len(), "{said:?}");
}

#[test]
fn maps_come_from_files_with_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let lib = folder.path().join("lib");
    std::fs::create_dir(&lib).unwrap();
    std::fs::write(lib.join("x.txt"), "inside").unwrap();
    std::fs::write(folder.path().join("y.txt"), "outside").unwrap();
    let reader = json!({"mve": 1,
        "nodes": {"read": {"module": "Read", "params": {"path": "x.txt"}},
                  "text": {"module": "MapOutput"}},
        "links": ["read.text -> text.value"], "parameters": {"path": "read.path"}});
    std::fs::write(lib.join("reader.json"), reader.to_string()).unwrap();
    let read = |params: Json| {
        let outer = json!({"nodes": {"r": {"module": "lib/reader.json", "params": params}}});
        let outcome = outcome(&plan_in(folder.path(), &map(outer)).unwrap());
        outcome.nodes["r"].outputs["text"].get::<String>().unwrap()
    };
    assert_eq!(*read(json!({})), "inside");
    assert_eq!(*read(json!({"path": "y.txt"})), "outside");
    let outer = map(json!({"nodes": {"r": {"module": "lib/no.json"}}}));
    let said = plan_in(folder.path(), &outer).unwrap_err();
    assert!(said[0].starts_with("r.module: ") && said[0].contains("lib/no.json"), "{said:?}");
    assert_eq!(said.len(), 1, "{said:?}");
}

#[test]
fn a_map_that_contains_itself_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = |other: &str| json!({"mve": 1, "nodes": {"n": {"module": other}}}).to_string();
    std::fs::write(folder.path().join("a.json"), text("b.json")).unwrap();
    std::fs::write(folder.path().join("b.json"), text("a.json")).unwrap();
    let outer = map(json!({"nodes": {"n": {"module": "a.json"}}}));
    let said = plan_in(folder.path(), &outer).unwrap_err();
    let expected = "the map contains itself: a.json -> b.json -> a.json";
    assert!(said[0].contains(expected), "{said:?}");
    let said = plan(json!({"nodes": {"n": {"module": "m"}},
        "maps": {"m": {"nodes": {"x": {"module": "m"}}}}}));
    assert!(said.unwrap_err()[0].contains("the map contains itself: m -> m"));
}

#[test]
fn maps_that_name_each_other_by_many_ways_are_opened_once() {
    // 2 to the 30th ways lead to the last.
    let last = json!({"nodes": {"x": {"module": "Add"}}});
    let level = |n: usize| {
        let next = |side: &str| json!({"module": format!("{side}{}", n + 1)});
        json!({"nodes": {"l": next("a"), "r": next("b")}})
    };
    let both =
        |n: usize, map: Json| [("a", map.clone()), ("b", map)].map(|(s, m)| (format!("{s}{n}"), m));
    let maps = (0..30).flat_map(|n| both(n, level(n))).chain(both(30, last));
    let maps: serde_json::Map<String, Json> = maps.collect();
    let said = plan(json!({"nodes": {"n": {"module": "a0"}}, "maps": maps})).err().unwrap();
    assert!(said[0].contains("give more than 100000 nodes"), "{}", said[0]);
    // All of them in a circle with all others.
    let all: Vec<String> = (0..24).map(|n| format!("m{n}")).collect();
    let nodes: serde_json::Map<String, Json> =
        all.iter().map(|name| (name.clone(), json!({"module": name}))).collect();
    let maps: serde_json::Map<String, Json> =
        all.iter().map(|name| (name.clone(), json!({"nodes": nodes.clone()}))).collect();
    let said = plan(json!({"nodes": {"n": {"module": "m0"}}, "maps": maps})).unwrap_err();
    assert!(said.iter().any(|said| said.contains("the map contains itself")), "{}", said[0]);
}

#[test]
fn a_map_runs_alone_on_its_defaults() {
    let mut alone = twice();
    let said = plan(alone.clone()).unwrap();
    assert!(said.warnings.iter().any(|w| w.to_string().starts_with("in: takes its value from")));
    alone["nodes"]["five"] = json!({"module": "Add", "params": {"amount": 5}});
    alone["links"].as_array_mut().unwrap().push(json!("five.sum -> in.default"));
    let planned = plan(alone.clone()).unwrap();
    assert_eq!(planned.warnings, []);
    assert_eq!(number(&outcome(&planned), "two", "sum"), 7.0);
    // As a node its default counts where nothing is linked.
    let outer = json!({"nodes": {"t": {"module": "twice"}}, "maps": {"twice": alone}});
    assert_eq!(number(&outcome(&plan(outer).unwrap()), "t", "sum"), 7.0);
}

#[test]
fn a_module_repeats_and_feeds_itself() {
    let looped = |repeat: Json| {
        json!({
            "nodes": {"first": {"module": "Add", "params": {"amount": 10}},
                      "loop": {"module": "Add", "params": {"amount": 2}, "repeat": repeat},
                      "last": {"module": "Add", "params": {"amount": 100}}},
            "links": ["first.sum -> loop.a", "loop.sum -> last.a"]})
    };
    let thrice = plan(looped(json!({"times": 3, "feed": {"a": "sum"}}))).unwrap();
    assert_eq!(number(&outcome(&thrice), "last", "sum"), 116.0);
    let until = json!({"times": 10, "feed": {"a": "sum"}, "until": {"output": "sum", "above": 13}});
    let ended = outcome(&plan(looped(until)).unwrap());
    assert_eq!(number(&ended, "last", "sum"), 114.0);
    assert_eq!(number(&ended, "loop", "sum"), 114.0 - 100.0);
    assert_eq!(ended.nodes["loop/2"].record.status, NodeStatus::Done);
    assert_eq!(ended.nodes["loop/3"].record.status, NodeStatus::Past);
    assert!(ended.is_done());
    for (wrong, expected) in [
        (json!({}), "neither \"times\" nor \"each\""),
        (json!({"times": 0}), "\"times\" is 0"),
        (json!({"times": 4_000_000_000_u32}), "the most is"),
        (json!({"times": 2, "feed": {"b": "sum"}}), "\"feed\": Add has no input \"b\""),
        (json!({"times": 2, "until": {"output": "sums", "above": 1}}), "did you mean \"sum\"?"),
        (json!({"times": 2, "until": {"output": "sum"}}), "neither \"below\" nor \"above\""),
        (json!({"each": {"amount": []}}), "no values"),
        (json!({"each": {"amounts": [1]}}), "did you mean \"amount\"?"),
    ] {
        let said = plan(looped(wrong)).unwrap_err();
        assert!(said[0].starts_with("loop.repeat: ") && said[0].contains(expected), "{said:?}");
    }
}

#[test]
fn rounds_over_values_go_into_an_input_that_takes_many() {
    let each = json!({
        "nodes": {"loop": {"module": "twice", "repeat": {"each": {"by": {"range": [1, 4, 4]}}}},
                  "one": {"module": "Add"},
                  "all": {"module": "Total"}, "last": {"module": "Add"}},
        "links": ["one.sum -> all.numbers", "loop.sum -> all.numbers"],
        "maps": {"twice": twice()}});
    let planned = plan(each.clone()).unwrap();
    assert_eq!(number(&outcome(&planned), "all", "sum"), 1.0 + 2.0 * 10.0);
    let mut wrong = each;
    wrong["links"] = json!(["one.sum -> all.numbers", "loop.sum -> last.a"]);
    let said = plan(wrong).unwrap_err();
    assert!(said[0].starts_with("last.a: \"loop.sum\" gives a value for each round"), "{said:?}");
}

/// The file that a loop sets in each round need not be set beside it.
#[test]
fn rounds_over_files_need_no_file_beside_them() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("a.txt", "one"), ("b.txt", "two")] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    for each in [json!({"glob": "*.txt"}), json!(["a.txt", "b.txt"])] {
        let own = json!({
            "nodes": {"loop": {"module": "Read", "repeat": {"each": {"path": each}}}}});
        let within = json!({
            "nodes": {"loop": {"module": "reader", "repeat": {"each": {"file": each}}}},
            "maps": {"reader": {"nodes": {"read": {"module": "Read"}},
                                "parameters": {"file": "read.path"}}}});
        for parts in [own, within] {
            let planned = plan_in(folder.path(), &map(parts)).unwrap();
            assert_eq!(outcome(&planned).failures().count(), 0);
        }
    }
}

#[test]
fn an_input_that_takes_many_needs_one_and_its_order_counts() {
    let said = plan(json!({"nodes": {"all": {"module": "Total"}}})).unwrap_err();
    assert_eq!(said, ["all.numbers: nothing is linked here, and Total needs a Number"]);
    let nodes = json!({"a": {"module": "Add"}, "b": {"module": "Add", "params": {"amount": 2}},
        "all": {"module": "Total"}});
    let linked = |links: Json| plan(json!({"nodes": nodes, "links": links})).unwrap();
    let forth = linked(json!(["a.sum -> all.numbers", "b.sum -> all.numbers"]));
    let back = linked(json!(["b.sum -> all.numbers", "a.sum -> all.numbers"]));
    assert_eq!(number(&outcome(&forth), "all", "sum"), 3.0);
    assert_ne!(forth.find("all").unwrap().key, back.find("all").unwrap().key);
}

#[test]
fn loops_stand_in_loops() {
    let nested = json!({
        "nodes": {"outer": {"module": "inner", "repeat": {"times": 3}}},
        "maps": {"inner": {
            "nodes": {"a": {"module": "MapInput"},
                      "loop": {"module": "Add", "repeat": {"times": 4, "feed": {"a": "sum"},
                               "until": {"output": "sum", "above": 6.5}}},
                      "out": {"module": "MapOutput", "params": {"name": "a"}}},
            "links": ["a.value -> loop.a", "loop.sum -> out.value"]}}});
    let outcome = outcome(&plan(nested).unwrap());
    // 4 after the first time; then 5, 6, 7; then 8 at once.
    assert_eq!(number(&outcome, "outer", "a"), 8.0);
    assert_eq!(outcome.nodes["outer/3/loop/2"].record.status, NodeStatus::Past);
}

#[test]
fn programs_vary_what_a_map_makes_known() {
    let mut parts = with_twice(json!({}));
    parts["programs"] = json!({"p": {"axes": [{"t.by": [1, 2, 3]}]}});
    let program = Program::new(&map(parts), "p", &registry(), Path::new("/nowhere")).unwrap();
    assert_eq!(program.steps.len(), 3);
    let mut ids: Vec<&str> = program.steps.iter().map(|step| step.id.as_str()).collect();
    ids.dedup();
    assert_eq!(ids.len(), 3);
    let columns: Vec<&String> = program.columns.0.keys().collect();
    assert_eq!(columns, ["first.sum", "t/one.sum", "t/two.sum", "t.sum", "last.sum"]);
    let mut looped = with_twice(json!({}));
    looped["nodes"]["t"]["repeat"] = json!({"times": 3, "feed": {"a": "sum"}});
    looped["programs"] = json!({"p": {"axes": [{"t.by": [1, 2]}]}});
    let looped = Program::new(&map(looped), "p", &registry(), Path::new("/nowhere")).ok().unwrap();
    let columns: Vec<&String> = looped.columns.0.keys().collect();
    assert_eq!(columns, ["first.sum", "t.sum", "last.sum"]);
    let mut wrong = with_twice(json!({}));
    wrong["programs"] = json!({"p": {"axes": [{"t.bye": [1, 2, 3]}]}});
    let said = Program::new(&map(wrong), "p", &registry(), Path::new("/nowhere")).err().unwrap();
    assert!(said[0].to_string().contains("did you mean \"by\"?"), "{said:?}");
    let mut changed = map(with_twice(json!({})));
    let known = registry().with_maps_of(&changed, Path::new("/nowhere"));
    assign(&mut changed, &known, "t.by", json!(7)).unwrap();
    assert_eq!(changed.nodes["t"].params["by"], 7);
}

#[test]
fn a_map_with_maps_is_saved_as_it_was() {
    let whole = map(with_twice(json!({"by": 3})));
    let mut changed = whole.clone();
    changed.title = "new".to_owned();
    let again = Map::parse(&changed.to_text()).unwrap();
    assert_eq!(again.problems(), []);
    assert_eq!((again.maps, again.parameters), (whole.maps, whole.parameters));
    let odd = Map::parse(r#"{"mve": 1, "nodes": {}, "maps": {"Big": {"nodes": {}}, "x": 3}}"#);
    let said: Vec<_> = odd.unwrap().problems().iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 2, "{said:?}");
}
