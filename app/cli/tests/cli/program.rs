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

#[cfg(unix)]
#[test]
fn a_step_out_of_memory_is_a_row_after_the_second_time_and_the_others_go_on() {
    let folder = Folder::new();
    let map = r#"{"mve": 1, "nodes": {"model": {"module": "Vase"}, "info": {"module": "MeshInfo"}},
        "links": ["model.mesh -> info.mesh"],
        "programs": {"p": {"axes": [{"model.segments": [64, 4096, 128],
            "model.profile_segments": [64, 4096, 128]}]}}}"#;
    folder.write("oom.json", map);
    let call = || {
        let mve = env!("CARGO_BIN_EXE_mve");
        let script = format!("ulimit -v 600000; exec {mve} program oom.json -j1 --threads 1");
        let mut shell = Command::new("sh");
        shell.args(["-c", &script]).current_dir(folder.path()).output().unwrap()
    };
    assert_eq!(call().status.code(), None, "dies");
    assert_eq!(call().status.code(), None, "dies again");
    let answer = common::Answer::new(call());
    let answer = answer.fails(1, "1 of 3 steps failed").says("3 steps: 2 done, 1 failed");
    answer.says("2 processes ended while they ran this step: out of memory, a crash, or killed");
    let table = folder.read("mve-out/oom-p/results.csv");
    assert_eq!(table.matches(",crashed,").count(), 1, "{table}");
}

#[cfg(unix)]
#[test]
fn an_interruption_while_inputs_are_hashed_ends_with_an_event() {
    let folder = Folder::new();
    let file = std::fs::File::create(folder.path().join("large.raw")).unwrap();
    file.set_len(64 << 30).unwrap();
    let map = r#"{"mve": 1, "nodes": {"load": {"module": "FileLoader",
        "params": {"path": "large.raw"}}}, "programs": {"p": {}}}"#;
    folder.write("large.json", map);
    for command in ["run", "program"] {
        let args = [command, "large.json", "--json"];
        let child =
            folder.command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(400));
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(kill.unwrap().success());
        let answer = common::Answer::new(child.wait_with_output().unwrap());
        let answer = answer.fails(130, "stopped before anything ran");
        let last = answer.json().pop().unwrap();
        assert_eq!((&last["event"], &last["status"]), (&"finished".into(), &"stopped".into()));
    }
}

#[test]
fn steps_that_another_process_holds_make_it_incomplete() {
    let folder = Folder::new();
    folder.mve(&["program", "map.json", "sweep", "--shard", "1/2"]).succeeds();
    let steps = folder.mve(&["program", "map.json", "sweep", "--dry-run", "--json"]).json();
    let id = steps.iter().find(|step| step["status"] == "to do").unwrap()["id"].clone();
    let claim = folder.path().join("mve-out/map-sweep/claims").join(id.as_str().unwrap());
    let lock = std::fs::File::create(claim).unwrap();
    lock.lock().unwrap();
    let sweep = ["program", "map.json", "sweep"];
    let answer = folder.mve(&sweep);
    let answer = answer.fails(5, "1 of 6 steps are with other processes, or were left by them");
    answer.says("5 done, 1 to do");
    let last = folder.mve(&[&sweep[..], &["--json"]].concat()).json().pop().unwrap();
    assert_eq!((&last["status"], &last["missing_of_part"]), (&"incomplete".into(), &1.into()));
    // Who waits runs it as soon as it is left.
    let waiting = folder.command(&[&sweep[..], &["--wait"]].concat());
    let waiting = { waiting }.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(300));
    drop(lock);
    let answer = common::Answer::new(waiting.wait_with_output().unwrap());
    answer.succeeds().says("6 done; 1 run now");
}

