//! PLY files on the disk, with the pictures that they name.

use std::path::{Path, PathBuf};

use mve_core::{Control, ModuleError};
use mve_mesh::data::TriMesh;

use super::header::Header;
use super::read::read_ply;
use crate::load_with;
use crate::obj::FileScope;
use crate::obj::bounds::Bounds;
use crate::obj::textures::{self, Pictures};
use crate::plain_file::read_beginning;
use crate::warnings::{Warning, Warnings};

/// Bytes of the longest header whose pictures count.
const LONGEST_HEADER: u64 = 1 << 24;

/// Reads a PLY file, and the pictures that it names, as those of a scope.
///
/// # Errors
/// With the path, where it cannot be read; that `control` ended the work.
pub fn load(
    path: &Path,
    scope: FileScope,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ModuleError> {
    let (mut mesh, mut list) = load_with(path, control, read_ply)?;
    let folder = folder_of(path);
    let mut warnings = Warnings::default();
    let bounds = Bounds::new(&folder, scope);
    let folders = [folder];
    let mut pictures = Pictures::default();
    pictures.read_all(&mut mesh.materials, &folders, &bounds, &mut warnings, control);
    list.extend(warnings.into_list());
    control.at(1.0)?;
    Ok((mesh, list))
}

/// The pictures that reading a PLY file may open, whether they exist or not.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    let Ok(bytes) = read_beginning(path, LONGEST_HEADER) else { return Vec::new() };
    let Ok(header) = Header::read(&bytes) else { return Vec::new() };
    let folder = folder_of(path);
    let mut paths = Vec::new();
    for scope in [FileScope::Folder, FileScope::Anywhere] {
        let bounds = Bounds::new(&folder, scope);
        for name in &header.textures {
            let (path, _) = textures::find(name, std::slice::from_ref(&folder), &bounds);
            if !paths.contains(&path) {
                paths.push(path);
            }
        }
    }
    paths
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}
