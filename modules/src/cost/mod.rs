//! The price of a collapse: the trait and the list of costs.
//!
//! A cost is asked for prices in batches, so that a costly one can use all cores, and is told of
//! every collapse. It owns no queue, no link condition and no flip test, and must not decide
//! anything by the order in which it is asked.

mod pictures;

mve_core::registered! {
    static ENTRIES: Entry<MakeCost> =
        COST in edge_length, image_mse, image_ssim, msdm2, quadric;
}

pub use edge_length::EdgeLength;
pub use image_mse::Squares;
pub use msdm2::Msdm2;
use mve_core::{Choices, Entry, ModuleError, Settings};
pub use quadric::Quadric;

use crate::data::TriMesh;
use crate::geometry::control::{Cancelled, Control};
use crate::geometry::simplify::{Collapse, Collapsing, Proposal, QuadricOptions, Reach, Renewal};

/// All costs, for the parameters of modules.
pub static COSTS: Choices<MakeCost> = Choices { entries: ENTRIES };

/// Makes a cost for a mesh that is about to be simplified, from the cost's parameters.
pub type MakeCost = fn(&TriMesh, &Settings) -> Result<Box<dyn Cost>, ModuleError>;

/// What a collapse costs. The engine makes the cheapest collapse first.
///
/// Prices are compared only with each other; a price that is not a number forbids the collapse.
pub trait Cost: Send {
    /// Told of the mesh before anything else. What takes long reports to `control`.
    fn begin(&mut self, _state: &Collapsing, _control: Control) -> Result<(), Cancelled> {
        Ok(())
    }

    /// Prices every proposal of the batch: `prices[i]` for `batch[i]`, equally long.
    ///
    /// A pure function of the state and of each proposal alone, so that a batch may be split over
    /// threads without changing a bit. The state is the mesh before the collapse.
    fn price(&self, state: &Collapsing, batch: &[Proposal], prices: &mut [f64]);

    /// Told of a collapse, with the state after it.
    fn collapsed(&mut self, _state: &Collapsing, _collapse: &Collapse) {}

    /// How far from a collapse prices go stale.
    fn reach(&self) -> Reach {
        Reach::MERGED
    }

    /// When prices that went stale are asked for again.
    fn renewal(&self) -> Renewal {
        Renewal::AtOnce
    }

    /// Whether a batch of prices is shared among threads.
    fn uses_threads(&self) -> bool {
        false
    }

    /// Whether the price of a position never falls by a collapse nearby. Where the placement says
    /// the same, an edge is priced again only when it comes up, which changes no result and
    /// saves most of the work.
    fn only_grows(&self) -> bool {
        false
    }

    /// The quadrics that the state must keep for this cost, if it reads any.
    fn quadrics(&self) -> Option<QuadricOptions> {
        None
    }
}
