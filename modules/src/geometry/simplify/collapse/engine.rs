//! The greedy loop: price, queue, check, merge, price again.

use std::ops::ControlFlow;
use std::time::Instant;

use mve_core::{Cancelled, Control};

use super::cost::Cost;
use super::marks::VertexMarks;
use super::merge::Merged;
use super::mesh::WorkingMesh;
use super::observer::{Collapse, Observer, WedgeChange, complete_changes, list_wedges};
use super::options::SimplifyOptions;
use super::outcome::{Seconds, Simplified, Statistics};
use super::placement::Placement;
use super::pricer::{Pricer, Verdict};
use super::quadrics::Quadrics;
use super::queue::{Entry, Queue};
use super::renewal::{Renewer, park};
use super::rings::Rings;
use super::stop::Outcome;
use super::ticker::Ticker;
use crate::data::{TriMesh, VertexId};
use crate::mesh::adjacency::EdgeId;

/// A run of the engine.
pub(super) struct Engine<'a> {
    input: &'a TriMesh,
    mesh: WorkingMesh,
    queue: Queue,
    pricer: Pricer<'a>,
    renewer: Renewer,
    observers: &'a mut [&'a mut dyn Observer],
    options: SimplifyOptions,
    ticker: Ticker<'a>,
    statistics: Statistics,
    start: Instant,
    marks: VertexMarks,
}

/// What is noted of one collapse, in memory that the next one uses again.
#[derive(Default)]
struct Memory {
    rings: Rings,
    merged: Merged,
    wedges: Vec<WedgeChange>,
}

