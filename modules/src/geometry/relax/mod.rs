//! Moves the vertices of a mesh and nothing else: smoothing, and noise.

pub mod noise;
pub mod shading;
pub mod smooth;
pub mod weights;
