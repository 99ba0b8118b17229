//! The greedy loop: price, queue, check, merge, price again.

use std::ops::ControlFlow;
use std::time::Instant;

use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::EdgeId;
use mve_mesh::data::{TriMesh, VertexId};

use super::blocked::Blocked;
use super::cost::Cost;
use super::marks::VertexMarks;
use super::merge::Merged;
use super::mesh::WorkingMesh;
use super::observer::{
    Collapse, MovedCorner, Observer, WedgeChange, complete_changes, list_moved, list_wedges,
};
use super::options::{Boundary, SimplifyOptions};
use super::origin::Origin;
use super::outcome::{Seconds, Simplified, Statistics};
use super::placement::Placement;
use super::pricer::{Pricer, Verdict};
use super::quadrics::{Planes, Quadrics};
use super::queue::{Entry, Queue, doubled};
use super::renewal::{Renewer, mark_parked, park};
use super::rings::Rings;
use super::shape::{Shape, ShapeLimits};
use super::stop::Outcome;
use super::ticker::Ticker;

/// A run of the engine.
pub(super) struct Engine<'a> {
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
    /// What the shapes of faces must be; `None` is no test.
    limits: Option<ShapeLimits>,
    /// Whether collapses of poor shape wait.
    is_patient: bool,
    /// A price above all that are free, where a largest cost is given.
    largest_free: f64,
    memory: Memory,
}

/// Why the loop halts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Halt {
    /// No more faces are left than asked for.
    Faces,
    /// The next collapse costs this, more than asked for.
    Price(f64),
    /// No collapse is left.
    Exhausted,
}

/// What is noted of one collapse, in memory that the next one uses again.
#[derive(Default)]
struct Memory {
    /// Edges that are to be priced before the queue is looked at again.
    due: Vec<EdgeId>,
    rings: Rings,
    merged: Merged,
    wedges: Vec<WedgeChange>,
    moved_corners: Vec<MovedCorner>,
}

