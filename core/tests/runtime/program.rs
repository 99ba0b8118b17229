//! Programs and stores: every step once, whatever happens on the way.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use mve_core::testing::{program_options, registry};
use mve_core::{
    CancelToken, Map, Part, Patience, Program, ProgramEvent, ProgramOptions, ProgramOutcome, Retry,
    Shard, Sharing, Store, StoreError, run_program,
};

const MAP: &str = r#"{"mve": 1, "title": "test", "nodes": {
    "base": {"module": "Add", "params": {"amount": 1}},
    "add": {"module": "Add"},
    "echo": {"module": "Echo"},
    "write": {"module": "Write", "params": {"path": "{add.amount}-{echo.say}.txt"}}},
  "links": ["base.sum -> add.a", "echo.text -> write.text"],
  "programs": {"p": {"axes": [{"add.amount": [1, 2, 99, 4]}, {"echo.say": ["x", "y"]}]}}}"#;

fn program(text: &str) -> Program {
    let map = Map::parse(text).unwrap();
    let program = Program::new(&map, "p", &registry(), Path::new("/"));
    program.unwrap_or_else(|problems| panic!("{problems:#?}"))
}

fn options(cancel: &CancelToken) -> ProgramOptions<'_> {
    ProgramOptions { jobs: 3, ..program_options(cancel) }
}

fn run_in(folder: &Path, text: &str) -> ProgramOutcome {
    let store = Store::open(folder).unwrap();
    run_program(&program(text), &store, &options(&CancelToken::new())).unwrap()
}

/// The table without the columns that hold times.
fn table(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(folder.join("results.csv")).unwrap();
    reader
        .deserialize::<BTreeMap<String, String>>()
        .map(|row| {
            let mut row = row.unwrap();
            row.retain(|name, _| !name.starts_with("seconds"));
            row
        })
        .collect()
}

#[test]
fn a_program_leaves_rows_files_and_a_summary() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = run_in(folder.path(), MAP);
    assert_eq!((outcome.steps, outcome.ran, outcome.failed, outcome.missing), (8, 8, 2, 0));
    let rows = table(folder.path());
    assert_eq!(rows.len(), 8);
    assert_eq!(rows[3]["add.amount"], "2");
    assert_eq!(rows[3]["echo.say"], "y");
    assert_eq!(rows[3]["add.sum"], "3");
    assert_eq!(rows[4]["status"], "failed");
    assert!(rows[4]["reason"].contains("add: 99 is too much"), "{:?}", rows[4]);
    assert_eq!(std::fs::read_to_string(folder.path().join("outputs/4-x.txt")).unwrap(), "x");
    let summary = std::fs::read_to_string(folder.path().join("summary.md")).unwrap();
    assert!(summary.contains("8 of 8 steps finished, 2 failed"));
    let lines = std::fs::read_to_string(folder.path().join("results.jsonl")).unwrap();
    let first: serde_json::Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
    assert_eq!(first["outputs"]["add.sum"], 2.0);
}

#[test]
fn finished_steps_do_not_run_again_until_asked() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), MAP);
    let before = table(folder.path());
    let again = run_in(folder.path(), MAP);
    assert_eq!((again.ran, again.found), (0, 8));
    assert_eq!(table(folder.path()), before);
    let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
    let retry = ProgramOptions { retry: Retry::Failed, ..options(&cancel) };
    assert_eq!(run_program(&program(MAP), &store, &retry).unwrap().ran, 2);
    assert_eq!(table(folder.path()), before);
}

#[test]
fn a_longer_axis_runs_only_the_new_steps() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), MAP);
    let longer = MAP.replace("[1, 2, 99, 4]", "[1, 2, 4, 5]");
    let outcome = run_in(folder.path(), &longer);
    assert_eq!((outcome.ran, outcome.found, outcome.others), (2, 6, 2));
    assert_eq!(table(folder.path()).len(), 8);
}

#[test]
fn a_step_whose_file_was_cut_short_or_is_gone_runs_again() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), MAP);
    let file = folder.path().join("outputs/4-x.txt");
    std::fs::write(&file, "").unwrap();
    assert_eq!([1, 0].map(|_| run_in(folder.path(), MAP).ran), [1, 0]);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "x");
}

#[test]
fn a_broken_record_is_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), MAP);
    let before = table(folder.path());
    let steps: Vec<_> = std::fs::read_dir(folder.path().join("steps")).unwrap().collect();
    for step in steps.iter().take(3) {
        let record = step.as_ref().unwrap().path().join("record.json");
        let text = std::fs::read(&record).unwrap();
        std::fs::write(&record, &text[..text.len() / 2]).unwrap();
    }
    assert_eq!(run_in(folder.path(), MAP).ran, 3);
    assert_eq!(table(folder.path()), before);
}

