//! The greedy loop: price, queue, check, merge, price again.

use std::ops::{ControlFlow, RangeInclusive};
use std::time::{Duration, Instant};

use glam::DVec3;

use super::Cost;
use super::Placement;
use super::attributes::{Attributes, SeamRule};
use super::connectivity::{Marks, Merged, Rings};
use super::pulse::Pulse;
use super::queue::{Entry, Queue};
use super::state::{Collapsing, flag};
use super::{
    Boundary, Candidates, Collapse, Ends, Outcome, Proposal, Reach, Renewal, Seconds, Simplified,
    SimplifyOptions, Statistics,
};
use crate::data::{TriMesh, VertexId};
use mve_core::{Cancelled, Control};

/// Edges priced in one batch, at the least and at most.
const BATCH: RangeInclusive<usize> = 1..=512;
/// The size of the first one. Batches grow while they take less than half a millisecond, and shrink
/// when they take so long that a cancel would wait; that changes no price.
const FIRST_BATCH: usize = 64;
const SHORT: Duration = Duration::from_micros(500);
const LONG: Duration = Duration::from_millis(20);

/// A run of the engine.
pub(super) struct Engine<'a> {
    mesh: &'a TriMesh,
    pub(super) state: Collapsing,
    attributes: Attributes,
    pub(super) queue: Queue,
    /// Whether edges are priced again only when they come up: the price of one that is stale is
    /// not above the one of now.
    pub(super) is_lazy: bool,
    cost: &'a mut dyn Cost,
    placement: &'a mut dyn Placement,
    pub(super) reach: Reach,
    pub(super) renewal: Renewal,
    options: SimplifyOptions,
    pulse: Pulse<'a>,
    statistics: Statistics,
    /// Edges of the next batch of prices.
    batch: usize,
    start: Instant,
    pub(super) marks: Marks,
    pub(super) scratch: Scratch,
}

/// Buffers that live across collapses.
#[derive(Default)]
pub(super) struct Scratch {
    ends: Vec<Ends>,
    candidates: Vec<Candidates>,
    batch: Vec<Proposal>,
    /// Edge and number of the candidate of each proposal of the batch.
    origins: Vec<(u32, u8)>,
    prices: Vec<f64>,
    pub edges: Vec<u32>,
    pub ring: Vec<u32>,
    pub rings: Rings,
    pub merged: Merged,
}

impl<'a> Engine<'a> {
    pub fn new(
        mesh: &'a TriMesh,
        cost: &'a mut dyn Cost,
        placement: &'a mut dyn Placement,
        options: SimplifyOptions,
        control: Control<'a>,
    ) -> Result<Self, Cancelled> {
        let start = Instant::now();
        let mut pulse = Pulse::new(control);
        let mut marks = Marks::new(mesh.positions.len());
        let mut state = Collapsing::link(mesh, &mut marks, &mut pulse)?;
        let attributes = Attributes::new(mesh, &state, options.seams, &mut pulse)?;
        if let Some(quadrics) = cost.quadrics().or(placement.quadrics()) {
            let is_seam = attributes.seam_edges(&state, &mut pulse)?;
            state.sum_quadrics(quadrics, options.boundary, &is_seam, &mut pulse)?;
        }
        if options.boundary == Boundary::Locked {
            for flags in &mut state.flags {
                if *flags & flag::IRREGULAR != 0 {
                    *flags |= flag::LOCKED;
                }
            }
        }
        let still = |_| match control.at(0.0) {
            Ok(()) => ControlFlow::Continue(()),
            Err(Cancelled) => ControlFlow::Break(()),
        };
        cost.begin(&state, Control::new(&still))?;
        let target_faces = options.stop.target_faces(mesh.faces.len());
        pulse.set_goal(state.n_faces, target_faces.unwrap_or(0));
        let queue = Queue::new(state.edges.len(), &mut pulse)?;
        let statistics = Statistics {
            n_faces: state.n_faces,
            target_faces,
            outcome: Outcome::Exhausted,
            n_collapses: 0,
            n_rejected_link: 0,
            n_rejected_flip: 0,
            n_rejected_boundary: 0,
            largest_cost: None,
        };
        Ok(Self {
            is_lazy: cost.only_grows() && placement.only_grows(),
            reach: cost.reach().max(placement.reach()),
            renewal: cost.renewal(),
            mesh,
            attributes,
            state,
            queue,
            cost,
            placement,
            options,
            pulse,
            statistics,
            batch: FIRST_BATCH,
            start,
            marks,
            scratch: Scratch::default(),
        })
    }

