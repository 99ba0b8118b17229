//! Simplification: one folder a family of methods.

pub mod collapse;
pub mod lindstrom_turk;
pub mod refit;
