//! Runs: values flow, failures stay where they are, and the cache never changes a result.

use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use mve_core::testing::{plan_options, registry, run_options};
use mve_core::{
    Cache, CacheUse, CancelToken, DiskCache, Event, FileHashes, Map, NodeStatus, Plan, RunOptions,
    RunOutcome, Scalar, contain_panics, run,
};

fn plan(text: &str) -> Plan {
    let files = FileHashes::new();
    let options = plan_options(Path::new("/"), &files);
    Plan::new(&Map::parse(text).unwrap(), &registry(), &options).unwrap()
}

fn run_with(plan: &Plan, threads: usize, cache: Option<&Cache>) -> RunOutcome {
    let folder = tempfile::tempdir().unwrap();
    let cancel = CancelToken::new();
    run(plan, &RunOptions { threads, cache, ..run_options(folder.path(), &cancel) })
}

fn number(outcome: &RunOutcome, node: &str) -> f64 {
    match outcome.nodes[node].record.scalars.get("sum") {
        Some(Scalar::Number(number)) => *number,
        other => panic!("{node} gave {other:?}"),
    }
}

/// A ladder: each node adds the two before it, by link and by linked parameter.
fn ladder(n: usize) -> String {
    let nodes: Vec<_> = (0..n).map(|i| format!(r#""n{i}": {{"module": "Add"}}"#)).collect();
    let links: Vec<_> = (2..n)
        .flat_map(|i| {
            let (one, two) = (i - 1, i - 2);
            [format!("\"n{one}.sum -> n{i}.a\""), format!("\"n{two}.sum -> n{i}.amount\"")]
        })
        .collect();
    format!(r#"{{"mve": 1, "nodes": {{{}}}, "links": [{}]}}"#, nodes.join(","), links.join(","))
}

#[test]
fn values_flow_through_links_and_linked_parameters() {
    for threads in [1, 4] {
        let outcome = run_with(&plan(&ladder(10)), threads, None);
        assert!(outcome.is_done());
        assert_eq!(number(&outcome, "n9"), 55.0); // Fibonacci
    }
}

#[test]
fn a_linked_value_is_held_to_the_range() {
    let outcome = run_with(&plan(&ladder(20)), 1, None);
    let failures: Vec<_> = outcome.failures().collect();
    assert_eq!(failures.len(), 1);
    // n11 is 144, over the limit of 100, and n13 is the first to take it as a parameter.
    let (node, error) = failures[0];
    assert_eq!(node, "n13");
    assert!(error.contains("by link: 144") && error.contains("from -100 to 100"), "{error}");
    let skipped = NodeStatus::Skipped { because_of: "n13".to_owned() };
    assert_eq!(outcome.nodes["n19"].record.status, skipped);
}

#[test]
fn a_panic_is_an_error_of_its_node_and_others_go_on() {
    contain_panics();
    let text = r#"{"mve": 1, "nodes": {
        "bad": {"module": "Add", "params": {"amount": -13}},
        "behind": {"module": "Add"},
        "good": {"module": "Add", "params": {"amount": 2}}},
        "links": ["bad.sum -> behind.a"]}"#;
    let outcome = run_with(&plan(text), 2, None);
    let failures: Vec<_> = outcome.failures().collect();
    assert!(failures[0].1.contains("thirteen brings bad luck"), "{failures:?}");
    assert!(failures[0].1.contains("testing.rs"), "{failures:?}");
    let skipped = NodeStatus::Skipped { because_of: "bad".to_owned() };
    assert_eq!(outcome.nodes["behind"].record.status, skipped);
    assert_eq!(number(&outcome, "good"), 2.0);
}

#[test]
fn a_stopped_run_ends_within_a_tenth_of_a_second() {
    let text = r#"{"mve": 1, "nodes": {"slow": {"module": "Add", "params": {"amount": -1}},
        "behind": {"module": "Add"}}, "links": ["slow.sum -> behind.a"]}"#;
    let (plan, cancel) = (plan(text), CancelToken::new());
    let folder = tempfile::tempdir().unwrap();
    let mut took = Duration::ZERO;
    std::thread::scope(|scope| {
        let runner = scope.spawn(|| run(&plan, &run_options(folder.path(), &cancel)));
        std::thread::sleep(Duration::from_millis(50));
        cancel.cancel();
        let start = Instant::now();
        let outcome = runner.join().unwrap();
        took = start.elapsed();
        assert!(outcome.nodes.values().all(|node| node.record.status == NodeStatus::Stopped));
    });
    assert!(took < Duration::from_millis(100), "{took:?}");
}

#[test]
fn only_what_changed_and_what_hangs_on_it_runs_again() {
    let text = |amount: u32| {
        format!(
            r#"{{"mve": 1, "nodes": {{"a": {{"module": "Add"}},
            "b": {{"module": "Add", "params": {{"amount": {amount}}}}},
            "c": {{"module": "Add"}}}},
            "links": ["a.sum -> b.a", "b.sum -> c.a"]}}"#
        )
    };
    let cache = Cache::new(1 << 20, None);
    let first = run_with(&plan(&text(5)), 1, Some(&cache));
    let second = run_with(&plan(&text(6)), 1, Some(&cache));
    let cached = |node: &str| second.nodes[node].record.cached;
    assert_eq!([cached("a"), cached("b"), cached("c")], [Some(CacheUse::Memory), None, None]);
    assert_eq!((number(&first, "c"), number(&second, "c")), (7.0, 8.0));
    assert_eq!(second.nodes["a"].record.log[0].text, "adding 1"); // what it said is said again
    assert_eq!(second.nodes["a"].record.seconds, None);
}

#[test]
fn a_saver_writes_even_where_its_inputs_are_known() {
    let text = r#"{"mve": 1, "nodes": {"e": {"module": "Echo"},
        "w": {"module": "Write", "params": {"path": "deep/er/x.txt"}}},
        "links": ["e.text -> w.text"]}"#;
    let (plan, cache) = (plan(text), Cache::new(1 << 20, None));
    for _ in 0..2 {
        let folder = tempfile::tempdir().unwrap();
        let cancel = CancelToken::new();
        let options = RunOptions { cache: Some(&cache), ..run_options(folder.path(), &cancel) };
        assert!(run(&plan, &options).is_done());
        assert_eq!(std::fs::read(folder.path().join("deep/er/x.txt")).unwrap(), b"hello");
    }
}

#[test]
fn another_process_finds_slow_results_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let open = || Cache::new(1 << 20, Some(DiskCache::open(folder.path(), 1 << 20).unwrap()));
    let plan = plan(r#"{"mve": 1, "nodes": {"a": {"module": "Add"}}}"#);
    run_with(&plan, 1, Some(&open()));
    // An addition is faster than reading a file, so nothing is kept.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn events_tell_the_whole_story() {
    let seen = Mutex::new(Vec::new());
    let text = r#"{"mve": 1, "nodes": {"a": {"module": "Add", "params": {"amount": 99}},
        "b": {"module": "Add"}}, "links": ["a.sum -> b.a"]}"#;
    let folder = tempfile::tempdir().unwrap();
    let cancel = CancelToken::new();
    let note = |event: &Event| seen.lock().unwrap().push(serde_json::to_value(event).unwrap());
    run(&plan(text), &RunOptions { observer: &note, ..run_options(folder.path(), &cancel) });
    let seen = seen.into_inner().unwrap();
    let brief: Vec<_> = seen
        .iter()
        .map(|e| format!("{} {} {}", e["node"], e["event"], e["record"]["status"]).replace('"', ""))
        .collect();
    assert_eq!(brief, ["a started null", "a ended failed", "b ended skipped"]);
}