    pub fn run(mut self) -> Result<Simplified, Cancelled> {
        let target = self.statistics.target_faces;
        let is_reached = |n_faces: usize| target.is_some_and(|target| n_faces <= target);
        if is_reached(self.state.n_faces) {
            self.statistics.outcome = Outcome::TargetReached;
        } else {
            self.fill_queue()?;
        }
        let first_prices = self.start.elapsed().as_secs_f64();
        while let Some(entry) = self.queue.first(self.state.n_faces, &mut self.pulse)? {
            if self.options.stop.cost.is_some_and(|limit| entry.price > limit) {
                self.statistics.outcome = Outcome::CostReached;
                break;
            }
            self.pulse.beat(self.state.n_faces)?;
            if self.queue.is_stale(entry.edge) {
                self.list_coming(entry.edge);
                self.price_edges()?;
                continue;
            }
            self.attempt(entry)?;
            if is_reached(self.state.n_faces) {
                self.statistics.outcome = Outcome::TargetReached;
                break;
            }
        }
        let Self { mesh, state, attributes, queue, mut pulse, mut statistics, start, .. } = self;
        statistics.n_faces = state.n_faces;
        pulse.call(statistics.n_faces)?;
        // Giving memory back takes time, too.
        drop(queue);
        pulse.beat(statistics.n_faces)?;
        let mesh = state.into_mesh(mesh, attributes, &mut pulse)?;
        pulse.call(statistics.n_faces)?;
        let collapses = start.elapsed().as_secs_f64() - first_prices;
        Ok(Simplified { mesh, statistics, seconds: Seconds { first_prices, collapses } })
    }

    /// Prices every edge.
    fn fill_queue(&mut self) -> Result<(), Cancelled> {
        let n_edges = self.state.edges.len();
        for first in (0..n_edges).step_by(*BATCH.end()) {
            let end = (first + BATCH.end()).min(n_edges);
            self.scratch.edges.clear();
            self.scratch.edges.extend(first as u32..end as u32);
            self.price_edges()?;
        }
        self.pulse.call(self.state.n_faces)
    }

    /// Finds the candidates of the edges in the scratch; forbids those that have none.
    fn propose(&mut self) {
        let Scratch { edges, ends, candidates, .. } = &mut self.scratch;
        ends.clear();
        ends.extend(edges.iter().map(|&edge| self.state.ends(edge)));
        candidates.iter_mut().for_each(Candidates::clear);
        candidates.resize(edges.len(), Candidates::default());
        self.placement.propose(&self.state, ends, candidates);
        for ((&edge, ends), candidates) in edges.iter().zip(ends).zip(candidates) {
            let fixed = match rule(&self.state, &self.attributes, edge, ends) {
                SeamRule::Anywhere => continue,
                SeamRule::OnlyAtKept => Some(ends.kept),
                SeamRule::OnlyAtGone => Some(ends.gone),
                SeamRule::Nowhere => None,
            };
            candidates.clear();
            if let Some(vertex) = fixed {
                candidates.push(self.state.position(vertex));
            }
        }
    }

    /// Prices the edges in the scratch and puts each on the queue with its best candidate, in
    /// batches.
    fn price_edges(&mut self) -> Result<(), Cancelled> {
        if self.scratch.edges.len() <= self.batch {
            return self.price_batch();
        }
        let all = std::mem::take(&mut self.scratch.edges);
        let mut left = all.as_slice();
        while !left.is_empty() {
            let (batch, rest) = left.split_at(self.batch.min(left.len()));
            self.scratch.edges.clear();
            self.scratch.edges.extend_from_slice(batch);
            self.price_batch()?;
            left = rest;
        }
        self.scratch.edges = all;
        Ok(())
    }

    /// Prices the edges in the scratch at once, and learns from how long that takes.
    fn price_batch(&mut self) -> Result<(), Cancelled> {
        let n = self.scratch.edges.len();
        if n == 0 {
            return Ok(());
        }
        // Small batches are too short to measure, and reading the clock takes time, too.
        let start = (n * 4 > self.batch).then(Instant::now);
        self.price_scratch();
        match start.map(|start| start.elapsed()) {
            Some(elapsed) if elapsed < SHORT && n == self.batch => {
                self.batch = (2 * self.batch).min(*BATCH.end());
            }
            Some(elapsed) if elapsed > LONG => self.batch = (n / 2).max(*BATCH.start()),
            _ => {}
        }
        self.pulse.beat(self.state.n_faces)
    }

    /// Prices the edges in the scratch.
    fn price_scratch(&mut self) {
        self.propose();
        let scratch = &mut self.scratch;
        scratch.batch.clear();
        scratch.origins.clear();
        let found = scratch.edges.iter().zip(&scratch.ends).zip(&scratch.candidates);
        for ((&edge, &ends), candidates) in found {
            if candidates.as_slice().is_empty() {
                self.statistics.n_rejected_boundary += 1;
                park(&mut self.state, &mut self.queue, edge);
            }
            for (choice, &position) in candidates.as_slice().iter().enumerate() {
                scratch.batch.push(Proposal { ends, position });
                scratch.origins.push((edge, choice as u8));
            }
        }
        scratch.prices.clear();
        scratch.prices.resize(scratch.batch.len(), f64::NAN);
        self.cost.price(&self.state, &scratch.batch, &mut scratch.prices);
        let mut at = 0;
        while at < scratch.origins.len() {
            let edge = scratch.origins[at].0;
            let mut best = (f64::NAN, 0);
            while let Some(&(same, choice)) = scratch.origins.get(at).filter(|o| o.0 == edge) {
                let price = scratch.prices[at];
                if !price.is_nan() && (best.0.is_nan() || price < best.0) {
                    best = (price, choice);
                }
                debug_assert_eq!(same, edge);
                at += 1;
            }
            if best.0.is_nan() {
                park(&mut self.state, &mut self.queue, edge);
            } else {
                let length_squared = self.state.length_squared(edge);
                self.queue.set(Entry { price: best.0, length_squared, edge }, best.1);
            }
        }
    }

