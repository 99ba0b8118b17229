//! Runs of small maps, waited for as the window waits for them.

use std::time::{Duration, Instant};

use super::*;

const MAP: &str = r#"{ "mve": 1,
    "nodes": {
        "box": { "module": "Box" },
        "info": { "module": "MeshInfo" },
        "load": { "module": "ObjLoader", "params": { "path": "no-such-file.obj" } },
        "normals": { "module": "NormalComputer" } },
    "links": ["box.mesh -> info.mesh", "load.mesh -> normals.mesh"] }"#;

fn shared() -> Arc<Shared> {
    let folder = std::env::temp_dir().join("mve-editor-runner");
    Shared::new(mve_modules::registry(), 1 << 26, Box::new(|| {}), Some(folder))
}

fn subject(text: &str, revision: u64) -> Subject {
    let map = Arc::new(Map::parse(text).expect("is a map"));
    let registry = mve_modules::registry();
    let (folder, allowed) = (PathBuf::new(), Arc::default());
    Subject { map, revision, folder, registry, allowed, asks: true }
}

fn wait(runner: &mut Runner, is_there: impl Fn(&Runner) -> bool) {
    let start = Instant::now();
    loop {
        runner.take_in();
        if is_there(runner) {
            return;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "it does not come");
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn what_can_run_runs_and_the_rest_says_why_not() {
    let mut runner = Runner::new(&shared());
    runner.run(subject(MAP, 1), Part::All);
    assert!(runner.is_running());
    wait(&mut runner, |runner| !runner.is_running());
    assert!(matches!(runner.status("box"), Status::Done(Some(_))));
    assert!(matches!(runner.status("info"), Status::Done(_)));
    assert!(runner.value("box", "mesh").is_some());
    let Status::Refused(why) = runner.status("load") else { panic!("it has no file") };
    assert!(why.contains("no-such-file.obj"), "{why}");
    let Status::Refused(why) = runner.status("normals") else { panic!("it has no mesh") };
    assert_eq!(why, "needs load, which cannot run");
}

#[test]
fn a_change_makes_old_what_hangs_on_it_and_undoing_it_makes_it_new_again() {
    let mut runner = Runner::new(&shared());
    runner.run(subject(MAP, 1), Part::All);
    wait(&mut runner, |runner| !runner.is_running());
    let changed =
        MAP.replace(r#""module": "Box""#, r#""module": "Box", "params": { "segments": 4 }"#);
    runner.check(subject(&changed, 2));
    wait(&mut runner, |runner| runner.checked().revision == 2);
    assert_eq!(runner.status("box"), Status::Dirty);
    assert_eq!(runner.status("info"), Status::Dirty);
    runner.check(subject(MAP, 3));
    wait(&mut runner, |runner| runner.checked().revision == 3);
    assert!(matches!(runner.status("info"), Status::Done(_)));
}

#[test]
fn up_to_here_runs_only_what_is_needed() {
    let mut runner = Runner::new(&shared());
    runner.run(subject(MAP, 1), Part::UpTo(vec!["box".to_owned()]));
    wait(&mut runner, |runner| !runner.is_running());
    assert!(matches!(runner.status("box"), Status::Done(_)));
    assert_eq!(runner.status("info"), Status::New);
}

#[test]
fn a_run_that_is_stopped_ends_soon_and_a_new_one_takes_its_place() {
    let text = r#"{ "mve": 1, "nodes": {
        "vase": { "module": "Vase" },
        "simplify": { "module": "Simplificator",
            "params": { "cost": "ImageSsim", "target_faces": 100 } } },
        "links": ["vase.mesh -> simplify.mesh"] }"#;
    let mut runner = Runner::new(&shared());
    runner.run(subject(text, 1), Part::All);
    wait(&mut runner, |runner| matches!(runner.status("simplify"), Status::Running(_)));
    let progress = runner.progress().expect("it runs");
    assert_eq!(progress.working.map(|(node, _)| node).as_deref(), Some("simplify"));
    assert_eq!((progress.n_ended, progress.n_nodes), (1, 2));
    let start = Instant::now();
    runner.stop();
    wait(&mut runner, |runner| !runner.is_running());
    assert!(start.elapsed() < Duration::from_secs(5));
    assert_eq!(runner.status("simplify"), Status::Stopped);
    runner.run(subject(MAP, 2), Part::All);
    wait(&mut runner, |runner| !runner.is_running());
    assert!(matches!(runner.status("info"), Status::Done(_)));
}

#[test]
fn what_was_removed_is_known_again_when_it_comes_back() {
    let mut runner = Runner::new(&shared());
    runner.run(subject(MAP, 1), Part::All);
    wait(&mut runner, |runner| !runner.is_running());
    let said: Vec<&str> = runner.log.lines().map(|line| line.text.as_str()).collect();
    assert!(said.last().is_some_and(|text| text.starts_with("ran 2 nodes in ")), "{said:?}");
    runner.forget_all_but(&Map::default());
    runner.forget_all_but(&subject(MAP, 2).map);
    assert!(runner.value("box", "mesh").is_some());
    // Of one name, but another module.
    runner.forget_all_but(&subject(&MAP.replace("\"Box\"", "\"Vase\""), 3).map);
    assert!(runner.value("box", "mesh").is_none());
}

#[test]
fn what_needs_a_muted_node_is_off() {
    let map = |mode: &str| {
        let text = r#"{ "mve": 1, "nodes": { "box": { "module": "Box", "mode": "MODE" },
            "info": { "module": "MeshInfo" }, "vase": { "module": "Vase" } },
            "links": ["box.mesh -> info.mesh"] }"#;
        text.replace("MODE", mode)
    };
    let mut runner = Runner::new(&shared());
    runner.run(subject(&map("active"), 1), Part::All);
    wait(&mut runner, |runner| !runner.is_running());
    assert!(matches!(runner.status("info"), Status::Done(_)));
    runner.check(subject(&map("muted"), 2));
    wait(&mut runner, |runner| runner.checked().revision == 2);
    assert_eq!(runner.status("box"), Status::Off("is muted".to_owned()));
    let why = "is left out: needs box.mesh, which is muted".to_owned();
    assert_eq!(runner.status("info"), Status::Off(why));
    assert!(matches!(runner.status("vase"), Status::Done(_)));
}

