//! What pointer and keys do with a picture of meshes.

pub mod click;
pub mod navigation;
pub mod pick;
