//! Every map that ships runs, alone and with its programs, and gives what it gave before.
//!
//! What it gave stands in `ref/`, numbers to six digits; they are compared to 1e-4 of their size
//! or 1e-9, which is far above rounding and far below any change of an algorithm. `UPDATE=1`
//! rewrites the references: read the difference before you commit it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use mve_core::testing::{plan_options, program_options, run_options};
use mve_core::{
    CancelToken, FileHashes, Map, Part, Plan, PlanOptions, Program, ProgramOptions, RunOptions,
    Scalar, Shard, Store, assign, run, run_program,
};
use mve_modules::registry;
use mve_tests::{maps, root};

#[test]
fn every_map_gives_what_it_gave() {
    let maps = maps();
    assert!(maps.len() >= 4, "maps are missing");
    for path in maps {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let reference = root().join(format!("tests/ref/{name}.txt"));
        let found = summary(&path);
        if std::env::var_os("UPDATE").is_some() {
            std::fs::write(&reference, &found).unwrap();
        }
        let expected = std::fs::read_to_string(&reference)
            .unwrap_or_else(|_| panic!("no reference for {name}; make it with UPDATE=1"));
        compare(&name, &expected, &found);
    }
}

#[test]
fn saving_a_map_changes_no_byte() {
    for path in maps() {
        let text = std::fs::read_to_string(&path).unwrap();
        let mut map = Map::parse(&text).unwrap();
        assert_eq!(map.problems(), [], "{}", path.display());
        assert_eq!(map.to_text(), text, "{}", path.display());
        // Changed and changed back, the text is made anew, and still the same: it is canonical.
        let title = std::mem::replace(&mut map.title, "another".to_owned());
        let other = map.to_text();
        let mut map = Map::parse(&other).unwrap();
        map.title = title;
        if std::env::var_os("UPDATE").is_some() {
            std::fs::write(&path, map.to_text()).unwrap();
            continue;
        }
        assert_eq!(map.to_text(), text, "{}", path.display());
    }
}

#[test]
fn steps_are_planned_together_as_they_are_alone() {
    let registry = registry();
    for path in maps() {
        let map = Map::load(&path).unwrap();
        let (folder, files) = (path.parent().unwrap(), FileHashes::new());
        for name in map.programs.keys() {
            let registry = registry.with_maps_of(&map, folder);
            let program = Program::new(&map, name, &registry, folder).unwrap();
            for step in &program.steps {
                let mut alone = map.clone();
                // As a program sets them: what brings other parameters along comes first.
                let mut params: Vec<_> = step.params.iter().collect();
                params.sort_by_key(|(path, _)| {
                    (!path.ends_with(".module"), path.matches('.').count())
                });
                for (path, value) in params {
                    assign(&mut alone, &registry, path, value.clone()).unwrap();
                }
                let options = PlanOptions { repeat: step.repeat, ..plan_options(folder, &files) };
                let plan = Plan::new(&alone, &registry, &options).unwrap();
                assert_eq!(plan.id.short(), step.id, "{} {name} {step:?}", path.display());
            }
        }
    }
}

/// Maps whose programs take minutes: these are planned only.
const LONG: [&str; 1] = ["image_driven.json"];

/// Programs on a large model: of these every n-th step runs. No value may be left out.
const EVERY_NTH: [(&str, usize); 2] = [("clustering.json", 7), ("fit.json", 5)];

