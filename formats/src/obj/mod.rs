//! Wavefront OBJ and its material files (MTL).
//!
//! After "Object Files (.obj)", Wavefront Technologies, Advanced Visualizer Manual, appendix B1,
//! 1992. One file gives one mesh. Vertices keep their number and order: vertex i of the mesh is
//! the file's vertex i + 1, used by a face or not. Texture coordinates and normals keep theirs and
//! are corner layers; objects, groups, materials and smoothing groups are face layers; colors after
//! the coordinates are a vertex layer. Polygons are cut into triangles on their own vertices, so
//! that n corners give n - 2 triangles in the place of the polygon (see `formats/polygon`).
//!
//! The reader takes what files in the wild contain: any line end, continued lines, comments
//! anywhere, faces before their vertices, names that are not UTF-8, numbers as old programs spell
//! them, lines of no known kind. What is left out is reported as a [`Warning`], a face, normal or
//! texture coordinate with a number that is not there among them; what spoils the file is an
//! [`ObjError`] with its line. Left out without a word, since they say nothing about the surface:
//! display attributes. Left out with a warning: points, lines, free-form curves and surfaces, the
//! weight `w` of a vertex, the third texture coordinate.
//!
//! Pictures that materials name are read with them ([`load`]) and written beside them ([`save`]).
//!
//! The crate tobj reads OBJ too and is the peer in the tests. It is not used because it gives one
//! mesh a group with vertices renumbered, duplicated and dropped, errors without a line, and fans
//! for concave polygons.

pub(super) mod bounds;
mod builder;
pub(super) mod cursor;
mod file;
mod kind;
mod materials;
pub(super) mod number;
mod parse;
pub(super) mod textures;
mod trouble;
mod write;

use std::io;
use std::path::Path;

use mve_core::ModuleError;
use mve_mesh::data::Material;
use thiserror::Error;

use super::FileError;
use super::warnings::{Warning, Warnings};

pub use bounds::FileScope;
pub use file::{
    TEXTURE_FOLDER, companions, load, load_within, save, save_naming, save_pictures,
    textures_not_there,
};
pub use materials::parse_mtl;
pub use parse::parse;
pub use write::{write_mtl, write_obj};

/// Gives the content of the MTL file of this name, as the OBJ file names it.
pub type MtlSource<'a> = dyn FnMut(&str) -> io::Result<Vec<u8>> + 'a;

/// What reading the text of an OBJ file asks for: the material files that it names, and the
/// pictures that these name.
trait Companions {
    /// The content of the material file of this name, as the OBJ file says it.
    fn material_file(&mut self, name: &str) -> io::Result<Vec<u8>>;

    /// Gives the textures of the materials of that file their pictures.
    fn pictures(&mut self, library: &str, materials: &mut [Material], warnings: &mut Warnings);
}

/// Why an OBJ file could not be read.
#[derive(Debug, Error)]
pub enum ObjError {
    /// A line says something wrong.
    #[error("line {line}: found {found}, expected {expected}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What should.
        expected: String,
    },
    /// The file has no vertex.
    #[error("no vertices: is it an OBJ file?")]
    NoVertices,
    /// The file is of another kind.
    #[error("line {line}: not an OBJ file, which is text: {kind}")]
    NotObj {
        /// The line, from 1, where that shows.
        line: usize,
        /// What it is instead.
        kind: &'static str,
    },
    /// More elements than an index can name.
    #[error("line {line}: more than 4,294,967,294 {what}; split the file")]
    TooMany {
        /// The line, from 1, of the first that is too much.
        line: usize,
        /// Of what.
        what: &'static str,
    },
    /// The control ended it.
    #[error("cancelled")]
    Cancelled,
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
}

impl ObjError {
    /// The error of a module that reads this file.
    pub fn about(self, path: &Path) -> ModuleError {
        match self {
            Self::Cancelled => ModuleError::Cancelled,
            // It names its file, which need not be this one.
            Self::File(error) => error.into(),
            other => ModuleError::io(path, other.to_string()),
        }
    }
}

#[cfg(test)]
mod fuzz_tests;
#[cfg(test)]
mod model_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod texture_tests;
#[cfg(test)]
mod trouble_tests;
