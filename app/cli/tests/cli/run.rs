//! `mve run` and `mve check`: results, messages and exit codes.

use crate::common::{self, Answer, Folder};

#[test]
fn a_run_prints_logs_and_a_table() {
    let answer = Folder::new().mve(&["run", "map.json"]).succeeds();
    let answer = answer.says("print: level: 2.5\n").says("other: 2.5\n");
    let answer = answer.says("node   status  seconds  output  value\n");
    let answer = answer.says("level  done ").says("value     2.5\n").says("3 of 3 nodes done in");
    assert!(answer.err.contains("] level: done, "), "{}", answer.err);
}

#[test]
fn quiet_leaves_the_result() {
    let answer = Folder::new().mve(&["run", "map.json", "--quiet"]).succeeds().says("3 of 3 nodes");
    assert_eq!(answer.err, "");
}

#[test]
fn parameters_are_set_as_json_or_text() {
    let folder = Folder::new();
    let set = ["--set", "level.value=7", "--set", "print.label=now it is"];
    folder.mve(&[&["run", "map.json"], &set[..]].concat()).succeeds().says("print: now it is 7\n");
}

#[test]
fn files_are_where_the_person_is_wherever_a_value_names_them() {
    let folder = Folder::new();
    folder.write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("7", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write(
        "maps/m.json",
        r#"{"mve": 1, "nodes": {"a": {"module": "ObjLoader", "params": {"path": "none.obj"}}}}"#,
    );
    for set in ["a.path=cube.obj", "a.path=7", r#"a.module={"ObjLoader": {"path": "cube.obj"}}"#] {
        folder.mve(&["run", "maps/m.json", "--set", set]).succeeds();
    }
}

#[test]
fn json_events_are_lines_and_the_summary_is_last() {
    let answer = Folder::new().mve(&["run", "map.json", "--json"]).succeeds();
    assert_eq!(answer.err, "");
    let lines = answer.json();
    assert!(lines.iter().any(|line| line["event"] == "log" && line["text"] == "level: 2.5"));
    let last = lines.last().unwrap();
    assert_eq!((&last["event"], &last["status"]), (&"finished".into(), &"done".into()));
    assert_eq!(last["nodes"]["level"]["scalars"]["value"], 2.5);
    assert_eq!(lines.iter().filter(|line| line["event"] == "ended").count(), 3);
}

#[test]
fn files_that_are_no_maps_are_explained() {
    let folder = Folder::new();
    folder.write("broken.json", "{\n  \"mve\": 1,\n}");
    folder.write("list.json", "[]");
    folder.write("newer.json", r#"{"mve": 99}"#);
    let run = |map: &str| folder.mve(&["run", map]);
    run("missing.json").fails(4, "error: missing.json: there is no such map\n");
    run(".").fails(4, "error: .: is a folder; name a map's file in it\n");
    run("map.json/x").fails(4, "a file stands where a folder is needed");
    run("broken.json")
        .fails(3, "not a map: line 3, column 1: a comma before the closing bracket\n");
    folder.write("why.json", "{\n  // why\n}");
    run("why.json").fails(3, "line 2, column 3: JSON has no comments");
    run("list.json").fails(3, "not a map");
    run("newer.json").fails(3, "written in format 99");
}

#[test]
fn all_problems_come_at_once_and_nothing_runs() {
    let folder = Folder::new();
    let text = common::map();
    folder.write("bad.json", &text.replace("\"Print\"", "\"Prnt\"").replace("2.5", "\"much\""));
    let answer = folder.mve(&["run", "bad.json", "--set", "lvel.value=1"]);
    let answer = answer.fails(3, "error: bad.json:3:48: level.value: \"much\" is not a number\n");
    let answer = answer.fails(3, "print: there is no module \"Prnt\"; did you mean \"Print\"?\n");
    let answer = answer.fails(3, "--set lvel.value: there is no node \"lvel\"; did you mean");
    let answer = answer.fails(3, "error: bad.json: 4 problems; nothing was run\n");
    assert_eq!(answer.out, "");
    let lines = folder.mve(&["run", "bad.json", "--json"]).fails(3, "3 problems").json();
    assert!(lines.iter().any(|line| line["node"] == "level" && line["port"] == "value"));
    assert_eq!(lines.last().unwrap()["status"], "refused");
}

#[test]
fn every_problem_has_a_line() {
    let folder = Folder::new();
    let text = common::map();
    let swept = |program: &str| text.replace("\"sweep\": {", &format!("\"sweep\": {{{program}, "));
    let linked = |link: &str| text.replace("\"links\": [", &format!("\"links\": [\n7, {link},"));
    let axes = r#""axes": [{"level.value": [1, 2, 3]}, {"print.label": ["x", "y"]}]"#;
    let uneven = r#""axes": [{"level.value": [1]}, {"print.label": ["x"], "level.value": [1, 2]}]"#;
    for (place, text) in [
        // Links: of no form, of no node, to no port, of another type.
        ("7:1", linked("\"level.value\"")),
        ("7:4", linked("\"level.value -> nobody.x\"")),
        ("7:4", linked("\"level.value -> print.lbel\"")),
        ("7:4", linked("\"level.none -> print.value\"")),
        // Axes, steps and the rest of a program.
        ("8:46", text.replace(axes, uneven)),
        ("8:15", swept("\"repeats\": 0")),
        ("8:15", swept("\"time_limit\": -1")),
        ("8:26", swept("\"report\": {\"group\": [\"x.y\"]}")),
        ("8:40", swept("\"report\": {\"measures\": [{\"column\": \"x.y\"}]}")),
        ("8:39", swept("\"report\": {\"measures\": [3]}")),
        // What stands twice, and what is of another form.
        ("5:5", text.replace("\"other\"", "\"print\"")),
        ("1:2", text.replace("\"mve\": 1", "\"mve\": -1")),
        ("1:1", text.replace("\"mve\": 1, ", "")),
        ("6:3", text.replace("\"links\": [", "\"links\": 3, \"_\": [")),
        ("2:14", "{\"mve\": 1,\n \"layout\": { \"a\": 3}, \"nodes\": {}}".to_owned()),
        ("1:12", "{\"mve\": 1, \"nodes\": {}}".to_owned()),
    ] {
        folder.write("bad.json", &text);
        let answer = folder.mve(&["check", "--json", "bad.json"]);
        let lines = answer.json();
        let problems: Vec<_> = lines.iter().filter(|line| line["event"] == "problem").collect();
        let at = |line: &&serde_json::Value| format!("{}:{}", line["line"], line["column"]);
        let places: Vec<String> = problems.iter().map(at).collect();
        assert!(
            places.iter().any(|at| at == place),
            "{place} not in {places:?}\n{answer:?}\n{text}"
        );
        assert!(!places.iter().any(|at| at.contains("null")), "{answer:?}");
    }
}

#[test]
fn a_circle_is_refused() {
    let folder = Folder::new();
    let text = common::map().replace("[\"level.value -> ", "[\"level.value -> level.value\", \"");
    folder.write("circle.json", &text.replace("\"print.value\"", "\"level.value -> print.value\""));
    folder.mve(&["run", "circle.json"]).fails(3, "the links run in a circle: level -> level");
}

#[test]
fn wrong_usage_is_code_2() {
    let folder = Folder::new();
    folder.mve(&["rnu"]).fails(2, "unrecognized subcommand 'rnu'");
    folder.mve(&["run"]).fails(2, "<MAP>");
    folder.mve(&["run", "map.json", "--set", "x"]).fails(2, "write NODE.PARAM=VALUE");
    folder.mve(&["run", "map.json", "--threads", "0"]).fails(2, "from 1 to 4096");
}

#[test]
fn a_cache_folder_that_cannot_be_is_code_4() {
    let folder = Folder::new();
    let answer = folder.mve(&["run", "map.json", "--cache", "map.json/cache"]);
    answer.fails(4, "error: map.json/cache: a file stands where a folder is needed\n");
    folder.mve(&["run", "map.json", "--cache", "cache"]).succeeds();
    assert!(folder.has("cache"));
}

#[test]
fn check_says_facts_or_groups_of_problems() {
    let folder = Folder::new();
    folder.mve(&["check", "map.json"]).succeeds().says(
        "map.json: no problems; 3 nodes, 2 links, 2 programs (sweep: 6 steps, long: 400 steps)\n",
    );
    let text = common::map().replace("[1, 2, 3]", "[1, \"two\"]").replace("\"label\"", "\"lbel\"");
    folder.write("bad.json", &text);
    let answer = folder.mve(&["check", "bad.json"]).fails(3, "error: bad.json: 2 problems\n");
    let expected = "bad.json
  error: line 4, column 45: print.lbel: there is no parameter of this name; did you mean \"label\"?
program \"sweep\"
  error: line 8, column 25: level.value: \"two\" is not a number (with level.value = \"two\", print.label = \"x\")\n";
    assert_eq!(answer.out, expected);
}

#[test]
fn maps_are_checked_together_as_lines_and_from_standard_input() {
    let folder = Folder::new();
    folder.write(
        "slip.json",
        &common::map().replace("\"params\": {\"value\"", "\"parms\": {\"value\""),
    );
    folder.write("bad.json", &common::map().replace("2.5", "\"2.5\""));
    let answer = folder.mve(&["check", "slip.json", "map.json"]).fails(3, "slip.json: 1 problem");
    let answer = answer.says("level.parms: \"parms\" means nothing in a node; did you mean");
    answer.says("map.json: no problems");
    let answer = folder.mve(&["check", "bad.json", "map.json", "--json"]).fails(3, "");
    let lines = answer.json();
    assert_eq!((&lines[0]["event"], &lines[0]["line"]), (&"problem".into(), &3.into()));
    assert!(lines[0]["message"].as_str().unwrap().ends_with("write it without quotes"));
    let ends: Vec<_> = lines.iter().filter(|line| line["event"] == "checked").collect();
    assert_eq!((&ends[0]["status"], &ends[1]["status"]), (&"refused".into(), &"fine".into()));
    let map = std::fs::File::open(folder.path().join("map.json")).unwrap();
    let answer = Answer::new(folder.command(&["check", "-"]).stdin(map).output().unwrap());
    answer.succeeds().says("stdin: no problems");
}

#[test]
fn what_every_program_sets_is_no_fault_of_the_map() {
    let folder = Folder::new();
    let map = |programs: &str| {
        let text = format!(
            "{{\"mve\": 1, \"nodes\": {{\"load\": {{\"module\": \"ObjLoader\"}}}}, \
             \"programs\": {{{programs}}}}}"
        );
        folder.write("glob.json", &text);
    };
    folder.write("scans/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let glob = "\"p\": {\"axes\": [{\"load.path\": {\"glob\": \"scans/*.obj\"}}]}";
    map(glob);
    let answer = folder.mve(&["check", "glob.json"]).succeeds();
    answer.says("only programs, which set it, can run this map").says("(p: 1 step)");
    folder.mve(&["program", "glob.json"]).succeeds();
    folder.mve(&["run", "glob.json"]).fails(3, "load.path: ");
    map(&format!("{glob}, \"q\": {{\"repeats\": 2}}"));
    folder.mve(&["check", "glob.json"]).fails(3, "");
}

#[test]
fn a_program_is_not_told_of_an_option_that_it_lacks() {
    let folder = Folder::new();
    let text = "{\"mve\": 1, \"nodes\": {\"box\": {\"module\": \"Box\"}, \
                \"save\": {\"module\": \"ObjSaver\", \"params\": {\"path\": \"NAME\"}}}, \
                \"links\": [\"box.mesh -> save.mesh\"], \"programs\": {\"p\": {\"repeats\": 1}}}";
    folder.write("map.json", &text.replace("NAME", "../a.obj"));
    let answer = folder.mve(&["program", "map.json"]);
    let answer = answer.fails(3, "the files of a program's steps stay in its store");
    assert!(!answer.err.contains("--allow-outside"), "{}", answer.err);
    folder.mve(&["run", "map.json"]).fails(3, "--allow-outside");
    // What turns the direction of a text would show `jbo.exe` for this name.
    folder.write("map.json", &text.replace("NAME", "\u{202e}exe.obj"));
    folder.mve(&["check", "map.json"]).fails(3, "").says("a path cannot hold control characters");
    folder.write("map.json", &text.replace("NAME", "a.obj").replace("\"p\"", "\"p\u{202e}\""));
    let answer = folder.mve(&["check", "map.json"]).fails(3, "");
    answer.says("the name of a program cannot hold control characters");
}

#[test]
fn one_fault_is_one_problem_and_a_long_name_is_cut() {
    let folder = Folder::new();
    let check = |a: &str, b: &str| {
        let saver = |name: &str| {
            format!("{{\"module\": \"ObjSaver\", \"params\": {{\"path\": \"{name}\"}}}}")
        };
        let text = format!(
            "{{\"mve\": 1, \"nodes\": {{\"box\": {{\"module\": \"Box\"}}, \"a\": {}, \"b\": {}}}, \
             \"links\": [\"box.mesh -> a.mesh\", \"box.mesh -> b.mesh\"]}}",
            saver(a),
            saver(b)
        );
        folder.write("map.json", &text);
        folder.mve(&["check", "map.json"]).fails(3, "map.json: 1 problem\n")
    };
    // A mesh, its materials and the folder of its textures.
    check("a.obj", "a.obj").says("a.path writes \"a.obj\" too").says("(the first of 3 such files)");
    check("a.obj", "a.obj/b.obj")
        .says("b.path: needs \"a.obj\" as a folder, which a.path writes alone");
    let id = "M".repeat(5000);
    folder.write(
        "map.json",
        &format!("{{\"mve\": 1, \"nodes\": {{\"a\": {{\"module\": \"{id}\"}}}}}}"),
    );
    let answer = folder.mve(&["check", "map.json"]).fails(3, "1 problem");
    assert!(answer.says("MMM…\"; `mve modules` lists them").out.len() < 300);
    let axis = |values: &str| {
        folder.write("map.json", &common::map().replace("[1, 2, 3]", values));
        folder.mve(&["check", "map.json"]).fails(3, "1 problem")
    };
    axis("{\"lgo\": [1, 2, 3]}").says("{\"range\": [0.1, 0.5, 5]}, {\"log\": [0.02, 0.5, 5]} or");
}

#[test]
fn a_slip_in_a_key_of_the_format_runs_nothing() {
    let folder = Folder::new();
    folder
        .write("map.json", &common::map().replace("\"sweep\": {\"axes\"", "\"sweep\": {\"axis\""));
    let meant = "\"axis\" means nothing in a program; did you mean \"axes\"?";
    folder.mve(&["check", "map.json"]).fails(3, "map.json: 1 problem").says(meant);
    folder.mve(&["program", "map.json", "sweep"]).fails(3, meant);
    folder.mve(&["run", "map.json"]).fails(3, meant);
    // It is none of the other program, which does what it says.
    folder.mve(&["program", "map.json", "long", "--dry-run"]).succeeds().says("400 steps: 0 done");
    // What is near to no key is kept for others to read.
    folder.write("map.json", &common::map().replace("\"sweep\": {", "\"sweep\": {\"color\": 3, "));
    folder.mve(&["check", "map.json"]).succeeds().says("no errors, 1 warning");
}

#[test]
fn warnings_are_told_and_do_not_fail() {
    let folder = Folder::new();
    let text =
        common::map().replace("[\"level.value -> ", "[\"print.label -> \", \"level.value -> ");
    // A parameter that is set and linked: the link counts.
    let text = text.replace("\"print.label -> \", ", "\"level.value -> twice.value\", ");
    let twice = r#""twice": {"module": "Constant", "params": {"value": 1}}, "print""#;
    folder.write("warn.json", &text.replacen("\"print\"", twice, 1));
    let answer = folder.mve(&["check", "warn.json"]).succeeds();
    answer.says("column 48: twice.value: is set and linked").says("no errors, 1 warning; 4 nodes");
    let answer = folder.mve(&["run", "warn.json"]).succeeds();
    assert!(answer.err.contains("warning: warn.json:4:48: twice.value: is set"), "{}", answer.err);
}

#[test]
fn threads_are_there_before_a_plan_looks_into_a_large_file() {
    let folder = Folder::new();
    let comments = "# a scan of many megabytes\n".repeat(250_000);
    folder.write("scan.obj", &format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n{comments}"));
    folder.write(
        "map.json",
        r#"{"mve": 1, "nodes": {"a": {"module": "ObjLoader", "params": {"path": "scan.obj"}}},
            "programs": {"p": {"axes": [{"a.path": ["scan.obj"]}]}}}"#,
    );
    folder.mve(&["run", "map.json", "--threads", "1"]).succeeds();
    folder.mve(&["program", "map.json", "--threads", "1", "--out", "store"]).succeeds();
}
