//! Triangle meshes, the algorithms on them, and the modules, costs and metrics of mve.
//!
//! `data` is what flows through ports; `mesh` and `geometry` are plain data and free functions
//! over it, with no ports; the other folders hold one file per module, cost, placement or metric.

pub mod cost;
pub mod data;
pub mod geometry;
pub mod mesh;
pub mod placement;
