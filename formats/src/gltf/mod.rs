//! glTF 2.0 files: `.gltf`, JSON with buffers inside or beside, and `.glb`, all in one.
//!
//! After "glTF 2.0 Specification", Khronos Group, 2.0.1, 2021, also ISO/IEC 12113:2022.
//! `document.rs` is what the JSON says, `buffers.rs` and `accessor.rs` give its numbers, `scene.rs`
//! says where meshes stand, `assembly.rs` puts them together.
//!
//! Read are triangles, strips and fans of all nodes of the scene, as one mesh where they stand,
//! with normals, colors, all sets of texture coordinates, numbers of programs (`_NAME`), and
//! materials with their pictures. The extensions KHR_mesh_quantization, EXT_meshopt_compression and
//! KHR_texture_transform are applied. Joints, shapes to morph into and animations are left out.
//!
//! Own code, since the crate `gltf` refuses a file that asks for an extension which it does not
//! know, and names neither the accessor nor the primitive that is wrong.

mod accessor;
mod assembly;
mod buffers;
mod container;
mod document;
mod file;
mod materials;
mod meshopt;
mod parts;
mod read;
mod scene;
mod surfaces;
mod transfer;
mod write;

pub use file::{companions, load};
pub use read::read_gltf;
pub use write::{save, write_glb};

/// Which vertices a mesh has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vertices {
    /// One at each place of each node. A vertex of glTF has one normal and one texture coordinate,
    /// so files repeat those on seams, and a surface would be open there.
    Welded,
    /// Those of the file.
    AsInFile,
}

#[cfg(test)]
mod meshopt_tests;
#[cfg(test)]
mod read_tests;
#[cfg(test)]
mod write_tests;
