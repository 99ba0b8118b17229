//! Open Inventor files on the disk, with the pictures that they name.

use std::path::{Path, PathBuf};

use mve_core::{Control, ModuleError};
use mve_mesh::data::{TriMesh, name_from_bytes};

use super::lexer::Lexer;
use super::read::read_iv;
use super::write::write_iv;
use crate::obj::FileScope;
use crate::obj::bounds::Bounds;
use crate::obj::textures::{self, Pictures};
use crate::plain_file::read_mesh_file;
use crate::warnings::{Warning, Warnings};
use crate::{load_with, obj, save_atomic};

/// Reads an Open Inventor file, and the pictures that it names, as those of a scope.
///
/// # Errors
/// With the path, where it cannot be read; that `control` ended the work.
pub fn load(
    path: &Path,
    scope: FileScope,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ModuleError> {
    let (mut mesh, mut list) = load_with(path, control, read_iv)?;
    let folder = folder_of(path);
    let bounds = Bounds::new(&folder, scope);
    let (mut warnings, mut pictures) = (Warnings::default(), Pictures::default());
    pictures.read_all(&mut mesh.materials, &[folder], &bounds, &mut warnings, control);
    list.extend(warnings.into_list());
    control.at(1.0)?;
    Ok((mesh, list))
}

/// The pictures that reading a file may open, whether they exist or not.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    const FIELD: &[u8] = b"filename";
    let Ok(bytes) = read_mesh_file(path, Control::none()) else { return Vec::new() };
    let folder = folder_of(path);
    let bounds = [FileScope::Folder, FileScope::Anywhere].map(|scope| Bounds::new(&folder, scope));
    let mut paths = Vec::new();
    let mut rest = bytes.as_slice();
    while let Some(at) = rest.windows(FIELD.len()).position(|word| word == FIELD) {
        rest = &rest[at + FIELD.len()..];
        let Ok(name) = Lexer::new(rest).text() else { continue };
        for bounds in &bounds {
            let name = name_from_bytes(&name);
            let (path, _) = textures::find(&name, std::slice::from_ref(&folder), bounds);
            if !name.is_empty() && !paths.contains(&path) {
                paths.push(path);
            }
        }
    }
    paths
}

/// Saves a mesh, and its pictures into a folder beside the file; what is changed or left out comes
/// back in sentences.
///
/// # Errors
/// With the path, where a file cannot be written or the mesh cannot be said in the format (see
/// [`write_iv`]); that `control` ended it.
pub fn save(mesh: &TriMesh, path: &Path, control: Control) -> Result<Vec<String>, ModuleError> {
    let materials = obj::save_pictures(&mesh.materials, path, "-iv-textures", control)?;
    let mut warnings = Vec::new();
    save_atomic(path, |out| {
        warnings = write_iv(mesh, &materials, out, control)?;
        Ok(())
    })?;
    warnings.extend(obj::textures_not_there(mesh, path, ""));
    Ok(warnings)
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}
