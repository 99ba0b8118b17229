//! The middle of the edge.

use super::Placement;
use crate::data::VertexId;
use crate::geometry::simplify::{Candidates, Collapsing};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct Midpoint;

impl Placement for Midpoint {
    fn propose(&self, state: &Collapsing, kept: VertexId, gone: VertexId, out: &mut Candidates) {
        out.push(state.position(kept).midpoint(state.position(gone)));
    }
}
