//! File formats, without ports: what reads them from bytes and writes them.

mod file_error;
pub mod gltf;
pub mod iv;
pub mod mesh_file;
pub mod number_pattern;
pub mod obj;
pub mod off;
mod pieces;
pub mod plain_file;
pub mod ply;
pub mod png;
mod polygon;
mod raw_mesh;
mod rounding;
mod save;
pub mod stl;
pub mod table;
pub mod texture_file;
pub mod warnings;
mod words;

pub use file_error::{FileAction, FileError};
pub use plain_file::{ReadError, load, load_with};
pub use save::save_atomic;
