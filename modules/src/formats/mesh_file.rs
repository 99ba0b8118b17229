//! Mesh files of any format that mve reads, told apart by how they begin.

use std::path::{Path, PathBuf};

use mve_core::{Control, ModuleError};

use super::obj::{self, FileScope, ObjError};
use super::plain_file::{load_with, read_mesh_file};
use super::warnings::Warning;
use super::{off, ply, stl};
use crate::data::TriMesh;

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    Ply,
    Stl,
    Off,
}

impl Format {
    /// By the bytes of a file. Text that is nothing else is OBJ, which may begin with anything.
    fn of(bytes: &[u8]) -> Self {
        let text = bytes.trim_ascii_start();
        let word = text.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let is_text = !bytes[..bytes.len().min(4096)].contains(&0);
        match word {
            b"ply" => Self::Ply,
            _ if word.ends_with(b"OFF") && word.len() <= 8 => Self::Off,
            _ if word.eq_ignore_ascii_case(b"solid") || !is_text => Self::Stl,
            _ => Self::Obj,
        }
    }

    fn of_file(path: &Path, control: Control) -> Option<Self> {
        read_mesh_file(path, control).ok().map(|bytes| Self::of(&bytes))
    }
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
    match Format::of_file(path, control.part(0.0, 0.1)) {
        Some(Format::Ply) => ply::load(path, scope, control),
        Some(Format::Stl) => load_with(path, control, stl::read_stl),
        Some(Format::Off) => load_with(path, control, off::read_off),
        // What cannot be read says so here.
        Some(Format::Obj) | None => {
            obj::load_within(path, scope, control).map_err(|error| match error {
                ObjError::Cancelled => ModuleError::Cancelled,
                // It names its file, which need not be this one.
                ObjError::File(error) => error.into(),
                other => ModuleError::io(path, other.to_string()),
            })
        }
    }
}

/// The files that reading one may open, whether they exist or not.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    match Format::of_file(path, Control::none()) {
        Some(Format::Obj) => obj::companions(path),
        Some(Format::Ply) => ply::companions(path),
        Some(Format::Stl | Format::Off) | None => Vec::new(),
    }
}