#[test]
fn a_stopped_program_goes_on_where_it_was() {
    let whole = tempfile::tempdir().unwrap();
    run_in(whole.path(), MAP);
    let folder = tempfile::tempdir().unwrap();
    let mut ran = 0;
    for _ in 0..8 {
        let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
        let stop_soon = |event: &ProgramEvent| {
            if matches!(event, ProgramEvent::StepEnded { .. }) {
                cancel.cancel();
            }
        };
        let options = ProgramOptions { jobs: 1, observer: &stop_soon, ..options(&cancel) };
        ran += run_program(&program(MAP), &store, &options).unwrap().ran;
    }
    assert_eq!(ran, 8);
    assert_eq!(table(folder.path()), table(whole.path()));
    assert_eq!(std::fs::read_dir(folder.path().join("work")).unwrap().count(), 0);
}

#[test]
fn two_at_once_do_every_step_once() {
    let folder = tempfile::tempdir().unwrap();
    let amounts: Vec<_> = (0..90).map(|i| i.to_string()).collect();
    let text = MAP.replace("[1, 2, 99, 4]", &format!("[{}]", amounts.join(",")));
    let started = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
                let count = |event: &ProgramEvent| {
                    if matches!(event, ProgramEvent::StepStarted { .. }) {
                        started.fetch_add(1, Ordering::Relaxed);
                    }
                };
                let options = ProgramOptions { observer: &count, ..options(&cancel) };
                run_program(&program(&text), &store, &options).unwrap();
            });
        }
    });
    assert_eq!(started.into_inner(), 180);
    assert_eq!(table(folder.path()).len(), 180);
}

#[test]
fn shards_divide_the_steps() {
    let folder = tempfile::tempdir().unwrap();
    let mut ran = Vec::new();
    for index in 0..3 {
        let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
        let shard = Shard { index, count: 3 };
        let options =
            ProgramOptions { part: Part { shard, ..Part::default() }, ..options(&cancel) };
        ran.push(run_program(&program(MAP), &store, &options).unwrap().ran);
    }
    assert_eq!(ran, [3, 3, 2]);
}

#[test]
fn timing_runs_everything_and_sharing_does_not() {
    let seconds_of_base = |sharing| {
        let folder = tempfile::tempdir().unwrap();
        let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
        let options = ProgramOptions { sharing, jobs: 1, ..options(&cancel) };
        run_program(&program(MAP), &store, &options).unwrap();
        let mut reader = csv::Reader::from_path(folder.path().join("results.csv")).unwrap();
        let rows = reader.deserialize::<BTreeMap<String, String>>();
        rows.filter(|row| !row.as_ref().unwrap()["seconds.base"].is_empty()).count()
    };
    assert_eq!(seconds_of_base(Sharing::Timing), 8);
    assert_eq!(seconds_of_base(Sharing::Shared), 1);
}

#[test]
fn timing_runs_each_step_as_often_as_is_asked_and_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
    let text = MAP.replace("[1, 2, 99, 4]", "[1, 2]");
    let run = |timings: usize| {
        let starts = Mutex::new(Vec::new());
        let count = |event: &ProgramEvent| {
            if let ProgramEvent::StepStarted { place, .. } = event {
                starts.lock().unwrap().push(*place);
            }
        };
        let sharing = Sharing::Timing;
        let options = ProgramOptions { sharing, timings, observer: &count, ..options(&cancel) };
        let outcome = run_program(&program(&text), &store, &options).unwrap();
        (outcome.ran, starts.into_inner().unwrap())
    };
    let (ran, starts) = run(3);
    assert_eq!((ran, starts.len()), (4, 12));
    // Each round has every step once, and not all rounds have one order.
    let rounds: Vec<Vec<usize>> = starts.chunks(4).map(<[usize]>::to_vec).collect();
    let sorted = |round: &Vec<usize>| {
        let mut round = round.clone();
        round.sort_unstable();
        round
    };
    assert!(rounds.iter().all(|round| sorted(round) == [0, 1, 2, 3]), "{rounds:?}");
    assert!(rounds.iter().any(|round| *round != rounds[0]), "{rounds:?}");
    assert_eq!(run(3), (0, Vec::new()));
    assert_eq!(run(4).1.len(), 4);
    let record = store.record(&program(&text).steps[0].id).unwrap();
    assert_eq!(record.timings.len(), 4);
    assert!(record.timings.iter().all(|timing| timing.parts.contains_key("base")));
    let row = &table(folder.path())[0];
    let least = record.timings.iter().map(|timing| timing.seconds).fold(f64::INFINITY, f64::min);
    assert_eq!(row["peak_bytes"].is_empty(), record.timings[0].peak_bytes.is_none());
    let mut reader = csv::Reader::from_path(folder.path().join("results.csv")).unwrap();
    let row: BTreeMap<String, String> = reader.deserialize().next().unwrap().unwrap();
    assert_eq!(row["seconds_min"].parse::<f64>().unwrap(), least);
    assert!(folder.path().join("outputs/1-x.txt").is_file());
}

