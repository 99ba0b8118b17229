//! Algorithms on meshes, as free functions over plain data; no ports.

pub mod curvature;
pub mod distance;
pub mod generate;
pub mod perception;
pub mod simplify;
pub mod surface;
