//! The nearest faces of many points together, where boxes hardly tell one face from another.
//!
//! A group of points has a list of faces of which one is nearest to each of them. The list gets
//! shorter as the group is halved across its longest side. Let `q` be the point of a face nearest
//! to a point `c`, `s` no less than the distance of any other point `y` of the face from `q`, and
//! `q'` the nearest point of all. As the face is convex, `|c - y|² ≥ |c - q|² + |y - q|²`, and for
//! any vector `x`, with the term in `y` at its worst:
//!
//! - The face is no nearer to `c + x` than `√(|c + x - q|² - e)`, where `e = 2 |x| s - s²`, or
//!   `|x|²` if `s > |x|`.
//! - The distance from `c + x` is at most `|c + x - q'|`, so with `|x| ≤ r` the face is never
//!   nearer where `|c - q|² - |c - q'|² ≥ 2 r |q - q'| + e`.
//!
//! No term is as large as the distance: that is as good far away from the mesh as near it, while
//! boxes are all the same from afar. The first line also bounds the distance in a part of the
//! group without a look at the face. Where both are nearest at one vertex, and the face lies behind
//! it as seen from all of the group, it is never nearer either: faces around a hub are one face to
//! what is before the hub.
//!
//! Faces whose distances differ by less than `TIE` count as equally near.

use std::ops::{Range, RangeInclusive};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use mve_core::{Cancelled, Control};

use super::boxes::LEAF;
use super::bvh::{Bvh, GROUP, Hit, Walker, is_usable};

/// Distances that differ by less than this part of them do so by their rounding.
const TIE: f64 = 4.0 * f64::EPSILON;
/// Nodes that one point may take before it counts as hard.
const MOST_VISITS: usize = 512;
/// Hard points beyond so many, and a share of all, end the asking one by one.
const FEW_HARD: usize = 16;
const HARD_SHARE: usize = 32;
/// Nodes that points may take on average before it ends, too.
const VISITS_PER_POINT: usize = 128;
/// A list of so many faces is looked through for each point.
const FEW: usize = 4;
/// The points of groups of about so many are asked one by one if that takes fewer nodes than this
/// share of the list: a node may take as long as some faces of the list.
const SMALL_GROUP: RangeInclusive<usize> = 33..=64;
const SHARE_OF_LIST: usize = 8;
/// Faces between two looks whether the work was cancelled: a millisecond or less.
const STRIDE: usize = 1 << 15;

/// A face as seen from a point.
#[derive(Clone, Copy, Debug)]
struct View {
    slot: u32,
    /// To the point from the nearest point of the face.
    offset: DVec3,
    /// No point of the face is farther from that one.
    size: f64,
}

impl View {
    #[inline]
    fn of(bvh: &Bvh, slot: u32, point: DVec3) -> Self {
        let triangle = &bvh.triangles[slot as usize];
        Self { slot, offset: triangle.offset(point), size: triangle.longest_side() }
    }

    /// What the squared distance from a point so far away may be less than that from the nearest
    /// point here: `e` at the head of this file.
    #[inline]
    fn shortfall(&self, away: f64) -> f64 {
        let near = self.size.min(away);
        near * (2.0 * away - near)
    }
}

/// All faces of a tree as seen from a point.
#[derive(Debug)]
struct Panorama {
    center: DVec3,
    views: Vec<View>,
}

