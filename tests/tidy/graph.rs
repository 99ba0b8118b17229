//! Which file of a crate names which other one, read from the sources, without tests.

use std::collections::{BTreeMap, BTreeSet};

use mve_tests::root;

use super::sources::{FOR_TESTS, Token, sources, tokens, without_tests};

/// Files that a crate begins with.
pub const ROOTS: [&str; 2] = ["lib.rs", "main.rs"];

/// The files of a crate and what they name of each other.
pub struct Graph {
    /// Paths below the folder of sources, such as `cost/quadric.rs`.
    pub files: Vec<String>,
    /// Files that a list of modules or entries names.
    pub entries: BTreeSet<String>,
    /// What names what, by the order of files.
    pub edges: Vec<Edge>,
    texts: BTreeMap<String, String>,
}

/// A name in one file that stands for something in another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Edge {
    /// The file that names.
    pub from: String,
    /// The file that has it.
    pub to: String,
    /// Line in the first one.
    pub line: usize,
}

/// A path as it is written, `crate::data::TriMesh`, with its line.
type Names<'a> = (Vec<&'a str>, usize);

impl Graph {
    /// Reads the sources in a folder of the repository: `modules/src`.
    pub fn of(folder: &str) -> Self {
        let all = sources(&root(), folder).unwrap();
        let is_code = |path: &&String| {
            path.ends_with(".rs")
                && !all.tests.contains(*path)
                && !FOR_TESTS.contains(&path.as_str())
        };
        let below = |path: &String| path[folder.len() + 1..].to_owned();
        let files: Vec<String> = all.contents.keys().filter(is_code).map(below).collect();
        let text_of = |file: &String| {
            let text = std::fs::read_to_string(root().join(folder).join(file)).unwrap();
            (file.clone(), text)
        };
        let texts = files.iter().map(text_of).collect();
        let entries = all.entries.iter().map(below).collect();
        let mut graph = Self { files, entries, edges: Vec::new(), texts };
        graph.edges = graph.all_edges();
        graph
    }

    /// What of a file is there without tests.
    pub fn tokens(&self, file: &str) -> Vec<Token<'_>> {
        without_tests(&tokens(&self.texts[file])).tokens
    }

    fn all_edges(&self) -> Vec<Edge> {
        // Where a crate has both roots, other files name the library's: `lib.rs`, the earlier one.
        let files = self.files.iter().rev();
        let modules: BTreeMap<String, &str> =
            files.map(|file| (module_of(file), file.as_str())).collect();
        let exports: BTreeMap<&str, BTreeMap<&str, String>> =
            self.files.iter().map(|file| (file.as_str(), self.exports(file, &modules))).collect();
        let mut edges = BTreeSet::new();
        for from in &self.files {
            for (names, line) in paths(&self.tokens(from), &["crate", "super"]) {
                let Some(mut full) = absolute(from, &names) else { continue };
                // A name that a folder hands on stands for the file that has it.
                let to = loop {
                    let (file, item) = resolve(&full, &modules);
                    match item.and_then(|item| exports.get(file)?.get(item)) {
                        Some(target) if *target != full => full.clone_from(target),
                        _ => break file,
                    }
                };
                if to != from {
                    edges.insert(Edge { from: from.clone(), to: to.to_owned(), line });
                }
            }
        }
        edges.into_iter().collect()
    }

    /// The names that a file hands on from modules below it, as full paths.
    fn exports(&self, file: &str, modules: &BTreeMap<String, &str>) -> BTreeMap<&str, String> {
        let module = module_of(file);
        let below = |name: &str| {
            if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") }
        };
        let all = tokens(&self.texts[file]);
        let tokens = without_tests(&all).tokens;
        let mut exports = BTreeMap::new();
        for (place, token) in tokens.iter().enumerate() {
            let Some(next) = tokens.get(place + 1) else { break };
            if token.text != "use" || !modules.contains_key(&below(next.text)) {
                continue;
            }
            for (names, _) in path_at(&tokens, place + 1) {
                if let Some(name) = names.last() {
                    exports.insert(*name, below(&names.join("::")));
                }
            }
        }
        exports
    }
}

/// `cost::quadric` for `cost/quadric.rs`, `cost` for `cost/mod.rs`, nothing for a root.
pub fn module_of(file: &str) -> String {
    let stem = file.trim_end_matches(".rs");
    let stem = stem.strip_suffix("/mod").unwrap_or(stem);
    if ROOTS.contains(&file) { String::new() } else { stem.replace('/', "::") }
}

/// A written path as one from the root of the crate.
pub fn absolute(file: &str, names: &[&str]) -> Option<String> {
    let module = module_of(file);
    let mut parts: Vec<&str> = module.split("::").filter(|part| !part.is_empty()).collect();
    let mut names = names.iter().peekable();
    if names.peek() == Some(&&"crate") {
        parts.clear();
        names.next();
    }
    while names.peek() == Some(&&"super") {
        parts.pop()?;
        names.next();
    }
    parts.extend(names.filter(|name| **name != "self"));
    Some(parts.join("::"))
}

/// The file of the longest module that a path begins with, and the name behind that.
fn resolve<'a, 'b>(
    path: &'a str,
    modules: &BTreeMap<String, &'b str>,
) -> (&'b str, Option<&'a str>) {
    let mut end = path.len();
    loop {
        if let Some(file) = modules.get(&path[..end]) {
            let rest = path[end..].trim_start_matches("::");
            return (file, rest.split("::").next().filter(|name| !name.is_empty()));
        }
        end = path[..end].rfind("::").unwrap_or(0);
    }
}

/// All paths that begin with one of these words, with every branch of `{…}`.
pub fn paths<'a>(tokens: &[Token<'a>], first: &[&str]) -> Vec<Names<'a>> {
    let mut found = Vec::new();
    for (place, token) in tokens.iter().enumerate() {
        let is_first = first.contains(&token.text)
            && (place == 0 || tokens[place - 1].text != "::")
            && tokens.get(place + 1).is_some_and(|next| next.text == "::");
        if is_first {
            found.extend(path_at(tokens, place));
        }
    }
    found
}

/// The paths that begin at a word.
fn path_at<'a>(tokens: &[Token<'a>], place: usize) -> Vec<Names<'a>> {
    let mut found = Vec::new();
    branch(tokens, place, &[], &mut found);
    found
}

/// Reads one branch of a path and gives the place behind it.
fn branch<'a>(
    tokens: &[Token<'a>],
    mut place: usize,
    before: &[&'a str],
    found: &mut Vec<Names<'a>>,
) -> usize {
    let mut names = before.to_vec();
    let line = tokens.get(place).map_or(0, |token| token.line);
    while let Some(token) = tokens.get(place) {
        if token.text == "{" {
            place += 1;
            while tokens.get(place).is_some_and(|token| token.text != "}") {
                place = branch(tokens, place, &names, found);
                place += usize::from(tokens.get(place).is_some_and(|token| token.text == ","));
            }
            return place + 1;
        }
        let is_name = token.text.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        if !is_name && token.text != "*" {
            break;
        }
        names.push(token.text);
        place += 1;
        if tokens.get(place).is_none_or(|token| token.text != "::") {
            break;
        }
        place += 1;
    }
    found.push((names, line));
    // A name that is given by `as` is not of interest.
    while tokens.get(place).is_some_and(|token| !matches!(token.text, "," | "}" | ";")) {
        if before.is_empty() {
            break;
        }
        place += 1;
    }
    place
}
