//! What may name what, inside of the crates: layers, entries that stand alone, and no circles.

use std::collections::{BTreeMap, BTreeSet};

use mve_tests::root;

use super::graph::{Graph, module_of, paths};
use super::sources::tokens;

/// The parts of `modules/src`; each may name those before it.
const MODULES: [&str; 15] = [
    "data",
    "mesh",
    "prelude",
    "geometry",
    "picture",
    "formats",
    "image_driven",
    "cost",
    "placement",
    "metric",
    "io",
    "generate",
    "filters",
    "measure",
    "images",
];

/// Folders of modules: none names another one.
const LISTS: [&str; 5] = ["io", "generate", "filters", "measure", "images"];

/// The parts of `core/src`; each may name those before it.
const CORE: [&str; 26] = [
    "fingerprint",
    "machine",
    "json",
    "template",
    "cancel",
    "control",
    "error",
    "files",
    "stored",
    "data",
    "problem",
    "listed",
    "port",
    "param",
    "module",
    "panics",
    "node_outputs",
    "disk_cache",
    "cache",
    "registry",
    "describe",
    "schema",
    "map",
    "plan",
    "run",
    "program",
];

const FOLDERS: [&str; 2] = ["core/src", "modules/src"];

/// The folder or file right below `folder` that `file` belongs to.
fn part<'a>(file: &'a str, folder: &str) -> Option<&'a str> {
    let below = file.strip_prefix(folder)?;
    Some(below.split('/').next().unwrap_or(below).trim_end_matches(".rs"))
}

