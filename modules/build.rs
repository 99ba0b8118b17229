//! Hashes the sources that modules share, so that results of an older algorithm are never taken
//! for results of the present one.

use std::path::{Path, PathBuf};

/// Folders with one file per module or entry; those files are hashed one by one where they are
/// listed, so that editing one cost function leaves the results of the others standing.
const ONE_BY_ONE: [&str; 8] =
    ["io", "images", "generate", "filters", "measure", "cost", "placement", "metric"];

fn main() {
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rerun-if-changed=../Cargo.lock");
    let mut files = Vec::new();
    collect(Path::new("src"), &mut files);
    // The runtime reads parameters and passes values; its defaults and checks decide results too.
    println!("cargo::rerun-if-changed=../core/src");
    collect(Path::new("../core/src"), &mut files);
    files.sort();
    let mut hasher = blake3::Hasher::new();
    for file in files.iter().filter(|file| is_shared(file)) {
        hasher.update(file.to_string_lossy().as_bytes());
        hasher.update(&std::fs::read(file).unwrap_or_default());
    }
    // The lock file is not there when the crate is built from a package of its own.
    hasher.update(&std::fs::read("../Cargo.lock").unwrap_or_default());
    println!("cargo::rustc-env=MVE_SHARED_SOURCES={}", hasher.finalize().to_hex());
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() { collect(&path, files) } else { files.push(path) }
    }
}

/// All but the files that a list names: those in a folder of [`ONE_BY_ONE`] that declare an item.
fn is_shared(file: &Path) -> bool {
    let folder = file.parent().and_then(|f| f.strip_prefix("src").ok()).and_then(Path::to_str);
    let text = std::fs::read_to_string(file).unwrap_or_default();
    let is_item = |item: &&str| text.contains(&format!("pub static {item}:"));
    let declares_one = ["MODULE", "COST", "PLACEMENT", "METRIC"].iter().any(is_item);
    !(declares_one && folder.is_some_and(|folder| ONE_BY_ONE.contains(&folder)))
}
