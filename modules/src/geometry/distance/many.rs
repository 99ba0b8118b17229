//! Many queries of one tree: each by the tree as long as that is fast, the others in `bulk`.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::morton::coarse_order;
use rayon::prelude::*;

use super::bulk::{Bulk, Panorama};
use super::bvh::{Bvh, GROUP, Hit, Walker, is_usable};

/// Nodes that one point may take before it counts as hard: near a hub of many faces other ways take
/// as long.
const MOST_VISITS: usize = 2000;
/// Hard points beyond so many, and a share of all, end the asking one by one.
const FEW_HARD: usize = 16;
const HARD_SHARE: usize = 32;
/// Nodes that points may take on average before it ends, too, once there are some points: the first
/// may be exceptions.
const VISITS_PER_POINT: usize = 96;
const SOME_POINTS: usize = 32;
/// Nodes that show whether a point is near enough, where that is so.
const FEW_VISITS: usize = 64;
/// Trees of cells are given so many times as many: lists are long where faces lie across each
/// other.
const PATIENCE: usize = 8;
/// Points that are taken together: more hard ones share more work, fewer leave some for other
/// threads.
const CHUNK: usize = 8192;

/// Chunks whose boxes have diagonals of so much of that of all, on average, need no order.
const CLOSE: f64 = 0.25;

/// Many queries of one tree, in bounded time wherever the points are.
#[derive(Debug)]
pub struct ManyQueries<'a> {
    bvh: &'a Bvh,
    center: DVec3,
    panorama: OnceLock<Panorama>,
    n_looks: AtomicUsize,
}

impl<'a> ManyQueries<'a> {
    /// Queries of points around this middle, which changes no more of the answers than which of
    /// equally near faces is found.
    pub fn new(bvh: &'a Bvh, center: DVec3) -> Self {
        Self { bvh, center, panorama: OnceLock::new(), n_looks: AtomicUsize::new(0) }
    }

