//! The middle of the edge.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Contraction, WorkingMesh};

pub static PLACEMENT: Entry<MakePlacement> = Entry {
    id: "Midpoint",
    summary: "The middle of the edge.",
    params: &[],
    build: |_, _| Ok(Box::new(Midpoint)),
};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint;

impl Placement for Midpoint {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, Contraction { kept, gone, .. }) in batch.iter().enumerate() {
            out.push(at, mesh.position(*kept).midpoint(mesh.position(*gone)));
        }
    }
}
