//! STL files: triangles, each with three points of its own and a normal.
//!
//! After "SLA file formats", 3D Systems, StereoLithography Interface Specification, 1988. Points of
//! the same coordinates become one vertex. Normals say nothing that the corners do not, and many
//! programs write zeros, so they are passed over; so are the two bytes behind each binary triangle,
//! in which some programs keep colors, each in its own way.

mod file;
mod near;
mod points;
mod read;
mod records;
mod save;
mod weld;
mod write;

pub use file::load;
pub use read::read_stl;
pub use save::save;
pub use write::{StlEncoding, write_stl};

/// Bytes of the head of a binary file with the number of its triangles, and of each triangle.
const HEAD: usize = 84;
const RECORD: usize = 50;

#[cfg(test)]
mod tests;
