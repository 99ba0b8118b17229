//! What the tests that cross crates share.

use std::path::{Path, PathBuf};

/// The root of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(".")).to_owned()
}

/// A real mesh, if the folder of models is there: the one that `MVE_MODELS` names, or
/// `../shared/models` beside the workspace. Says so where it is not.
pub fn model(name: &str) -> Option<PathBuf> {
    let beside = || root().join("../shared/models");
    let folder = std::env::var_os("MVE_MODELS").map_or_else(beside, PathBuf::from);
    let path = folder.join(name);
    if path.is_file() {
        return path.canonicalize().ok();
    }
    eprintln!("skipped: {} is not there; set MVE_MODELS", path.display());
    None
}

/// The maps that ship.
pub fn maps() -> Vec<PathBuf> {
    let folder = root().join("maps");
    let mut maps: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    maps.sort();
    maps
}
