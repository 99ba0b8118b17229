//! Distances between surfaces: a tree of triangles, samples, mean and largest distance,
//! attributes that moved.

mod boxes;
mod bulk;
pub mod bvh;
mod bvh_build;
mod bvh_split;
pub mod drift;
pub mod hausdorff;
mod hausdorff_max;
pub mod many;
mod pieces;
pub mod point_triangle;
pub mod sample;
