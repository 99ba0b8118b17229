//! Asks placement and cost, in batches of a size that keeps the control responsive.

use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

use mve_mesh::adjacency::EdgeId;

use super::attributes::SeamRule;
use super::complex::flag;
use super::cost::Cost;
use super::mesh::WorkingMesh;
use super::observer::Collapse;
use super::placement::Placement;
use super::proposal::{Candidates, Contraction, Proposal};
use super::wedge::AttributeValue;

/// Edges priced in one batch, at the least and at most.
const BATCH: RangeInclusive<usize> = 1..=512;
/// The size of the first one. Batches grow while they take less than half a millisecond, and shrink
/// when they take so long that a cancel would wait; that changes no price.
const FIRST_BATCH: usize = 64;
const SHORT: Duration = Duration::from_micros(500);
const LONG: Duration = Duration::from_millis(20);

/// What came of pricing an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// The least price, and the number of the candidate that has it.
    Price(f64, u8),
    /// No candidate has a price.
    Unpriced,
    /// There is no candidate: the boundary policy, seams or a coordinate that is not finite.
    Forbidden,
}

/// The cost and the placement of a run, and the buffers of asking them.
pub(super) struct Pricer<'a> {
    pub cost: &'a mut dyn Cost,
    pub placement: &'a mut dyn Placement,
    /// Edges of the next batch.
    batch_size: usize,
    contractions: Vec<Contraction>,
    candidates: Candidates,
    proposals: Vec<Proposal>,
    prices: Vec<f64>,
    verdicts: Vec<(EdgeId, Verdict)>,
}

impl<'a> Pricer<'a> {
    pub fn new(cost: &'a mut dyn Cost, placement: &'a mut dyn Placement) -> Self {
        Self {
            cost,
            placement,
            batch_size: FIRST_BATCH,
            contractions: Vec::new(),
            candidates: Candidates::default(),
            proposals: Vec::new(),
            prices: Vec::new(),
            verdicts: Vec::new(),
        }
    }

    /// The most edges that should be priced at once.
    pub const fn largest_batch() -> usize {
        *BATCH.end()
    }

    /// Prices edges, as many of the first as make a batch, and learns from how long that takes.
    /// One verdict for each.
    pub fn price_batch(&mut self, mesh: &WorkingMesh, edges: &[EdgeId]) -> &[(EdgeId, Verdict)] {
        let n = edges.len().min(self.batch_size);
        // Small batches are too short to measure, and reading the clock takes time, too.
        let start = (n * 4 > self.batch_size).then(Instant::now);
        self.price(mesh, &edges[..n]);
        match start.map(|start| start.elapsed()) {
            Some(elapsed) if elapsed < SHORT && n == self.batch_size => {
                self.batch_size = (2 * self.batch_size).min(*BATCH.end());
            }
            Some(elapsed) if elapsed > LONG => self.batch_size = (n / 2).max(*BATCH.start()),
            _ => {}
        }
        &self.verdicts
    }

    fn price(&mut self, mesh: &WorkingMesh, edges: &[EdgeId]) {
        self.propose(mesh, edges);
        self.prices.clear();
        self.prices.resize(self.proposals.len(), f64::NAN);
        let batch = self.candidates.batch(&self.proposals);
        self.cost.price(mesh, batch, &mut self.prices);
        self.verdicts.clear();
        let mut prices = self.prices.as_slice();
        for (&edge, n) in edges.iter().zip(self.candidates.counts()) {
            let (of_edge, rest) = prices.split_at(n);
            prices = rest;
            self.verdicts.push((edge, verdict(of_edge)));
        }
    }

    /// Lists the proposals for edges: those of the placement, or the places that the boundary
    /// policy and the seams leave.
    fn propose(&mut self, mesh: &WorkingMesh, edges: &[EdgeId]) {
        let Self { contractions, candidates, proposals, .. } = self;
        contractions.clear();
        contractions.extend(edges.iter().map(|&edge| mesh.contraction(edge)));
        candidates.reset(edges.len());
        self.placement.propose(mesh, contractions, candidates);
        for (at, (&edge, contraction)) in edges.iter().zip(contractions.iter()).enumerate() {
            let place = match rule(mesh, edge, contraction) {
                SeamRule::Anywhere => continue,
                SeamRule::OnlyAtKept => Some(mesh.position(contraction.kept)),
                SeamRule::OnlyAtGone => Some(mesh.position(contraction.gone)),
                SeamRule::Nowhere => None,
            };
            candidates.restrict(at, place);
        }
        candidates.list_proposals(contractions, proposals);
    }

