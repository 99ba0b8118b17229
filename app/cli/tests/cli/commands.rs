//! Outside programs: nothing runs unasked, and what would run is told.

use crate::common::Folder;

const MAP: &str = r#"{"mve": 1, "nodes": {
    "model": {"module": "Box"},
    "call": {"module": "Command", "params": {
        "command": ["cp", "{in.mesh:off}", "{out.mesh:off}"]}},
    "touch": {"module": "Command", "params": {"command": ["touch", "PLACE"]}},
    "info": {"module": "MeshInfo"}},
  "links": ["model.mesh -> call.mesh", "call.mesh -> info.mesh"],
  "programs": {"p": {"axes": [{"model.segments": [1, 2]}]}}}"#;

fn folder() -> (Folder, String) {
    let folder = Folder::new();
    let place = folder.path().join("touched");
    folder.write("map.json", &MAP.replace("PLACE", place.to_str().unwrap()));
    let touch = format!("touch: touch {}", place.display());
    (folder, touch)
}

#[test]
fn a_run_refuses_outside_programs_until_they_are_allowed() {
    let (folder, _) = folder();
    let refused = folder.mve(&["run", "map.json"]);
    let refused = refused.fails(3, "map.json: 2 problems; nothing was run");
    for said in ["call.command: would run an outside program", "cp {in.mesh:off} {out.mesh:off};"] {
        assert!(refused.err.contains(said), "{}", refused.err);
    }
    assert!(refused.err.contains("--allow-commands") && !folder.has("touched"));
    let done = folder.mve(&["run", "map.json", "--allow-commands"]).succeeds();
    // A box of eight segments a side has 6 · 8² · 2 faces.
    done.says("call: exit code 0\n").says("info   done").says("faces                  768\n");
    assert!(folder.has("touched"));
}

#[test]
fn check_and_dry_runs_say_what_would_run_and_run_nothing() {
    let (folder, touch) = folder();
    let checked = folder.mve(&["check", "map.json"]).succeeds();
    checked
        .says("with --allow-commands alone:\n  call: cp {in.mesh:off} {out.mesh:off}\n")
        .says(&touch);
    let lines = folder.mve(&["check", "--json", "map.json"]).succeeds().json();
    let commands = lines.iter().filter(|line| line["event"] == "command");
    assert_eq!(
        commands.map(|line| line["node"].as_str().unwrap()).collect::<Vec<_>>(),
        ["call", "touch"]
    );
    folder.mve(&["program", "map.json", "--dry-run"]).succeeds().says("runs:    call: cp ");
    assert!(!folder.has("touched") && !folder.has("mve-out"));
}

#[test]
fn a_program_refuses_them_too_and_resumes_with_them() {
    let (folder, _) = folder();
    let refused = folder.mve(&["program", "map.json"]);
    refused.fails(3, "touch.command: would run an outside program");
    assert!(!folder.has("touched") && !folder.has("mve-out"));
    let allowed = ["program", "map.json", "--allow-commands"];
    folder.mve(&allowed).succeeds().says("2 steps: 2 done; 2 run now");
    folder.mve(&allowed).succeeds().says("2 steps: 2 done; 0 run now");
}
