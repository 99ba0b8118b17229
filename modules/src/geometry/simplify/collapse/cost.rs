//! What a part that prices collapses must do.
//!
//! A cost is asked for prices in batches, so that a costly one can use all cores, and is told of
//! every collapse. It owns no queue, no link condition and no flip test, and must not decide
//! anything by the order in which it is asked.

use mve_core::{Cancelled, Control};

use super::mesh::WorkingMesh;
use super::observer::Collapse;
use super::options::QuadricOptions;
use super::proposal::{Batch, Contraction, Reach, Renewal};

/// What a collapse costs. The engine makes the cheapest collapse first.
///
/// Prices are compared only with each other; a price that is not a number forbids the collapse.
pub trait Cost: Send {
    /// Told of the mesh before anything else. What takes long reports to `control`.
    fn begin(&mut self, _mesh: &WorkingMesh, _control: Control) -> Result<(), Cancelled> {
        Ok(())
    }

    /// Prices every proposal of the batch: `prices[i]` for the `i`-th, equally long.
    ///
    /// A pure function of the mesh and of each proposal alone, so that a batch may be split over
    /// threads without changing a bit. The mesh is that before the collapse.
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]);

    /// An equal cost for a block of the mesh that is simplified beside others; `None` where prices
    /// read more than the faces around both ends, their corners and the quadrics of the ends, or
    /// where the cost remembers collapses.
    fn for_block(&self) -> Option<Box<dyn Cost>> {
        None
    }

    /// Told of a collapse, with the mesh after it.
    fn collapsed(&mut self, _mesh: &WorkingMesh, _collapse: &Collapse) {}

    /// How far from a collapse prices go stale.
    fn reach(&self) -> Reach {
        Reach::MERGED
    }

    /// Beyond which distance from a collapse no price changes by a single bit. A cost that lets
    /// distant prices go stale a little says more than [`Cost::reach`]; one for which no number of
    /// edges is enough, such as a cost that looks at pictures, says `None`. A test holds every
    /// registered cost to it.
    fn exact_reach(&self) -> Option<Reach> {
        Some(self.reach())
    }

    /// When prices that went stale are asked for again.
    fn renewal(&self) -> Renewal {
        Renewal::AtOnce
    }

    /// At which part of its earlier price a stale edge waits under [`Renewal::Lazy`]: so a price
    /// that falls is noticed in time unless it falls below that.
    fn waiting_share(&self) -> f64 {
        1.0 / 3.0
    }

    /// Whether a batch of prices is shared among threads.
    fn uses_threads(&self) -> bool {
        false
    }

    /// Whether a collapse that makes a poor shape should wait at a multiple of its price: so for
    /// prices that are errors, at least 0, of which a multiple says something. Other costs are
    /// obeyed as they are.
    fn is_patient(&self) -> bool {
        false
    }

    /// Whether a price is no more than rounding and what orders collapses of equal error: then the
    /// collapse costs nothing.
    fn is_free(&self, _mesh: &WorkingMesh, _contraction: &Contraction, price: f64) -> bool {
        price <= 0.0
    }

    /// A price above all that are [free](Cost::is_free). Asked once, and only where a largest cost
    /// is given.
    fn largest_free(&self, _mesh: &WorkingMesh, _control: Control) -> Result<f64, Cancelled> {
        Ok(0.0)
    }

    /// Whether the price of a position never falls by a collapse nearby. Where the placement says
    /// the same, an edge is priced again only when it comes up, which changes no result and
    /// saves most of the work.
    fn only_grows(&self) -> bool {
        false
    }

    /// Where nobody says otherwise: the multiple of the target down to which quadrics with all
    /// their memory, which are several times as fast, simplify first. `None`: this cost does all.
    fn head_start(&self) -> Option<f64> {
        None
    }

    /// The quadrics that the working mesh must keep for this cost, if it reads any.
    fn quadrics(&self) -> Option<QuadricOptions> {
        None
    }
}
