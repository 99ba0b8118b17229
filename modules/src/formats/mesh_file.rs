//! Mesh files of any format that mve reads, told apart by how they begin.

use std::path::{Path, PathBuf};

use mve_core::{Control, ModuleError};

use super::obj::{self, FileScope};
use super::plain_file::{load_with, read_beginning};
use super::warnings::Warning;
use super::{off, ply, stl};
use crate::data::TriMesh;

/// Bytes at the beginning of a file that say what it is.
const N_BYTES: u64 = 4096;

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    Ply,
    Stl,
    Off,
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
            _ if word.ends_with(b"OFF") && word.len() <= 8 => Self::Off,
            _ if word.eq_ignore_ascii_case(b"solid") || !is_text => Self::Stl,
            _ => Self::Obj,
        }
    }

    fn of_file(path: &Path) -> Option<Self> {
        read_beginning(path, N_BYTES).ok().map(|bytes| Self::of(&bytes))
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
    match Format::of_file(path) {
        Some(Format::Ply) => ply::load(path, scope, control),
        Some(Format::Stl) => load_with(path, control, stl::read_stl),
        Some(Format::Off) => load_with(path, control, off::read_off),
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
        Some(Format::Stl | Format::Off) | None => Vec::new(),
    }
}
