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
            let patch = Patch::around(mesh, &proposal.contraction);
            *price = patch.cost(proposal.position - mesh.position(proposal.contraction.kept));
        }
    }

    fn reach(&self) -> Reach {
        Reach::NEIGHBORS
    }

    fn renewal(&self) -> Renewal {
        Renewal::Lazy
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::FaceId;
    use crate::geometry::simplify::collapse::trial::{face_price, first_prices};
    use crate::mesh::fixtures::{mesh_of, tetrahedron};
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
}
