//! A mesh as an OFF file on the disk.

use std::path::Path;

use mve_core::{Control, ModuleError};
use mve_mesh::data::{Layer, TriMesh};

use super::write_off;
use crate::save_atomic;

/// Saves a mesh; what is left out comes back in sentences.
///
/// # Errors
/// With the path, where the file cannot be written or the mesh cannot be said in the format (see
/// [`write_off`]); that `control` ended it.
pub fn save(mesh: &TriMesh, path: &Path, control: Control) -> Result<Vec<String>, ModuleError> {
    let names = [Layer::NORMAL, Layer::TEXCOORD, Layer::MATERIAL];
    let there = names.iter().filter(|name| mesh.layer(name).is_some());
    let warning = |name| format!("the layer \"{name}\" has no place in the file and is left out");
    let warnings = there.map(warning).collect();
    save_atomic(path, |out| write_off(mesh, out, control))?;
    Ok(warnings)
}
