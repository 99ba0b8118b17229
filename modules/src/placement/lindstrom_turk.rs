//! The placement of Lindstrom and Turk: volume and border are preserved, then the cost is least.
//!
//! P. Lindstrom and G. Turk, "Fast and memory efficient polygonal simplification", IEEE
//! Visualization 1998, section 4; see [`crate::geometry::simplify::lindstrom_turk`]. Where the
//! constraints determine no point, the middle of the edge is taken; the paper leaves such an edge.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Contraction, Reach, WorkingMesh};
use crate::geometry::simplify::lindstrom_turk::Patch;

pub static PLACEMENT: Entry<MakePlacement> = Entry {
    id: "LindstromTurk",
    summary: "Keeps the volume and the border, then makes the change of volume least (Lindstrom and \
              Turk 1998).",
    params: &[],
    build: |_, _| Ok(Box::new(LindstromTurk)),
};

/// See the file's header.
#[derive(Clone, Copy, Debug, Default)]
pub struct LindstromTurk;

impl Placement for LindstromTurk {
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates) {
        for (at, contraction) in batch.iter().enumerate() {
            let patch = Patch::around(mesh, contraction);
            let offset = patch.place().unwrap_or_else(|| patch.middle());
            out.push(at, mesh.position(contraction.kept) + offset);
        }
    }

    fn reach(&self) -> Reach {
        Reach::NEIGHBORS
    }
}