impl Panorama {
    fn new(bvh: &Bvh, center: DVec3, control: &Control) -> Result<Self, Cancelled> {
        let mut views = Vec::new();
        for (at, node) in bvh.nodes.iter().enumerate() {
            control.item(at, usize::MAX)?;
            let slots = node.filled().filter(|child| child & LEAF != 0).map(|child| child & !LEAF);
            views.extend(slots.map(|slot| View::of(bvh, slot, center)));
        }
        Ok(Self { center, views })
    }
}

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

    /// Nodes and faces that were looked at so far, a measure of the work that does not depend on
    /// the machine.
    pub fn n_looks(&self) -> usize {
        self.n_looks.load(Ordering::Relaxed)
    }

    /// The face nearest to every point, in order, into `out`; the same as [`Bvh::closest`] of each
    /// but for the last bits of the distance. Best in an order in which neighbors follow each
    /// other.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn closest(
        &self,
        points: &[DVec3],
        out: &mut Vec<Option<Hit>>,
        control: &Control,
    ) -> Result<(), Cancelled> {
        out.clear();
        out.resize(points.len(), None);
        let mut walker = self.bvh.walker();
        let mut hard = Hard::default();
        for (at, (&point, out)) in points.iter().zip(out.iter_mut()).enumerate() {
            *out = hard.ask(&mut walker, at, point);
            walker.poll(control)?;
        }
        self.ask_together(&mut walker, &hard.points, points, control, |at, hit| out[at] = hit)
    }

    /// The squared distance of every point, in order, into `out`; the same as of
    /// [`ManyQueries::closest`], and faster where points that follow each other lie closer together
    /// than the faces are wide. Points that are not finite and trees without faces give infinity.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn distances_sq(
        &self,
        points: &[DVec3],
        out: &mut Vec<f64>,
        control: &Control,
    ) -> Result<(), Cancelled> {
        let distance_sq = |hit: Option<Hit>| hit.map_or(f64::INFINITY, |hit| hit.distance_sq);
        out.clear();
        let mut walker = self.bvh.walker();
        let mut hard = Hard::default();
        for group in points.chunks(GROUP) {
            if !hard.are_all && walker.shared_distances_sq(group, out) {
                continue;
            }
            for &point in group {
                let hit = hard.ask(&mut walker, out.len(), point);
                out.push(distance_sq(hit));
                walker.poll(control)?;
            }
        }
        let put = |at: usize, hit| out[at] = distance_sq(hit);
        self.ask_together(&mut walker, &hard.points, points, control, put)
    }

    /// Finds the faces nearest to those of the points that are named.
    fn ask_together(
        &self,
        walker: &mut Walker<'a>,
        hard: &[u32],
        points: &[DVec3],
        control: &Control,
        mut put: impl FnMut(usize, Option<Hit>),
    ) -> Result<(), Cancelled> {
        let mut n_looks = walker.n_visits();
        if !hard.is_empty() {
            if self.panorama.get().is_none() {
                // Another thread may be as far; both found the same.
                let _ = self.panorama.set(Panorama::new(self.bvh, self.center, control)?);
            }
            let Some(all) = self.panorama.get() else { return Ok(()) };
            let points: Vec<DVec3> = hard.iter().map(|&at| points[at as usize]).collect();
            let mut bulk = Bulk::new(walker, all);
            let hits = bulk.closest(&points, control)?;
            hard.iter().zip(hits).for_each(|(&at, hit)| put(at as usize, hit));
            n_looks = bulk.n_looks + walker.n_visits();
        }
        self.n_looks.fetch_add(n_looks, Ordering::Relaxed);
        Ok(())
    }
}

/// The points that are not asked one by one.
#[derive(Default)]
struct Hard {
    points: Vec<u32>,
    /// Whether all that follow are hard.
    are_all: bool,
}

impl Hard {
    /// Asks for a point by the tree, if that takes not too long; otherwise takes note of it.
    fn ask(&mut self, walker: &mut Walker, at: usize, point: DVec3) -> Option<Hit> {
        if !is_usable(point) {
            return None;
        }
        let hit = if self.are_all { None } else { walker.closest_by(point, MOST_VISITS) };
        if hit.is_none() {
            self.points.push(at as u32);
            self.are_all |= self.points.len() > FEW_HARD + at / HARD_SHARE;
        }
        self.are_all |= walker.n_visits() > VISITS_PER_POINT * (FEW_HARD + at);
        hit
    }
}

/// Queries that share their work.
struct Bulk<'w, 'a> {
    walker: &'w mut Walker<'a>,
    bvh: &'a Bvh,
    all: &'w Panorama,
    /// The lists of the groups that are being halved, one after the other.
    lists: Vec<View>,
    /// The list in work as seen from its new middle.
    views: Vec<View>,
    /// Faces that were looked at, and how many of them since the last look whether the work was
    /// cancelled.
    n_looks: usize,
    n_unreported: usize,
}

/// A list of faces, as seen from a point.
#[derive(Clone)]
struct List {
    center: DVec3,
    /// In [`Bulk::lists`]; `None` for all faces of the panorama.
    range: Option<Range<usize>>,
}

