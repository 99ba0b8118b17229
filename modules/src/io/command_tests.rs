//! Command with the small programs that every Unix has.

use std::time::{Duration, Instant};

use mve_core::testing::{Outputs, Trial};
use mve_core::{CancelToken, ModuleError};
use mve_mesh::data::{Measures, TriMesh};
use mve_mesh::fixtures::tetrahedron;
use serde_json::{Value as Json, json};

use super::MODULE;

fn trial(command: Json) -> Trial {
    Trial::of(&MODULE).input("mesh", tetrahedron()).set("command", command)
}

fn message(trial: Trial) -> String {
    trial.run().unwrap_err().to_string()
}

fn mesh(outputs: &Outputs) -> TriMesh {
    outputs["mesh"].clone().take().unwrap()
}

#[test]
fn a_mesh_goes_through_a_program_and_back_in_every_format() {
    for ending in ["", ":ply", ":obj", ":off", ":iv"] {
        let [from, to] = ["in", "out"].map(|way| format!("{{{way}.mesh{ending}}}"));
        let outputs = trial(json!(["cp", from, to])).run().unwrap();
        assert_eq!(mesh(&outputs), tetrahedron(), "{ending}");
    }
    for ending in ["stl", "glb"] {
        let command = format!("cp {{in.mesh:{ending}}} {{out.mesh:{ending}}}");
        let outputs = trial(json!(command)).run().unwrap();
        assert_eq!((mesh(&outputs).faces.len(), mesh(&outputs).area()), (4, tetrahedron().area()));
    }
    // What a format does not hold is said.
    let mut far = tetrahedron();
    far.positions.iter_mut().for_each(|p| p.x += 1e6);
    let trial = Trial::of(&MODULE).input("mesh", far);
    let log = trial.set("command", json!("cp {in.mesh:stl} {out.mesh:stl}")).log().unwrap();
    assert!(log[0].contains("{in.mesh:stl}: STL has floats"), "{log:?}");
}

#[test]
fn without_a_place_for_it_the_mesh_passes_through() {
    assert_eq!(mesh(&trial(json!(["true"])).run().unwrap()), tetrahedron());
    let alone = Trial::of(&MODULE).set("command", json!(["true"])).run().unwrap();
    assert_eq!(mesh(&alone), TriMesh::default());
}

#[test]
fn numbers_become_measures() {
    let command = json!(["printf", "rms  = 0.25\nmax = 1e-3 of 7\n"]);
    let trial = trial(command).set("patterns", "rms = {rms}; max = {max} of {n}");
    let outputs = trial.run().unwrap();
    let measures = outputs["measures"].get::<Measures>().unwrap();
    let found: Vec<_> = measures.0.iter().map(|m| (&*m.name, m.value)).collect();
    assert_eq!(found, [("rms", 0.25), ("max", 1e-3), ("n", 7.0)]);
    // The second input, as a file whose bytes are counted: 84 bytes and 50 a face.
    let trial = Trial::of(&MODULE).input("other", tetrahedron());
    let trial = trial.set("command", json!(["wc", "-c", "{in.other:stl}"]));
    let outputs = trial.set("patterns", "{bytes} /").run().unwrap();
    assert_eq!(outputs["measures"].get::<Measures>().unwrap().0[0].value, 284.0);
}

#[test]
fn each_bad_end_is_told_with_what_the_program_said() {
    let code = message(trial(json!(["ls", "/no-such-folder"])));
    assert!(code.contains("exit code ") && code.contains("No such file"), "{code}");
    let silent = message(trial(json!(["false"])));
    assert_eq!(silent, "the program ended with exit code 1; it said nothing");
    assert!(trial(json!(["false"])).set("any_exit_code", true).run().is_ok());
    let none = message(trial(json!(["echo", "nothing", "{out.mesh:obj}"])));
    assert!(none.contains("wrote no file {out.mesh:obj}") && none.contains("nothing /"), "{none}");
    let wrong = message(trial(json!(["cp", "/bin/ls", "{out.mesh:ply}"])));
    assert!(wrong.starts_with("what the program wrote as {out.mesh:ply}: "), "{wrong}");
    assert!(!wrong.contains("mve-command-"), "{wrong}");
    assert!(trial(json!("cp {in.mesh:off} {out.mesh:ply}")).run().is_err());
    let pattern = message(trial(json!(["echo", "min 3"])).set("patterns", "max {max}"));
    assert!(pattern.contains("fits \"max {max}\"") && pattern.contains("min 3"), "{pattern}");
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("no-program");
    std::fs::write(&text, "no program").unwrap();
    let started = message(trial(json!([text])));
    assert!(started.contains("cannot be started") && started.contains("no-program"), "{started}");
    let unlinked = Trial::of(&MODULE).set("command", json!("cat {in.other}"));
    let unlinked = message(unlinked);
    assert!(unlinked.starts_with("input \"other\": nothing is linked here"), "{unlinked}");
}

#[test]
fn a_program_that_hangs_ends_at_its_limit_or_when_it_is_stopped() {
    let start = Instant::now();
    let late = message(trial(json!(["sleep", "600"])).set("time_limit", 0.2));
    assert!(late.contains("did not end within 0.2 seconds"), "{late}");
    let cancel = CancelToken::new().child(Some(Instant::now() + Duration::from_millis(200)));
    let stopped = trial(json!(["sleep", "600"])).run_until(&cancel);
    assert!(matches!(stopped, Err(ModuleError::Cancelled)));
    assert!(start.elapsed() < Duration::from_secs(60));
}

#[test]
fn the_log_is_bounded_and_steers_no_terminal() {
    let log = trial(json!(["seq", "1", "100000"])).log().unwrap();
    assert_eq!((log.len(), log[0].as_str(), log[100].as_str()), (102, "1", "100000"));
    assert_eq!(log[50], "… 99900 lines are left out …");
    assert_eq!(log[101], "exit code 0");
    let log = trial(json!(["printf", "\\033[31mred\\a\\n%01000d", "7"])).log().unwrap();
    assert_eq!(log[0], "\\u{1b}[31mred\\u{7}");
    assert_eq!(log[1].chars().count(), 501);
    // Larger than what is kept of it.
    let log = trial(json!(["head", "-c", "5000000", "/dev/zero"])).log().unwrap();
    assert!(log.iter().any(|line| line.contains("bytes are left out")), "{log:?}");
}

#[test]
fn the_folder_of_a_program_is_gone_when_it_has_ended() {
    let log = trial(json!(["pwd"])).log().unwrap();
    assert!(log[0].contains("mve-command-"), "{log:?}");
    assert!(!std::path::Path::new(&log[0]).exists());
}
