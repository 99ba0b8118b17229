//! The order in which vertices go, until the target is met or none can go.
//!
//! `Queue` takes the least important vertex first. On large meshes it comes to that in waves: each
//! goes along the vertices in memory, and all that are no more important than a bound go; the bound
//! is such that a part of the vertices is below it. The last twentieth goes by a queue. So two
//! neighbors in memory are looked at one after the other, which on a million faces takes a third of
//! the time. Importances are not renewed when faces nearby change but when they are up next: where
//! one has risen, its vertex goes back.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use mve_core::{Cancelled, Control};
use mve_mesh::quadric::Quadric;

use super::appraise::{Appraiser, Depth, Removal};
use super::kind::VertexKind;
use super::options::{DecimateOptions, RemovalKind, Sequence};
use super::quadrics::{add_borders, quadrics};
use super::refusal::Refusal;
use super::split::split_vertices;
use super::star_mesh::StarMesh;

/// Vertices from which on there are waves.
const WAVES_FROM: usize = 1 << 12;
/// The part of the vertices that a wave looks at.
const WAVE: f64 = 0.2;
/// Times that vertices are split at most.
const MOST_SPLITS: usize = 64;
/// Faces that are looked at between two looks whether the work was cancelled.
const PAUSE: usize = 1 << 16;
/// The key of a vertex that is gone; one that waits for its faces to change has the highest bit.
const GONE: u64 = u64::MAX;
const PARKED: u64 = 1 << 63;

/// What vertices of the input were found to be.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// The kind of each; `None` without a face.
    pub kinds: Vec<Option<VertexKind>>,
    /// The importance of each as a distance, not a number for those that stay.
    pub distances: Vec<f64>,
}

/// A run.
pub struct Run<'a> {
    /// The mesh as it is now.
    pub mesh: StarMesh,
    /// What was found before the first vertex went.
    pub findings: Findings,
    /// Vertices that went.
    pub n_removed: usize,
    /// Copies of vertices that were made.
    pub n_split: usize,
    /// The largest distance of a vertex that went.
    pub largest_distance: f64,
    appraiser: Appraiser,
    quadrics: Vec<Quadric>,
    options: DecimateOptions,
    control: Control<'a>,
    n_faces_before: usize,
    next_pause: usize,
    /// The bits of the price of each vertex, which rise with it.
    keys: Vec<u64>,
}

