//! Distances between surfaces: a tree of triangles, samples, mean and largest distance,
//! attributes that moved.

mod boxes;
mod bulk;
pub mod bvh;
mod bvh_build;
mod bvh_cells;
mod bvh_split;
mod cells;
pub mod drift;
mod group;
pub mod hausdorff;
mod hausdorff_max;
mod items;
mod lists;
pub mod many;
pub mod point_triangle;
pub mod pointwise;
mod polygon;
pub mod sample;
pub mod vertex_shift;