#[test]
fn a_module_that_is_added_runs_alone() {
    let folder = Folder::new();
    let map = |nodes: &str, links: &str| {
        format!(
            r#"{{"mve": 1, "nodes": {{"model": {{"module": "Vase",
            "params": {{"segments": 256, "profile_segments": 256}}}},
            "simplify": {{"module": "Simplificator"}}{nodes}}},
            "links": ["model.mesh -> simplify.mesh"{links}],
            "programs": {{"p": {{"axes": [{{"simplify.ratio": [0.2, 0.1]}}]}}}}}}"#
        )
    };
    folder.write("a.json", &map("", ""));
    folder.mve(&["program", "a.json"]).succeeds();
    let info = r#", "info": {"module": "MeshInfo"}"#;
    folder.write("a.json", &map(info, r#", "simplify.mesh -> info.mesh""#));
    let lines = folder.mve(&["program", "a.json", "--json"]).succeeds().json();
    let started = lines.iter().filter(|line| line["event"] == "started");
    let started: Vec<_> = started.map(|line| line["node"].as_str().unwrap()).collect();
    // A value that was made in no time is made again.
    assert!(!started.contains(&"simplify") && started.contains(&"info"), "{started:?}");
    let ended = lines.iter().filter(|line| line["event"] == "ended");
    let mut simplify = ended.filter(|line| line["node"] == "simplify");
    let seconds = |line: &serde_json::Value| line["record"]["seconds"].as_f64().unwrap();
    assert!(simplify.all(|line| line["record"]["cached"] == "disk" && seconds(line) > 0.02));
    // What was measured for comparison is never taken from it, and a person can do without.
    let timed = folder.mve(&["program", "a.json", "--timing", "--json"]).succeeds().json();
    assert!(timed.iter().all(|line| line["record"]["cached"].is_null()));
    let answer = folder.mve(&["clean", "mve-out/a-p"]).succeeds();
    answer
        .says("2 steps of earlier versions, ")
        .says("values in the cache, ")
        .says("--yes removes");
    folder.mve(&["clean", "mve-out/a-p", "--yes"]).succeeds().says("removed ");
    folder.mve(&["clean", "mve-out/a-p"]).succeeds().says("nothing to clean");
    folder.mve(&["program", "a.json"]).succeeds().says("2 done; 0 run now");
    folder.mve(&["program", "a.json", "--no-cache", "--out", "bare"]).succeeds();
    assert!(!folder.has("bare/cache"));
    folder.mve(&["clean", "nowhere"]).fails(4, "nowhere: there is no such file or folder");
}

#[test]
fn maps_of_one_name_do_not_share_a_table() {
    let folder = Folder::new();
    for name in ["a/exp.json", "b/exp.json"] {
        folder.write(name, &common::map());
    }
    folder.mve(&["program", "a/exp.json", "sweep"]).succeeds();
    let answer = folder.mve(&["program", "b/exp.json", "sweep"]);
    answer.fails(2, "mve-out/exp-sweep: holds the results of another map of this name, /");
    folder.mve(&["program", "b/exp.json", "sweep", "--out", "b/out"]).succeeds();
    // One that was moved is the same map still.
    std::fs::remove_dir_all(folder.path().join("b")).unwrap();
    std::fs::rename(folder.path().join("a"), folder.path().join("b")).unwrap();
    folder.mve(&["program", "b/exp.json", "sweep"]).succeeds().says("6 done; 0 run now");
}

#[test]
fn settings_of_a_call_are_a_column() {
    let folder = Folder::new();
    let one = r#"{"mve": 1, "nodes": {"level": {"module": "Constant"},
        "print": {"module": "Print"}}, "links": ["level.value -> print.value"],
        "programs": {"p": {"axes": [{"print.label": ["x", "y"]}]}}}"#;
    folder.write("one.json", one);
    for (value, steps) in [("3", 2), ("4", 4)] {
        let set = format!("level.value={value}");
        let answer = folder.mve(&["program", "one.json", "--set", &set]).succeeds();
        answer.says(&format!("{steps} steps: {steps} done; 2 run now"));
    }
    let table = folder.read("mve-out/one-p/results.csv");
    let rows: Vec<_> = table.lines().map(|row| row.split(',').nth(1).unwrap()).collect();
    assert_eq!(rows, ["level.value", "3", "3", "4", "4"]);
}

