//! What a part that places the vertex of a collapse must do.
//!
//! A placement proposes up to three positions; the cost prices each and the cheapest that passes
//! the engine's tests wins, the first proposed among equals.

use super::mesh::WorkingMesh;
use super::observer::Collapse;
use super::options::QuadricOptions;
use super::proposal::{Candidates, Contraction, Reach};

/// Proposes positions for the vertex that an edge becomes.
pub trait Placement: Send {
    /// Proposes where the vertex of each contraction of the batch may go: `out.push(i, position)`
    /// for `batch[i]`, up to three times. A pure function of the mesh and of each edge
    /// alone, as prices are.
    fn propose(&self, mesh: &WorkingMesh, batch: &[Contraction], out: &mut Candidates);

    /// An equal placement for a block of the mesh that is simplified beside others, as
    /// [`Cost::for_block`](super::Cost::for_block).
    fn for_block(&self) -> Option<Box<dyn Placement>> {
        None
    }

    /// Whether it promises nothing of its places but that they are good, so that the least quadric
    /// error may stand for it where quadrics begin; otherwise it places those vertices, too.
    fn gives_way(&self) -> bool {
        false
    }

    /// Told of a collapse, with the mesh after it.
    fn collapsed(&mut self, _mesh: &WorkingMesh, _collapse: &Collapse) {}

    /// How far from a collapse proposals go stale.
    fn reach(&self) -> Reach {
        Reach::MERGED
    }

    /// Whether the least price among the candidates never falls by a collapse nearby, given a cost
    /// of which that holds for every position; see [`Cost::only_grows`](super::Cost::only_grows).
    fn only_grows(&self) -> bool {
        false
    }

    /// The quadrics that the working mesh must keep for this placement, if it reads any. Where the
    /// cost asks for quadrics too, the cost's options hold for both.
    fn quadrics(&self) -> Option<QuadricOptions> {
        None
    }
}
