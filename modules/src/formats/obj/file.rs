//! OBJ files with their material files on the disk.

use std::ffi::OsStr;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::cursor::{Comments, Cursor};
use super::{ObjError, Warning, materials, parse, write_mtl, write_obj};
use crate::data::TriMesh;
use crate::formats::plain_file::read_plain;
use crate::formats::{FileError, save_atomic};
use mve_core::Control;

/// Bytes of the largest material file that is read; real ones have a few thousand.
const MAX_MTL_BYTES: u64 = 64 << 20;

/// Reads an OBJ file and the material files that it names, which are relative to its folder.
///
/// # Errors
/// [`ObjError::File`] with the path when the file cannot be read, and those of
/// [`parse`](super::parse()).
pub fn load(path: &Path, control: Control) -> Result<(TriMesh, Vec<Warning>), ObjError> {
    let bytes = read_plain(path, u64::MAX).map_err(|source| FileError::read(path, source))?;
    let folder = folder_of(path);
    parse(&bytes, &mut |name| read_plain(&folder.join(name), MAX_MTL_BYTES), control)
}

/// Writes `mesh` as an OBJ file, and its materials, if there are any, as an MTL file of the same
/// stem beside it. The MTL file comes first, so that no OBJ file names one that is not there; each
/// file is replaced whole or not at all.
///
/// # Errors
/// With the path, when `control` ends it, a file cannot be written or the mesh cannot be said in the format (see
/// [`write_obj`]).
pub fn save(mesh: &TriMesh, path: &Path, control: Control) -> Result<(), FileError> {
    let write = |out: &mut dyn Write, mtl_name: Option<&str>| {
        write_obj(mesh, &mut Watched { out, control }, mtl_name)
    };
    if mesh.materials.is_empty() {
        return save_atomic(path, |out| write(out, None));
    }
    let refuse = |source| FileError::write(path, source);
    let mtl_path = path.with_extension("mtl");
    let Some(mtl_name) = mtl_path.file_name().map(OsStr::to_string_lossy) else {
        return Err(refuse(io::Error::from(io::ErrorKind::IsADirectory)));
    };
    if mtl_path == path {
        let message = "that is the name of the material file; end it in .obj";
        return Err(refuse(io::Error::new(io::ErrorKind::InvalidInput, message)));
    }
    // A mesh that cannot be written must not cost the old materials.
    write(&mut io::sink(), Some(&mtl_name)).map_err(refuse)?;
    save_atomic(&mtl_path, |out| write_mtl(&mesh.materials, out))?;
    save_atomic(path, |out| write(out, Some(&mtl_name)))
}

/// A writer that fails once the control says so.
struct Watched<'a> {
    out: &'a mut dyn Write,
    control: Control<'a>,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.control.at(0.0).map_err(io::Error::other)?;
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The material files that reading an OBJ file may open, whether they exist or not, without
/// repeats and in the order of the file. Their contents decide with that of the OBJ file what is
/// read. Where one of the statements can be understood as one name with blanks or as several
/// names, all of them are listed. An unreadable file has none.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    const STATEMENT: &[u8] = b"mtllib";
    let Ok(bytes) = read_plain(path, u64::MAX) else { return Vec::new() };
    let folder = folder_of(path);
    let mut paths = Vec::new();
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
        for name in materials::candidates(&cursor.text(Comments::Cut)) {
            let path = folder.join(&name);
            if !name.is_empty() && !paths.contains(&path) {
                paths.push(path);
            }
        }
    }
    paths
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}
