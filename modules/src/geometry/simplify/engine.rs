//! The greedy loop: price, queue, check, merge, price again.

use glam::DVec3;

use super::attributes::{Attributes, SeamRule};
use super::connectivity::{Marks, Removed};
use super::pulse::Pulse;
use super::queue::{Entry, Queue};
use super::state::{Collapsing, NONE, flag, next_in_face, previous_in_face};
use super::{
    Boundary, Candidates, Collapse, Outcome, Proposal, Reach, Simplified, SimplifyOptions,
    Statistics,
};
use crate::cost::Cost;
use crate::data::{FaceId, TriMesh, VertexId};
use crate::geometry::control::{Cancelled, Control};
use crate::placement::Placement;

/// Edges priced in one batch while the queue is filled, at the start and at most. A batch grows
/// while it takes less than a millisecond; that changes no price.
const BATCH: std::ops::RangeInclusive<usize> = 16..=4096;

/// A bit beside the number of the candidate: the price on the queue is that of an earlier state,
/// and not above the one of now.
const STALE: u8 = 0x80;

/// Waiting edges at a neighbor of the merged vertex are looked at up to this valence.
const MAX_WAKE_VALENCE: usize = 1024;

/// A run of the engine.
pub(super) struct Engine<'a> {
    mesh: &'a TriMesh,
    state: Collapsing,
    attributes: Attributes,
    queue: Queue,
    /// Which candidate of each edge is on the queue.
    choices: Vec<u8>,
    /// Whether edges are priced again only when they come up.
    is_lazy: bool,
    cost: &'a mut dyn Cost,
    placement: &'a mut dyn Placement,
    reach: Reach,
    options: SimplifyOptions,
    pulse: Pulse<'a>,
    statistics: Statistics,
    marks: Marks,
    scratch: Scratch,
}

/// Buffers that live across collapses.
#[derive(Default)]
struct Scratch {
    batch: Vec<Proposal>,
    /// Edge and number of the candidate of each proposal of the batch.
    origins: Vec<(u32, u8)>,
    prices: Vec<f64>,
    edges: Vec<u32>,
    ring: Vec<u32>,
    removed: Removed,
    dead_faces: Vec<FaceId>,
}

impl<'a> Engine<'a> {
    pub fn new(
        mesh: &'a TriMesh,
        cost: &'a mut dyn Cost,
        placement: &'a mut dyn Placement,
        options: SimplifyOptions,
        control: Control<'a>,
    ) -> Result<Self, Cancelled> {
        let mut pulse = Pulse::new(control);
        let mut marks = Marks::new(mesh.positions.len());
        let mut state = Collapsing::link(mesh, &mut marks, &mut pulse)?;
        let attributes = Attributes::new(mesh, &state, options.seams);
        pulse.beat(state.n_faces)?;
        if let Some(quadrics) = cost.quadrics().or(placement.quadrics()) {
            let is_seam = attributes.seam_edges(&state);
            state.sum_quadrics(quadrics, options.boundary, &is_seam, &mut pulse)?;
        }
        if options.boundary == Boundary::Locked {
            for vertex in &mut state.vertices {
                if vertex.flags & flag::IRREGULAR != 0 {
                    vertex.flags |= flag::LOCKED;
                }
            }
        }
        let target_faces = options.stop.target_faces(mesh.faces.len());
        pulse.set_goal(state.n_faces, target_faces.unwrap_or(0));
        let n_edges = state.edges.len();
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
            mesh,
            attributes,
            state,
            queue: Queue::new(n_edges),
            choices: vec![0; n_edges],
            cost,
            placement,
            options,
            pulse,
            statistics,
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
        while let Some(entry) = self.queue.first() {
            if self.options.stop.cost.is_some_and(|limit| entry.price > limit) {
                self.statistics.outcome = Outcome::CostReached;
                break;
            }
            self.pulse.beat(self.state.n_faces)?;
            if self.choices[entry.edge as usize] & STALE != 0 {
                // Those that come up next go along: their loads from memory overlap.
                let choices = &self.choices;
                let is_stale = |&edge: &u32| choices[edge as usize] & STALE != 0;
                self.scratch.edges.clear();
                self.scratch.edges.extend(self.queue.near_head().filter(is_stale));
                self.price_edges(Queue::set);
                continue;
            }
            self.attempt(entry);
            if is_reached(self.state.n_faces) {
                self.statistics.outcome = Outcome::TargetReached;
                break;
            }
        }
        self.pulse.call(self.state.n_faces)?;
        self.statistics.n_faces = self.state.n_faces;
        Ok(Simplified {
            mesh: self.state.into_mesh(self.mesh, self.attributes),
            statistics: self.statistics,
        })
    }

