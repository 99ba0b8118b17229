//! What a surface is like and how it is made finer: counts, normals, subdivision; vertices joined
//! and split.

mod butterfly;
pub mod components;
pub mod field_statistics;
pub mod folds;
pub mod mesh_info;
pub mod normals;
pub mod split;
pub mod subdivide;
pub mod weld;
