//! The cheaper end of the edge: a half-edge collapse.
//!
//! The vertices of the result are vertices of the input, bit for bit, with their attributes.

use super::Placement;
use crate::data::VertexId;
use crate::geometry::simplify::{Candidates, Collapsing};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct Endpoint;

impl Placement for Endpoint {
    fn propose(&self, state: &Collapsing, kept: VertexId, gone: VertexId, out: &mut Candidates) {
        out.push(state.position(kept));
        out.push(state.position(gone));
    }
}
