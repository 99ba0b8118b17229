//! Algorithms on meshes, as free functions over plain data; no ports.

pub mod cluster;
pub mod curvature;
pub mod decimate;
pub mod distance;
pub mod edit;
pub mod fields;
pub mod generate;
pub mod perception;
pub mod relax;
pub mod remesh;
pub mod select;
pub mod simplify;
pub mod surface;
pub mod transfer;
pub mod visibility;