    /// Prices every edge.
    fn fill_queue(&mut self) -> Result<(), Cancelled> {
        let mut at = 0;
        let mut size = *BATCH.start();
        while at < self.state.edges.len() {
            let end = (at + size).min(self.state.edges.len());
            self.scratch.edges.clear();
            self.scratch.edges.extend(at as u32..end as u32);
            let start = std::time::Instant::now();
            self.price_edges(Queue::append);
            let micros = start.elapsed().as_micros();
            size = if micros < 500 {
                size * 2
            } else if micros > 1000 {
                size / 2
            } else {
                size
            };
            size = size.clamp(*BATCH.start(), *BATCH.end());
            self.pulse.beat(self.state.n_faces)?;
            at = end;
        }
        self.queue.order();
        self.pulse.call(self.state.n_faces)
    }

    /// Prices the edges in the scratch and hands each with its best candidate to `put`.
    fn price_edges(&mut self, put: impl Fn(&mut Queue, Entry)) {
        let scratch = &mut self.scratch;
        scratch.batch.clear();
        scratch.origins.clear();
        warm(&self.state, scratch.edges.iter().copied());
        for &edge in &scratch.edges {
            let candidates = propose(&self.state, &self.attributes, self.placement, edge);
            if candidates.as_slice().is_empty() {
                self.statistics.n_rejected_boundary += 1;
                park(&mut self.state, &mut self.queue, edge);
            }
            let [kept, gone] = self.state.edges[edge as usize].map(VertexId);
            for (choice, &position) in candidates.as_slice().iter().enumerate() {
                scratch.batch.push(Proposal { kept, gone, position });
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
                self.choices[edge as usize] = best.1;
                let length_squared = self.state.length_squared(edge);
                put(&mut self.queue, Entry { price: best.0, length_squared, edge });
            }
        }
    }

    /// Tries the collapse at the head of the queue.
    fn attempt(&mut self, entry: Entry) {
        let edge = entry.edge;
        let candidates = propose(&self.state, &self.attributes, self.placement, edge);
        let choice = self.choices[edge as usize];
        let Some(&position) = candidates.as_slice().get(choice as usize) else {
            park(&mut self.state, &mut self.queue, edge);
            return;
        };
        if !self.state.link_condition_holds(edge, &mut self.marks) {
            self.statistics.n_rejected_link += 1;
            park(&mut self.state, &mut self.queue, edge);
            return;
        }
        let least_cosine = self.options.flip_angle_rad.map(f64::cos);
        if !position.is_finite()
            || least_cosine.is_some_and(|limit| self.state.turns_a_face(edge, position, limit))
        {
            self.statistics.n_rejected_flip += 1;
            self.try_next_candidate(entry, candidates);
            return;
        }
        self.collapse(entry, position);
    }

    /// Puts the edge back with the candidate that comes next by price and number, if any.
    fn try_next_candidate(&mut self, entry: Entry, candidates: Candidates) {
        let [kept, gone] = self.state.edges[entry.edge as usize].map(VertexId);
        let proposals: Vec<Proposal> = candidates
            .as_slice()
            .iter()
            .map(|&position| Proposal { kept, gone, position })
            .collect();
        let mut prices = [f64::NAN; Candidates::MAX];
        let prices = &mut prices[..proposals.len()];
        if proposals.len() > 1 {
            self.cost.price(&self.state, &proposals, prices);
        }
        let tried = (entry.price, self.choices[entry.edge as usize]);
        let next = prices
            .iter()
            .zip(0u8..)
            .map(|(&price, choice)| (price, choice))
            .filter(|&untried| !untried.0.is_nan() && untried > tried)
            .reduce(|best, other| if other < best { other } else { best });
        match next {
            Some((price, choice)) => {
                self.choices[entry.edge as usize] = choice;
                self.queue.set(Entry { price, ..entry });
            }
            None => park(&mut self.state, &mut self.queue, entry.edge),
        }
    }

    fn collapse(&mut self, entry: Entry, position: DVec3) {
        warm(&self.state, self.queue.near_head().skip(1).take(4));
        let [kept, gone] = self.state.edges[entry.edge as usize].map(VertexId);
        let before = [self.state.position(kept), self.state.position(gone)];
        let scratch = &mut self.scratch;
        self.attributes.merge(&self.state, entry.edge, position);
        self.state.merge(entry.edge, position, &mut self.marks, &mut scratch.removed);
        for &edge in &scratch.removed.edges {
            self.queue.remove(edge);
        }
        scratch.dead_faces.clear();
        scratch.dead_faces.extend(scratch.removed.faces.iter().map(|&face| FaceId(face)));
        let dead_faces = &scratch.dead_faces;
        let collapse = Collapse { kept, gone, position, before, dead_faces, price: entry.price };
        self.cost.collapsed(&self.state, &collapse);
        self.placement.collapsed(&self.state, &collapse);
        self.statistics.n_collapses += 1;
        let largest = &mut self.statistics.largest_cost;
        *largest = Some(largest.map_or(entry.price, |price| price.max(entry.price)));
        if self.is_lazy && self.reach == Reach::MERGED {
            self.mark_stale(kept.0);
        } else {
            self.find_stale(kept.0);
        }
        self.wake_parked(kept.0);
        self.scratch.edges.sort_unstable();
        self.scratch.edges.dedup();
        self.price_edges(Queue::set);
    }

