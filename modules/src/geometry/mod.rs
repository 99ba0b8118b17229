//! Algorithms as free functions over plain data; no ports.

pub mod bvh;
mod bvh_build;
pub mod color_map;
pub mod color_scale;
pub mod contact_sheet;
pub mod control;
pub mod curvature;
pub mod generate;
pub mod hausdorff;
mod hausdorff_max;
pub mod image_driven;
pub mod mesh_info;
mod morton;
pub mod msdm;
pub mod msdm2;
pub mod normals;
pub mod point_triangle;
pub mod render;
pub mod sample;
pub mod simplify;
pub mod ssim;
pub mod subdivide;
pub mod text;