impl<'a> Run<'a> {
    /// Looks at all vertices.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn new(
        mesh: StarMesh,
        options: DecimateOptions,
        control: Control<'a>,
    ) -> Result<Self, Cancelled> {
        let n = mesh.positions.len();
        let quadrics = if options.needs_quadrics() {
            quadrics(&mesh, options.openings.boundary, control.part(0.0, 0.1))?
        } else {
            Vec::new()
        };
        let mut run = Self {
            findings: Findings { kinds: Vec::with_capacity(n), distances: vec![f64::NAN; n] },
            n_removed: 0,
            n_split: 0,
            largest_distance: 0.0,
            appraiser: Appraiser::new(options, n),
            quadrics,
            options,
            control: control.part(0.1, 0.25),
            n_faces_before: mesh.n_faces,
            next_pause: 0,
            keys: vec![GONE; n],
            mesh,
        };
        for vertex in 0..n as u32 {
            run.listen(f64::from(vertex) / n as f64)?;
            let found = run.look(vertex, Depth::Order);
            let kind = match found {
                Err(Refusal::Odd) => run.appraiser.classify(&run.mesh, vertex),
                _ => Some(run.appraiser.kind),
            };
            run.findings.kinds.push(kind);
            if let Ok(removal) = found {
                run.findings.distances[vertex as usize] = removal.distance;
            }
            run.note(vertex, found);
        }
        run.control = control.part(0.25, 1.0);
        Ok(run)
    }

    /// Takes vertices away until the target is met or none can go.
    ///
    /// # Errors
    /// [`Cancelled`] when the control says so.
    pub fn finish(&mut self) -> Result<(), Cancelled> {
        for _ in 0..MOST_SPLITS {
            match self.options.sequence {
                Sequence::Passes => self.passes()?,
                Sequence::Queue => {
                    if self.keys.len() >= WAVES_FROM {
                        self.waves()?;
                    }
                    self.queue()?;
                }
            }
            if self.is_done() || !self.split()? {
                break;
            }
        }
        Ok(())
    }

    /// How many vertices stay for each reason, in the order of [`Refusal::ALL`].
    ///
    /// # Errors
    /// [`Cancelled`] when the control says so.
    pub fn refusals(&mut self) -> Result<[usize; 6], Cancelled> {
        let mut counts = [0; 6];
        for vertex in 0..self.keys.len() as u32 {
            self.listen(1.0)?;
            if let (false, Err(refusal)) =
                (self.mesh.corners_of(vertex).is_empty(), self.look(vertex, Depth::All))
            {
                counts[refusal.place()] += 1;
            }
        }
        Ok(counts)
    }

    fn is_done(&self) -> bool {
        self.mesh.n_faces <= self.options.target_faces
    }

    fn listen(&mut self, share: f64) -> Result<(), Cancelled> {
        if self.appraiser.work < self.next_pause {
            return Ok(());
        }
        self.next_pause = self.appraiser.work + PAUSE;
        self.control.at(share)
    }

    /// The part of the faces that is gone of those that have to go.
    fn share(&self) -> f64 {
        let all = self.n_faces_before.saturating_sub(self.options.target_faces).max(1);
        (self.n_faces_before - self.mesh.n_faces) as f64 / all as f64
    }

    fn look(&mut self, vertex: u32, depth: Depth) -> Result<Removal, Refusal> {
        self.appraiser.appraise(&self.mesh, &self.quadrics, vertex, depth)
    }

    fn note(&mut self, vertex: u32, found: Result<Removal, Refusal>) {
        let key = &mut self.keys[vertex as usize];
        match found {
            Ok(removal) => *key = removal.price.to_bits(),
            Err(_) if *key == GONE => *key = PARKED,
            Err(_) => *key |= PARKED,
        }
    }

    /// Looks at a vertex whose key is no more than a bound, and takes it away unless that has
    /// risen above the bound. Tells of each neighbor, with whether it had waited.
    fn try_removal(&mut self, vertex: u32, bound: u64, mut tell: impl FnMut(u32, bool)) -> bool {
        // Where the price has risen the costly tests can wait.
        let mut found = self.look(vertex, Depth::Order);
        if found.is_ok_and(|removal| removal.price.to_bits() <= bound) {
            found = self.look(vertex, Depth::All);
        }
        match found {
            Ok(removal) if removal.price.to_bits() <= bound => {
                self.remove(removal);
                self.keys[vertex as usize] = GONE;
                for &neighbor in &self.appraiser.star.ring {
                    let key = &mut self.keys[neighbor as usize];
                    tell(neighbor, *key & PARKED != 0);
                    *key &= !PARKED;
                }
                true
            }
            found => {
                self.note(vertex, found);
                false
            }
        }
    }

    fn waves(&mut self) -> Result<(), Cancelled> {
        loop {
            let mut waiting: Vec<u64> =
                self.keys.iter().copied().filter(|key| key & PARKED == 0).collect();
            let n_left = self.mesh.n_faces.saturating_sub(self.options.target_faces).div_ceil(2);
            if waiting.is_empty() || n_left < self.keys.len() / 20 {
                return Ok(());
            }
            // No more than three of four of those that have to go, as the last go by a queue.
            let place = (WAVE * waiting.len() as f64) as usize;
            let place = place.min(n_left * 3 / 4).min(waiting.len() - 1);
            let bound = *waiting.select_nth_unstable(place).1;
            for vertex in 0..self.keys.len() as u32 {
                if self.keys[vertex as usize] <= bound {
                    self.listen(self.share())?;
                    self.try_removal(vertex, bound, |_, _| ());
                    if self.is_done() {
                        return Ok(());
                    }
                }
            }
            self.control.at(self.share())?;
        }
    }

    fn queue(&mut self) -> Result<(), Cancelled> {
        let waiting = (0..).zip(&self.keys).filter(|(_, key)| **key & PARKED == 0);
        let mut heap: BinaryHeap<Reverse<(u64, u32)>> =
            waiting.map(|(vertex, &key)| Reverse((key, vertex))).collect();
        let mut woken = Vec::new();
        while !self.is_done() {
            let Some(Reverse((bound, vertex))) = heap.pop() else { break };
            self.listen(self.share())?;
            woken.clear();
            let tell = |neighbor, had_waited| {
                if had_waited {
                    woken.push(neighbor);
                }
            };
            if self.try_removal(vertex, bound, tell) {
                let keys = &self.keys;
                heap.extend(woken.iter().map(|&v| Reverse((keys[v as usize], v))));
            } else if self.keys[vertex as usize] & PARKED == 0 {
                heap.push(Reverse((self.keys[vertex as usize], vertex)));
            }
        }
        Ok(())
    }

    fn passes(&mut self) -> Result<(), Cancelled> {
        let mut pass_of = vec![0_u32; self.keys.len()];
        for pass in 1.. {
            let mut order = Vec::new();
            for vertex in 0..self.keys.len() as u32 {
                self.listen(self.share())?;
                if !self.mesh.corners_of(vertex).is_empty()
                    && let Ok(removal) = self.look(vertex, Depth::Order)
                {
                    order.push((removal.price.to_bits(), vertex));
                }
            }
            self.control.at(self.share())?;
            order.sort_unstable();
            let n_before = self.n_removed;
            for (_, vertex) in order {
                if self.is_done() {
                    return Ok(());
                }
                self.listen(self.share())?;
                if pass_of[vertex as usize] != pass {
                    self.try_removal(vertex, GONE, |v, _| pass_of[v as usize] = pass);
                }
            }
            if self.n_removed == n_before {
                break;
            }
        }
        Ok(())
    }

    /// Takes away the vertex that was looked at last.
    fn remove(&mut self, removal: Removal) {
        let star = &self.appraiser.star;
        let (vertex, target) = (star.vertex, star.ring[removal.target]);
        match self.options.removal {
            RemovalKind::Collapse => {
                if !self.mesh.wedges.is_empty() {
                    let (dying, staying) = self.appraiser.shared(&self.mesh, removal.target);
                    self.mesh.wedges.iter_mut().for_each(|layer| layer.merge(&dying, &staying));
                }
                for blade in &star.blades {
                    if blade.next == target || blade.before == target {
                        self.mesh.remove_face(blade.corner / 3);
                    }
                }
                self.mesh.merge(vertex, target);
            }
            RemovalKind::Retriangulate { .. } => self.appraiser.fill.apply(&mut self.mesh, star),
        }
        if !self.quadrics.is_empty() {
            let own = self.quadrics[vertex as usize].shifted(star.spokes[removal.target]);
            self.quadrics[target as usize].add(&own);
        }
        self.n_removed += 1;
        self.largest_distance = self.largest_distance.max(removal.distance);
    }

    /// Splits vertices where rules are opened; whether there were any.
    fn split(&mut self) -> Result<bool, Cancelled> {
        let openings = self.options.openings;
        if !openings.complex && !openings.corners {
            return Ok(false);
        }
        let feature_cos = self.options.feature_angle_rad.cos();
        let control = self.control.part(self.share(), self.share());
        let copies = split_vertices(&mut self.mesh, openings, feature_cos, control)?;
        self.n_split += copies.len();
        let n = self.mesh.positions.len();
        self.appraiser.grow(n);
        self.keys.resize(n, GONE);
        if !self.quadrics.is_empty() {
            for &[vertex, _] in &copies {
                self.quadrics.push(self.quadrics[vertex as usize]);
            }
            for vertex in copies.iter().map(|pair| pair[1]) {
                add_borders(&self.mesh, vertex, &mut self.quadrics[vertex as usize]);
            }
        }
        for vertex in 0..n as u32 {
            self.listen(self.share())?;
            if !self.mesh.corners_of(vertex).is_empty() {
                let found = self.look(vertex, Depth::Order);
                self.note(vertex, found);
            }
        }
        Ok(!copies.is_empty())
    }
}
