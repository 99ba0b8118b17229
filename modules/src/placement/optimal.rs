//! See [`crate::geometry::simplify::optimal`].

use mve_core::Entry;

use super::MakePlacement;
pub use crate::geometry::simplify::optimal::Optimal;
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

#[cfg(test)]
mod tests {
    use mve_mesh::data::FaceId;
    use mve_mesh::fixtures::tetrahedron;

    use super::*;
    use crate::geometry::simplify::collapse::trial::{face_places, first_places};
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
