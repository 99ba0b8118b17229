//! Files among the parameters of the entries of choices: they are read, written, keyed and checked
//! as files of the top level are, at any depth.

use std::path::{Path, PathBuf};

use mve_core::testing::{Trial, plan_options, run_options};
use mve_core::{
    Cache, CancelToken, ChoiceParam, Choices, Entry, FileHashes, Listed, Map, Module, ModuleError,
    ModuleList, NodeStatus, Out, Param, Plan, PlanOptions, Registry, RunOutcome, Settings, run,
};

type Work = fn(&Settings) -> Result<String, ModuleError>;

const WEIGHTS: Param<PathBuf> = Param::input_file("weights", "Where.", &["txt"]);
const REPORT: Param<PathBuf> = Param::output_file("report", "Where.", &["txt"]);

fn read(path: &Path) -> Result<String, ModuleError> {
    std::fs::read_to_string(path).map_err(|error| ModuleError::io(path, error.to_string()))
}

static PLAIN: Entry<Work> =
    Entry { id: "Plain", summary: "No file.", params: &[], build: |_| Ok(String::new()) };
static LEARNED: Entry<Work> = Entry {
    id: "Learned",
    summary: "Reads a file.",
    params: &[WEIGHTS.spec()],
    build: |settings| read(&settings.get(&WEIGHTS)?),
};
static LOGGED: Entry<Work> = Entry {
    id: "Logged",
    summary: "Writes a file.",
    params: &[REPORT.spec()],
    build: |settings| {
        let path = settings.get(&REPORT)?;
        std::fs::write(&path, "log").map_err(|error| ModuleError::io(&path, error.to_string()))?;
        Ok("logged".to_owned())
    },
};
static INNER: Choices<Work> = Choices::new(&[
    Listed { item: &LEARNED, source: 1 },
    Listed { item: &LOGGED, source: 2 },
    Listed { item: &PLAIN, source: 3 },
]);
const BY: ChoiceParam<Work> = ChoiceParam::new("by", "How.", &INNER, "Plain");
static WRAPPED: Entry<Work> = Entry {
    id: "Wrapped",
    summary: "Does what another entry does.",
    params: &[BY.spec()],
    build: |settings| {
        let chosen = settings.choice(&BY)?;
        (chosen.entry.build)(&chosen.params)
    },
};
static OUTER: Choices<Work> = Choices::new(&[
    Listed { item: &LEARNED, source: 1 },
    Listed { item: &LOGGED, source: 2 },
    Listed { item: &PLAIN, source: 3 },
    Listed { item: &WRAPPED, source: 4 },
]);
const COST: ChoiceParam<Work> = ChoiceParam::new("cost", "How.", &OUTER, "Plain");
const TEXT: Out<String> = Out::new("text", "The text.");

static WORK: Module = Module {
    id: "Work",
    summary: "Does what its choice says.",
    inputs: &[],
    outputs: &[TEXT.spec()],
    params: &[COST.spec()],
    run: |io| {
        let chosen = io.choice(COST)?;
        let text = (chosen.entry.build)(&chosen.params)?;
        io.put(TEXT, text);
        Ok(())
    },
};
const NEEDY_COST: ChoiceParam<Work> = ChoiceParam::new("cost", "How.", &INNER, "Learned");
static NEEDY: Module = Module { id: "Needy", params: &[NEEDY_COST.spec()], ..WORK };
static LIST: ModuleList = ModuleList {
    category: "test",
    modules: &[Listed { item: &WORK, source: 1 }, Listed { item: &NEEDY, source: 2 }],
};