#[test]
fn a_missed_target_is_a_column_and_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = run_in(folder.path(), &MAP.replace("[1, 2, 99, 4]", "[1, 98, 4]"));
    assert_eq!((outcome.failed, outcome.missed), (0, 2));
    let rows = table(folder.path());
    assert_eq!((rows[0]["missed"].as_str(), rows[0]["warnings"].as_str()), ("", "0"));
    assert_eq!(rows[2]["missed"], "add: 98 of 100 parts");
    assert_eq!((rows[2]["warnings"].as_str(), rows[2]["status"].as_str()), ("1", "done"));
    let lines = std::fs::read_to_string(folder.path().join("results.jsonl")).unwrap();
    let third: serde_json::Value = serde_json::from_str(lines.lines().nth(2).unwrap()).unwrap();
    assert_eq!(third["missed"][0]["target"]["reached"], 98.0);
    let summary = std::fs::read_to_string(folder.path().join("summary.md")).unwrap();
    assert!(summary.contains("2 of 6 steps did not reach their target."), "{summary}");
}

#[test]
fn a_step_over_its_time_is_a_row() {
    let folder = tempfile::tempdir().unwrap();
    let text = MAP
        .replace("[1, 2, 99, 4]", "[1, -1]")
        .replace(r#""programs": {"p": {"#, r#""programs": {"p": {"time_limit": 0.05, "#);
    let outcome = run_in(folder.path(), &text);
    assert_eq!((outcome.ran, outcome.failed), (4, 2));
    let rows = table(folder.path());
    assert_eq!(rows[2]["status"], "timed out");
    assert_eq!(rows[2]["reason"], "add: not done within the time limit of 0.05 s");
}

#[test]
fn repeats_are_rows() {
    let folder = tempfile::tempdir().unwrap();
    let text = MAP
        .replace("{add.amount}-", "{add.amount}-{repeat}-")
        .replace(r#""programs": {"p": {"#, r#""programs": {"p": {"repeats": 2, "#);
    run_in(folder.path(), &text);
    let rows = table(folder.path());
    assert_eq!(rows.len(), 16);
    assert_eq!((rows[0]["repeat"].as_str(), rows[1]["repeat"].as_str()), ("0", "1"));
}

#[test]
fn steps_that_write_one_file_are_refused() {
    let map = Map::parse(&MAP.replace("{add.amount}-{echo.say}", "{echo.say}")).unwrap();
    let problems = Program::new(&map, "p", &registry(), Path::new("/")).err().unwrap();
    let text = problems[0].to_string();
    assert!(text.contains("two steps write \"x.txt\""), "{problems:?}");
    // What differs, and nothing else.
    assert!(text.contains("Put {add.amount} into the name"), "{problems:?}");
}

#[test]
fn values_of_one_word_are_told_apart_by_the_step() {
    let map = Map::parse(&MAP.replace(r#"["x", "y"]"#, r#"["x/y", "x:y"]"#)).unwrap();
    let problems = Program::new(&map, "p", &registry(), Path::new("/")).err().unwrap();
    let text = problems[0].to_string();
    assert!(text.ends_with("Put {step} into the name"), "{problems:?}");
}

#[test]
fn problems_of_steps_name_the_step() {
    let map = Map::parse(&MAP.replace("[1, 2, 99, 4]", "[1, 1000]")).unwrap();
    let problems = Program::new(&map, "p", &registry(), Path::new("/")).err().unwrap();
    let text = problems[0].to_string();
    assert!(text.starts_with("program \"p\": add.amount: 1000 is not a number"), "{text}");
    assert!(text.contains("(with add.amount = 1000, echo.say = \"x\")"), "{text}");
    assert_eq!(problems.len(), 1);
}

#[test]
fn a_folder_with_other_things_is_not_taken() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("thesis.tex"), "").unwrap();
    assert!(matches!(Store::open(folder.path()), Err(StoreError::NotAStore(_))));
}

#[test]
fn looking_at_a_store_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing");
    assert!(Store::look(&missing).unwrap().is_none() && !missing.exists());
    assert!(Store::look(folder.path()).unwrap().is_some());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    run_in(&missing, MAP);
    let (program, store) = (program(MAP), Store::look(&missing).unwrap().unwrap());
    assert!(program.record(&store, 0).is_some());
    let (header, rows) = program.brief_table(&store);
    // base.sum is the same in every step, and echo.text the same as echo.say.
    assert_eq!(header, ["add.amount", "echo.say", "add.sum", "seconds", "status"]);
    assert_eq!((rows.len(), rows[7][2].as_str()), (8, "5"));
    assert!(matches!(Store::look(folder.path()), Err(StoreError::NotAStore(_))));
}

#[test]
fn a_time_limit_given_by_hand_counts() {
    let folder = tempfile::tempdir().unwrap();
    let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
    let text = MAP.replace("[1, 2, 99, 4]", "[-1]");
    let limit = Some(Duration::from_millis(20));
    let options = ProgramOptions { time_limit: limit, ..options(&cancel) };
    assert_eq!(run_program(&program(&text), &store, &options).unwrap().failed, 2);
}

/// Puts the count of attempts beside a step that processes leave when they end over it.
fn crash(folder: &Path, id: &str, attempts: u32) {
    let path = folder.join("claims").join(format!("{id}.attempts"));
    std::fs::write(path, attempts.to_string()).unwrap();
}

#[test]
fn a_step_that_took_two_processes_along_is_a_row_and_the_others_run() {
    let folder = tempfile::tempdir().unwrap();
    let (program, cancel) = (program(MAP), CancelToken::new());
    let store = Store::open(folder.path()).unwrap();
    crash(folder.path(), &program.steps[0].id, 1);
    crash(folder.path(), &program.steps[1].id, 2);
    let running = AtomicUsize::new(0);
    let together = AtomicUsize::new(0);
    let observer = |event: &ProgramEvent| match event {
        ProgramEvent::StepStarted { place, .. } => {
            let n = running.fetch_add(1, Ordering::SeqCst);
            if *place < 2 {
                together.fetch_max(n, Ordering::SeqCst);
            }
        }
        ProgramEvent::StepEnded { .. } => {
            running.fetch_sub(1, Ordering::SeqCst);
        }
        _ => {}
    };
    let options = ProgramOptions { observer: &observer, ..options(&cancel) };
    let outcome = run_program(&program, &store, &options).unwrap();
    assert_eq!((outcome.ran, outcome.failed, outcome.missing), (8, 3, 0));
    assert_eq!(together.into_inner(), 0, "a suspect runs alone");
    let rows = table(folder.path());
    assert_eq!((&*rows[0]["status"], &*rows[1]["status"]), ("done", "crashed"));
    assert!(rows[1]["reason"].starts_with("2 processes ended while they ran this step"));
    assert_eq!(
        std::fs::read_dir(folder.path().join("claims")).unwrap().count(),
        1,
        "of the tables"
    );
    // Whoever asks for it tries it again, with a clean record.
    let retry = ProgramOptions { retry: Retry::Failed, ..self::options(&cancel) };
    let outcome = run_program(&program, &store, &retry).unwrap();
    assert_eq!((outcome.ran, outcome.failed), (3, 2));
}

#[test]
fn what_failed_for_want_of_a_file_is_tried_again_and_other_failures_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let text = MAP
        .replace("[1, 2, 99, 4]", "[1, 99]")
        .replace("{add.amount}-{echo.say}.txt", "{echo.say}/{add.amount}.txt");
    // A name that no file system takes.
    let long = "l".repeat(300);
    let text = text.replace(r#"["x", "y"]"#, &format!(r#"["x", "{long}"]"#));
    let outcome = run_in(folder.path(), &text);
    assert_eq!((outcome.ran, outcome.failed), (4, 3));
    let again = run_in(folder.path(), &text);
    assert_eq!((again.ran, again.found, again.failed), (2, 2, 3));
}

#[test]
fn a_record_that_was_changed_by_hand_is_not_believed() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), MAP);
    let before = table(folder.path());
    let steps: Vec<_> = std::fs::read_dir(folder.path().join("steps")).unwrap().collect();
    let record = steps[0].as_ref().unwrap().path().join("record.json");
    let text = std::fs::read_to_string(&record).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["checksum"].as_str().unwrap().len(), 64);
    std::fs::write(&record, text.replace("\"repeat\": 0", "\"repeat\": 1")).unwrap();
    let outcome = run_in(folder.path(), MAP);
    assert_eq!((outcome.damaged, outcome.ran, outcome.found), (1, 1, 7));
    assert_eq!(table(folder.path()), before);
}

