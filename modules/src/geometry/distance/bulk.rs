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
//! boxes are all the same from afar. Where the face recedes from `q` as seen from all of the group,
//! `e` is less: with the corners of the face at `q + w`, it is at most the largest of
//! `2 (|x| |w| + (c - q) · w)`, and 0 where all of these are negative. Faces around a hub are one
//! face to what is before the hub.
//!
//! A group that is small enough takes its whole list, point by point: the second line for all faces
//! gives a bound, and the faces that the first line does not put beyond it are looked at.
//!
//! Faces whose distances differ by less than `TIE` count as equally near.

use std::ops::Range;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use wide::f64x4;

use super::boxes::LEAF;
use super::bvh::{Bvh, Hit};

/// Distances that differ by less than this part of them do so by their rounding.
const TIE: f64 = 4.0 * f64::EPSILON;
/// A group of so many points, or a list of so many faces, is small: its points take the whole list.
const FEW_POINTS: usize = 64;
const FEW_FACES: usize = 16;
/// The middle of a part of a group is no farther from that of the group than this many times the
/// group's radius: the middles are those of boxes, and their boxes lie in each other.
const PARTS_WITHIN: f64 = 1.1;
/// Faces between two looks whether the work was cancelled: a millisecond or less.
const STRIDE: usize = 1 << 15;

/// A face as seen from the middle of a group.
#[derive(Clone, Copy, Debug)]
struct FaceView {
    slot: u32,
    /// To the middle from the nearest point of the face.
    offset: DVec3,
    /// No point of the face is farther from that one.
    size: f64,
    /// What [`FaceView::shortfall`] is at most for points of the group.
    most_shortfall: f64,
}

impl FaceView {
    #[inline]
    fn of(bvh: &Bvh, slot: u32, ball: &Ball) -> Self {
        let triangle = &bvh.triangles[slot as usize];
        let offset = triangle.offset(ball.center);
        let reach = PARTS_WITHIN * ball.radius;
        let mut most_shortfall = 0.0f64;
        for corner in triangle.corners_from(ball.center) {
            let corner = corner + offset;
            let term = reach * corner.length() + offset.dot(corner);
            most_shortfall = most_shortfall.max(2.0 * term);
        }
        Self { slot, offset, size: triangle.longest_side(), most_shortfall }
    }

    /// What the squared distance from a point so far away may be less than that from the nearest
    /// point here: `e` at the head of this file.
    #[inline]
    fn shortfall(&self, away: f64) -> f64 {
        let near = self.size.min(away);
        (near * (2.0 * away - near)).min(self.most_shortfall)
    }
}

/// All faces of a tree as seen from a point.
#[derive(Debug)]
pub(super) struct Panorama {
    ball: Ball,
    views: Vec<FaceView>,
}

impl Panorama {
    pub fn new(bvh: &Bvh, center: DVec3, control: &Control) -> Result<Self, Cancelled> {
        let ball = Ball { center, radius: f64::INFINITY, longest_axis: 0 };
        let mut views = Vec::with_capacity(bvh.triangles.len());
        if bvh.lists.is_some() {
            for slot in 0..bvh.triangles.len() - bvh.copies.len() {
                control.item(slot, usize::MAX)?;
                views.push(FaceView::of(bvh, slot as u32, &ball));
            }
            return Ok(Self { ball, views });
        }
        for (at, node) in bvh.nodes.iter().enumerate() {
            control.item(at, usize::MAX)?;
            for slot in node.filled().filter(|child| child & LEAF != 0).map(|child| child & !LEAF) {
                views.push(FaceView::of(bvh, slot, &ball));
            }
        }
        Ok(Self { ball, views })
    }
}

