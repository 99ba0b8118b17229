//! Algorithms as free functions over plain data; no ports.

pub mod bvh;
mod bvh_build;
pub mod control;
pub mod generate;
pub mod hausdorff;
mod hausdorff_max;
pub mod mesh_info;
mod morton;
pub mod normals;
pub mod point_triangle;
pub mod render;
pub mod sample;
pub mod simplify;
pub mod ssim;
