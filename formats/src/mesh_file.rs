//! Mesh files of any format: read by how they begin, written by how their names end.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mve_core::{Control, ModuleError};
use mve_mesh::data::TriMesh;

use super::gltf::{self, Vertices};
use super::obj::{self, FileScope};
use super::plain_file::{load_with, read_beginning};
use super::ply::{Encoding, PlyOptions, Precision};
use super::stl::StlEncoding;
use super::warnings::Warning;
use super::{iv, off, ply, stl};

/// Bytes at the beginning of a file that say what it is.
const N_BYTES: u64 = 4096;

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    Ply,
    Stl,
    Off,
    Gltf,
    Iv,
}

impl Format {
    /// By the first bytes of a file. Text that is nothing else is OBJ, which may begin with
    /// anything.
    fn of(bytes: &[u8]) -> Self {
        let mut text = bytes.trim_ascii_start();
        while text.starts_with(b"#") {
            let length = text.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            text = text[length.unwrap_or(text.len())..].trim_ascii_start();
        }
        let word = text.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let is_text = !bytes.contains(&0);
        match word {
            b"ply" => Self::Ply,
            _ if ["#Inventor V", "#VRML V"]
                .iter()
                .any(|head| bytes.starts_with(head.as_bytes())) =>
            {
                Self::Iv
            }
            _ if bytes.starts_with(b"glTF") || text.starts_with(b"{") => Self::Gltf,
            _ if word.ends_with(b"OFF") && word.len() <= 8 => Self::Off,
            _ if word.eq_ignore_ascii_case(b"solid") || !is_text => Self::Stl,
            _ => Self::Obj,
        }
    }

    fn of_file(path: &Path) -> Option<Self> {
        read_beginning(path, N_BYTES).ok().map(|bytes| Self::of(&bytes))
    }
}

/// Whether a file that is not text has about the length that binary STL says of itself. Of a
/// compressed file the length is not known.
fn can_be_stl(path: &Path) -> bool {
    let Ok(bytes) = read_beginning(path, N_BYTES) else { return true };
    if bytes.trim_ascii_start().to_ascii_lowercase().starts_with(b"solid") {
        return true;
    }
    let mut raw = [0; 2];
    let file = File::open(path).and_then(|mut file| {
        let n_bytes = file.metadata()?.len();
        file.read_exact(&mut raw).map(|()| n_bytes)
    });
    let (Ok(n_bytes), Some(count)) = (file, bytes.get(80..84)) else { return true };
    let n_faces = count.iter().rev().fold(0, |n, byte| n << 8 | u64::from(*byte));
    raw == [0x1f, 0x8b] || n_bytes <= 2 * (84 + 50 * n_faces) + N_BYTES
}

/// Reads a file by its format's reader.
///
/// # Errors
/// As of the reader; that `control` ended the work.
pub fn load(
    path: &Path,
    scope: FileScope,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ModuleError> {
    if read_beginning(path, N_BYTES).is_ok_and(|bytes| bytes.trim_ascii().is_empty()) {
        return Err(ModuleError::io(path, "the file is empty"));
    }
    match Format::of_file(path) {
        Some(Format::Stl) if !can_be_stl(path) => Err(ModuleError::io(
            path,
            "is no mesh file that mve knows: it is not text, and not as long as an STL file of its \
             number of faces is; StlLoader reads it nonetheless",
        )),
        Some(Format::Ply) => ply::load(path, scope, control),
        Some(Format::Stl) => load_with(path, control, stl::read_stl),
        Some(Format::Off) => load_with(path, control, off::read_off),
        Some(Format::Gltf) => gltf::load(path, scope, Vertices::Welded, control),
        Some(Format::Iv) => iv::load(path, scope, control),
        // What cannot be read says so here.
        Some(Format::Obj) | None => {
            obj::load_within(path, scope, control).map_err(|error| error.about(path))
        }
    }
}

/// The files that reading one may open, whether they exist or not.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    match Format::of_file(path) {
        Some(Format::Obj) => obj::companions(path),
        Some(Format::Ply) => ply::companions(path),
        Some(Format::Gltf) => gltf::companions(path),
        Some(Format::Iv) => iv::companions(path),
        Some(Format::Stl | Format::Off) | None => Vec::new(),
    }
}

/// The endings of files that are written.
pub const WRITTEN: [&str; 6] = ["obj", "ply", "stl", "off", "glb", "iv"];

/// Saves a mesh as its saver does without parameters, by the ending of the file's name; what is
/// changed or left out comes back in sentences.
///
/// # Errors
/// With the path, where its ending is none of [`WRITTEN`], or as of the saver; that `control` ended
/// the work.
pub fn save(mesh: Arc<TriMesh>, path: &Path, control: Control) -> Result<Vec<String>, ModuleError> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    match ending.to_str() {
        Some("obj") => {
            obj::save(&mesh, path, control)?;
            Ok(obj::textures_not_there(&mesh, path, ""))
        }
        Some("ply") => {
            let options = PlyOptions { encoding: Encoding::Binary, precision: Precision::Float };
            ply::save(mesh, None, options, path, control)
        }
        Some("stl") => stl::save(&mesh, StlEncoding::Binary, path, control),
        Some("off") => off::save(&mesh, path, control),
        Some("glb") => gltf::save(&mesh, path, control),
        Some("iv") => iv::save(&mesh, path, control),
        _ => {
            let known = WRITTEN.map(|ending| format!(".{ending}")).join(", ");
            let message = format!("its ending says no format; end it in one of {known}");
            Err(ModuleError::io(path, message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_is_no_mesh() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ls");
        // Byte 80 of a program may be anything.
        let mut bytes = vec![0_u8; 50_000];
        (bytes[0], bytes[80]) = (0x7f, 64);
        std::fs::write(&path, &bytes).unwrap();
        let error = load(&path, FileScope::Folder, Control::none()).unwrap_err().to_string();
        assert!(error.contains("is no mesh file that mve knows"), "{error}");
        bytes.truncate(84 + 50 * 64);
        std::fs::write(&path, &bytes).unwrap();
        let (mesh, _) = load(&path, FileScope::Folder, Control::none()).unwrap();
        assert_eq!(mesh.faces.len(), 64);
    }
}
