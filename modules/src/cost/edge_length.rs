//! The length of the edge, in model units; the shortest edge collapses first. Where the corners of
//! a face merge, it is that of the longest of its edges.
//!
//! The simplest cost there is (H. Hoppe et al., "Mesh optimization", SIGGRAPH 1993, names it as
//! the naive strategy); it ignores where the new vertex goes.

use mve_core::Entry;

use super::{Cost, MakeCost};
use crate::geometry::simplify::collapse::{Batch, WorkingMesh};

pub static COST: Entry<MakeCost> = Entry {
    id: "EdgeLength",
    summary: "The length of the edge: the shortest collapses first.",
    params: &[],
    build: |_, _| Ok(Box::new(EdgeLength)),
};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct EdgeLength;

impl Cost for EdgeLength {
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        for (price, proposal) in prices.iter_mut().zip(batch) {
            *price = proposal.contraction.length_squared(|v| mesh.position(v)).sqrt();
        }
    }

    fn for_block(&self) -> Option<Box<dyn Cost>> {
        Some(Box::new(*self))
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::FaceId;
    use mve_mesh::fixtures::mesh_of;

    use super::*;
    use crate::geometry::simplify::collapse::trial::{face_price, first_prices};
    use crate::placement::Midpoint;
    use glam::DVec3;

    #[test]
    fn a_price_is_the_length_of_the_edge() {
        let corners = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let mesh = mesh_of(&corners, &[[0, 1, 2]]);
        let prices = first_prices(&mesh, &mut EdgeLength, &mut Midpoint);
        assert_eq!(prices, [(0, 1, 3.0), (0, 2, 4.0), (1, 2, 5.0)]);
        assert_eq!(face_price(&mesh, FaceId(0), DVec3::ZERO, &mut EdgeLength), 5.0);
    }
}
