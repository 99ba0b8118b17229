//! The point of least quadric error (Garland and Heckbert 1997, section 4).
//!
//! Rule for singular systems: the search starts in the middle of the edge and moves only along
//! directions that the planes determine, so a flat area gives the projection of the midpoint onto
//! the plane and a straight crease its projection onto the crease; the derivation stands at
//! [`Quadric::minimum_near`](mve_mesh::quadric::Quadric::minimum_near). A vertex without planes
//! takes the midpoint. Where the corners of a face merge, its middle stands for that of the edge.
//!
//! Where quadrics forget planes, those of the tip of a thin limb are soon gone, and the planes that
//! are left let it shrink. There only places count that keep the volume (P. Lindstrom and G. Turk,
//! "Fast and memory efficient polygonal simplification", IEEE Visualization 1998, section 4).

use mve_mesh::quadric::Quadric;

use super::collapse::{Candidates, Contraction, Placement, QuadricOptions, WorkingMesh};

/// The plane of the places that keep the volume counts so many times as all others.
const VOLUME_WEIGHT: f64 = 1000.0;

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
        for (at, contraction) in batch.iter().enumerate() {
            let Contraction { kept, gone, also_gone, quadric, volume_plane } = contraction;
            let from = mesh.position(*kept);
            let along = mesh.position(*gone) - from;
            let middle =
                also_gone.map_or(0.5 * along, |third| (along + mesh.position(third) - from) / 3.0);
            let (mut quadric, mut stiffness) = (*quadric, self.stiffness);
            if let Some((normal, volume)) = *volume_plane {
                let weight = VOLUME_WEIGHT * quadric.weight();
                quadric.add(&Quadric::from_plane(normal, volume, weight));
                // A direction is as flat as it was.
                stiffness /= 1.0 + VOLUME_WEIGHT;
            }
            out.push(at, from + quadric.minimum_near(middle, stiffness).unwrap_or(middle));
        }
    }

    fn gives_way(&self) -> bool {
        true
    }

    fn for_block(&self) -> Option<Box<dyn Placement>> {
        Some(Box::new(*self))
    }

    // The minimum of a sum is at least that of a part, and the sums only gain parts.
    fn only_grows(&self) -> bool {
        true
    }

    fn quadrics(&self) -> Option<QuadricOptions> {
        Some(self.options)
    }
}
