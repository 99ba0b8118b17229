//! Which packages a crate of the workspace is built from, by the manifests and the lock file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The crate and what it is built from, without what only tests and benches need.
pub struct Packages {
    /// Crates of the workspace, the first one first: name and folder.
    pub crates: Vec<(String, String)>,
    /// Name, version, source and checksum of each other package, and the features that the
    /// workspace asks for, as lines; all of the lock file if something in it was not understood.
    pub description: String,
}

/// A package in the lock file.
#[derive(Default)]
struct Locked<'a> {
    name: &'a str,
    version: &'a str,
    /// All of its lines but the dependencies.
    lines: Vec<&'a str>,
    /// `name`, `name version` or `name version (source)`.
    dependencies: Vec<&'a str>,
}

/// The packages that `name` reaches, in the workspace at `root`.
pub fn packages(root: &Path, name: &str) -> Packages {
    let read = |path: &Path| std::fs::read_to_string(path).unwrap_or_default().replace('\r', "");
    let manifest = read(&root.join("Cargo.toml"));
    let lock = read(&root.join("Cargo.lock"));
    let mut crates: Vec<(String, String)> = Vec::new();
    let mut description = String::new();
    // What is not understood counts as a whole.
    let workspace = declarations(&manifest).unwrap_or_else(|| {
        description += &manifest;
        description += &lock;
        lines_of(&manifest)
    });
    // Folders that a crate's own manifest names, not the workspace.
    let mut own_folders: BTreeMap<String, String> = BTreeMap::new();
    let mut outer = BTreeSet::new();
    let mut todo = vec![name.to_owned()];
    while let Some(name) = todo.pop() {
        let of_workspace = workspace.get(&name).and_then(|line| folder(line));
        let Some(folder) = of_workspace.or_else(|| own_folders.get(&name).cloned()) else {
            outer.insert(name);
            continue;
        };
        if crates.iter().any(|(other, _)| *other == name) {
            continue;
        }
        let manifest = read(&root.join(&folder).join("Cargo.toml"));
        let declared = declarations(&manifest).unwrap_or_else(|| {
            description += &manifest;
            description += &lock;
            lines_of(&manifest)
        });
        for (dependency, line) in declared {
            if let Some(path) = self::folder(&line) {
                own_folders.insert(dependency.clone(), format!("{folder}/{path}"));
            }
            let of_workspace = workspace.get(&dependency).map_or("", String::as_str);
            description += &format!("{name}: {line} {of_workspace}\n");
            todo.push(dependency);
        }
        crates.push((name, folder));
    }
    let inner: BTreeSet<&str> = crates.iter().map(|(name, _)| name.as_str()).collect();
    match reached(&lock, &inner, &outer) {
        Some(lines) => description += &lines,
        None => description += &lock,
    }
    Packages { crates, description }
}

/// The lines of dependencies by name, without those that only tests and benches have; of a
/// workspace, those that its crates may refer to. `None` of a manifest that says one in more than a
/// line.
fn declarations(manifest: &str) -> Option<BTreeMap<String, String>> {
    let is_of_dependency = |section: &str| {
        let above = section.rsplit_once('.').map_or("", |(above, _)| above);
        above.ends_with("dependencies") && !above.ends_with("dev-dependencies")
    };
    let is_whole = |line: &String| {
        let n = |signs: [char; 2]| line.matches(signs).count();
        n(['[', '{']) == n([']', '}'])
    };
    let headers = manifest.lines().filter_map(|line| line.trim().strip_prefix('['));
    let has_tables = headers.map(|header| header.trim_end_matches(']')).any(is_of_dependency);
    let lines = lines_of(manifest);
    (!has_tables && lines.values().all(is_whole)).then_some(lines)
}

/// The first lines of dependencies by name.
fn lines_of(manifest: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut section = "";
    for line in manifest.lines().map(|line| without_comment(line).trim()) {
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            section = name;
            continue;
        }
        let kind = section.rsplit('.').next().unwrap_or_default();
        if !matches!(kind, "dependencies" | "build-dependencies") {
            continue;
        }
        if let Some((name, _)) = line.split_once(['.', '=', ' ']) {
            found.insert(name.to_owned(), line.to_owned());
        }
    }
    found
}

fn without_comment(line: &str) -> &str {
    let mut is_text = false;
    for (place, byte) in line.bytes().enumerate() {
        match byte {
            b'"' => is_text = !is_text,
            b'#' if !is_text => return &line[..place],
            _ => {}
        }
    }
    line
}

/// The folder that a declaration names: `{ path = "core" }`.
fn folder(line: &str) -> Option<String> {
    let (_, rest) = line.split_once("path = \"")?;
    Some(rest.split_once('"')?.0.to_owned())
}

/// The locked packages that crates of the workspace reach through packages that they name; `None`
/// if one of them is not in the lock file under its name.
fn reached(lock: &str, inner: &BTreeSet<&str>, outer: &BTreeSet<String>) -> Option<String> {
    let packages: Vec<Locked> = lock.split("[[package]]").skip(1).map(locked).collect();
    let find = |dependency: &str| {
        let mut words = dependency.split(' ');
        let (name, version) = (words.next(), words.next());
        packages.iter().position(|package| {
            Some(package.name) == name && version.is_none_or(|version| version == package.version)
        })
    };
    // The lock file says which version of a package a crate of ours has, where there are several.
    let mut todo = Vec::new();
    for name in inner {
        let package = &packages[find(name)?];
        for dependency in &package.dependencies {
            let name = dependency.split(' ').next().unwrap_or_default();
            if outer.contains(name) {
                todo.push(find(dependency)?);
            }
        }
    }
    let is_named = |name: &String| todo.iter().any(|&place| packages[place].name == name);
    if !outer.iter().all(is_named) {
        return None;
    }
    let mut places = BTreeSet::new();
    while let Some(place) = todo.pop() {
        if places.insert(place) {
            for dependency in &packages[place].dependencies {
                todo.push(find(dependency)?);
            }
        }
    }
    let mut text = String::new();
    for place in places {
        text += &packages[place].lines.join(" ");
        text.push('\n');
    }
    Some(text)
}

fn locked(block: &str) -> Locked<'_> {
    let mut package = Locked::default();
    for line in block.lines().map(str::trim).filter(|line| !line.is_empty()) {
        match line.split_once(" = ") {
            Some(("dependencies", _)) => {}
            Some((field, value)) => {
                let value = value.trim_matches('"');
                match field {
                    "name" => package.name = value,
                    "version" => package.version = value,
                    _ => {}
                }
                package.lines.push(line);
            }
            None if line.starts_with('"') => {
                package.dependencies.push(line.trim_matches([',', '"']));
            }
            None => {}
        }
    }
    package
}
