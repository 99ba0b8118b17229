//! Outside programs: refused unless allowed, and part of keys by their content.

use std::collections::BTreeSet;
use std::path::Path;

use mve_core::testing::plan_options;
use mve_core::{
    CommandLine, CommandLineSpec, CommandScope, FileHashes, Listed, Map, Module, ModuleList, Out,
    Param, Plan, PlanOptions, Problem, Program, Registry,
};

const COMMAND: Param<CommandLine> = Param::command_line(
    "command",
    "What runs.",
    CommandLineSpec { reads: &[], writes: &[], endings: &[] },
);
const TEXT: Out<String> = Out::new("text", "Its program.");

static CALL: Module = Module {
    id: "Call",
    summary: "Tells which program it would run.",
    inputs: &[],
    outputs: &[TEXT.spec()],
    params: &[COMMAND.spec()],
    run: |io| {
        let line = io.param(COMMAND)?;
        io.put(TEXT, line.program().display().to_string());
        Ok(())
    },
};

static LIST: ModuleList =
    ModuleList { category: "test", modules: &[Listed { item: &CALL, source: 1 }] };

fn registry() -> Registry {
    mve_core::testing::registry().with(&[&LIST], "test")
}

fn map(command: &str) -> Map {
    let nodes = format!(
        r#"{{"mve": 1, "nodes": {{"a": {{"module": "Call", "params": {{"command": {command}}}}},
            "b": {{"module": "Echo"}}}},
            "programs": {{"p": {{"axes": [{{"a.command": ["true x", ["true", "y z"]]}}]}}}}}}"#
    );
    Map::parse(&nodes).unwrap()
}

fn plan(map: &Map, folder: &Path, command_scope: CommandScope) -> Result<Plan, Vec<Problem>> {
    let files = FileHashes::new();
    let options = PlanOptions { command_scope, ..plan_options(folder, &files) };
    Plan::new(map, &registry(), &options)
}

fn texts(problems: &[Problem]) -> Vec<String> {
    problems.iter().map(Problem::to_string).collect()
}

#[test]
fn a_plan_refuses_what_nobody_has_allowed() {
    let (map, here) = (map(r#"["true", "it's"]"#), Path::new("/"));
    let refused = texts(&plan(&map, here, CommandScope::Nothing).unwrap_err());
    assert_eq!(refused.len(), 1);
    assert!(refused[0].starts_with("a.command: would run an outside program"), "{refused:?}");
    assert!(refused[0].contains(r"true 'it'\''s'; ") && refused[0].contains("--allow-commands"));
    let seen = |text: &str| BTreeSet::from([text.to_owned()]);
    assert!(plan(&map, here, CommandScope::Seen(&seen("true it's"))).is_err());
    let plan = plan(&map, here, CommandScope::Seen(&seen(r"true 'it'\''s'"))).unwrap();
    let [(path, line)] = &plan.find("a").unwrap().command_lines()[..] else { panic!("one") };
    assert_eq!((path.as_str(), line.to_string()), ("command", r"true 'it'\''s'".to_owned()));
    // What does not run is not asked for.
    let muted = r#"{"mve": 1, "nodes": {"a": {"module": "Call", "mode": "muted",
        "params": {"command": "true"}}, "b": {"module": "Echo"}}}"#;
    assert!(self::plan(&Map::parse(muted).unwrap(), here, CommandScope::Nothing).is_ok());
}

#[test]
fn a_program_refuses_them_in_every_step() {
    let map = map(r#""true""#);
    let new = |scope| Program::allowing(scope, &map, "p", &registry(), Path::new("/"));
    let refused = texts(&Program::new(&map, "p", &registry(), Path::new("/")).err().unwrap());
    assert_eq!(refused.len(), 2, "{refused:?}");
    assert!(refused[0].contains("a.command: would run") && refused[1].contains("true 'y z'"));
    let first = BTreeSet::from(["true x".to_owned()]);
    assert_eq!(texts(&new(CommandScope::Seen(&first)).err().unwrap()).len(), 1);
    let program = new(CommandScope::All).map_err(|problems| texts(&problems)).unwrap();
    let lines = ["true 'y z'", "true x"].map(|line| ("a".to_owned(), line.to_owned()));
    assert_eq!(program.command_lines, BTreeSet::from(lines));
    assert_ne!(program.steps[0].id, program.steps[1].id);
}

#[test]
fn keys_have_the_content_of_programs_and_files_and_not_where_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let write = |path: &str, text: &str| {
        let path = folder.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    let key = |command: &str| {
        let plan = plan(&map(command), folder.path(), CommandScope::All);
        plan.map(|plan| plan.find("a").unwrap().key).map_err(|problems| texts(&problems))
    };
    ["one/tool", "two/tool"].iter().for_each(|path| write(path, "a program"));
    ["one/a.py", "two/b.py"].iter().for_each(|path| write(path, "a script"));
    let first = key(r#"["one/tool", "{file:one/a.py}", "3"]"#).unwrap();
    assert_eq!(key(r#"["./two/tool", "{file:two/b.py}", 3]"#).unwrap(), first);
    assert_eq!(key(r#""one/tool   {file:one/a.py} '3'""#).unwrap(), first);
    assert_ne!(key(r#"["one/tool", "{file:one/a.py}", "4"]"#).unwrap(), first);
    assert_ne!(key(r#"["one/tool", "{file:one/a.py}3"]"#).unwrap(), first);
    write("two/b.py", "another script");
    assert_ne!(key(r#"["two/tool", "{file:two/b.py}", 3]"#).unwrap(), first);
    write("one/tool", "another program");
    assert_ne!(key(r#"["one/tool", "{file:one/a.py}", "3"]"#).unwrap(), first);
    let missing = key(r#"["one/tool", "{file:one/c.py}"]"#).unwrap_err();
    assert!(missing[0].contains("c.py: there is no such file"), "{missing:?}");
    let missing = key(r#""no-program-has-this-name""#).unwrap_err();
    assert!(missing[0].contains("no program \"no-program-has-this-name\""), "{missing:?}");
}