    /// Lists the edges within reach of a merge.
    fn find_stale(&mut self, merged: u32) {
        let Scratch { edges, ring, .. } = &mut self.scratch;
        edges.clear();
        ring.clear();
        ring.push(merged);
        self.marks.clear();
        self.marks.is_new(merged);
        let mut from = 0;
        for _ in 0..=self.reach.0 {
            let to = ring.len();
            for at in from..to {
                let vertex = ring[at];
                for corner in self.state.corners_around(vertex) {
                    let before = previous_in_face(corner);
                    for (half_edge, other) in [(corner, next_in_face(corner)), (before, before)] {
                        let other = self.state.vertex_at(other);
                        if self.marks.is_new(other) {
                            ring.push(other);
                            edges.push(self.state.edge_at(half_edge));
                        } else if vertex != merged {
                            // An edge between vertices that are both known; sorted out below.
                            edges.push(self.state.edge_at(half_edge));
                        }
                    }
                }
            }
            from = to;
        }
    }

    /// Marks the prices of the edges at the merged vertex as stale, and lists those that were put
    /// off, to be priced at once.
    fn mark_stale(&mut self, merged: u32) {
        let Scratch { edges, ring, .. } = &mut self.scratch;
        edges.clear();
        ring.clear();
        let mut corner = self.state.vertices[merged as usize].first;
        while corner != NONE {
            let before = previous_in_face(corner);
            for (half_edge, other) in [(corner, next_in_face(corner)), (before, before)] {
                let edge = self.state.edge_at(half_edge);
                let other = self.state.vertex_at(other);
                if other == NONE {
                    continue;
                }
                self.choices[edge as usize] |= STALE;
                if !self.queue.contains(edge) {
                    edges.push(edge);
                }
                if self.state.vertices[other as usize].flags & flag::PARKED != 0 {
                    ring.push(other);
                }
            }
            corner = self.state.next_at(corner);
        }
    }

    /// Adds the edges that were put off at the neighbors of the merged vertex.
    fn wake_parked(&mut self, merged: u32) {
        let Scratch { edges, ring, .. } = &mut self.scratch;
        self.state.vertices[merged as usize].flags &= !flag::PARKED;
        for &vertex in ring.iter() {
            if self.state.vertices[vertex as usize].flags & flag::PARKED == 0
                || self.state.prune(vertex, MAX_WAKE_VALENCE).is_none()
            {
                continue;
            }
            self.state.vertices[vertex as usize].flags &= !flag::PARKED;
            for corner in self.state.corners_around(vertex) {
                for half_edge in [corner, previous_in_face(corner)] {
                    let edge = self.state.edge_at(half_edge);
                    if !self.queue.contains(edge) {
                        edges.push(edge);
                    }
                }
            }
        }
    }
}

/// The candidates that the boundary policy leaves.
fn propose(
    state: &Collapsing,
    attributes: &Attributes,
    placement: &dyn Placement,
    edge: u32,
) -> Candidates {
    let mut candidates = Candidates::default();
    let [kept, gone] = state.edges[edge as usize];
    let [at_kept, at_gone] = [kept, gone].map(|v| state.vertices[v as usize].position);
    if kept == NONE || !at_kept.is_finite() || !at_gone.is_finite() {
        return candidates;
    }
    let is_locked = |v: u32| state.vertices[v as usize].flags & flag::LOCKED != 0;
    let rule = attributes.seam_rule(state, edge);
    let stays_kept = is_locked(kept) || rule == SeamRule::OnlyAtKept;
    let stays_gone = is_locked(gone) || rule == SeamRule::OnlyAtGone;
    match (stays_kept, stays_gone) {
        _ if rule == SeamRule::Nowhere => {}
        (false, false) => placement.propose(state, VertexId(kept), VertexId(gone), &mut candidates),
        (true, false) => candidates.push(at_kept),
        (false, true) => candidates.push(at_gone),
        (true, true) => {}
    }
    candidates
}

/// Reads what pricing or trying these edges will read. The loads do not wait for each other here,
/// as they do in the work itself, so they overlap. It changes no result.
fn warm(state: &Collapsing, edges: impl Iterator<Item = u32>) {
    let mut sum = 0.0;
    let mut bits = 0;
    for edge in edges {
        for v in state.edges[edge as usize] {
            let Some(vertex) = state.vertices.get(v as usize) else { continue };
            sum += vertex.position.x;
            sum += state.quadrics.get(v as usize).map_or(0.0, |quadric| quadric.a[0] + quadric.c);
            bits ^= state.faces.get(vertex.first as usize / 3).map_or(0, |face| face.next[0]);
        }
    }
    std::hint::black_box((sum, bits));
}

/// Takes an edge off the queue until something near it changes.
fn park(state: &mut Collapsing, queue: &mut Queue, edge: u32) {
    queue.remove(edge);
    for v in state.edges[edge as usize] {
        state.vertices[v as usize].flags |= flag::PARKED;
    }
}
