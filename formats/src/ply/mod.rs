//! PLY files: polygons with any properties.
//!
//! `header.rs` says what rows there are, `read.rs` reads them.
//!
//! Source of the format: G. Turk, "The PLY polygon file format", 1994; names of properties as
//! MeshLab, VTK and Blender read them.

mod file;
mod fixed;
mod header;
mod read;
mod save;
mod source;
mod write;

pub use file::{companions, load};
pub use read::read_ply;
pub use save::save;
pub use write::{Encoding, PlyOptions, Precision, write_ply};

#[cfg(test)]
mod read_tests;
#[cfg(test)]
mod tests;
