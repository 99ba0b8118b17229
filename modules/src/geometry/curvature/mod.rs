//! Curvature of a surface at its vertices: mean, Gaussian, principal, with directions.
//!
//! Convex is positive where the faces are counter-clockwise from outside: a sphere of radius r has
//! principal curvatures 1/r. What is not defined is not a number, and a direction of length 0.

mod discrete;
mod quadric_fit;

pub use discrete::discrete;
pub use quadric_fit::{FitOptions, quadric_fit};

use glam::DVec3;

use mve_mesh::data::TriMesh;

/// Vertices that are worked on in one piece.
const CHUNK: usize = 1 << 10;

/// The curvature at one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// Half the sum of the principal curvatures, in 1 / model unit.
    pub mean: f64,
    /// The product of the principal curvatures, in 1 / model unit².
    pub gaussian: f64,
    /// The larger principal curvature, signed.
    pub maximum: f64,
    /// The smaller principal curvature, signed.
    pub minimum: f64,
    /// The direction in which the surface bends by `maximum`, a unit vector; its sign means
    /// nothing.
    pub max_direction: DVec3,
    /// The direction in which the surface bends by `minimum`, a unit vector; its sign means
    /// nothing.
    pub min_direction: DVec3,
}

impl Curvature {
    /// Where there is none.
    pub const UNDEFINED: Self = Self {
        mean: f64::NAN,
        gaussian: f64::NAN,
        maximum: f64::NAN,
        minimum: f64::NAN,
        max_direction: DVec3::ZERO,
        min_direction: DVec3::ZERO,
    };

    /// The curvature of the same surface at `scale` times its size.
    fn scaled(self, scale: f64) -> Self {
        Self {
            mean: self.mean / scale,
            gaussian: self.gaussian / scale / scale,
            maximum: self.maximum / scale,
            minimum: self.minimum / scale,
            ..self
        }
    }
}

/// The points of a mesh moved to the origin and scaled to about 1, so that no square over- or
/// underflows, and the scale.
fn normalized(mesh: &TriMesh) -> (TriMesh, f64) {
    let (low, high) = mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ZERO));
    let center = 0.5 * low + 0.5 * high;
    let size = (0.5 * high - 0.5 * low).max_element();
    let is_plain = center.is_finite() && size.is_normal();
    let (center, scale) = if is_plain { (center, size) } else { (DVec3::ZERO, 1.0) };
    let positions = mesh.positions.iter().map(|p| (p - center) / scale).collect();
    (TriMesh::new(positions, mesh.faces.clone()), scale)
}

/// Two unit vectors at right angles to a unit normal and to each other (Duff et al., "Building an
/// orthonormal basis, revisited", JCGT 2017).
fn tangents(normal: DVec3) -> [DVec3; 2] {
    let (first, second) = normal.any_orthonormal_pair();
    [first, second]
}

/// Eigenvalues of the symmetric matrix (a, b; b, c), the larger first, and the unit eigenvector of
/// the larger; (1, 0) where both are equal.
fn eigen(a: f64, b: f64, c: f64) -> ([f64; 2], [f64; 2]) {
    let (middle, half) = (0.5 * (a + c), 0.5 * (a - c));
    let radius = half.hypot(b);
    let angle = 0.5 * b.atan2(half);
    ([middle + radius, middle - radius], [angle.cos(), angle.sin()])
}

#[cfg(test)]
mod tests;
