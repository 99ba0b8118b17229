//! The middle of the edge.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::data::VertexId;
use crate::geometry::simplify::{Candidates, Collapsing};

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
    fn propose(&self, state: &Collapsing, kept: VertexId, gone: VertexId, out: &mut Candidates) {
        out.push(state.position(kept).midpoint(state.position(gone)));
    }
}