/// A point and its place among all.
struct Query {
    point: DVec3,
    at: u32,
}

/// Points around a middle.
struct Ball {
    center: DVec3,
    radius: f64,
    /// Of the box around the points.
    longest_axis: usize,
}

impl<'w, 'a> Bulk<'w, 'a> {
    /// For a walker that has asked for some points and taken long.
    fn new(walker: &'w mut Walker<'a>, all: &'w Panorama) -> Self {
        let bvh = walker.bvh();
        Self { walker, bvh, all, lists: Vec::new(), views: Vec::new(), n_looks: 0, n_unreported: 0 }
    }

    /// The face nearest to every point, in order; all are usable.
    fn closest(
        &mut self,
        points: &[DVec3],
        control: &Control,
    ) -> Result<Vec<Option<Hit>>, Cancelled> {
        let mut out = vec![None; points.len()];
        if self.all.views.is_empty() {
            return Ok(out);
        }
        let mut queries: Vec<_> =
            (0..).zip(points).map(|(at, &point)| Query { point, at }).collect();
        let list = List { center: self.all.center, range: None };
        self.solve(&mut queries, &mut out, &list, control)?;
        Ok(out)
    }

    /// Answers queries, each of which has a nearest face in the list.
    fn solve(
        &mut self,
        queries: &mut [Query],
        out: &mut [Option<Hit>],
        list: &List,
        control: &Control,
    ) -> Result<(), Cancelled> {
        if self.n_unreported >= STRIDE {
            self.n_unreported = 0;
            control.at(0.0)?;
        }
        let end = self.lists.len();
        let ball = Ball::around(queries);
        self.shorten(&ball, list);
        let kept = end..self.lists.len();
        let n_single = self.ask_singly(queries, out, kept.clone(), control)?;
        let queries = &mut queries[n_single..];
        if kept.len() <= FEW || queries.len() <= 1 {
            for query in queries {
                out[query.at as usize] = self.nearest_of(kept.clone(), query.point);
            }
        } else {
            let half = queries.len() / 2;
            let along = |query: &Query| query.point[ball.longest_axis];
            queries.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)));
            let (below, above) = queries.split_at_mut(half);
            let kept = List { center: ball.center, range: Some(kept) };
            self.solve(below, out, &kept, control)?;
            self.solve(above, out, &kept, control)?;
        }
        self.lists.truncate(end);
        Ok(())
    }

    /// Asks the queries of a small group with a long list by the tree, as long as that is faster;
    /// says how many have their answer.
    fn ask_singly(
        &mut self,
        queries: &[Query],
        out: &mut [Option<Hit>],
        list: Range<usize>,
        control: &Control,
    ) -> Result<usize, Cancelled> {
        let most_visits = list.len() / SHARE_OF_LIST;
        if !SMALL_GROUP.contains(&queries.len()) || most_visits < FEW {
            return Ok(0);
        }
        self.walker.start_from_slot(self.lists[list.start].slot);
        for (n_done, query) in queries.iter().enumerate() {
            match self.walker.closest_by(query.point, most_visits) {
                Some(hit) => out[query.at as usize] = Some(hit),
                None => return Ok(n_done),
            }
            self.walker.poll(control)?;
        }
        Ok(queries.len())
    }

    /// Puts those of the list that may be nearest to a point of the ball behind all lists, the one
    /// nearest to its middle first.
    fn shorten(&mut self, ball: &Ball, list: &List) {
        let Self { bvh, all, lists, views, n_looks, n_unreported, .. } = self;
        let all = match list.range.clone() {
            Some(range) => &lists[range],
            None => &all.views,
        };
        let moved = ball.center - list.center;
        let away = moved.length();
        let (mut best, mut best_least) = (0, f64::INFINITY);
        for (at, view) in all.iter().enumerate() {
            let least = (view.offset + moved).length_squared() - view.shortfall(away);
            if least < best_least {
                (best, best_least) = (at, least);
            }
        }
        let mut nearest = Nearest::new(View::of(bvh, all[best].slot, ball.center), ball);
        views.clear();
        views.push(nearest.view);
        for (at, view) in all.iter().enumerate() {
            if at == best || ball.is_never_nearer(view, moved, away, &nearest) {
                continue;
            }
            let view = View::of(bvh, view.slot, ball.center);
            views.push(view);
            if view.offset.length_squared() < nearest.distance_sq {
                nearest = Nearest::new(view, ball);
            }
        }
        *n_looks += all.len() + views.len();
        *n_unreported += all.len() + 8 * views.len();
        lists.push(nearest.view);
        lists.extend(views.iter().filter(|view| {
            view.slot != nearest.view.slot
                && !ball.is_never_nearer(view, DVec3::ZERO, 0.0, &nearest)
                && !is_behind(bvh, ball, view, &nearest.view)
        }));
    }

    /// The nearest of a list to a point.
    fn nearest_of(&self, list: Range<usize>, point: DVec3) -> Option<Hit> {
        let hit = |&View { slot, .. }: &View| {
            let distance_sq = self.bvh.triangles[slot as usize].distance_sq(point);
            Hit { distance_sq, face: self.bvh.faces[slot as usize], slot }
        };
        let hits = self.lists[list].iter().map(hit);
        hits.reduce(|a, b| if b.distance_sq < a.distance_sq { b } else { a })
    }
}

