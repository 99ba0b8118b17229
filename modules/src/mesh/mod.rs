//! What algorithms on meshes stand on: adjacency, orders, quadrics.

pub mod adjacency;
pub mod fixtures;
pub mod morton;
pub mod quadric;
#[cfg(test)]
pub mod test_models;
pub mod union_find;
