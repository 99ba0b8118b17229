//! PLY files: meshes with colors, normals and a field, for viewers.
//!
//! Source of the format: G. Turk, "The PLY polygon file format", 1994; names of properties as
//! MeshLab, VTK and Blender read them.

mod write;

pub use write::{Encoding, PlyOptions, Precision, write_ply};

#[cfg(test)]
mod tests;