    /// Tries the collapse at the head of the queue.
    fn attempt(&mut self, entry: Entry) -> Result<(), Cancelled> {
        let edge = entry.edge;
        self.scratch.edges.clear();
        self.scratch.edges.push(edge);
        self.propose();
        let choice = usize::from(self.queue.choice(edge));
        let found = self.scratch.candidates.first();
        let Some(&position) = found.and_then(|found| found.as_slice().get(choice)) else {
            park(&mut self.state, &mut self.queue, edge);
            return Ok(());
        };
        let rings = &mut self.scratch.rings;
        if !self.state.link_condition_holds(edge, rings, &mut self.marks) {
            self.statistics.n_rejected_link += 1;
            park(&mut self.state, &mut self.queue, edge);
            return Ok(());
        }
        let least_cosine = self.options.flip_angle_rad.map(f64::cos);
        if !position.is_finite()
            || least_cosine
                .is_some_and(|limit| self.state.turns_a_face(edge, rings, position, limit))
        {
            self.statistics.n_rejected_flip += 1;
            self.try_next_candidate(entry);
            return Ok(());
        }
        self.collapse(entry, position)
    }

    /// Puts the edge back with the candidate that comes next by price and number, if any.
    fn try_next_candidate(&mut self, entry: Entry) {
        let Scratch { ends, candidates, .. } = &self.scratch;
        let found = ends.iter().zip(candidates);
        let proposals: Vec<Proposal> = found
            .flat_map(|(&ends, found)| found.as_slice().iter().map(move |&p| (ends, p)))
            .map(|(ends, position)| Proposal { ends, position })
            .collect();
        let mut prices = [f64::NAN; Candidates::MAX];
        let prices = &mut prices[..proposals.len()];
        if proposals.len() > 1 {
            self.cost.price(&self.state, &proposals, prices);
        }
        let tried = (entry.price, self.queue.choice(entry.edge));
        let next = prices
            .iter()
            .zip(0u8..)
            .map(|(&price, choice)| (price, choice))
            .filter(|&untried| !untried.0.is_nan() && untried > tried)
            .reduce(|best, other| if other < best { other } else { best });
        match next {
            Some((price, choice)) => self.queue.set(Entry { price, ..entry }, choice),
            None => park(&mut self.state, &mut self.queue, entry.edge),
        }
    }

    fn collapse(&mut self, entry: Entry, position: DVec3) -> Result<(), Cancelled> {
        let [kept, gone] = self.state.edges[entry.edge as usize].map(VertexId);
        let before = [self.state.position(kept), self.state.position(gone)];
        let scratch = &mut self.scratch;
        self.attributes.merge(&self.state, entry.edge, position);
        let merged = &mut scratch.merged;
        self.state.merge(entry.edge, position, &scratch.rings, &mut self.marks, merged);
        for &edge in &merged.dead_edges {
            self.queue.remove(edge);
        }
        let dead_faces = &merged.dead_faces;
        let collapse = Collapse { kept, gone, position, before, dead_faces, price: entry.price };
        self.cost.collapsed(&self.state, &collapse);
        self.placement.collapsed(&self.state, &collapse);
        self.statistics.n_collapses += 1;
        let largest = &mut self.statistics.largest_cost;
        *largest = Some(largest.map_or(entry.price, |price| price.max(entry.price)));
        self.list_stale(kept.0);
        self.price_edges()
    }
}

/// What the boundary policy and the seams leave to an edge.
#[inline]
fn rule(state: &Collapsing, attributes: &Attributes, edge: u32, ends: &Ends) -> SeamRule {
    let [kept, gone] = [ends.kept, ends.gone].map(|v| state.flags[v.idx()]);
    if (kept | gone) & (flag::LOCKED | flag::NOWHERE) == 0 && !attributes.have_seams() {
        return SeamRule::Anywhere;
    }
    if (kept | gone) & flag::NOWHERE != 0 {
        return SeamRule::Nowhere;
    }
    let rule = attributes.seam_rule(state, edge);
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

/// Takes an edge off the queue until something near it changes.
fn park(state: &mut Collapsing, queue: &mut Queue, edge: u32) {
    queue.remove(edge);
    for v in state.edges[edge as usize] {
        state.flags[v as usize] |= flag::PARKED;
    }
}
