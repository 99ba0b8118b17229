//! Plain data about meshes: fixtures, adjacency, quadrics.

pub mod adjacency;
pub mod fixtures;
pub mod quadric;
#[cfg(test)]
pub mod test_models;
pub mod union_find;