impl<'a> Engine<'a> {
    /// For a mesh that the result is made with again: see [`Engine::run`].
    pub fn new(
        input: &TriMesh,
        cost: &'a mut dyn Cost,
        placement: &'a mut dyn Placement,
        observers: &'a mut [&'a mut dyn Observer],
        options: SimplifyOptions,
        origin: Origin,
        control: Control<'a>,
    ) -> Result<Self, Cancelled> {
        let start = Instant::now();
        let mut ticker = Ticker::new(control);
        let mut marks = VertexMarks::new(input.positions.len());
        let mut mesh = WorkingMesh::new(input, options.seams, &mut marks, &mut ticker)?;
        if let Origin::Block(is_cut) = origin {
            mesh.freeze(is_cut);
        }
        if let Some(quadrics) = cost.quadrics().or(placement.quadrics()) {
            let is_seam = mesh.attributes.seam_edges(&mesh.complex, &mut ticker)?;
            let WorkingMesh { complex, order, .. } = &mesh;
            let is_weighted = options.boundary == Boundary::Weighted;
            let planes = Planes { options: quadrics, is_weighted, is_seam: &is_seam, origin };
            mesh.quadrics = Quadrics::sum(complex, order, planes, &mut ticker)?;
        }
        mesh.lock_boundary(options.boundary);
        let still = |_| match control.at(0.0) {
            Ok(()) => ControlFlow::Continue(()),
            Err(Cancelled) => ControlFlow::Break(()),
        };
        let still = Control::new(&still);
        cost.begin(&mesh, still)?;
        let is_patient = cost.is_patient();
        let largest_free = match options.stop.cost {
            Some(_) => cost.largest_free(&mesh, still)?,
            None => 0.0,
        };
        observers.iter_mut().for_each(|observer| observer.begin(&mesh));
        let target_faces = options.stop.target_faces(input.faces.len());
        ticker.set_goal(mesh.n_faces(), target_faces.unwrap_or(0));
        let queue = Queue::new(mesh.complex.edges.len(), &mut ticker)?;
        let renewer = Renewer::new(
            cost.only_grows() && placement.only_grows(),
            cost.reach().max(placement.reach()),
            cost.renewal(),
            cost.waiting_share(),
        );
        Ok(Self {
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
            limits: ShapeLimits::new(&options, is_patient),
            is_patient,
            largest_free,
            memory: Memory::default(),
        })
    }

    /// Makes all collapses; `input` is what the engine was made for.
    pub fn run(mut self, input: &TriMesh) -> Result<Simplified, Cancelled> {
        let target = self.statistics.target_faces;
        if target.is_none_or(|target| self.mesh.n_faces() > target) {
            self.fill_queue()?;
        }
        let first_prices = self.start.elapsed().as_secs_f64();
        let largest = self.options.stop.cost.map(|cost| cost.max(self.largest_free));
        loop {
            match self.advance(target, largest)? {
                Halt::Faces => self.statistics.outcome = Outcome::TargetReached,
                Halt::Price(_) => self.statistics.outcome = Outcome::CostReached,
                Halt::Exhausted if self.relax()? => continue,
                Halt::Exhausted => {}
            }
            break;
        }
        self.finish(input, first_prices)
    }

    /// Collapses edges while more than so many faces are left and the next one costs no more than
    /// `largest`.
    pub fn advance(
        &mut self,
        target: Option<usize>,
        largest: Option<f64>,
    ) -> Result<Halt, Cancelled> {
        let mut memory = std::mem::take(&mut self.memory);
        let halt = loop {
            if target.is_some_and(|target| self.mesh.n_faces() <= target) {
                break Halt::Faces;
            }
            let Some(entry) = self.queue.first(self.mesh.n_faces(), &mut self.ticker)? else {
                break Halt::Exhausted;
            };
            if largest.is_some_and(|largest| entry.price > largest) {
                break Halt::Price(entry.price);
            }
            self.ticker.tick(self.mesh.n_faces())?;
            if self.queue.is_stale(entry.edge) {
                let due = &mut memory.due;
                self.renewer.list_coming(entry.edge, &self.mesh, &self.queue, due);
                self.price(due)?;
                continue;
            }
            if self.is_too_dear(entry) {
                self.statistics.outcome = Outcome::CostReached;
                park(&mut self.mesh.complex, &mut self.queue, entry.edge);
                continue;
            }
            if !self.attempt(entry, &mut memory) {
                continue;
            }
            let Memory { merged, due, .. } = &mut memory;
            let (mesh, queue) = (&mut self.mesh, &mut self.queue);
            self.renewer.list_after(merged, mesh, queue, &mut self.marks, due);
            self.price(due)?;
        };
        self.memory = memory;
        Ok(halt)
    }

    /// Whether a collapse costs more than allowed.
    fn is_too_dear(&self, entry: Entry) -> bool {
        let Some(limit) = self.options.stop.cost else { return false };
        let price = self.queue.own_price(entry.edge);
        price > limit && !(limit >= 0.0 && self.pricer.is_free(&self.mesh, entry.edge, price))
    }

    /// Now that no collapse is left, allows what was not allowed so far for the sake of shape, if
    /// faces are still to go; whether there was anything.
    fn relax(&mut self) -> Result<bool, Cancelled> {
        let is_missed =
            self.statistics.target_faces.is_some_and(|target| target < self.mesh.n_faces());
        let is_exhausted = self.statistics.outcome == Outcome::Exhausted;
        let Some(limits) = self.limits.as_mut().filter(|_| is_missed && is_exhausted) else {
            return Ok(false);
        };
        let is_wider = limits.widen();
        let was_patient = std::mem::replace(&mut self.is_patient, false);
        if is_wider || was_patient {
            let edges = self.mesh.edges_left(&mut self.ticker)?;
            // Edges that rules hold were counted when they were priced first.
            let n_held = self.statistics.n_rejected_boundary;
            self.price(&edges)?;
            self.statistics.n_rejected_boundary = n_held;
        }
        Ok(is_wider || was_patient)
    }

    /// Faces that are left.
    pub fn n_faces(&self) -> usize {
        self.mesh.n_faces()
    }

    /// What a block is now, and the counts of its run.
    pub fn into_block(mut self) -> Result<(WorkingMesh, Statistics), Cancelled> {
        self.ticker.call(self.mesh.n_faces())?;
        Ok((self.mesh, self.statistics))
    }

    fn finish(mut self, input: &TriMesh, first_prices: f64) -> Result<Simplified, Cancelled> {
        if self.statistics.target_faces.is_some() && self.statistics.outcome == Outcome::Exhausted {
            let Self { mesh, pricer, limits, marks, ticker, statistics, .. } = &mut self;
            statistics.blocked = Some(Blocked::count(mesh, pricer, *limits, marks, ticker)?);
        }
        let Self { mesh, queue, observers, mut ticker, mut statistics, start, .. } = self;
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
    pub fn fill_queue(&mut self) -> Result<(), Cancelled> {
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

    /// Tries the collapse at the head of the queue; whether it was made. Then `memory` says what it
    /// did.
    fn attempt(&mut self, entry: Entry, memory: &mut Memory) -> bool {
        let Self { mesh, queue, pricer, statistics, limits, .. } = self;
        let Memory { rings, merged, wedges, moved_corners, .. } = memory;
        let edge = entry.edge;
        let choice = queue.choice(edge);
        let Some(&proposal) = pricer.proposals(mesh, edge).get(usize::from(choice)) else {
            park(&mut mesh.complex, queue, edge);
            return false;
        };
        let rings = mesh.complex.neighborhood(edge, rings);
        let Some(rings) = rings.filter(|r| r.keep_topology(&mesh.complex, &mut self.marks)) else {
            statistics.n_rejected_link += 1;
            park(&mut mesh.complex, queue, edge);
            return false;
        };
        let position = proposal.position;
        let Some(shape) = rings.shape_after(&mesh.complex, position, limits.as_ref()) else {
            statistics.n_rejected_flip += 1;
            match pricer.next_choice(mesh, edge, (entry.price, choice)) {
                Some((price, choice)) => queue.set(Entry { price, ..entry }, choice),
                None => park(&mut mesh.complex, queue, edge),
            }
            return false;
        };
        if shape != Shape::SOUND && self.let_wait(entry, choice, shape) {
            return false;
        }
        let Self { mesh, queue, pricer, statistics, .. } = self;
        let price = queue.own_price(edge);
        let is_free = pricer.cost.is_free(mesh, &proposal.contraction, price);
        let [kept, gone] = [rings.kept, rings.gone].map(VertexId);
        let before = [kept, gone, kept].map(|v| mesh.position(v));
        let is_observed = !self.observers.is_empty();
        if is_observed {
            list_wedges(mesh, rings, wedges);
            list_moved(rings, moved_corners);
        }
        let values = pricer.attributes(&proposal);
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
            also_gone: None,
            position,
            before,
            dying_faces: &merged.dying_faces,
            price,
            moved_corners,
            wedges,
        };
        pricer.collapsed(mesh, &collapse);
        self.observers.iter_mut().for_each(|observer| observer.collapsed(mesh, &collapse));
        statistics.add_collapse(if is_free { price.min(0.0) } else { price }, shape.is_turned);
        true
    }

    /// Lets a collapse of poor shape wait, or tries another place first that costs less than that;
    /// `false` where it has waited, or should not.
    fn let_wait(&mut self, entry: Entry, choice: u8, shape: Shape) -> bool {
        let Self { mesh, queue, pricer, .. } = self;
        let limits = self.limits.filter(|_| self.is_patient && !queue.has_waited(entry.edge));
        let doublings = limits.map_or(0, |limits| limits.doublings(shape));
        let doublings = below(entry.price, doublings, self.options.stop.cost);
        if doublings == 0 {
            return false;
        }
        let waiting = doubled(entry.price, doublings);
        match pricer.next_choice(mesh, entry.edge, (entry.price, choice)) {
            Some((price, choice)) if price < waiting => {
                queue.set(Entry { price, ..entry }, choice);
            }
            _ => queue.let_wait(entry, choice, doublings),
        }
        mark_parked(&mut mesh.complex, entry.edge);
        true
    }
}

/// The most doublings, up to so many, that leave a price finite and a cost that is allowed allowed.
fn below(price: f64, most: u8, limit: Option<f64>) -> u8 {
    let limit = limit.filter(|limit| price <= *limit).unwrap_or(f64::MAX);
    // A price of 0 stays what it is, so to wait would change nothing.
    let most = if price > 0.0 { most } else { 0 };
    (0..=most).rev().find(|&n| doubled(price, n) <= limit).unwrap_or(0)
}
