//! What a run gives.

use mve_mesh::data::TriMesh;

use super::blocked::Blocked;
use super::stop::Outcome;

/// A simplified mesh and how it came about.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// The result.
    pub mesh: TriMesh,
    /// Counts of the run.
    pub statistics: Statistics,
    /// How long its two parts took.
    pub seconds: Seconds,
}

impl Simplified {
    /// Adds the counts and seconds of a run with another cost that made the input of this one. The
    /// dearest collapse stays that of this one, as prices of two costs do not compare.
    pub fn add_start(&mut self, start: &Self) {
        let largest_cost = self.statistics.largest_cost;
        self.statistics.add(&start.statistics);
        self.statistics.largest_cost = largest_cost;
        self.seconds.first_prices += start.seconds.first_prices;
        self.seconds.collapses += start.seconds.collapses;
    }
}

/// How long the parts of a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seconds {
    /// To link the mesh, let the cost look at it, and price every edge.
    pub first_prices: f64,
    /// To collapse edges and price their neighbors again, and to put the result together.
    pub collapses: f64,
}

/// Counts of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Faces of the result.
    pub n_faces: usize,
    /// The number of faces that the stops asked for, if they did.
    pub target_faces: Option<usize>,
    /// Why the run ended.
    pub outcome: Outcome,
    /// Collapses made.
    pub n_collapses: usize,
    /// Attempts that would have changed the topology. An edge may be tried again after its
    /// neighborhood has changed, and counts each time.
    pub n_rejected_link: usize,
    /// Attempts that would have turned a face too far or made it degenerate.
    pub n_rejected_flip: usize,
    /// Edges that the boundary policy, seams or a coordinate that is not finite forbids.
    pub n_rejected_boundary: usize,
    /// Collapses that turned a face by more than 45°, under [`Turns::Adaptive`](super::Turns).
    pub n_wide_turns: usize,
    /// What holds the edges that are left, where the number of faces was not reached.
    pub blocked: Option<Blocked>,
    /// Price of the dearest collapse made, if there was one; 0 if all were free.
    pub largest_cost: Option<f64>,
}

impl Statistics {
    /// Before the first collapse.
    pub(super) fn new(n_faces: usize, target_faces: Option<usize>) -> Self {
        Self {
            n_faces,
            target_faces,
            outcome: Outcome::Exhausted,
            n_collapses: 0,
            n_rejected_link: 0,
            n_rejected_flip: 0,
            n_rejected_boundary: 0,
            n_wide_turns: 0,
            blocked: None,
            largest_cost: None,
        }
    }

    /// Adds the collapses of a block.
    pub(super) fn add(&mut self, block: &Self) {
        self.n_collapses += block.n_collapses;
        self.n_rejected_link += block.n_rejected_link;
        self.n_rejected_flip += block.n_rejected_flip;
        self.n_wide_turns += block.n_wide_turns;
        let largest = self.largest_cost.into_iter().chain(block.largest_cost);
        self.largest_cost = largest.reduce(f64::max);
    }

    /// Counts a collapse at this price, and whether it turned a face far.
    pub(super) fn add_collapse(&mut self, price: f64, is_wide_turn: bool) {
        self.n_wide_turns += usize::from(is_wide_turn);
        self.n_collapses += 1;
        self.largest_cost = Some(self.largest_cost.map_or(price, |largest| largest.max(price)));
    }
}