/// Scalars and values of a run of the map, and of all steps of its programs.
fn summary(path: &Path) -> String {
    let folder = tempfile::tempdir().unwrap();
    let map = Map::load(path).unwrap();
    let home = path.parent().unwrap();
    let mut text = String::new();
    let files = FileHashes::new();
    let options = PlanOptions { output_folder: Some(folder.path()), ..plan_options(home, &files) };
    let plan = Plan::new(&map, &registry(), &options).unwrap_or_else(|p| panic!("{p:?}"));
    let cancel = CancelToken::new();
    let options = RunOptions { threads: 2, ..run_options(folder.path(), &cancel) };
    let outcome = run(&plan, &options);
    assert!(outcome.is_done(), "{}: {:?}", path.display(), outcome.failures().collect::<Vec<_>>());
    text.push_str("run\n");
    for (name, node) in &outcome.nodes {
        write_record(&mut text, name, &node.record);
        assert!(node.record.files.iter().all(|file| folder.path().join(file).is_file()));
    }
    for name in map.programs.keys() {
        let program =
            Program::new(&map, name, &registry(), home).unwrap_or_else(|p| panic!("{p:?}"));
        if path.file_name().is_some_and(|file| LONG.iter().any(|long| file == *long)) {
            continue;
        }
        let store = Store::open(&folder.path().join(format!("program-{name}"))).unwrap();
        let part = |(file, n): &(&str, usize)| path.ends_with(file).then_some(*n);
        let n = EVERY_NTH.iter().find_map(part).unwrap_or(1);
        let part = Part { shard: Shard { index: 0, count: n }, ..Part::default() };
        let options = ProgramOptions { jobs: 2, threads: 2, part, ..program_options(&cancel) };
        let outcome = run_program(&program, &store, &options).unwrap();
        let steps: Vec<_> = program.steps.iter().enumerate().step_by(n).collect();
        assert_eq!((outcome.ran, outcome.failed), (steps.len(), 0), "{}", path.display());
        let run: Vec<_> = steps.iter().flat_map(|(_, step)| &step.params).collect();
        let mut all = program.steps.iter().flat_map(|step| &step.params);
        assert!(all.all(|value| run.contains(&value)), "{}: a value never runs", path.display());
        for (place, step) in steps {
            let params: Vec<_> = step.params.iter().map(|(p, v)| format!("{p}={v}")).collect();
            let _ = writeln!(text, "program {name}: {}", params.join(" "));
            for (name, node) in &program.record(&store, place).unwrap().nodes {
                write_record(&mut text, name, node);
            }
        }
    }
    text
}

/// One line a node; values of a mesh are its counts.
fn write_record(text: &mut String, name: &str, record: &mve_core::NodeRecord) {
    let cells = record.scalars.iter().map(|(name, scalar)| match scalar {
        // How often something was tried may change with every tuning, and says nothing.
        Scalar::Number(number) if !name.starts_with("rejected") => format!("{name}={number:.6e}"),
        Scalar::Number(_) => format!("{name}=…"),
        other => format!("{name}={other}"),
    });
    let meshes = record.values.iter().filter(|(_, value)| value.contains("faces"));
    let meshes = meshes.map(|(name, value)| format!("{name}: {value}"));
    let warnings = record.log.iter().filter(|line| line.is_warning).map(|line| line.text.clone());
    let all: Vec<_> = cells.chain(meshes).chain(warnings).collect();
    if !all.is_empty() {
        let _ = writeln!(text, "  {name}: {}", all.join(", "));
    }
}

/// Compares word by word, numbers within the tolerance.
fn compare(name: &str, expected: &str, found: &str) {
    let lines = |text: &str| -> BTreeMap<usize, String> {
        text.lines().map(str::to_owned).enumerate().collect()
    };
    let (expected, found) = (lines(expected), lines(found));
    assert_eq!(expected.len(), found.len(), "{name}: lines; UPDATE=1 shows the difference");
    for (place, line) in &expected {
        let words = |line: &str| -> Vec<String> {
            line.split([' ', '=', ',']).map(str::to_owned).collect()
        };
        let (old, new) = (words(line), words(&found[place]));
        let is_same = old.len() == new.len() && old.iter().zip(&new).all(|(a, b)| agree(a, b));
        assert!(is_same, "{name}, line {}:\n{line}\n{}", place + 1, found[place]);
    }
}

fn agree(old: &str, new: &str) -> bool {
    match (old.parse::<f64>(), new.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= (1e-4 * a.abs()).max(1e-9) || (a.is_nan() && b.is_nan()),
        _ => old == new,
    }
}
