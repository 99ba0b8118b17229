//! The point of least quadric error (Garland and Heckbert 1997, section 4).
//!
//! Rule for singular systems: the search starts in the middle of the edge and moves only along
//! directions that the planes determine, so a flat area gives the projection of the midpoint onto
//! the plane and a straight crease its projection onto the crease; the derivation stands at
//! [`Quadric::minimum_near`](crate::mesh::quadric::Quadric::minimum_near). A vertex without planes
//! takes the midpoint.

use super::Placement;
use crate::data::VertexId;
use crate::geometry::simplify::{Candidates, Collapsing, QuadricOptions};

/// See the file's header. The quadrics themselves live in the engine's state.
#[derive(Clone, Copy, Debug)]
pub struct Optimal {
    /// The share of the sum of eigenvalues below which a direction counts as undetermined.
    /// Default 10⁻⁶; twice the square root of it is about the angle in radians by which a surface
    /// must bend around the edge before the bend pulls the vertex along it.
    pub stiffness: f64,
    /// Which planes the quadrics sum, when the cost asks for none.
    pub options: QuadricOptions,
}

impl Default for Optimal {
    fn default() -> Self {
        Self { stiffness: 1e-6, options: QuadricOptions::default() }
    }
}

impl Placement for Optimal {
    fn propose(&self, state: &Collapsing, kept: VertexId, gone: VertexId, out: &mut Candidates) {
        let (from, to) = (state.position(kept), state.position(gone));
        let middle = 0.5 * (to - from);
        let quadric = state.merged_quadric(kept, gone);
        out.push(from + quadric.minimum_near(middle, self.stiffness).unwrap_or(middle));
    }

    // The minimum of a sum is at least that of a part, and the sums only gain parts.
    fn only_grows(&self) -> bool {
        true
    }

    fn quadrics(&self) -> Option<QuadricOptions> {
        Some(self.options)
    }
}
