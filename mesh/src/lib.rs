//! Triangle meshes and what else flows through ports, and what algorithms and file formats on them
//! stand on: adjacency, orders, quadrics, vertices that are joined and split.

pub mod adjacency;
pub mod data;
pub mod fixtures;
pub mod morton;
pub mod quadric;
pub mod random;
pub mod split;
#[doc(hidden)]
pub mod testing;
pub mod union_find;
pub mod weld;
