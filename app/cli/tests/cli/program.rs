//! `mve program`: stores, tables, shards, and what an interruption leaves.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use crate::common::{self, Folder};

#[test]
fn a_program_prints_its_table_and_resumes() {
    let folder = Folder::new();
    let answer = folder.mve(&["program", "map.json", "sweep"]).succeeds();
    let answer = answer.says("level.value  print.label  seconds  status\n");
    let answer = answer.says("6 steps: 6 done; 6 run now in").says("mve-out/map-sweep/results.csv");
    assert!(answer.err.contains("[6/6] done, "), "{}", answer.err);
    assert_eq!(folder.read("mve-out/map-sweep/results.csv").lines().count(), 7);
    let again = folder.mve(&["program", "map.json", "sweep"]).succeeds();
    assert_eq!(again.says("6 steps: 6 done; 0 run now").err, "");
}

#[test]
fn the_program_is_named_where_there_are_several() {
    let folder = Folder::new();
    folder.mve(&["program", "map.json"]).fails(2, "2 programs; name one of sweep, long\n");
    let answer = folder.mve(&["program", "map.json", "swep"]);
    answer.fails(2, "no program \"swep\"; the map has sweep, long; did you mean \"sweep\"?\n");
    folder.write("one.json", &common::map().replace("\"long\": {\"axes\"", "\"long\": {\"axs\""));
    folder.write("none.json", r#"{"mve": 1, "nodes": {"a": {"module": "Constant"}}}"#);
    folder.mve(&["program", "none.json"]).fails(2, "the map has no programs");
    let text = common::map();
    let end = text.find(",\n    \"long\"").unwrap();
    folder.write("one.json", &format!("{}}}}}", &text[..end]));
    folder.mve(&["program", "one.json", "--dry-run"]).succeeds().says("6 steps");
}

#[test]
fn a_dry_run_lists_steps_and_writes_nothing() {
    let folder = Folder::new();
    let dry = ["program", "map.json", "sweep", "--dry-run"];
    let answer = folder.mve(&dry).succeeds().says("6 steps: 0 done, 0 failed, 6 to do\n");
    let answer = answer.says("to do   level.value = 1, print.label = x\n");
    answer
        .says("folder:  mve-out/map-sweep (not made yet)\n")
        .says("varied:  level.value, print.label\n");
    assert!(!folder.has("mve-out"));
    folder.mve(&["program", "map.json", "sweep", "--shard", "1/3"]).succeeds();
    folder.mve(&dry).succeeds().says("6 steps: 2 done, 0 failed, 4 to do\n");
    let answer = folder.mve(&[&dry[..], &["--shard", "2/3"]].concat()).succeeds();
    answer.says("2 steps in shard 2/3: 0 done, 0 failed, 2 to do\n");
    let lines = folder.mve(&[&dry[..], &["--json"]].concat()).succeeds().json();
    assert_eq!((lines.len(), &lines[6]["to_do"]), (7, &4.into()));
    assert_eq!(lines[0]["params"]["level.value"], 1);
}

#[test]
fn shards_share_a_folder() {
    let folder = Folder::new();
    for (shard, rest) in [("1/2", "3 of 6 steps remain for other shards"), ("2/2", "")] {
        let answer = folder.mve(&["program", "map.json", "sweep", "--shard", shard, "-q"]);
        answer.fails(0, rest).says("3 run now");
    }
    folder.mve(&["program", "map.json", "sweep"]).succeeds().says("6 done; 0 run now");
    folder.mve(&["program", "map.json", "sweep", "--shard", "3/2"]).fails(2, "I from 1 to N");
}

#[test]
fn json_lines_tell_every_step() {
    let answer = Folder::new().mve(&["program", "map.json", "sweep", "--json", "--jobs", "2"]);
    let answer = answer.succeeds();
    let lines = answer.json();
    let n_of = |event: &str| lines.iter().filter(|line| line["event"] == event).count();
    assert_eq!((n_of("step_started"), n_of("step_ended")), (6, 6));
    let last = lines.last().unwrap();
    assert_eq!((&last["status"], &last["ran"]), (&"done".into(), &6.into()));
    assert_eq!(answer.err, "");
}

#[test]
fn timing_shares_nothing() {
    let folder = Folder::new();
    let timing = ["program", "map.json", "sweep", "--timing"];
    folder.mve(&timing).succeeds();
    let table = folder.read("mve-out/map-sweep/results.csv");
    let mut lines = table.lines();
    let place = lines.next().unwrap().split(',').position(|name| name == "seconds.level").unwrap();
    assert!(lines.all(|line| !line.split(',').nth(place).unwrap().is_empty()), "{table}");
    folder.mve(&[&timing[..], &["--jobs", "2"]].concat()).fails(2, "cannot be used with");
    // Three runs of each of six steps; what is asked for again is there.
    let lines = folder.read("mve-out/map-sweep/results.jsonl");
    let n_of = |line: &str| {
        let row: serde_json::Value = serde_json::from_str(line).unwrap();
        row["timings"].as_array().unwrap().len()
    };
    assert_eq!(lines.lines().map(n_of).collect::<Vec<_>>(), [3; 6]);
    assert!(table.starts_with("step,") && table.contains(",seconds,seconds_median,seconds_min,"));
    let dry = |timing: &str| folder.mve(&["program", "map.json", "sweep", "--dry-run", timing]);
    dry("--timing").succeeds().says("6 done, 0 failed, 0 to do");
    dry("--timing=4").succeeds().says("0 done, 0 failed, 6 to do");
    folder.mve(&["program", "map.json", "sweep", "--timing=4"]).succeeds().says("6 run now");
    let lines = folder.read("mve-out/map-sweep/results.jsonl");
    assert_eq!(lines.lines().map(n_of).collect::<Vec<_>>(), [4; 6]);
}

#[test]
fn folders_that_are_no_stores_are_refused() {
    let folder = Folder::new();
    let out = |out: &str| folder.mve(&["program", "map.json", "sweep", "--out", out]);
    out(".").fails(4, "error: .: the folder is not empty and not a store of mve");
    out("map.json/x").fails(4, "error: map.json/x: a file stands where a folder is needed\n");
    out("map.json").fails(4, "error: map.json: a file of this name is in the way\n");
}

#[test]
fn problems_of_steps_are_refused() {
    let folder = Folder::new();
    folder.write("bad.json", &common::map().replace("[1, 2, 3]", "[1, \"two\"]"));
    let answer = folder.mve(&["program", "bad.json", "sweep"]);
    let answer = answer.fails(3, "program \"sweep\": level.value: \"two\" is not a number");
    answer.fails(3, "error: bad.json: 1 problem; nothing was run\n");
    assert!(!folder.has("mve-out"));
    let answer = folder.mve(&["program", "map.json", "sweep", "--set", "level.valu=1"]);
    answer.fails(3, "--set level.valu: there is no parameter \"valu\"");
    let answer = folder.mve(&["program", "map.json", "sweep", "--set", "level.value=1"]);
    answer.fails(0, "--set level.value has no effect: the program varies it");
}

#[test]
fn sizes_and_limits_are_read() {
    let folder = Folder::new();
    let with = |option: &str, value: &str| {
        folder.mve(&["program", "map.json", "sweep", "--dry-run", option, value])
    };
    with("--memory", "512M").succeeds();
    with("--memory", "much").fails(2, "write a size such as 4G or 512M");
    with("--time-limit", "0").fails(2, "write a number of seconds above 0");
}

#[cfg(unix)]
#[test]
fn an_interruption_keeps_finished_steps_and_the_next_run_resumes() {
    for signal in ["-INT", "-TERM"] {
        let folder = Folder::new();
        let args = ["program", "map.json", "long", "--json", "--jobs", "1"];
        let mut child =
            folder.command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let is_ended = |line: &String| line.contains("\"step_ended\"");
        let _ = lines.by_ref().map(Result::unwrap).filter(is_ended).nth(2).unwrap();
        let kill = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(kill.unwrap().success());
        let last = lines.map(Result::unwrap).last().unwrap();
        let answer = common::Answer::new(child.wait_with_output().unwrap());
        let answer = answer.fails(130, "stopping; finished steps are kept, run the same command");
        answer.fails(130, "of 400 steps remain, the same command resumes\n");
        let last: serde_json::Value = serde_json::from_str(&last).unwrap();
        assert_eq!((&last["event"], &last["status"]), (&"finished".into(), &"stopped".into()));
        let (ran, missing) = (last["ran"].as_u64().unwrap(), last["missing"].as_u64().unwrap());
        assert!(ran >= 3 && missing > 0 && ran + missing == 400, "{last}");
        let again = folder.mve(&["program", "map.json", "long", "-q"]).succeeds();
        again
            .says(&format!("400 steps: 400 done; {missing} run now"))
            .says(&format!("{ran} found"));
    }
}
