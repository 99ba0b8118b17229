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
use crate::prelude::*;

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
