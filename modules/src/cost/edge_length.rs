//! The length of the edge, in model units; the shortest edge collapses first.
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
            *price = mesh
                .position(proposal.contraction.kept)
                .distance(mesh.position(proposal.contraction.gone));
        }
    }
}