impl<'a> Engine<'a> {
    pub fn new(
        input: &'a TriMesh,
        cost: &'a mut dyn Cost,
        placement: &'a mut dyn Placement,
        observers: &'a mut [&'a mut dyn Observer],
        options: SimplifyOptions,
        control: Control<'a>,
    ) -> Result<Self, Cancelled> {
        let start = Instant::now();
        let mut ticker = Ticker::new(control);
        let mut marks = VertexMarks::new(input.positions.len());
        let mut mesh = WorkingMesh::new(input, options.seams, &mut marks, &mut ticker)?;
        if let Some(quadrics) = cost.quadrics().or(placement.quadrics()) {
            let is_seam = mesh.attributes.seam_edges(&mesh.complex, &mut ticker)?;
            let WorkingMesh { complex, .. } = &mesh;
            let boundary = options.boundary;
            mesh.quadrics = Quadrics::sum(complex, quadrics, boundary, &is_seam, &mut ticker)?;
        }
        mesh.lock_boundary(options.boundary);
        let still = |_| match control.at(0.0) {
            Ok(()) => ControlFlow::Continue(()),
            Err(Cancelled) => ControlFlow::Break(()),
        };
        cost.begin(&mesh, Control::new(&still))?;
        observers.iter_mut().for_each(|observer| observer.begin(&mesh));
        let target_faces = options.stop.target_faces(input.faces.len());
        ticker.set_goal(mesh.n_faces(), target_faces.unwrap_or(0));
        let queue = Queue::new(mesh.complex.edges.len(), &mut ticker)?;
        let renewer = Renewer::new(
            cost.only_grows() && placement.only_grows(),
            cost.reach().max(placement.reach()),
            cost.renewal(),
        );
        Ok(Self {
            input,
            statistics: Statistics::new(mesh.n_faces(), target_faces),
            mesh,
            queue,
            pricer: Pricer::new(cost, placement),
            renewer,
            observers,
            options,
            ticker,
            start,
            marks,
        })
    }

    pub fn run(mut self) -> Result<Simplified, Cancelled> {
        let target = self.statistics.target_faces;
        let is_reached = |n_faces: usize| target.is_some_and(|target| n_faces <= target);
        if is_reached(self.mesh.n_faces()) {
            self.statistics.outcome = Outcome::TargetReached;
        } else {
            self.fill_queue()?;
        }
        let first_prices = self.start.elapsed().as_secs_f64();
        // Edges that are to be priced before the queue is looked at again.
        let mut due = Vec::new();
        let mut memory = Memory::default();
        while let Some(entry) = self.queue.first(self.mesh.n_faces(), &mut self.ticker)? {
            if self.options.stop.cost.is_some_and(|limit| entry.price > limit) {
                self.statistics.outcome = Outcome::CostReached;
                break;
            }
            self.ticker.tick(self.mesh.n_faces())?;
            if self.queue.is_stale(entry.edge) {
                self.renewer.list_coming(entry.edge, &self.mesh, &self.queue, &mut due);
                self.price(&due)?;
                continue;
            }
            let Some(merged) = self.attempt(entry, &mut memory) else { continue };
            let (mesh, queue) = (&mut self.mesh, &mut self.queue);
            self.renewer.list_after(merged, mesh, queue, &mut self.marks, &mut due);
            self.price(&due)?;
            if is_reached(self.mesh.n_faces()) {
                self.statistics.outcome = Outcome::TargetReached;
                break;
            }
        }
        self.finish(first_prices)
    }

    fn finish(self, first_prices: f64) -> Result<Simplified, Cancelled> {
        let Self { input, mesh, queue, observers, mut ticker, mut statistics, start, .. } = self;
        observers.iter_mut().for_each(|observer| observer.finished(&mesh));
        statistics.n_faces = mesh.n_faces();
        ticker.call(statistics.n_faces)?;
        // Giving memory back takes time, too.
        drop(queue);
        ticker.tick(statistics.n_faces)?;
        let mesh = mesh.into_mesh(input, &mut ticker)?;
        ticker.call(statistics.n_faces)?;
        let collapses = start.elapsed().as_secs_f64() - first_prices;
        Ok(Simplified { mesh, statistics, seconds: Seconds { first_prices, collapses } })
    }

    /// Prices every edge.
    fn fill_queue(&mut self) -> Result<(), Cancelled> {
        let n_edges = self.mesh.complex.edges.len();
        let mut edges = Vec::new();
        for first in (0..n_edges).step_by(Pricer::largest_batch()) {
            let end = (first + Pricer::largest_batch()).min(n_edges);
            edges.clear();
            edges.extend((first as u32..end as u32).map(EdgeId));
            self.price(&edges)?;
        }
        self.ticker.call(self.mesh.n_faces())
    }

    /// Prices edges and puts each on the queue with its best candidate.
    fn price(&mut self, edges: &[EdgeId]) -> Result<(), Cancelled> {
        let mut left = edges;
        while !left.is_empty() {
            let verdicts = self.pricer.price_batch(&self.mesh, left);
            left = &left[verdicts.len()..];
            for &(edge, verdict) in verdicts {
                if let Verdict::Price(price, choice) = verdict {
                    let length_squared = self.mesh.complex.length_squared(edge);
                    self.queue.set(Entry { price, length_squared, edge }, choice);
                } else {
                    let is_forbidden = verdict == Verdict::Forbidden;
                    self.statistics.n_rejected_boundary += usize::from(is_forbidden);
                    park(&mut self.mesh.complex, &mut self.queue, edge);
                }
            }
            self.ticker.tick(self.mesh.n_faces())?;
        }
        Ok(())
    }

    /// Tries the collapse at the head of the queue; what it did, if it was made.
    fn attempt<'m>(&mut self, entry: Entry, memory: &'m mut Memory) -> Option<&'m Merged> {
        let Self { mesh, queue, pricer, statistics, .. } = self;
        let Memory { rings, merged, wedges } = memory;
        let edge = entry.edge;
        let choice = queue.choice(edge);
        let Some((proposal, values)) = pricer.proposal(mesh, edge, choice) else {
            park(&mut mesh.complex, queue, edge);
            return None;
        };
        let rings = mesh.complex.neighborhood(edge, rings);
        let Some(rings) = rings.filter(|r| r.keep_topology(&mesh.complex, &mut self.marks)) else {
            statistics.n_rejected_link += 1;
            park(&mut mesh.complex, queue, edge);
            return None;
        };
        let position = proposal.position;
        let least_cosine = self.options.flip_angle_rad.map(f64::cos);
        let turns = |limit| rings.turn_a_face(&mesh.complex, position, limit);
        if !position.is_finite() || least_cosine.is_some_and(turns) {
            statistics.n_rejected_flip += 1;
            match pricer.next_choice(mesh, edge, (entry.price, choice)) {
                Some((price, choice)) => queue.set(Entry { price, ..entry }, choice),
                None => park(&mut mesh.complex, queue, edge),
            }
            return None;
        }
        let [kept, gone] = [rings.kept, rings.gone].map(VertexId);
        let before = [mesh.position(kept), mesh.position(gone)];
        let is_observed = !self.observers.is_empty();
        if is_observed {
            list_wedges(mesh, rings, wedges);
        }
        mesh.merge(rings, position, values, &mut self.marks, merged);
        if is_observed {
            complete_changes(mesh, wedges);
        }
        for &edge in &merged.dead_edges {
            queue.remove(edge);
        }
        let collapse = Collapse {
            kept,
            gone,
            position,
            before,
            dying_faces: &merged.dying_faces,
            price: entry.price,
            wedges,
            rings,
        };
        pricer.collapsed(mesh, &collapse);
        self.observers.iter_mut().for_each(|observer| observer.collapsed(mesh, &collapse));
        statistics.add_collapse(entry.price);
        Some(merged)
    }
}
