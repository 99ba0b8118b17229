//! The cheaper end of the edge: a half-edge collapse.
//!
//! The vertices of the result are vertices of the input, bit for bit, with their attributes.

use mve_core::Entry;

use super::{MakePlacement, Placement};
use crate::geometry::simplify::collapse::{Candidates, Collapsing, Ends};

pub static PLACEMENT: Entry<MakePlacement> = Entry {
    id: "Endpoint",
    summary: "The cheaper end of the edge: vertices of the result are vertices of the input.",
    params: &[],
    build: |_, _| Ok(Box::new(Endpoint)),
};

/// See the file's header. Stateless.
#[derive(Clone, Copy, Debug, Default)]
pub struct Endpoint;

impl Placement for Endpoint {
    fn propose(&self, state: &Collapsing, batch: &[Ends], out: &mut [Candidates]) {
        for (ends, out) in batch.iter().zip(out) {
            out.push(state.position(ends.kept));
            out.push(state.position(ends.gone));
        }
    }
}
