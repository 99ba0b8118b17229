//! glTF files on the disk, with the files that they name.

use std::path::{Path, PathBuf};

use mve_core::{Control, ModuleError};
use mve_mesh::data::{TriMesh, name_to_file, shown_name};

use super::Vertices;
use super::container::{self, Uri};
use super::read::read_with;
use crate::load_with;
use crate::obj::FileScope;
use crate::obj::bounds::Bounds;
use crate::obj::textures;
use crate::plain_file::{read_long, read_mesh_file};
use crate::warnings::Warning;

/// Reads a glTF file, with the buffers and pictures that it names, as those of a scope.
///
/// # Errors
/// With the path, where it or a buffer cannot be read; that `control` ended the work.
pub fn load(
    path: &Path,
    scope: FileScope,
    vertices: Vertices,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ModuleError> {
    let folder = folder_of(path);
    let mut buffer = |name: &str| {
        let path = folder.join(name_to_file(name));
        let bytes = Bounds::new(&folder, scope).check(&path);
        let bytes = bytes.and_then(|()| read_long(&path, u64::MAX, control));
        bytes.map_err(|why| format!("is in {}, which cannot be read: {why}", shown_name(name)))
    };
    load_with(path, control, |bytes, control| {
        let place = (folder.clone(), Bounds::new(&folder, scope));
        read_with(bytes, &mut buffer, Some(place), vertices, control)
    })
}

/// The files that reading a glTF file may open, whether they exist or not.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    let Ok(bytes) = read_mesh_file(path, Control::none()) else { return Vec::new() };
    let Ok(file) = container::open(&bytes) else { return Vec::new() };
    let folder = folder_of(path);
    let mut paths = Vec::new();
    let file_of = |uri: &Option<String>| match Uri::parse(uri.as_ref()?) {
        Ok(Uri::File(name)) => Some(name),
        _ => None,
    };
    for name in file.document.buffers.iter().filter_map(|buffer| file_of(&buffer.uri)) {
        paths.push(folder.join(name_to_file(&name)));
    }
    for scope in [FileScope::Folder, FileScope::Anywhere] {
        let bounds = Bounds::new(&folder, scope);
        for name in file.document.images.iter().filter_map(|image| file_of(&image.uri)) {
            let (path, _) = textures::find(&name, std::slice::from_ref(&folder), &bounds);
            paths.push(path);
        }
    }
    let mut known = std::collections::HashSet::new();
    paths.retain(|path| known.insert(path.clone()));
    paths
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}