impl Ball {
    /// Around at least one point.
    fn around(queries: &[Query]) -> Self {
        if let [Query { point, .. }] = *queries {
            return Self { center: point, radius: 0.0, longest_axis: 0 };
        }
        let (mut low, mut high) = (queries[0].point, queries[0].point);
        for query in queries {
            low = low.min(query.point);
            high = high.max(query.point);
        }
        let center = low * 0.5 + high * 0.5;
        let radius_sq =
            queries.iter().map(|query| query.point.distance_squared(center)).fold(0.0, f64::max);
        let longest_axis = (high - low).max_position();
        Self { center, radius: radius_sq.sqrt() * (1.0 + TIE), longest_axis }
    }

    /// Whether no point of the ball has `other` nearer than `nearest`; `other` as seen from where
    /// the middle was before it moved.
    #[inline]
    fn is_never_nearer(&self, other: &View, moved: DVec3, away: f64, nearest: &Nearest) -> bool {
        let offset = other.offset + moved;
        let gap = offset.length_squared() * (1.0 + TIE) - nearest.rounded_sq;
        // `gap ≥ 2 r |q - q'| + e` without the root.
        let rest = gap - other.shortfall(away + self.radius);
        let apart_sq = offset.distance_squared(nearest.view.offset);
        let is_clear = rest >= 0.0 && rest * rest >= 4.0 * self.radius * self.radius * apart_sq;
        is_clear || gap - other.shortfall(away) >= nearest.room
    }
}

/// The face nearest to the middle of a ball.
#[derive(Clone, Copy)]
struct Nearest {
    view: View,
    /// Its squared distance.
    distance_sq: f64,
    /// The same, less what rounding may add.
    rounded_sq: f64,
    /// A face whose squared distance is larger by this is not nearer to any point of the ball, as
    /// both distances change by at most the radius.
    room: f64,
}

impl Nearest {
    fn new(view: View, ball: &Ball) -> Self {
        let distance_sq = view.offset.length_squared();
        let room = 4.0 * ball.radius * (distance_sq.sqrt() + ball.radius);
        Self { view, distance_sq, rounded_sq: distance_sq * (1.0 - TIE), room }
    }
}

/// Whether both faces are nearest at one vertex, and the other lies behind it: then no point of the
/// ball has another point of it nearer than that vertex.
fn is_behind(bvh: &Bvh, ball: &Ball, other: &View, nearest: &View) -> bool {
    let rounding = TIE * (nearest.offset.length() + other.size);
    if other.offset.distance_squared(nearest.offset) > rounding * rounding {
        return false;
    }
    let corners = bvh.triangles[other.slot as usize].corners_from(ball.center);
    let at = corners.map(|corner| (corner + other.offset).length_squared());
    let vertex = if at[0] <= at[1].min(at[2]) { 0 } else { 1 + usize::from(at[2] < at[1]) };
    at[vertex] <= rounding * rounding
        && corners.iter().all(|&corner| {
            let side = corner - corners[vertex];
            other.offset.dot(side) <= -ball.radius * side.length()
        })
}

#[cfg(test)]
#[path = "bulk_tests.rs"]
mod tests;
