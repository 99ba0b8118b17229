//! What a surface is like and how it is made finer: counts, normals, subdivision.

mod butterfly;
pub mod components;
pub mod field_statistics;
pub mod folds;
pub mod mesh_info;
pub mod normals;
pub mod subdivide;
