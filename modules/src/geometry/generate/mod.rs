//! Meshes made from a few numbers: closed, manifold, welded and oriented outwards.
//!
//! At their default options they have the sizes of the classic test set of a box, a surface and a
//! vase: 768, 4,352 and 7,808 triangles. The same options give the same bits.

pub mod subdivided_box;
pub mod surface;
pub mod vase;

pub use subdivided_box::{BoxOptions, subdivided_box};
pub use surface::{SurfaceOptions, surface};
pub use vase::{VaseOptions, vase};

use crate::data::VertexId;

/// The two triangles of a quadrilateral that is counter-clockwise from outside.
fn quad(corners: [u32; 4]) -> [[VertexId; 3]; 2] {
    let [a, b, c, d] = corners.map(VertexId);
    [[a, b, c], [a, c, d]]
}

#[cfg(test)]
mod checks;