#[test]
fn crates_and_folders_name_only_what_is_below_them() {
    let mut wrong = Vec::new();
    for (folder, order) in [("core/src", CORE.as_slice()), ("modules/src", MODULES.as_slice())] {
        let graph = Graph::of(folder);
        let place_of = |file: &str| order.iter().position(|name| part(file, "") == Some(name));
        for file in graph.files.iter().filter(|file| *file != "lib.rs") {
            assert!(place_of(file).is_some(), "{folder}/{file}: give it a place in the order");
        }
        for edge in &graph.edges {
            let (from, to) = (place_of(&edge.from), place_of(&edge.to));
            let are_lists = folder == "modules/src"
                && from != to
                && [from, to].into_iter().flatten().all(|place| LISTS.contains(&order[place]));
            if edge.from != "lib.rs" && (to > from || are_lists) {
                wrong.push(format!("{folder}/{}:{} names {}", edge.from, edge.line, edge.to));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Between the files of a folder, and the folders in it. The file of the folder itself, which
/// declares them, may name all of them and be named by all.
#[test]
fn the_files_of_a_folder_name_each_other_in_no_circle() {
    let mut wrong = Vec::new();
    for folder in FOLDERS {
        let graph = Graph::of(folder);
        let inner = graph.files.iter().filter_map(|file| Some(file.rsplit_once('/')?.0));
        let inner: BTreeSet<String> = inner.map(|path| format!("{path}/")).collect();
        for below in inner.iter().map(String::as_str).chain([""]) {
            let mut names: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
            for edge in &graph.edges {
                let (from, to) = (part(&edge.from, below), part(&edge.to, below));
                if let (Some(from), Some(to)) = (from, to)
                    && from != to
                    && ![from, to].iter().any(|part| ["mod", "lib"].contains(part))
                {
                    names.entry(from).or_default().insert(to);
                }
            }
            let circle = circle(names);
            if !circle.is_empty() {
                wrong.push(format!("{folder}/{below}: {circle:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What is left when whatever names nothing else, or is named by nothing, is taken away.
fn circle<'a>(mut names: BTreeMap<&'a str, BTreeSet<&'a str>>) -> Vec<&'a str> {
    loop {
        let named: BTreeSet<&str> = names.values().flatten().copied().collect();
        let naming: BTreeSet<&str> = names.keys().copied().collect();
        let before = names.clone();
        names.retain(|name, _| named.contains(name));
        names.values_mut().for_each(|targets| targets.retain(|target| naming.contains(target)));
        names.retain(|_, targets| !targets.is_empty());
        if names == before {
            return names.into_keys().collect();
        }
    }
}

#[test]
fn a_circle_is_found_and_what_hangs_on_it_is_not_blamed() {
    let edges = |pairs: &[(&'static str, &'static str)]| {
        let mut names: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for (from, to) in pairs {
            names.entry(from).or_default().insert(to);
        }
        circle(names)
    };
    assert_eq!(edges(&[("a", "b"), ("b", "c"), ("a", "c")]), [""; 0]);
    assert_eq!(
        edges(&[("x", "a"), ("a", "b"), ("b", "c"), ("c", "a"), ("c", "y")]),
        ["a", "b", "c"]
    );
}

/// The hash of a result holds those of the entries that a map chooses, and that of shared code. Who
/// computed through another entry would outlive an edit of it.
#[test]
fn no_code_computes_through_an_entry() {
    let mut wrong = Vec::new();
    let graph = Graph::of("modules/src");
    assert!(graph.entries.len() > 30);
    for edge in graph.edges.iter().filter(|edge| graph.entries.contains(&edge.to)) {
        wrong.push(format!("modules/src/{}:{} names {}", edge.from, edge.line, edge.to));
    }
    for entry in &graph.entries {
        let (folder, file) = entry.rsplit_once('/').unwrap();
        let (list, name) = (format!("{folder}/mod.rs"), file.trim_end_matches(".rs"));
        // The file of the folder may hand an entry's items on, but not use them.
        let tokens = graph.tokens(&list);
        for (names, line) in paths(&tokens, &[name]) {
            let is_import = tokens.iter().rev().find_map(|token| match token.text {
                _ if token.line > line => None,
                "use" if token.line == line => Some(true),
                _ if token.line < line => Some(false),
                _ => None,
            });
            if is_import != Some(true) {
                wrong.push(format!("modules/src/{list}:{line} uses {}", names.join("::")));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What an entry says of a type of the algorithms holds for other entries without a name of it.
#[test]
fn entries_implement_traits_for_types_of_their_own() {
    let graph = Graph::of("modules/src");
    for entry in &graph.entries {
        let tokens = graph.tokens(entry);
        let word = |place: usize| tokens.get(place).map_or("", |token| token.text);
        for place in (0..tokens.len()).filter(|&place| word(place) == "for") {
            let (Some(start), Some(end)) = (
                (0..place).rev().take(12).find(|&p| word(p) == "impl"),
                (place..tokens.len()).take(12).find(|&p| word(p) == "{"),
            ) else {
                continue;
            };
            let is_name = |text: &str| text.chars().all(|c| c.is_alphanumeric() || c == '_');
            let name = (place + 1..end).map(word).take_while(|text| is_name(text) || *text == "::");
            let name = name.last().unwrap_or_default();
            let is_own = tokens.windows(2).any(|two| {
                matches!(two[0].text, "struct" | "enum" | "type") && two[1].text == name
            });
            let is_names = (start..place).any(|place| word(place) == "Enumeration");
            let others = graph.entries.iter().filter(|other| *other != entry);
            let is_used = |other: &String| graph.tokens(other).iter().any(|t| t.text == name);
            let shared: Vec<_> = others.filter(|other| is_used(other)).collect();
            let line = tokens[place].line;
            assert!(
                is_own || (is_names && shared.is_empty()),
                "modules/src/{entry}:{line}: {name} is not its own; used by {shared:?}"
            );
        }
    }
}

#[test]
fn code_names_nothing_that_is_for_tests() {
    for (folder, module) in [("core/src", "testing"), ("modules/src", "fixtures")] {
        let graph = Graph::of(folder);
        for file in graph.files.iter().filter(|file| module_of(file) != module) {
            for (names, line) in paths(&graph.tokens(file), &["crate", "super", "mve_core"]) {
                let is_for_tests = names.iter().any(|name| ["testing", "fixtures"].contains(name));
                assert!(!is_for_tests, "{folder}/{file}:{line}: {}", names.join("::"));
            }
        }
    }
}

/// No crate names one above it; Cargo refuses only circles.
#[test]
fn crates_stand_on_those_below_them() {
    let above = [("core", "mve_modules"), ("modules", "mve_report"), ("modules", "mve_editor")];
    for (folder, name) in above {
        let manifest = std::fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
        assert!(!manifest.contains(&name.replace('_', "-")), "{folder} depends on {name}");
    }
}

#[test]
fn paths_are_read_with_their_branches() {
    let all = tokens("use crate::a::{self, b::C, d::{e, F as G}}; fn x() { super::h::i::<u8>() }");
    let found: Vec<String> =
        paths(&all, &["crate", "super"]).iter().map(|(names, _)| names.join("::")).collect();
    let expected =
        ["crate::a::self", "crate::a::b::C", "crate::a::d::e", "crate::a::d::F", "super::h::i"];
    assert_eq!(found, expected);
}
