//! Hashes of the sources that results come from, so that a result of other code is never taken
//! for one of the present code, and nothing runs again that gives the same.
//!
//! A file that a list names (`modules!`, `registered!`) has a hash of its own; all other files,
//! the crates of the workspace that this one stands on, and the packages that they are built from
//! have one together. White space, comments, line ends, tests, and packages that are only tests'
//! or the window's, enter no hash. The build script and the tests of the workspace share this file.

mod manifests;
mod tokens;

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use manifests::packages;
pub use tokens::{Token, tokens, without_tests};

/// Files that only tests use, though they are built always: other crates' tests need them too.
pub const FOR_TESTS: [&str; 3] =
    ["core/src/testing.rs", "mesh/src/fixtures.rs", "mesh/src/testing.rs"];

/// What [`source_hashes`] gives.
#[derive(Debug, PartialEq, Eq)]
pub struct SourceHashes {
    /// Of all that entries share.
    pub shared: String,
    /// Of each file that a list names, by its path as a module: `mve_modules::cost::quadric`.
    pub entries: BTreeMap<String, String>,
    /// Files and folders that a change of these hashes can come from.
    pub watched: Vec<PathBuf>,
}

/// Hashes the sources of a crate of the workspace at `root`.
///
/// # Errors
/// If a file cannot be read.
pub fn source_hashes(root: &Path, name: &str) -> io::Result<SourceHashes> {
    let packages = packages(root, name);
    let mut watched = vec![root.join("Cargo.toml"), root.join("Cargo.lock")];
    let mut shared = blake3::Hasher::new();
    shared.update(packages.description.as_bytes());
    let mut entries = BTreeMap::new();
    for (name, folder) in &packages.crates {
        let sources = sources(root, &format!("{folder}/src"))?;
        let module_of = |path: &str| {
            let below = path.strip_prefix(&format!("{folder}/src/")).unwrap_or(path);
            let module = below.strip_suffix(".rs").unwrap_or(below).replace('/', "::");
            format!("{}::{module}", name.replace('-', "_"))
        };
        for (path, content) in &sources.contents {
            if sources.tests.contains(path) || FOR_TESTS.contains(&path.as_str()) {
                continue;
            }
            if sources.entries.contains(path) {
                entries.insert(module_of(path), blake3::hash(content).to_hex().to_string());
            } else {
                shared.update(path.as_bytes());
                shared.update(&(content.len() as u64).to_le_bytes());
                shared.update(content);
            }
        }
        watched.extend([root.join(folder).join("src"), root.join(folder).join("Cargo.toml")]);
    }
    Ok(SourceHashes { shared: shared.finalize().to_hex().to_string(), entries, watched })
}

/// The files below a folder; paths are below the root, with `/`.
#[derive(Default)]
pub struct Sources {
    /// What of each file is hashed.
    pub contents: BTreeMap<String, Vec<u8>>,
    /// Files that a list names.
    pub entries: BTreeSet<String>,
    /// Files that only tests are built from.
    pub tests: BTreeSet<String>,
}

/// Reads the files below a folder, and tells entries and tests from the others.
///
/// # Errors
/// If a file cannot be read.
pub fn sources(root: &Path, folder: &str) -> io::Result<Sources> {
    let mut paths = Vec::new();
    collect(root, folder, &mut paths)?;
    let mut sources = Sources::default();
    let mut test_modules = Vec::new();
    for path in paths {
        let bytes = std::fs::read(root.join(&path))?;
        let content = match String::from_utf8(bytes) {
            Ok(text) if path.ends_with(".rs") => {
                let text = text.replace("\r\n", "\n");
                let left = without_tests(&tokens(&text));
                let lists = lists(&left.tokens).into_iter();
                sources.entries.extend(lists.map(|name| module_file(&path, name, None)));
                let tests = left.test_modules.into_iter();
                test_modules.extend(tests.map(|(name, said)| module_file(&path, name, said)));
                joined(&left.tokens)
            }
            Ok(text) => text.replace("\r\n", "\n").into_bytes(),
            Err(error) => error.into_bytes(),
        };
        sources.contents.insert(path, content);
    }
    for module in test_modules {
        // The file, or the folder of that name, and what the module declares in turn.
        let stem = module.strip_suffix(".rs").unwrap_or(&module);
        let below = format!("{stem}/");
        let is_test = |path: &&String| **path == module || path.starts_with(&below);
        let tests: Vec<String> = sources.contents.keys().filter(is_test).cloned().collect();
        sources.tests.extend(tests);
    }
    sources.entries.retain(|path| sources.contents.contains_key(path));
    Ok(sources)
}

/// The tokens as bytes: equal for texts that differ in white space and comments alone.
fn joined(tokens: &[Token]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let is_sign = |token: &Token| !token.text.starts_with(|c: char| c.is_alphanumeric());
    for (place, token) in tokens.iter().enumerate() {
        let is_part = place > 0 && !token.is_apart && is_sign(token) && is_sign(&tokens[place - 1]);
        bytes.push(if is_part { 1 } else { 0 });
        bytes.extend_from_slice(token.text.as_bytes());
    }
    bytes
}

/// Names in the lists of a file: `modules! { "io": a, b }`, `registered! { … = ITEM in a, b; }`.
pub fn lists<'a>(tokens: &[Token<'a>]) -> Vec<&'a str> {
    let mut names = Vec::new();
    for (place, three) in tokens.windows(3).enumerate() {
        let [name, "!", "{"] = [0, 1, 2].map(|k| three[k].text) else { continue };
        let before = match name {
            "modules" => ":",
            "registered" => "in",
            _ => continue,
        };
        let list = tokens[place + 3..].iter().map(|token| token.text);
        let list = list.take_while(|text| !matches!(*text, "}" | "$"));
        let list = list.skip_while(|text| *text != before).skip(1);
        names.extend(list.filter(|text| !matches!(*text, "," | ";")));
    }
    names
}

/// The file of a module that the file at `path` declares.
fn module_file(path: &str, name: &str, said: Option<&str>) -> String {
    let (folder, file) = path.rsplit_once('/').unwrap_or(("", path));
    match (said, file) {
        (Some(said), _) => format!("{folder}/{said}"),
        (None, "mod.rs" | "lib.rs") => format!("{folder}/{name}.rs"),
        (None, file) => format!("{folder}/{}/{name}.rs", file.trim_end_matches(".rs")),
    }
}

fn collect(root: &Path, folder: &str, paths: &mut Vec<String>) -> io::Result<()> {
    let mut names: Vec<_> = std::fs::read_dir(root.join(folder))?.collect::<Result<Vec<_>, _>>()?;
    names.sort_by_key(std::fs::DirEntry::file_name);
    for entry in names {
        let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            collect(root, &path, paths)?;
        } else {
            paths.push(path);
        }
    }
    Ok(())
}