    /// The proposals of an edge.
    pub fn proposals(&mut self, mesh: &WorkingMesh, edge: EdgeId) -> &[Proposal] {
        self.propose(mesh, &[edge]);
        &self.proposals
    }

    /// The attribute values of a proposal, one of those that were listed last.
    pub fn attributes(&self, proposal: &Proposal) -> &[AttributeValue] {
        self.candidates.batch(&self.proposals).attributes(proposal)
    }

    /// The price and number of the proposal of an edge that comes next after one that was tried, by
    /// price and number.
    pub fn next_choice(
        &mut self,
        mesh: &WorkingMesh,
        edge: EdgeId,
        tried: (f64, u8),
    ) -> Option<(f64, u8)> {
        self.propose(mesh, &[edge]);
        if self.proposals.len() < 2 {
            return None;
        }
        let mut prices = [f64::NAN; Candidates::MAX];
        let prices = &mut prices[..self.proposals.len()];
        let batch = self.candidates.batch(&self.proposals);
        self.cost.price(mesh, batch, prices);
        let numbered = prices.iter().zip(0u8..).map(|(&price, choice)| (price, choice));
        numbered
            .filter(|&untried| !untried.0.is_nan() && untried > tried)
            .reduce(|best, other| if other < best { other } else { best })
    }

    /// Whether an edge costs nothing at this price.
    pub fn is_free(&self, mesh: &WorkingMesh, edge: EdgeId, price: f64) -> bool {
        self.cost.is_free(mesh, &mesh.contraction(edge), price)
    }

    /// Tells both parts of a collapse.
    pub fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        self.cost.collapsed(mesh, collapse);
        self.placement.collapsed(mesh, collapse);
    }
}

/// The least of the prices of one edge, the first of equal ones.
fn verdict(prices: &[f64]) -> Verdict {
    let mut best = (f64::NAN, 0);
    for (&price, choice) in prices.iter().zip(0u8..) {
        if !price.is_nan() && (best.0.is_nan() || price < best.0) {
            best = (price, choice);
        }
    }
    match best {
        _ if prices.is_empty() => Verdict::Forbidden,
        (price, _) if price.is_nan() => Verdict::Unpriced,
        (price, choice) => Verdict::Price(price, choice),
    }
}

/// What the boundary policy and the seams leave to an edge.
#[inline]
fn rule(mesh: &WorkingMesh, edge: EdgeId, contraction: &Contraction) -> SeamRule {
    let [kept, gone] = [contraction.kept, contraction.gone].map(|v| mesh.complex.flags[v.idx()]);
    let attributes = &mesh.attributes;
    if (kept | gone) & (flag::LOCKED | flag::NOWHERE) == 0 && !attributes.have_seams() {
        return SeamRule::Anywhere;
    }
    if (kept | gone) & flag::NOWHERE != 0 {
        return SeamRule::Nowhere;
    }
    let rule = attributes.seam_rule(&mesh.complex, edge);
    let stays_kept = kept & flag::LOCKED != 0 || rule == SeamRule::OnlyAtKept;
    let stays_gone = gone & flag::LOCKED != 0 || rule == SeamRule::OnlyAtGone;
    match (stays_kept, stays_gone) {
        _ if rule == SeamRule::Nowhere => rule,
        (false, false) => SeamRule::Anywhere,
        (true, false) => SeamRule::OnlyAtKept,
        (false, true) => SeamRule::OnlyAtGone,
        (true, true) => SeamRule::Nowhere,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_price_wins_and_the_first_of_equals() {
        assert_eq!(verdict(&[3.0, 1.0, 1.0]), Verdict::Price(1.0, 1));
        assert_eq!(verdict(&[f64::NAN, 2.0]), Verdict::Price(2.0, 1));
        assert_eq!(verdict(&[f64::NAN; 2]), Verdict::Unpriced);
        assert_eq!(verdict(&[]), Verdict::Forbidden);
    }
}
