//! OBJ files with their material files and textures on the disk.

use std::collections::HashSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use mve_core::Control;
use mve_mesh::data::{Material, Texture, TriMesh, name_from_file, name_to_file, shown_name};

use super::bounds::{Bounds, FileScope};
use super::cursor::Cursor;
use super::parse::parse_with;
use super::textures::{self, Pictures, TextureFolder, named, texture_folder};
use super::{Companions, ObjError, Warning, Warnings, materials, parse_mtl, write_mtl, write_obj};
use crate::plain_file::{read_mesh_file, read_plain};
use crate::png::write_png;
use crate::{FileError, save_atomic};

/// Bytes of the largest material file that is read; real ones have a few thousand.
const MAX_MTL_BYTES: u64 = 64 << 20;

/// What follows the stem of a mesh's file in the name of the folder with its textures.
pub const TEXTURE_FOLDER: &str = "-textures";

/// Reads an OBJ file, the material files that it names, which are relative to its folder, and the
/// pictures that these name. What is missing of material files and pictures is a warning, and so
/// is what lies outside of the folder of the file.
///
/// # Errors
/// [`ObjError::File`] with the path when the file cannot be read, and those of
/// [`parse`](super::parse()).
pub fn load(path: &Path, control: Control) -> Result<(TriMesh, Vec<Warning>), ObjError> {
    load_within(path, FileScope::Folder, control)
}

/// Reads an OBJ file as [`load`] does, with the files of a scope.
///
/// # Errors
/// As [`load`].
pub fn load_within(
    path: &Path,
    scope: FileScope,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ObjError> {
    let bytes = read_mesh_file(path, control).map_err(|source| FileError::read(path, source));
    let bytes = bytes.map_err(|error| match error.is_cancelled() {
        true => ObjError::Cancelled,
        false => error.into(),
    })?;
    let folder = folder_of(path);
    let pictures = Pictures::default();
    let mut disk = Disk { bounds: Bounds::new(&folder, scope), folder, pictures, control };
    let loaded = parse_with(&bytes, &mut disk, control)?;
    control.at(1.0).map_err(|_| ObjError::Cancelled)?;
    Ok(loaded)
}

/// The files beside an OBJ file.
struct Disk<'a> {
    folder: PathBuf,
    bounds: Bounds,
    pictures: Pictures,
    control: Control<'a>,
}

impl Companions for Disk<'_> {
    fn material_file(&mut self, name: &str) -> io::Result<Vec<u8>> {
        let path = self.folder.join(name_to_file(name));
        self.bounds.check(&path)?;
        read_plain(&path, MAX_MTL_BYTES)
    }

    fn pictures(&mut self, library: &str, materials: &mut [Material], warnings: &mut Warnings) {
        let folders = texture_folders(&self.folder, library);
        self.pictures.read_all(materials, &folders, &self.bounds, warnings, self.control);
    }
}

/// Where the pictures are looked for that a material file names: beside it, then beside the mesh.
fn texture_folders(folder: &Path, library: &str) -> Vec<PathBuf> {
    let mut folders = vec![folder_of(&folder.join(name_to_file(library)))];
    if folders[0] != folder {
        folders.push(folder.to_owned());
    }
    folders
}

/// Writes `mesh` as an OBJ file, and its materials, if there are any, as an MTL file of the same
/// stem beside it. Their pictures go into a folder beside both, its name the stem and
/// [`TEXTURE_FOLDER`]: as the files that they were read from, byte for byte, or else as PNG files.
/// Names that two pictures share get a number, and those that a system refuses are changed. What
/// else lies in that folder stays. A texture whose file was not read keeps the name that it came
/// with.
///
/// Pictures come first and the OBJ file last, so that no file names one that is not there; each
/// file is replaced whole or not at all.
///
/// # Errors
/// With the path, when `control` ends it, a file cannot be written or the mesh cannot be said in
/// the format (see [`write_obj`]).
pub fn save(mesh: &TriMesh, path: &Path, control: Control) -> Result<(), FileError> {
    let folder = folder_beside(path, TEXTURE_FOLDER);
    let name = name_from_file(folder.file_name().unwrap_or_default());
    let placed = texture_folder(&mesh.materials, &name);
    save_with(mesh, path, &placed, control)
}

/// Writes `mesh` as [`save`] does, but without pictures: the material file names them in `folder`,
/// which is relative to it.
///
/// # Errors
/// As [`save`].
pub fn save_naming(
    mesh: &TriMesh,
    path: &Path,
    folder: &str,
    control: Control,
) -> Result<(), FileError> {
    let placed = TextureFolder { materials: named(&mesh.materials, folder), files: Vec::new() };
    save_with(mesh, path, &placed, control)
}

