//! Where tests and benches find what is not in the repository: real models, and reference values.

use std::path::{Path, PathBuf};

/// The file of a real model: in the folder that `MVE_MODELS` names, or in `shared/models` beside
/// the checkout. `None`, after a line that says so, where it is not there.
pub fn model(name: &str) -> Option<PathBuf> {
    file(name.as_ref())
}

/// A file of reference values, in the folder `refs` beside that of the models.
pub fn reference(name: &str) -> Option<PathBuf> {
    file(&Path::new("../refs").join(name))
}

fn file(name: &Path) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/models");
    let folder = std::env::var_os("MVE_MODELS").map_or_else(beside, PathBuf::from);
    let path = folder.join(name);
    // Without `..`, since a map names files by it.
    let found = path.canonicalize().ok().filter(|path| path.is_file());
    if found.is_none() {
        eprintln!("skipped: there is no {}; MVE_MODELS names the folder of models", path.display());
    }
    found
}
