//! Simplification: one folder a family of methods, and what costs and placements share.

pub mod collapse;
pub mod lindstrom_turk;
pub mod optimal;
pub mod quadric;
pub mod refit;