    /// The tree that is asked.
    pub fn tree(&self) -> &'a Bvh {
        self.bvh
    }

    /// Nodes and faces that were looked at so far, a measure of the work that does not depend on
    /// the machine.
    pub fn n_looks(&self) -> usize {
        self.n_looks.load(Ordering::Relaxed)
    }

    /// The face nearest to every point, in order; the same as [`Bvh::closest`] of each but for the
    /// last bits of the distance. Best in an order in which neighbors follow each other.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn closest(
        &self,
        points: &[DVec3],
        control: Control,
    ) -> Result<Vec<Option<Hit>>, Cancelled> {
        let steps = control.part(0.0, 0.5).steps(points.len().div_ceil(CHUNK));
        let found: Vec<(Vec<Option<Hit>>, Vec<u32>)> = points
            .par_chunks(CHUNK)
            .map(|chunk| {
                let found = self.easy_hits(chunk, &control)?;
                steps.step()?;
                Ok(found)
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut hits = Vec::with_capacity(points.len());
        let mut hard: Vec<usize> = Vec::new();
        for (found, hard_there) in found {
            hard.extend(hard_there.into_iter().map(|at| hits.len() + at as usize));
            hits.extend(found);
        }
        let hard_points: Vec<DVec3> = hard.iter().map(|&at| points[at]).collect();
        let found = self.hard_hits(&hard_points, &control.part(0.5, 1.0))?;
        hard.into_iter().zip(found).for_each(|(at, hit)| hits[at] = hit);
        Ok(hits)
    }

    /// For every point in order, a face that is at most so far away, or the nearest one where none
    /// is; nothing for points that are not finite. Fast where most points have one.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn nearby(
        &self,
        points: &[DVec3],
        distance: f64,
        control: Control,
    ) -> Result<Vec<Option<Hit>>, Cancelled> {
        let distance_sq = distance * distance;
        let first_look = control.part(0.0, 0.5);
        let near = |chunk: &[DVec3]| {
            let mut walker = self.bvh.walker();
            let near = |&point: &DVec3| {
                let is_usable = is_usable(point);
                is_usable.then(|| walker.within_reach(point, distance_sq, FEW_VISITS)).flatten()
            };
            let hits: Vec<Option<Hit>> = chunk.iter().map(near).collect();
            self.n_looks.fetch_add(walker.n_visits(), Ordering::Relaxed);
            first_look.at(0.0)?;
            Ok(hits)
        };
        let hits = points.par_chunks(CHUNK).map(near).collect::<Result<Vec<_>, Cancelled>>()?;
        let mut hits = hits.concat();
        let far = |at: &usize| hits[*at].is_none() && is_usable(points[*at]);
        let far: Vec<usize> = (0..points.len()).filter(far).collect();
        let places: Vec<DVec3> = far.iter().map(|&at| points[at]).collect();
        let found = self.closest(&places, control.part(0.5, 1.0))?;
        far.into_iter().zip(found).for_each(|(at, hit)| hits[at] = hit);
        Ok(hits)
    }

    /// The points that are farther than a distance from the surface, by their places in the list in
    /// order, with the faces nearest to them; points that are not finite are not. Fast where few
    /// are.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn farther(
        &self,
        points: &[DVec3],
        distance: f64,
        control: Control,
    ) -> Result<Vec<(usize, Hit)>, Cancelled> {
        let found = self.nearby(points, distance, control)?.into_iter().enumerate();
        let all = found.filter_map(|(at, hit)| Some((at, hit?)));
        Ok(all.filter(|(_, hit)| hit.distance_sq > distance * distance).collect())
    }

    /// What [`ManyQueries::closest`] gives, but nothing for the points that take long, which are
    /// returned as well, for [`ManyQueries::hard_hits`].
    fn easy_hits(
        &self,
        points: &[DVec3],
        control: &Control,
    ) -> Result<(Vec<Option<Hit>>, Vec<u32>), Cancelled> {
        if self.bvh.lists.is_some() {
            let hard = (0..).zip(points).filter(|(_, point)| is_usable(**point));
            return Ok((vec![None; points.len()], hard.map(|(at, _)| at).collect()));
        }
        self.asked_one_by_one(points, control)
    }

    fn asked_one_by_one(
        &self,
        points: &[DVec3],
        control: &Control,
    ) -> Result<(Vec<Option<Hit>>, Vec<u32>), Cancelled> {
        let mut hits = Vec::with_capacity(points.len());
        let mut walker = self.bvh.walker();
        let mut hard = Hard::of(self.bvh);
        for (at, &point) in points.iter().enumerate() {
            hits.push(hard.ask(&mut walker, at, point));
            walker.poll(control)?;
        }
        self.n_looks.fetch_add(walker.n_visits(), Ordering::Relaxed);
        Ok((hits, hard.points))
    }

    /// The squared distances instead of hits, into `out`: faster where points that follow each
    /// other lie closer together than the faces are wide. Points that are not finite, that are
    /// hard, and trees without faces give infinity. Returns the places of the hard ones, for
    /// [`ManyQueries::hard_hits`].
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn easy_distances_sq(
        &self,
        points: &[DVec3],
        out: &mut Vec<f64>,
        control: &Control,
    ) -> Result<Vec<u32>, Cancelled> {
        out.clear();
        if self.bvh.lists.is_some() {
            out.resize(points.len(), f64::INFINITY);
            let hard = (0..).zip(points).filter(|(_, point)| is_usable(**point));
            return Ok(hard.map(|(at, _)| at).collect());
        }
        let mut walker = self.bvh.walker();
        let mut hard = Hard::of(self.bvh);
        for group in points.chunks(GROUP) {
            if !hard.are_all && walker.shared_distances_sq(group, out) {
                continue;
            }
            for &point in group {
                let hit = hard.ask(&mut walker, out.len(), point);
                out.push(hit.map_or(f64::INFINITY, |hit| hit.distance_sq));
                walker.poll(control)?;
            }
        }
        self.n_looks.fetch_add(walker.n_visits(), Ordering::Relaxed);
        Ok(hard.points)
    }

    /// The face nearest to every point, in order, for those that take long: the more at a time the
    /// better.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn hard_hits(
        &self,
        points: &[DVec3],
        control: &Control,
    ) -> Result<Vec<Option<Hit>>, Cancelled> {
        if points.is_empty() || self.bvh.triangles.is_empty() {
            return Ok(vec![None; points.len()]);
        }
        let order = if follow_each_other(points, control)? {
            (0..points.len() as u32).collect()
        } else {
            coarse_order(points, control.part(0.0, 0.0))?
        };
        let chunks: Vec<Vec<Option<Hit>>> = order
            .par_chunks(CHUNK)
            .map(|chunk| {
                let points: Vec<DVec3> = chunk.iter().map(|&at| points[at as usize]).collect();
                if self.bvh.lists.is_none() {
                    return self.hits_together(&points, control);
                }
                let (mut hits, hard) = self.asked_one_by_one(&points, control)?;
                let points: Vec<DVec3> = hard.iter().map(|&at| points[at as usize]).collect();
                let found = self.hits_together(&points, control)?;
                hard.iter().zip(found).for_each(|(&at, hit)| hits[at as usize] = hit);
                Ok(hits)
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut hits = vec![None; points.len()];
        for (&at, hit) in order.iter().zip(chunks.into_iter().flatten()) {
            hits[at as usize] = hit;
        }
        Ok(hits)
    }

    /// The face nearest to every point, in order.
    fn hits_together(
        &self,
        points: &[DVec3],
        control: &Control,
    ) -> Result<Vec<Option<Hit>>, Cancelled> {
        if points.is_empty() {
            return Ok(Vec::new());
        }
        if self.panorama.get().is_none() {
            // Another thread may be as far; both found the same.
            let _ = self.panorama.set(Panorama::new(self.bvh, self.center, control)?);
        }
        let Some(all) = self.panorama.get() else { return Ok(vec![None; points.len()]) };
        let mut bulk = Bulk::new(self.bvh, all);
        let hits = bulk.closest(points, control)?;
        self.n_looks.fetch_add(bulk.n_looks, Ordering::Relaxed);
        Ok(hits)
    }
}

/// Whether chunks of the points as they are lie so close together that sorting them costs more than
/// it saves: their boxes are at most [`CLOSE`] of the box around all, on average.
fn follow_each_other(points: &[DVec3], control: &Control) -> Result<bool, Cancelled> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut sum = 0.0;
    for chunk in points.chunks(CHUNK) {
        control.at(0.0)?;
        let (mut low_there, mut high_there) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &point in chunk {
            low_there = low_there.min(point);
            high_there = high_there.max(point);
        }
        sum += low_there.distance(high_there);
        (low, high) = (low.min(low_there), high.max(high_there));
    }
    let n_chunks = points.len().div_ceil(CHUNK);
    Ok(n_chunks == 1 || sum <= CLOSE * n_chunks as f64 * low.distance(high))
}

/// The points that are not asked one by one.
struct Hard {
    points: Vec<u32>,
    patience: usize,
    /// Whether all that follow are hard.
    are_all: bool,
}

impl Hard {
    fn of(bvh: &Bvh) -> Self {
        let patience = if bvh.lists.is_some() { PATIENCE } else { 1 };
        Self { points: Vec::new(), patience, are_all: false }
    }

    /// Asks for a point by the tree, if that takes not too long; otherwise takes note of it.
    fn ask(&mut self, walker: &mut Walker, at: usize, point: DVec3) -> Option<Hit> {
        if !is_usable(point) {
            return None;
        }
        let hit =
            if self.are_all { None } else { walker.closest_by(point, self.patience * MOST_VISITS) };
        if hit.is_none() {
            self.points.push(at as u32);
            self.are_all |= self.points.len() > FEW_HARD + at / HARD_SHARE;
        }
        self.are_all |= walker.n_visits() > self.patience * VISITS_PER_POINT * (SOME_POINTS + at);
        hit
    }
}

#[cfg(test)]
#[path = "many_tests.rs"]
mod tests;