#[cfg(unix)]
#[test]
fn outside_programs_run_only_when_they_were_seen() {
    let text = r#"{ "mve": 1, "nodes": { "box": { "module": "Box" },
        "call": { "module": "Command", "params": { "command": "true 'a b'" } },
        "info": { "module": "MeshInfo" } },
        "links": ["box.mesh -> call.mesh", "call.mesh -> info.mesh"] }"#;
    let mut runner = Runner::new(&shared());
    // Nobody has asked for this run, so nobody is asked.
    runner.run(subject(text, 1), Part::Quiet);
    wait(&mut runner, |runner| !runner.is_running());
    assert!(runner.take_question().is_none());
    assert!(matches!(runner.status("box"), Status::Done(_)));
    assert_eq!(runner.status("call"), Status::New);
    runner.run(subject(text, 1), Part::All);
    wait(&mut runner, |runner| !runner.is_running());
    let asked = BTreeSet::from([("call".to_owned(), "true 'a b'".to_owned())]);
    assert_eq!(runner.take_question(), Some((asked, Part::All)));
    assert_eq!(runner.take_question(), None);
    // The rest of it, without asking.
    runner.run(Subject { asks: false, ..subject(text, 1) }, Part::All);
    wait(&mut runner, |runner| !runner.is_running());
    assert!(runner.take_question().is_none() && runner.value("call", "mesh").is_none());
    let allowed = Arc::new(BTreeSet::from(["true 'a b'".to_owned()]));
    runner.run(Subject { allowed: Arc::clone(&allowed), ..subject(text, 1) }, Part::All);
    wait(&mut runner, |runner| !runner.is_running());
    assert!(matches!(runner.status("info"), Status::Done(_)));
    // Another command is another question.
    let other = text.replace("'a b'", "c");
    runner.run(Subject { allowed, ..subject(&other, 2) }, Part::All);
    wait(&mut runner, |runner| !runner.is_running());
    assert!(runner.take_question().is_some());
}
