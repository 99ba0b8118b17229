//! Where the vertex of a collapse goes: the trait and the list of placements.
//!
//! A placement proposes up to three positions; the cost prices each and the cheapest that passes
//! the engine's tests wins, the first proposed among equals.

mve_core::registered! {
    static ENTRIES: Entry<MakePlacement> = PLACEMENT in endpoint, midpoint, optimal;
}

pub use endpoint::Endpoint;
pub use midpoint::Midpoint;
use mve_core::{Choices, Entry, ModuleError, Settings};
pub use optimal::Optimal;

use crate::data::TriMesh;
use crate::geometry::simplify::{Candidates, Collapse, Collapsing, Ends, QuadricOptions, Reach};

/// All placements, for the parameters of modules.
pub static PLACEMENTS: Choices<MakePlacement> = Choices { entries: ENTRIES };

/// Makes a placement for a mesh that is about to be simplified, from the placement's parameters.
pub type MakePlacement = fn(&TriMesh, &Settings) -> Result<Box<dyn Placement>, ModuleError>;

/// Proposes positions for the vertex that an edge becomes.
pub trait Placement: Send {
    /// Proposes where the vertex of each edge of the batch may go: `out[i]`, empty before, takes
    /// the candidates of `batch[i]`, equally long. A pure function of the state and of each edge
    /// alone, as prices are.
    fn propose(&self, state: &Collapsing, batch: &[Ends], out: &mut [Candidates]);

    /// Told of a collapse, with the state after it.
    fn collapsed(&mut self, _state: &Collapsing, _collapse: &Collapse) {}

    /// How far from a collapse proposals go stale.
    fn reach(&self) -> Reach {
        Reach::MERGED
    }

    /// Whether the least price among the candidates never falls by a collapse nearby, given a cost
    /// of which that holds for every position; see [`Cost::only_grows`](crate::cost::Cost).
    fn only_grows(&self) -> bool {
        false
    }

    /// The quadrics that the state must keep for this placement, if it reads any. Where the cost
    /// asks for quadrics too, the cost's options hold for both.
    fn quadrics(&self) -> Option<QuadricOptions> {
        None
    }
}