/// A plan of nodes, each with its cost as JSON.
fn plan_in(folder: &Path, costs: &[(&str, &str)]) -> Result<Plan, Vec<String>> {
    let node = |(name, cost): &(&str, &str)| {
        format!(r#""{name}": {{"module": "Work", "params": {{"cost": {cost}}}}}"#)
    };
    let nodes: Vec<_> = costs.iter().map(node).collect();
    plan_of(folder, &format!(r#"{{"mve": 1, "nodes": {{{}}}}}"#, nodes.join(", ")))
}

fn plan_of(folder: &Path, text: &str) -> Result<Plan, Vec<String>> {
    let (map, files) = (Map::parse(text).unwrap(), FileHashes::new());
    let options = PlanOptions { output_folder: Some(folder), ..plan_options(folder, &files) };
    let registry = Registry::new().with(&[&LIST], "test");
    Plan::new(&map, &registry, &options).map_err(|p| p.iter().map(|p| p.to_string()).collect())
}

fn run_in(folder: &Path, plan: &Plan, cache: Option<&Cache>) -> RunOutcome {
    let cancel = CancelToken::new();
    run(plan, &mve_core::RunOptions { cache, ..run_options(folder, &cancel) })
}

fn text(outcome: &RunOutcome) -> String {
    match &outcome.nodes["a"].record {
        record if record.status == NodeStatus::Done => record.scalars["text"].to_string(),
        record => panic!("{:?}", record.status),
    }
}

#[test]
fn a_nested_file_is_read_from_the_folder_of_the_map() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("w.txt"), "seven").unwrap();
    for cost in [
        r#"{"Learned": {"weights": "w.txt"}}"#,
        r#"{"Wrapped": {"by": {"Learned": {"weights": "w.txt"}}}}"#,
    ] {
        let plan = plan_in(folder.path(), &[("a", cost)]).unwrap();
        assert_eq!(plan.nodes[0].reads[0].0, folder.path().join("w.txt"));
        assert_eq!(text(&run_in(folder.path(), &plan, None)), "seven", "{cost}");
    }
}

#[test]
fn the_content_of_a_nested_file_is_in_the_key_and_its_path_is_not() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in [("a.txt", "same"), ("b.txt", "same"), ("c.txt", "other")] {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    for wrap in [false, true] {
        let key = |name: &str| {
            let cost = format!(r#"{{"Learned": {{"weights": "{name}"}}}}"#);
            let deep = format!(r#"{{"Wrapped": {{"by": {cost}}}}}"#);
            let cost = if wrap { &deep } else { &cost };
            plan_in(folder.path(), &[("a", cost)]).unwrap().nodes[0].key
        };
        assert_eq!(key("a.txt"), key("b.txt"));
        assert_ne!(key("a.txt"), key("c.txt"));
    }
}

#[test]
fn a_missing_nested_file_is_named_by_its_dotted_path() {
    let said = |cost: &str| plan_in(Path::new("/nowhere"), &[("a", cost)]).unwrap_err();
    let missing = said(r#"{"Learned": {"weights": "w.txt"}}"#);
    let expected = "a.cost.weights: /nowhere/w.txt: there is no such file; paths in a map are \
                    relative to its folder";
    assert_eq!(missing, [expected]);
    let deep = said(r#"{"Wrapped": {"by": {"Learned": {"weights": "w.txt"}}}}"#);
    assert!(deep[0].starts_with("a.cost.by.weights: /nowhere/w.txt: "), "{deep:?}");
    let unset = said(r#"{"Wrapped": {"by": "Learned"}}"#);
    assert_eq!(unset, ["a.cost.by.weights: choose a file"]);
    // The entry that is chosen by default may need a file too.
    let map = r#"{"mve": 1, "nodes": {"a": {"module": "Needy"}}}"#;
    let needy = plan_of(Path::new("/nowhere"), map).unwrap_err();
    assert_eq!(needy, ["a.cost.weights: choose a file"]);
}

#[test]
fn a_nested_output_file_stands_in_the_output_folder() {
    let folder = tempfile::tempdir().unwrap();
    let cost = r#"{"Wrapped": {"by": {"Logged": {"report": "sub/{repeat}-{a.module}.txt"}}}}"#;
    let plan = plan_in(folder.path(), &[("a", cost)]).unwrap();
    assert_eq!(plan.nodes[0].writes, [PathBuf::from("sub/0-Work.txt")]);
    let cache = Cache::new(1 << 20, None);
    for _ in 0..2 {
        // What is cached would leave the second run without its file.
        let outcome = run_in(folder.path(), &plan, Some(&cache));
        assert_eq!(outcome.nodes["a"].record.files, [PathBuf::from("sub/0-Work.txt")]);
        std::fs::remove_file(folder.path().join("sub/0-Work.txt")).unwrap();
    }
}

#[test]
fn nested_output_files_may_not_meet_or_leave_or_overwrite() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.txt"), "in").unwrap();
    let said = |costs: &[(&str, &str)]| plan_in(folder.path(), costs).unwrap_err();
    let logged = r#"{"Logged": {"report": "x.txt"}}"#;
    let deep = r#"{"Wrapped": {"by": {"Logged": {"report": "X.txt"}}}}"#;
    let meet = said(&[("a", logged), ("b", deep)]);
    assert_eq!(
        meet,
        ["b.cost.by.report: a.cost.report writes \"X.txt\" too; give each a name of its own"]
    );
    let leaves = said(&[("a", r#"{"Logged": {"report": "../x.txt"}}"#)]);
    assert!(leaves[0].starts_with("a.cost.report: \"../x.txt\" leaves the output folder"));
    let over = said(&[
        ("a", r#"{"Learned": {"weights": "in.txt"}}"#),
        ("b", r#"{"Logged": {"report": "in.txt"}}"#),
    ]);
    assert!(over[0].contains("would overwrite"), "{over:?}");
}

#[cfg(unix)]
#[test]
fn a_link_in_the_way_of_a_nested_output_file_is_refused() {
    let (folder, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    std::os::unix::fs::symlink(other.path(), folder.path().join("sub")).unwrap();
    let plan = plan_in(folder.path(), &[("a", r#"{"Logged": {"report": "sub/x.txt"}}"#)]).unwrap();
    match &run_in(folder.path(), &plan, None).nodes["a"].record.status {
        NodeStatus::Failed { error, .. } => {
            assert!(error.contains("is a symbolic link"), "{error}")
        }
        other => panic!("{other:?}"),
    }
    assert!(!other.path().join("x.txt").exists());
}

#[test]
fn a_trial_takes_nested_paths_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("w.txt");
    std::fs::write(&path, "eight").unwrap();
    let cost = serde_json::json!({"Wrapped": {"by": {"Learned": {"weights": path}}}});
    let outputs = Trial::of(&WORK).set("cost", cost).run().unwrap();
    assert_eq!(outputs["text"].get::<String>().unwrap().as_str(), "eight");
    assert!(WORK.writes_files());
}