/// Queries that share their work.
pub(super) struct Bulk<'a> {
    bvh: &'a Bvh,
    all: &'a Panorama,
    /// The lists of the groups that are being divided, one after the other.
    lists: Vec<FaceView>,
    /// The list in work as seen from its new middle.
    views: Vec<FaceView>,
    /// The list that points take as a whole, four faces together.
    fours: Vec<Four>,
    /// Squared distances from a point to what is nearest to the middle, of these.
    distances_sq: Vec<f64x4>,
    /// Faces that were looked at, and how many of them since the last look whether the work was
    /// cancelled.
    pub n_looks: usize,
    n_unreported: usize,
}

/// The offsets of four views, and their shortfalls.
#[derive(Clone, Copy)]
struct Four {
    offset: [f64x4; 3],
    shortfall: f64x4,
}

/// A list of faces, as seen from the middle of a group.
struct List {
    ball: Ball,
    /// In [`Bulk::lists`]; `None` for all faces of the panorama.
    range: Option<Range<usize>>,
}

/// A point and its place among all.
struct Query {
    point: DVec3,
    at: u32,
}

/// Points around a middle.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: DVec3,
    radius: f64,
    /// Of the box around the points.
    longest_axis: usize,
}

impl<'a> Bulk<'a> {
    pub fn new(bvh: &'a Bvh, all: &'a Panorama) -> Self {
        let (lists, views, fours, distances_sq) = Default::default();
        Self { bvh, all, lists, views, fours, distances_sq, n_looks: 0, n_unreported: 0 }
    }

    /// The face nearest to every point, in order; all are usable.
    pub fn closest(
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
        let list = List { ball: self.all.ball, range: None };
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
        self.poll(control)?;
        let end = self.lists.len();
        let ball = Ball::around(queries);
        self.shorten(&ball, list);
        let kept = end..self.lists.len();
        if kept.len() <= FEW_FACES || queries.len() <= FEW_POINTS {
            self.look_through(queries, out, &ball, kept, control)?;
        } else {
            let kept = List { ball, range: Some(kept) };
            // Two cuts at once, as a shorter list costs more than it saves after one.
            for half in halves(queries, &ball) {
                let ball = Ball::around(half);
                for quarter in halves(half, &ball) {
                    self.solve(quarter, out, &kept, control)?;
                }
            }
        }
        self.lists.truncate(end);
        Ok(())
    }

    /// Looks whether the work was cancelled, if some was done since the last look.
    #[inline]
    fn poll(&mut self, control: &Control) -> Result<(), Cancelled> {
        if self.n_unreported < STRIDE {
            return Ok(());
        }
        self.n_unreported = 0;
        control.at(0.0)
    }

    /// Answers the queries of a ball, each by the whole list.
    fn look_through(
        &mut self,
        queries: &[Query],
        out: &mut [Option<Hit>],
        ball: &Ball,
        list: Range<usize>,
        control: &Control,
    ) -> Result<(), Cancelled> {
        self.fours.clear();
        self.fours.extend(self.lists[list.clone()].chunks(4).map(|views| Four::of(views, ball)));
        for query in queries {
            out[query.at as usize] = self.nearest_of(list.start, query.point, ball);
            self.n_looks += list.len() / 2;
            self.n_unreported += list.len() / 2;
            self.poll(control)?;
        }
        Ok(())
    }

