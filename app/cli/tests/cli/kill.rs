//! A program that is killed at random moments, over and over, ends with every step once, and with
//! the same meshes and the same table as one that ran undisturbed on one thread.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// How often the program is killed, at the least.
const KILLS: usize = 30;

/// 72 steps over real modules, some of a millisecond and some of many, a few of which fail.
const MAP: &str = r#"{"mve": 1, "title": "killed", "nodes": {
    "model": {"module": "Vase", "params": {"segments": 64, "profile_segments": 60}},
    "simplify": {"module": "Simplificator"},
    "compare": {"module": "MeshComparer", "params": {"metric": {"Hausdorff": {"samples": 20000}}}},
    "save": {"module": "ObjSaver",
        "params": {"path": "{simplify.cost}-{simplify.placement}-{simplify.ratio}.obj"}}},
  "links": ["model.mesh -> simplify.mesh", "model.mesh -> compare.original",
    "simplify.mesh -> compare.simplified", "simplify.mesh -> save.mesh"],
  "programs": {"p": {"axes": [
    {"simplify.cost": ["EdgeLength", "Quadric"]},
    {"simplify.placement": ["Endpoint", "Midpoint", "Optimal"]},
    {"simplify.ratio": [0.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.01]}]}}}"#;

fn program(map: &Path, out: &Path, threads: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mve"));
    command.arg("program").arg(map).arg("--out").arg(out);
    command.args(["--jobs", threads, "--threads", threads]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// The table without the columns that hold times.
fn table(out: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(out.join("results.csv")).unwrap();
    let rows = reader.deserialize::<BTreeMap<String, String>>().map(|row| {
        let mut row = row.unwrap();
        row.retain(|name, _| !name.starts_with("seconds"));
        row
    });
    rows.collect()
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    let content = |path| std::fs::read(path).unwrap();
    entries.map(|e| (e.file_name().into_string().unwrap(), content(e.path()))).collect()
}

#[test]
fn every_step_ends_up_once_in_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("map.json");
    std::fs::write(&map, MAP).unwrap();
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    let start = std::time::Instant::now();
    assert!(program(&map, &whole, "1").status().unwrap().success());
    let took = start.elapsed();

    // Moments that a fixed generator picks, up to a fifteenth of the time of a whole run, so that
    // the last kill comes well before the end. A run that was done nevertheless starts afresh.
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let (mut n_kills, mut n_begun) = (0, 0);
    while n_kills < KILLS {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let share = (state >> 40) as f64 / (1 << 24) as f64;
        let mut child = program(&map, &broken, "2").spawn().unwrap();
        std::thread::sleep(Duration::from_secs_f64(took.as_secs_f64() * share / 15.0));
        let is_done = child.try_wait().unwrap().is_some();
        child.kill().unwrap();
        child.wait().unwrap();
        if is_done {
            std::fs::remove_dir_all(&broken).unwrap();
            continue;
        }
        n_kills += 1;
        n_begun += usize::from(broken.join("steps").is_dir());
    }
    assert!(n_begun > 0, "no kill came after the start of the program");
    // Of a step that was killed twice while it ran alone nobody knows that it was not its fault.
    let last = program(&map, &broken, "2").arg("--retry-failed").status();
    assert!(last.unwrap().success());

    let (expected, found) = (table(&whole), table(&broken));
    assert_eq!(expected.len(), 72);
    assert_eq!(found.len(), 72);
    for (found, expected) in found.iter().zip(&expected) {
        let differs = |name: &&String| found.get(*name) != expected.get(*name);
        let names: Vec<_> = expected.keys().chain(found.keys()).filter(differs).collect();
        assert!(names.is_empty(), "{}: {names:?}", expected["step"]);
    }
    assert_eq!(files(&broken.join("outputs")), files(&whole.join("outputs")));
    assert_eq!(std::fs::read_dir(broken.join("steps")).unwrap().count(), 72);
    assert_eq!(std::fs::read_dir(broken.join("work")).unwrap().count(), 0);
}
