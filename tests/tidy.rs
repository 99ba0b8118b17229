//! The house style, as far as a program can see it.

use std::path::{Path, PathBuf};
use std::process::Command;

use mve_core::describe_all;
use mve_modules::registry;
use mve_tests::root;

mod graph;
mod hashes;
mod layers;
#[path = "../modules/sources/mod.rs"]
mod sources;
mod width;

/// Longest file, in lines.
const LONGEST: usize = 500;

fn files(extension: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for folder in ["app", "core", "docs", "formats", "mesh", "modules", "tests"] {
        collect(&root().join(folder), extension, &mut files);
    }
    for entry in std::fs::read_dir(root()).unwrap().flatten() {
        if entry.path().extension().is_some_and(|e| e == extension) {
            files.push(entry.path());
        }
    }
    files
}

fn collect(folder: &Path, extension: &str, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() && entry.file_name() != "target" {
            collect(&path, extension, files);
        } else if path.extension().is_some_and(|e| e == extension) {
            files.push(path);
        }
    }
}

#[test]
fn files_begin_with_what_they_are_and_end_in_time() {
    for path in files("rs") {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("//! "), "{}: no header", path.display());
        let n_lines = text.lines().count();
        assert!(n_lines <= LONGEST, "{}: {n_lines} lines; split it", path.display());
    }
}

/// `cargo fmt` does not see files that are declared inside a macro, as modules and entries are.
#[test]
fn every_file_is_formatted() {
    let output = Command::new("rustfmt")
        .args(["--check", "--edition", "2024", "--config-path"])
        .arg(root())
        .args(files("rs"))
        .output()
        .expect("rustfmt is installed: rustup component add rustfmt");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "run rustfmt on these files:\n{text}");
}

#[test]
fn lists_of_modules_are_sorted() {
    for path in files("rs").iter().filter(|path| path.ends_with("mod.rs")) {
        let text = std::fs::read_to_string(path).unwrap();
        for list in text.split("! {").skip(1).filter_map(list_of) {
            let names: Vec<_> = list.split(',').map(str::trim).filter(|n| !n.is_empty()).collect();
            assert!(names.is_sorted(), "{}: {names:?}", path.display());
        }
    }
}

/// The names in what follows `modules! {` or `registered! {`.
fn list_of(text: &str) -> Option<&str> {
    let (list, _) = text.split_once('}')?;
    let behind_category = list.trim().starts_with('"').then(|| list.split_once(':')).flatten();
    let behind_item = list.contains("static ").then(|| list.split_once(" in ")).flatten();
    let (_, names) = behind_category.or(behind_item)?;
    Some(names.trim_end().trim_end_matches(';'))
}

#[test]
fn the_documentation_of_modules_is_fresh() {
    let path = root().join("docs/modules.md");
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(text == describe_all(&registry()), "run: mve modules --write docs/modules.md");
}

/// Words in back quotes that look like paths of the repository must be there.
#[test]
fn paths_named_in_documents_exist() {
    for path in files("md").iter().filter(|path| !path.ends_with("docs/modules.md")) {
        let text = std::fs::read_to_string(path).unwrap();
        for word in text.split('`').skip(1).step_by(2) {
            let folders = [
                "app/", "core/", "docs/", "formats/", "maps/", "mesh/", "modules/", "tests/",
                ".ci/",
            ];
            let is_path = folders.iter().any(|folder| word.starts_with(folder))
                && !word.contains([' ', '<', '*', '{', '…', '\n'])
                && !word.contains("my_");
            assert!(!is_path || root().join(word).exists(), "{}: {word}", path.display());
        }
    }
}

#[test]
fn the_runtime_knows_no_mesh_and_code_neither_prints_nor_panics() {
    let never = ["println!", ".unwrap()", "panic!("];
    for (folder, foreign) in [
        ("core/src", ["mve_modules", "mve_mesh", "glam"].as_slice()),
        ("mesh/src", &[]),
        ("formats/src", &[]),
        ("modules/src", &[]),
    ] {
        let graph = graph::Graph::of(folder);
        assert!(graph.files.len() > 10);
        for file in &graph.files {
            let code: String = graph.tokens(file).iter().map(|token| token.text).collect();
            for bad in never.iter().chain(foreign) {
                assert!(!code.contains(bad), "{folder}/{file}: {bad}");
            }
        }
    }
}
