//! A mesh as an STL file on the disk.

use std::path::Path;

use mve_core::{Control, ModuleError};
use mve_mesh::data::TriMesh;

use super::{StlEncoding, write_stl};
use crate::rounding::Rounding;
use crate::save_atomic;

/// Saves the triangles of a mesh; what is changed comes back in sentences.
///
/// # Errors
/// With the path, where the file cannot be written or the mesh cannot be said in the format (see
/// [`write_stl`]); that `control` ended it.
pub fn save(
    mesh: &TriMesh,
    encoding: StlEncoding,
    path: &Path,
    control: Control,
) -> Result<Vec<String>, ModuleError> {
    let advice = "move the mesh to the origin, or save it as PLY with Double";
    let warning = |rounding| format!("STL has floats: {rounding}; {advice}");
    let warnings = Rounding::of_floats(mesh).map(warning).into_iter().collect();
    save_atomic(path, |out| write_stl(mesh, encoding, out, control))?;
    Ok(warnings)
}