#[test]
fn outputs_of_earlier_plans_leave_the_folder_and_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    run_in(folder.path(), MAP);
    assert!(folder.path().join("outputs/4-x.txt").exists());
    run_in(folder.path(), &MAP.replace("[1, 2, 99, 4]", "[1, 2]"));
    let left: Vec<_> = std::fs::read_dir(folder.path().join("outputs")).unwrap().collect();
    assert_eq!(left.len(), 4);
    let store = Store::open(folder.path()).unwrap();
    let unneeded = store.unneeded().unwrap();
    assert_eq!((unneeded.steps.len(), unneeded.outputs.len()), (4, 0));
    unneeded.steps.iter().for_each(|path| store.remove(path).unwrap());
    assert_eq!(store.unneeded().unwrap(), mve_core::Unneeded::default());
    assert_eq!(run_in(folder.path(), MAP).ran, 4);
}

#[test]
fn a_setting_for_one_call_is_a_column_beside_those_of_others() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let run = |amount: u32| {
        let text = MAP.replace("\"amount\": 1", &format!("\"amount\": {amount}"));
        let mut program = program(&text);
        program.set_apart(&[("base.amount".to_owned(), amount.into())], Some(&store));
        run_program(&program, &store, &options(&CancelToken::new())).unwrap()
    };
    assert_eq!(run(1).steps, 8);
    let outcome = run(5);
    assert_eq!((outcome.steps, outcome.ran, outcome.found), (16, 8, 8));
    let rows = table(folder.path());
    assert_eq!((&*rows[0]["base.amount"], &*rows[15]["base.amount"]), ("1", "5"));
    assert_eq!(run(5).steps, 16);
}