#[test]
fn parts_of_a_program_run_alone() {
    let folder = Folder::new();
    let only = |only: &str| folder.mve(&["program", "map.json", "sweep", "--only", only]);
    only("print.label=x").succeeds().says("6 steps: 3 done, 3 to do; 3 run now");
    only("print.lable=x").fails(2, "it varies level.value, print.label; did you mean");
    only("print.label=z").fails(2, "no step has it as \"z\"");
    only("print.label=xx").fails(2, "no step has it as \"xx\"; did you mean \"x\"?");
}

#[test]
fn axes_name_files_by_a_pattern_and_numbers_by_their_ends() {
    let folder = Folder::new();
    for name in ["scans/b.raw", "scans/a.raw"] {
        folder.write(name, name);
    }
    let map = r#"{"mve": 1, "nodes": {"load": {"module": "FileLoader",
        "params": {"path": "scans/a.raw"}}, "level": {"module": "Constant"}},
        "programs": {"p": {"axes": [{"load.path": {"glob": "scans/*.raw"}},
            {"level.value": {"range": [0.1, 0.3, 3]}}]}}}"#;
    folder.write("many.json", map);
    let answer = folder.mve(&["program", "many.json"]).succeeds();
    answer.says("6 steps: 6 done").says("scans/b.raw").says(" 0.2 ");
    folder.mve(&["check", "many.json"]).succeeds().says("p: 6 steps");
    folder.write("none.json", &map.replace("*.raw", "*.obj"));
    folder.mve(&["program", "none.json"]).fails(3, "no file is named like \"scans/*.obj\"");
}

#[test]
fn events_are_what_their_schema_says() {
    let folder = Folder::new();
    let text = folder.mve(&["schema", "--events"]).succeeds().out;
    let schema: serde_json::Value = serde_json::from_str(&text).unwrap();
    let kinds = schema["oneOf"].as_array().unwrap();
    let sweep = ["program", "map.json", "sweep", "--json"];
    let calls = [&sweep[..], &sweep[..], &["run", "map.json", "--json"]];
    let dry = [&sweep[..], &["--dry-run"]].concat();
    for args in calls.into_iter().chain([&dry[..]]) {
        let lines = folder.mve(args).succeeds().json();
        for line in &lines {
            let kind =
                kinds.iter().find(|kind| kind["properties"]["event"]["const"] == line["event"]);
            let kind = kind.unwrap_or_else(|| panic!("{line}"));
            let required = kind["required"].as_array().unwrap();
            assert!(required.iter().all(|key| !line[key.as_str().unwrap()].is_null()), "{line}");
            assert!(line["time"].as_f64().unwrap() > 1.7e9, "{line}");
        }
        assert!(args.contains(&"--dry-run") || lines[0]["event"] == "began", "{args:?}");
    }
}

#[test]
fn nothing_that_a_map_says_steers_a_terminal() {
    let folder = Folder::new();
    let odd = r"\u001b]0;pwn\u0007\u202e\u009b31m";
    let map = common::map()
        .replace("\"level:\"", &format!("\"{odd}\""))
        .replace("[\"x\", \"y\"]", &format!("[\"{odd}\", \"=1+1\"]"))
        .replace("\"title\": \"test\"", &format!("\"title\": \"{odd}|<b>\""));
    folder.write("odd.json", &map);
    let steers = |text: &str| text.contains(|c| c != '\n' && mve_core::is_steering(c));
    for args in [
        &["run", "odd.json"][..],
        &["program", "odd.json", "sweep"],
        &["program", "odd.json", "sweep", "--dry-run"],
        &["program", "odd.json", "sweep", "--json"],
        &["check", "odd.json"],
    ] {
        let answer = folder.mve(args).succeeds();
        assert!(!steers(&answer.out) && !steers(&answer.err), "{args:?}: {answer:?}");
    }
    let store = |name: &str| folder.read(&format!("mve-out/odd-sweep/{name}"));
    let summary = store("summary.md");
    assert!(!steers(&summary) && summary.contains("&lt;b>"), "{summary}");
    assert!(store("results.csv").contains(",'=1+1,"));
    let steps = std::fs::read_dir(folder.path().join("mve-out/odd-sweep/steps")).unwrap();
    for step in steps {
        let log = step.unwrap().path().join("log.txt");
        assert!(!steers(&std::fs::read_to_string(log).unwrap()));
    }
}
