//! Algorithms as free functions over plain data; no ports.

pub mod bvh;
mod bvh_build;
pub mod control;
mod morton;
pub mod point_triangle;