    /// The nearest to a point of the ball among the faces in `fours`, the first of which is at
    /// `start` of the lists.
    fn nearest_of(&mut self, start: usize, point: DVec3, ball: &Ball) -> Option<Hit> {
        let Self { bvh, lists, fours, distances_sq, n_looks, n_unreported, .. } = self;
        let moved = (point - ball.center).to_array().map(f64x4::splat);
        let mut least = f64x4::splat(f64::INFINITY);
        distances_sq.clear();
        distances_sq.extend(fours.iter().map(|four| {
            let [x, y, z] = [0, 1, 2].map(|axis| four.offset[axis] + moved[axis]);
            let distance_sq = x * x + y * y + z * z;
            least = least.fast_min(distance_sq);
            distance_sq
        }));
        let least = least.to_array().into_iter().fold(f64::INFINITY, f64::min);
        let mut best: Option<Hit> = None;
        let mut bound = least * (1.0 + TIE);
        for (k, (four, &distance_sq)) in fours.iter().zip(distances_sq.iter()).enumerate() {
            let least_sq = distance_sq - four.shortfall;
            let mut near = least_sq.simd_le(f64x4::splat(bound)).to_bitmask();
            while near != 0 {
                let slot = lists[start + 4 * k + near.trailing_zeros() as usize].slot;
                near &= near - 1;
                let distance_sq = bvh.triangles[slot as usize].distance_sq(point);
                *n_looks += 1;
                *n_unreported += 1;
                if best.is_none_or(|best| distance_sq < best.distance_sq) {
                    best = Some(Hit { distance_sq, face: bvh.faces[slot as usize], slot });
                    bound = bound.min(distance_sq);
                }
            }
        }
        best
    }

    /// Puts those of the list that may be nearest to a point of the ball behind all lists, the one
    /// nearest to its middle first.
    fn shorten(&mut self, ball: &Ball, list: &List) {
        let Self { bvh, all, lists, views, n_looks, n_unreported, .. } = self;
        let all = match list.range.clone() {
            Some(range) => &lists[range],
            None => &all.views,
        };
        let moved = ball.center - list.ball.center;
        let away = moved.length();
        let (mut best, mut best_least) = (0, f64::INFINITY);
        for (at, view) in all.iter().enumerate() {
            let least = (view.offset + moved).length_squared() - view.shortfall(away);
            if least < best_least {
                (best, best_least) = (at, least);
            }
        }
        let mut nearest = Nearest::new(FaceView::of(bvh, all[best].slot, ball), ball);
        views.clear();
        views.push(nearest.view);
        for (at, view) in all.iter().enumerate() {
            if at == best || ball.is_never_nearer(view, moved, away, &nearest) {
                continue;
            }
            let view = FaceView::of(bvh, view.slot, ball);
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
        }));
    }
}

/// The queries on both sides of the middle one along the longest axis; all of them and none where
/// there are not two.
fn halves<'q>(queries: &'q mut [Query], ball: &Ball) -> impl Iterator<Item = &'q mut [Query]> {
    let half = queries.len() / 2;
    let along = |query: &Query| query.point[ball.longest_axis];
    if half > 0 {
        queries.select_nth_unstable_by(half, |a, b| {
            along(a).total_cmp(&along(b)).then(a.at.cmp(&b.at))
        });
    }
    let (below, above) = queries.split_at_mut(half);
    [below, above].into_iter().filter(|half| !half.is_empty())
}

impl Four {
    /// Of up to four views; what is missing is infinitely far.
    fn of(views: &[FaceView], ball: &Ball) -> Self {
        let lanes = |of: &dyn Fn(&FaceView) -> f64, missing: f64| {
            f64x4::from([0, 1, 2, 3].map(|lane| views.get(lane).map_or(missing, of)))
        };
        Self {
            offset: [0, 1, 2].map(|axis| lanes(&|view| view.offset[axis], f64::INFINITY)),
            shortfall: lanes(&|view| view.shortfall(ball.radius), 0.0),
        }
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
    fn is_never_nearer(
        &self,
        other: &FaceView,
        moved: DVec3,
        away: f64,
        nearest: &Nearest,
    ) -> bool {
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
    view: FaceView,
    /// Its squared distance.
    distance_sq: f64,
    /// The same, less what rounding may add.
    rounded_sq: f64,
    /// A face whose squared distance is larger by this is not nearer to any point of the ball, as
    /// both distances change by at most the radius.
    room: f64,
}

impl Nearest {
    fn new(view: FaceView, ball: &Ball) -> Self {
        let distance_sq = view.offset.length_squared();
        let room = 4.0 * ball.radius * (distance_sq.sqrt() + ball.radius);
        Self { view, distance_sq, rounded_sq: distance_sq * (1.0 - TIE), room }
    }
}
