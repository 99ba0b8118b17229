//! The point of least quadric error (Garland and Heckbert 1997, section 4).
//!
//! Rule for singular systems: the search starts in the middle of the edge and moves only along
//! directions that the planes determine, so a flat area gives the projection of the midpoint onto
//! the plane and a straight crease its projection onto the crease; the derivation stands at
//! [`Quadric::minimum_near`](crate::mesh::quadric::Quadric::minimum_near). A vertex without planes
//! takes the midpoint. Where the corners of a face merge, its middle stands for that of the edge.
//!
//! Where quadrics forget planes, those of the tip of a thin limb are soon gone, and the planes that
//! are left let it shrink. There only places count that keep the volume (P. Lindstrom and G. Turk,
//! "Fast and memory efficient polygonal simplification", IEEE Visualization 1998, section 4).

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Contraction, QuadricOptions, WorkingMesh};
use crate::geometry::simplify::lindstrom_turk::volume_plane;
use crate::mesh::quadric::Quadric;
use crate::prelude::*;

const STIFFNESS: Param<f64> = Param::number(
    "stiffness",
    "The share of the quadric's largest part below which a direction counts as flat, and the \
     vertex does not move along it.",
    Optimal::DEFAULT.stiffness,
)
.within((1e-12, 1.0))
.usually((1e-8, 1e-2));

/// The plane of the places that keep the volume counts so many times as all others.
const VOLUME_WEIGHT: f64 = 1000.0;

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
        for (at, Contraction { kept, gone, also_gone, quadric }) in batch.iter().enumerate() {
            let from = mesh.position(*kept);
            let along = mesh.position(*gone) - from;
            let middle =
                also_gone.map_or(0.5 * along, |third| (along + mesh.position(third) - from) / 3.0);
            let (mut quadric, mut stiffness) = (*quadric, self.stiffness);
            if mesh.forgets_planes()
                && let Some((normal, volume)) = volume_plane(mesh, &batch[at])
            {
                let weight = VOLUME_WEIGHT * quadric.weight();
                quadric.add(&Quadric::from_plane(normal, volume, weight));
                // A direction is as flat as it was.
                stiffness /= 1.0 + VOLUME_WEIGHT;
            }
            out.push(at, from + quadric.minimum_near(middle, stiffness).unwrap_or(middle));
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::FaceId;
    use crate::geometry::simplify::collapse::trial::{face_places, first_places};
    use crate::mesh::fixtures::tetrahedron;
    use glam::DVec3;

    #[test]
    fn three_planes_of_a_corner_and_the_slanted_one_pull_as_their_areas_say() {
        // The edge from the origin to (1, 0, 0). Planes x = 0 (once), y = 0 and z = 0 (twice each)
        // of weight w = 1/6, and x + y + z = 1 of weight √3 w, once: with s = (x + y + z − 1) / √3
        // the minimum has x = −s, 2 y = −s and 2 z = −s, so s (√3 + 2) = −1.
        let places = first_places(&tetrahedron(), &mut Optimal::default());
        let s = -1.0 / (3f64.sqrt() + 2.0);
        let expected = DVec3::new(-s, -s / 2.0, -s / 2.0);
        let (from, to, places) = &places[0];
        assert_eq!((*from, *to), (0, 1));
        assert!((places[0] - expected).length() < 1e-5, "{} {expected}", places[0]);
    }

    #[test]
    fn a_face_is_pulled_by_the_planes_of_its_three_corners() {
        // The face in z = 0: x = 0 and y = 0 twice each, z = 0 three times, the slanted one twice.
        // So 2 x = 2 y = 3 z = −2 s and s (√3 + 8/3) = −1.
        let places = face_places(&tetrahedron(), FaceId(0), &mut Optimal::default());
        let s = -1.0 / (3f64.sqrt() + 8.0 / 3.0);
        let expected = DVec3::new(-s, -s, -2.0 * s / 3.0);
        assert!((places[0] - expected).length() < 1e-5, "{} {expected}", places[0]);
    }
}
