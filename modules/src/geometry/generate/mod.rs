//! Meshes made from a few numbers: manifold, welded and oriented outwards, and closed but for
//! planes and open cylinders.
//!
//! At their default options they have the sizes of the classic test set of a box, a surface and a
//! vase: 768, 4,352 and 7,808 triangles. The same options give the same bits.

pub mod cylinder;
pub mod plane;
pub mod sphere;
pub mod subdivided_box;
pub mod surface;
pub mod terrain;
pub mod texcoords;
pub mod torus;
pub mod vase;

use std::f64::consts::TAU;

pub use cylinder::{CylinderOptions, cylinder};
use glam::DVec3;
pub use plane::{PlaneOptions, plane};
pub use sphere::{ico_sphere, uv_sphere};
pub use subdivided_box::{BoxOptions, subdivided_box};
pub use surface::{SurfaceOptions, surface};
pub use torus::{TorusOptions, torus};
pub use vase::{VaseOptions, vase};

use mve_mesh::data::VertexId;

/// The two triangles of a quadrilateral that is counter-clockwise from outside.
fn quad(corners: [u32; 4]) -> [[VertexId; 3]; 2] {
    let [a, b, c, d] = corners.map(VertexId);
    [[a, b, c], [a, c, d]]
}

/// Points on a circle around z, counter-clockwise from x.
fn ring(radius: f64, height: f64, segments: u32) -> impl Iterator<Item = DVec3> {
    (0..segments).map(move |k| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(segments)).sin_cos();
        DVec3::new(radius * cos, radius * sin, height)
    })
}

#[cfg(test)]
mod checks;
