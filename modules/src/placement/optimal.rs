//! The point of least quadric error (Garland and Heckbert 1997, section 4).
//!
//! Rule for singular systems: the search starts in the middle of the edge and moves only along
//! directions that the planes determine, so a flat area gives the projection of the midpoint onto
//! the plane and a straight crease its projection onto the crease; the derivation stands at
//! [`Quadric::minimum_near`](crate::mesh::quadric::Quadric::minimum_near). A vertex without planes
//! takes the midpoint.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Contraction, QuadricOptions, WorkingMesh};
use crate::prelude::*;

const STIFFNESS: Param<f64> = Param::number(
    "stiffness",
    "The share of the quadric's largest part below which a direction counts as flat, and the \
     vertex does not move along it.",
    Optimal::DEFAULT.stiffness,
)
.within((1e-12, 1.0))
.usually((1e-8, 1e-2));

pub static PLACEMENT: Entry<MakePlacement> = Entry {
    id: "Optimal",
    summary: "Where the quadric error is least; along directions that no plane determines, the \
              middle of the edge.",
    params: &[STIFFNESS.spec()],
    build: |_, settings| {
        Ok(Box::new(Optimal { stiffness: settings.get(&STIFFNESS)?, ..Optimal::DEFAULT }))
    },
};

/// See the file's header. The quadrics themselves live in the engine's mesh.
#[derive(Clone, Copy, Debug)]
pub struct Optimal {
    /// The share of the sum of eigenvalues below which a direction counts as undetermined.
    /// Twice the square root of it is about the angle in radians by which a surface
    /// must bend around the edge before the bend pulls the vertex along it.
    pub stiffness: f64,
    /// Which planes the quadrics sum, when the cost asks for none.
    pub options: QuadricOptions,
}

impl Optimal {
    /// The default.
    pub const DEFAULT: Self = Self { stiffness: 1e-6, options: QuadricOptions::DEFAULT };
}

impl Default for Optimal {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Placement for Optimal {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, Contraction { kept, gone, quadric, .. }) in batch.iter().enumerate() {
            let (from, to) = (mesh.position(*kept), mesh.position(*gone));
            let middle = 0.5 * (to - from);
            out.push(at, from + quadric.minimum_near(middle, self.stiffness).unwrap_or(middle));
        }
    }

    // The minimum of a sum is at least that of a part, and the sums only gain parts.
    fn only_grows(&self) -> bool {
        true
    }

    fn quadrics(&self) -> Option<QuadricOptions> {
        Some(self.options)
    }
}
