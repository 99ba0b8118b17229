//! What may name what, inside of the crates: layers, entries that stand alone, and no circles.

use std::collections::{BTreeMap, BTreeSet};

use mve_modules::registry;
use mve_tests::root;

use super::graph::{Graph, ROOTS, absolute, module_of, paths};
use super::sources::{Token, tokens};

/// Folders of modules: none names another one.
const LISTS: [&str; 5] = ["io", "generate", "filters", "measure", "images"];

/// The parts of `core/src`; each may name those before it.
const CORE: [&str; 33] = [
    "fingerprint",
    "machine",
    "json",
    "problem",
    "template",
    "cancel",
    "control",
    "outside",
    "memory",
    "error",
    "files",
    "stored",
    "data",
    "listed",
    "quantity",
    "port",
    "param",
    "module",
    "made",
    "panics",
    "node_outputs",
    "disk_cache",
    "cache",
    "map",
    "pattern",
    "spread",
    "registry",
    "describe",
    "schema",
    "search",
    "plan",
    "run",
    "program",
];

const FOLDERS: [&str; 7] = [
    "core/src",
    "mesh/src",
    "formats/src",
    "modules/src",
    "app/report/src",
    "app/cli/src",
    "app/editor/src",
];

/// Parts of `app/editor/src` that alone may name the document and the runner.
const HOLDERS: [&str; 2] = ["canvas", "app"];

/// The parts of a folder as a document draws them, from below to above: the names that begin the
/// lines of the drawing behind "Inside of".
fn drawn(document: &str, folder: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(document)).unwrap();
    let (_, behind) = text.split_once(&format!("Inside of `{folder}/`")).unwrap();
    let drawing = behind.split("```").nth(1).unwrap();
    let names = drawing.lines().skip(1).flat_map(|line| {
        line.split(' ').map_while(|word| word.strip_suffix('/').or(word.strip_suffix(".rs")))
    });
    names.map(str::to_owned).collect()
}

/// The folder or file right below `folder` that `file` belongs to.
fn part<'a>(file: &'a str, folder: &str) -> Option<&'a str> {
    let below = file.strip_prefix(folder)?;
    Some(below.split('/').next().unwrap_or(below).trim_end_matches(".rs"))
}

