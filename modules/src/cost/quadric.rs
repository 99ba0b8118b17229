//! See [`crate::geometry::simplify::quadric`].

use mve_core::Entry;

use super::MakeCost;
use crate::geometry::simplify::collapse::QuadricOptions;
pub use crate::geometry::simplify::quadric::Quadric;
use crate::prelude::*;

const BOUNDARY_WEIGHT: Param<f64> = Param::number(
    "boundary_weight",
    "How much a border or seam edge counts against a face of the same size; 0 lets borders shrink.",
    QuadricOptions::DEFAULT.boundary_weight,
)
.within((0.0, 1e6))
.usually((0.0, 1000.0));

const MEMORY: Param<f64> = Param::number(
    "memory",
    "How much the planes of all faces count that the ends of an edge stand for, against those of the \
     faces around it as they are. 1 is the classic quadric, which is fastest; with less the result \
     errs less.",
    0.1,
)
.within((0.0, 1.0));

pub static COST: Entry<MakeCost> = Entry {
    id: "Quadric",
    summary: "The squared distance of the new vertex from the planes of the faces that it stands \
              for, weighted by their area (Garland and Heckbert 1997).",
    params: &[BOUNDARY_WEIGHT.spec(), MEMORY.spec()],
    build: |_, settings| {
        let options = QuadricOptions {
            boundary_weight: settings.get(&BOUNDARY_WEIGHT)?,
            memory: settings.get(&MEMORY)?,
        };
        Ok(Box::new(Quadric { options }))
    },
};

#[cfg(test)]
mod tests {
    use mve_mesh::data::FaceId;
    use mve_mesh::fixtures::tetrahedron;

    use super::*;
    use crate::geometry::simplify::collapse::trial::{face_price, first_prices};
    use crate::placement::Endpoint;
    use glam::DVec3;

    #[test]
    fn a_price_is_the_weighted_squared_distance_from_the_planes() {
        // The corner at the origin has three planes of area 1/2, which count a third each; a leg of
        // length 1 to (1, 0, 0) leaves one of them by 1: (1/2) / 3. The other end has two of them
        // and the slanted face of area √3/2 at distance 1/√3: (√3/2) (1/3) / 3. The dearer is not
        // taken.
        let prices = first_prices(&tetrahedron(), &mut Quadric::default(), &mut Endpoint);
        let expected = f64::min(0.5 / 3.0, 3f64.sqrt() / 2.0 / 3.0 / 3.0);
        let (_, _, price) = prices[0];
        assert!((price - expected).abs() < 1e-9, "{price} {expected}");
        assert_eq!((prices.len(), COST.id), (6, "Quadric"));
    }

    #[test]
    fn a_face_counts_the_planes_of_its_three_corners() {
        // The face in z = 0 has that plane at all of its corners: three times (1/2) / 3. The other
        // three planes go through (0, 0, 1).
        let price = |p| face_price(&tetrahedron(), FaceId(0), p, &mut Quadric::default());
        assert!((price(DVec3::Z) - 0.5).abs() < 1e-9, "{}", price(DVec3::Z));
        // At the corner in the origin there is left what two corners have of the slanted plane of
        // area √3/2 at distance 1/√3: 2 (√3/2) (1/3) / 3.
        let expected = 3f64.sqrt() / 9.0;
        assert!((price(DVec3::ZERO) - expected).abs() < 1e-9, "{}", price(DVec3::ZERO));
    }
}
