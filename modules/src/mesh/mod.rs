//! Plain data about meshes: fixtures, adjacency, quadrics.

pub mod fixtures;
pub mod quadric;
