//! What pointer and keys do with a picture of meshes.

pub mod navigation;
pub mod pick;
