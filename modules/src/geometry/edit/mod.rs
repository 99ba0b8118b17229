//! Changes of a mesh that keep what its layers say: moved, turned, cut, taken apart, put together,
//! cleaned.

pub mod clean;
pub mod crop;
pub mod holes;
pub mod manifold;
pub mod merge;
pub mod orient;
pub mod parts;
pub mod place;
pub mod rebuild;
pub mod transform;

#[cfg(test)]
pub(super) mod checks;