#[test]
fn crates_and_folders_name_only_what_is_below_them() {
    let mut wrong = Vec::new();
    let orders = [
        ("core/src", CORE.map(str::to_owned).to_vec()),
        ("modules/src", drawn("docs/ARCHITECTURE.md", "modules/src")),
        ("app/editor/src", drawn("docs/WINDOW.md", "app/editor/src")),
    ];
    for (folder, order) in orders {
        let graph = Graph::of(folder);
        let place_of =
            |file: &str| order.iter().position(|name| part(file, "") == Some(name.as_str()));
        for file in graph.files.iter().filter(|file| !ROOTS.contains(&file.as_str())) {
            assert!(place_of(file).is_some(), "{folder}/{file}: give it a place in the order");
        }
        for name in &order {
            let is_there = graph.files.iter().any(|file| part(file, "") == Some(name.as_str()));
            assert!(is_there, "{folder}: {name} has a place in the order and is gone");
        }
        for edge in &graph.edges {
            let (from, to) = (place_of(&edge.from), place_of(&edge.to));
            let are_lists = folder == "modules/src"
                && from != to
                && [from, to].iter().flatten().all(|&at| LISTS.contains(&order[at].as_str()));
            let is_held = folder == "app/editor/src"
                && ["document", "runner"].map(Some).contains(&part(&edge.to, ""))
                && from != to
                && from.is_none_or(|at| !HOLDERS.contains(&order[at].as_str()));
            let is_root = ROOTS.contains(&edge.from.as_str());
            if !is_root && (to > from || are_lists || is_held) {
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
                    && ![from, to].iter().any(|part| ["mod", "lib", "main"].contains(part))
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

/// An import of a folder with a list, of all that a folder has, or of the crate under another name
/// would hide from these tests what is named through it.
#[test]
fn imports_hide_no_entry() {
    let graph = Graph::of("modules/src");
    let lists: BTreeSet<String> = graph
        .entries
        .iter()
        .filter_map(|entry| Some(entry.rsplit_once('/')?.0.replace('/', "::")))
        .collect();
    let mut wrong = Vec::new();
    for file in graph.files.iter().filter(|file| *file != "prelude.rs") {
        let tokens = graph.tokens(file);
        for (names, line) in paths(&tokens, &["crate", "super"]) {
            // A file without an entry may have modules of its own, which name all that it has.
            let is_own = names[0] == "super" && !graph.entries.contains(file);
            let is_glob = names.last() == Some(&"*") && !names.contains(&"prelude") && !is_own;
            let is_folder = absolute(file, &names).is_some_and(|full| lists.contains(&full));
            if is_glob || is_folder {
                wrong.push(format!("modules/src/{file}:{line} names {}", names.join("::")));
            }
        }
        let renames = |three: &&[Token]| {
            let [a, b, c] = [0, 1, 2].map(|k| three[k].text);
            a == "use" && matches!(b, "crate" | "super") && c == "as"
        };
        wrong.extend(tokens.windows(3).find(renames).map(|three| {
            format!("modules/src/{file}:{} gives the crate another name", three[0].line)
        }));
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
    for (folder, module) in [
        ("core/src", "testing"),
        ("mesh/src", "fixtures"),
        ("formats/src", ""),
        ("modules/src", ""),
    ] {
        let graph = Graph::of(folder);
        for file in graph.files.iter().filter(|file| module_of(file) != module) {
            for (names, line) in
                paths(&graph.tokens(file), &["crate", "super", "mve_core", "mve_mesh"])
            {
                let is_for_tests = names.iter().any(|name| ["testing", "fixtures"].contains(name));
                assert!(!is_for_tests, "{folder}/{file}:{line}: {}", names.join("::"));
            }
        }
    }
}

/// No crate names one above it or one that it is to know nothing of; Cargo refuses only circles.
#[test]
fn crates_stand_on_those_below_them() {
    let all =
        ["eframe", "mve-editor", "mve", "mve-report", "mve-modules", "mve-formats", "mve-mesh"];
    for (folder, unknown) in [
        ("core", &all[..]),
        ("mesh", &all[..]),
        ("formats", &all[..6]),
        ("modules", &all[..4]),
        ("app/report", &all[..]),
        ("app/cli", &all[..2]),
    ] {
        let manifest = std::fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
        let names = manifest.lines().filter_map(|line| line.split(['.', ' ', '=']).next());
        let found: Vec<&str> = names.filter(|name| unknown.contains(name)).collect();
        assert!(found.is_empty(), "{folder} depends on {found:?}");
    }
}

/// What a form, a view or a report needs of a module, its declaration says. A name of one word may
/// be a word of the window too.
#[test]
fn windows_and_reports_name_no_module() {
    let is_long = |id: &&str| id.chars().filter(|c| c.is_uppercase()).count() > 1;
    let registry = registry();
    let ids: Vec<&str> = registry.modules().iter().map(|info| info.module.id).collect();
    let ids: Vec<&str> = ids.into_iter().filter(is_long).collect();
    assert!(ids.contains(&"ObjLoader"));
    for folder in ["app/editor/src", "app/report/src"] {
        let graph = Graph::of(folder);
        for file in &graph.files {
            let tokens = graph.tokens(file);
            for token in &tokens {
                let is_named =
                    token.text.contains('"') && ids.iter().any(|id| token.text.contains(id));
                assert!(!is_named, "{folder}/{file}:{}: {}", token.line, token.text);
            }
            for (names, line) in paths(&tokens, &["mve_modules"]) {
                let is_known = ["data", "picture", "registry", "SYNONYMS"].contains(&names[1]);
                assert!(is_known, "{folder}/{file}:{line}: {}", names.join("::"));
            }
        }
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