#[test]
fn a_part_is_of_steps_that_set_a_parameter_so() {
    let folder = tempfile::tempdir().unwrap();
    let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
    let only = vec![("echo.say".to_owned(), "x".into())];
    let part = Part { only, shard: Shard { index: 0, count: 2 } };
    let options = ProgramOptions { part, ..options(&cancel) };
    let outcome = run_program(&program(MAP), &store, &options).unwrap();
    assert_eq!((outcome.ran, outcome.missing, outcome.missing_of_part), (2, 6, 0));
    assert!(table(folder.path()).iter().all(|row| row["echo.say"] == "x"));
}

#[test]
fn who_waits_ends_when_others_have_done_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    let text = MAP.replace("[1, 2, 99, 4]", &format!("{:?}", (0..40).collect::<Vec<_>>()));
    let outcomes = std::thread::scope(|scope| {
        let process = || {
            let store = Store::open(folder.path()).unwrap();
            let cancel = CancelToken::new();
            let options = ProgramOptions { patience: Patience::Wait, ..options(&cancel) };
            run_program(&program(&text), &store, &options).unwrap()
        };
        let both = [scope.spawn(process), scope.spawn(process)];
        both.map(|handle| handle.join().unwrap())
    });
    assert_eq!(outcomes.iter().map(|outcome| outcome.ran).sum::<usize>(), 80);
    assert!(outcomes.iter().all(|outcome| outcome.missing == 0), "{outcomes:?}");
}

#[test]
fn events_say_what_there_is_to_do_and_what_was_found() {
    let folder = tempfile::tempdir().unwrap();
    let lines = || {
        let (store, cancel) = (Store::open(folder.path()).unwrap(), CancelToken::new());
        let lines = std::sync::Mutex::new(Vec::new());
        let observer = |event: &ProgramEvent| {
            lines.lock().unwrap().push(serde_json::to_value(event).unwrap());
        };
        let options = ProgramOptions { observer: &observer, ..options(&cancel) };
        run_program(&program(MAP), &store, &options).unwrap();
        lines.into_inner().unwrap()
    };
    let first = lines();
    let began = serde_json::json!({"event": "began", "steps": 8, "found": 0});
    assert_eq!(first[0], began);
    let ended = first.iter().find(|line| line["event"] == "ended").unwrap();
    assert!(ended["place"].is_u64() && ended["node"].is_string(), "as of a run: {ended}");
    let again = lines();
    assert_eq!(again.len(), 9);
    assert!(again[1..].iter().all(|line| line["event"] == "step_found"));
}
