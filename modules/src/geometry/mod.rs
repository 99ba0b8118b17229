//! Algorithms on meshes, as free functions over plain data; no ports.

pub mod curvature;
pub mod distance;
pub mod edit;
pub mod generate;
pub mod perception;
pub mod relax;
pub mod simplify;
pub mod surface;