/// Which textures of a mesh do not lie beside the file that it was saved at: those that were not
/// read, and those that are not in the folder that the materials name, if it is named.
pub fn textures_not_there(mesh: &TriMesh, path: &Path, named: &str) -> Vec<String> {
    let folder = path.parent().map(|folder| folder.join(named)).unwrap_or_default();
    let missing = |texture: &Texture| {
        let name = shown_name(&texture.name);
        if texture.image.is_none() {
            Some(format!("texture {name} was not read, so it is not saved beside the mesh"))
        } else if !named.is_empty() && !folder.join(name_to_file(&texture.name)).is_file() {
            Some(format!("texture {name} does not lie in {named}, seen from the file"))
        } else {
            None
        }
    };
    mesh.materials.iter().flat_map(|material| &material.textures).filter_map(missing).collect()
}

fn save_with(
    mesh: &TriMesh,
    path: &Path,
    placed: &TextureFolder,
    control: Control,
) -> Result<(), FileError> {
    let write = |out: &mut dyn Write, mtl_name: Option<&str>| {
        write_obj(mesh, &mut ControlledWriter { out, control }, mtl_name)
    };
    if mesh.materials.is_empty() {
        return save_atomic(path, |out| write(out, None));
    }
    let refuse = |source| FileError::write(path, source);
    let mtl_path = path.with_extension("mtl");
    let Some(mtl_name) = mtl_path.file_name().map(name_from_file) else {
        return Err(refuse(io::Error::from(io::ErrorKind::IsADirectory)));
    };
    if mtl_path == path {
        let message = "that is the name of the material file; end it in .obj";
        return Err(refuse(io::Error::new(io::ErrorKind::InvalidInput, message)));
    }
    // A mesh that cannot be written must not cost the old materials.
    write(&mut io::sink(), Some(&mtl_name)).map_err(refuse)?;
    save_placed(placed, &folder_beside(path, TEXTURE_FOLDER), control)?;
    save_atomic(&mtl_path, |out| write_mtl(&placed.materials, out))?;
    save_atomic(path, |out| write(out, Some(&mtl_name)))
}

/// Saves the pictures of a mesh that is saved at `path` into the folder beside it whose name is the
/// stem and `ending`, and gives the materials that name them there.
///
/// # Errors
/// With the path, when `control` ends it or a file cannot be written.
pub fn save_pictures(
    materials: &[Material],
    path: &Path,
    ending: &str,
    control: Control,
) -> Result<Vec<Material>, FileError> {
    let folder = folder_beside(path, ending);
    let name = name_from_file(folder.file_name().unwrap_or_default());
    let placed = texture_folder(materials, &name);
    save_placed(&placed, &folder, control)?;
    Ok(placed.materials)
}

fn save_placed(placed: &TextureFolder, folder: &Path, control: Control) -> Result<(), FileError> {
    if !placed.files.is_empty() {
        fs::create_dir_all(folder).map_err(|source| FileError::write(folder, source))?;
    }
    for (name, image) in &placed.files {
        save_atomic(&folder.join(name_to_file(name)), |out| match image.encoded() {
            Some(bytes) => ControlledWriter { out, control }.write_all(bytes),
            // What has no bytes has pixels.
            None => image.pixels().map_or(Ok(()), |pixels| write_png(pixels, out, control)),
        })?;
    }
    Ok(())
}

/// The folder for the pictures of a mesh that is saved at `path`.
fn folder_beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

/// A writer that fails once the control says so.
struct ControlledWriter<'a> {
    out: &'a mut dyn Write,
    control: Control<'a>,
}

impl Write for ControlledWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.control.at(0.0).map_err(io::Error::other)?;
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The files that reading an OBJ file may open, whether they exist or not, without repeats: the
/// material files in the order of the file, each with the pictures that it names behind it. Their
/// contents decide with that of the OBJ file what is read. Where one of the statements can be
/// understood as one name with blanks or as several names, all of them are listed. An unreadable
/// file has none.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    const STATEMENT: &[u8] = b"mtllib";
    let Ok(bytes) = read_mesh_file(path, Control::none()) else { return Vec::new() };
    let folder = folder_of(path);
    let bounds = [FileScope::Folder, FileScope::Anywhere].map(|scope| Bounds::new(&folder, scope));
    let (mut paths, mut known) = (Vec::new(), HashSet::new());
    for line in bytes.split(|byte| matches!(byte, b'\n' | b'\r')) {
        // Almost no line gets beyond the first test.
        if !line.contains(&b'm') {
            continue;
        }
        let mut cursor = Cursor::new(line);
        cursor.skip_blanks();
        if cursor.word() != STATEMENT {
            continue;
        }
        for name in materials::candidates(&cursor.name()) {
            let path = folder.join(name_to_file(&name));
            if name.is_empty() || !known.insert(path.clone()) {
                continue;
            }
            let bytes = read_plain(&path, MAX_MTL_BYTES).unwrap_or_default();
            paths.push(path);
            let folders = texture_folders(&folder, &name);
            let materials = parse_mtl(&bytes).0;
            for texture in materials.iter().flat_map(|material| &material.textures) {
                for bounds in &bounds {
                    let (path, _) = textures::find(&texture.name, &folders, bounds);
                    if known.insert(path.clone()) {
                        paths.push(path);
                    }
                }
            }
        }
    }
    paths
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}
