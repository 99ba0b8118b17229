//! The middle of the edge.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Collapsing, Ends};

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
    fn propose(&self, state: &Collapsing, batch: &[Ends], out: &mut [Candidates]) {
        for (ends, out) in batch.iter().zip(out) {
            out.push(state.position(ends.kept).midpoint(state.position(ends.gone)));
        }
    }
}
