//! The memoryless cost of Lindstrom and Turk, in model units to the sixth power (volume²).
//!
//! P. Lindstrom and G. Turk, "Fast and memory efficient polygonal simplification", IEEE
//! Visualization 1998, section 4, with λ = ½; see [`crate::geometry::simplify::lindstrom_turk`].
//! Half of the squared volumes between the new vertex and the faces around the edge, and half of
//! the squared areas between it and border edges, times the squared length of the edge.

use mve_core::Entry;

use super::{Cost, MakeCost};
use crate::geometry::simplify::collapse::{Batch, Reach, Renewal, WorkingMesh};
use crate::geometry::simplify::lindstrom_turk::Patch;

pub static COST: Entry<MakeCost> = Entry {
    id: "LindstromTurk",
    summary: "The squared volumes between the new vertex and the faces around the edge as they are \
              (Lindstrom and Turk 1998), without memory of the input.",
    params: &[],
    build: |_, _| Ok(Box::new(LindstromTurk)),
};

/// See the file's header.
#[derive(Clone, Copy, Debug, Default)]
pub struct LindstromTurk;

impl Cost for LindstromTurk {
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        for (price, proposal) in prices.iter_mut().zip(batch) {
            let offset = proposal.position - mesh.position(proposal.contraction.kept);
            *price = Patch::cost(mesh, &proposal.contraction, offset).unwrap_or(f64::NAN);
        }
    }

    fn for_block(&self) -> Option<Box<dyn Cost>> {
        Some(Box::new(*self))
    }

    fn reach(&self) -> Reach {
        Reach::NEIGHBORS
    }

    fn renewal(&self) -> Renewal {
        Renewal::Lazy
    }

    // As of Quadric.
    fn waiting_share(&self) -> f64 {
        0.7
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::FaceId;
    use mve_mesh::fixtures::{mesh_of, tetrahedron};

    use super::*;
    use crate::geometry::simplify::collapse::trial::{face_price, first_prices};
    use crate::placement::Endpoint;
    use glam::DVec3;

    #[test]
    fn a_price_is_half_of_the_squared_volumes() {
        // All faces of a tetrahedron touch each of its edges. From a corner three of them are flat,
        // and the fourth spans the whole volume of 1/6.
        for (_, _, price) in first_prices(&tetrahedron(), &mut LindstromTurk, &mut Endpoint) {
            assert!((price - 0.5 / 36.0).abs() < 1e-15, "{price}");
        }
        // So do those around a face; from the middle of it, x = y = 1/3 and z = 0, three faces span
        // 1/18 each.
        let middle = DVec3::new(1.0, 1.0, 0.0) / 3.0;
        let price = face_price(&tetrahedron(), FaceId(0), middle, &mut LindstromTurk);
        assert!((price - 0.5 * 3.0 / 324.0).abs() < 1e-15, "{price}");
    }

    #[test]
    fn border_edges_count_by_the_areas_that_they_sweep() {
        // A triangle in its plane: no volume. The edge along y = 0, of length 2, to its end at the
        // origin: of the three border edges one is off, the side opposite to that end, and with it
        // spans the whole area of 1: half of 1 × 2². Of length √2 and to the same end: half of 2.
        let mesh = mesh_of(&[[0.0; 3], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]], &[[0, 1, 2]]);
        let prices = first_prices(&mesh, &mut LindstromTurk, &mut Endpoint);
        let found: Vec<f64> = prices.iter().map(|(_, _, price)| *price).collect();
        for (price, expected) in found.iter().zip([2.0, 1.0, 1.0]) {
            assert!((price - expected).abs() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn borders_of_fans_that_touch_in_one_vertex_are_seen() {
        // Two triangles in a plane that share the origin alone, in every order of their corners, so
        // that in some the numbers behind the origin and those before it have one sum. No face has
        // a volume, so what an edge costs is what border edges sweep: a triangle at least.
        let points =
            [[0.0; 3], [1.0, 0.2, 0.0], [0.2, 1.0, 0.0], [-1.0, 0.5, 0.0], [-0.4, -1.0, 0.0]];
        let orders = (0..256_u32).map(|k| [0, 2, 4, 6].map(|bit| 1 + (k >> bit & 3)));
        for [a, b, c, d] in orders.filter(|order| (1..5).all(|v| order.contains(&v))) {
            let mesh = mesh_of(&points, &[[0, a, b], [0, c, d]]);
            let prices = first_prices(&mesh, &mut LindstromTurk, &mut Endpoint);
            assert!(prices.iter().all(|(_, _, price)| *price > 1e-3), "{prices:?}");
        }
    }

    #[test]
    fn faces_that_are_nowhere_make_nothing_cheap() {
        // Faces at the edge from 0 to 1, one of them with a corner that is not a number.
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1.0, 0.5], [0.5, -1.0, 0.5], [f64::NAN; 3]];
        let mesh = mesh_of(&points, &[[0, 1, 2], [1, 0, 3], [0, 2, 4]]);
        let prices = first_prices(&mesh, &mut LindstromTurk, &mut Endpoint);
        let at = prices.iter().find(|(from, to, _)| (*from, *to) == (0, 1)).unwrap();
        assert!(at.2 > 1e-3, "{prices:?}");
    }

    #[test]
    fn a_hub_of_very_many_faces_takes_no_square_of_time() {
        // A cone over 20,000 points: each edge at its tip sees all faces.
        let n = 20_000_u32;
        let angle = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
        let ring = (0..n).map(|i| [angle(i).cos(), angle(i).sin(), 0.0]);
        let points: Vec<_> = std::iter::once([0.0, 0.0, 1.0]).chain(ring).collect();
        let faces: Vec<_> = (0..n).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        let prices = first_prices(&mesh_of(&points, &faces), &mut LindstromTurk, &mut Endpoint);
        let (at_tip, others): (Vec<_>, Vec<_>) = prices.iter().partition(|(from, _, _)| *from == 0);
        assert!(at_tip.iter().all(|(_, _, price)| !price.is_finite()));
        assert_eq!(others.len(), n as usize);
    }
}
