//! The point of a triangle mesh that is closest to a given point.
//!
//! A tree of boxes over the triangles: a node has up to four children, each a node or a single
//! triangle, whose boxes are tested together. Boxes are `f32` in a frame of their own and rounded
//! outward, so that they never cut off a triangle; the distance itself is `f64` in model space, and
//! equal to the least over all faces of [`PreparedTriangle::distance_sq`] to the last bit or so,
//! whatever way the tree was walked. Of several faces at the same distance any may be named.
//!
//! Many queries that lie near each other go through a [`Walker`], which starts each query with the
//! face that the one before found.

use glam::{DVec3, Vec3A, Vec4};

use super::point_triangle::PreparedTriangle;
use crate::data::FaceId;

/// A child that is not there.
pub(super) const EMPTY: u32 = u32::MAX;
/// Set in a child that is a triangle.
pub(super) const LEAF: u32 = 1 << 31;

/// Points that share one walk of the tree in [`Walker::distances_sq`].
const GROUP: usize = 32;
/// The points of a group with more candidates than this are asked one by one: that is faster.
const MOST_CANDIDATES: usize = 20;
/// Groups that are asked one by one, untried, from such a group on.
const PAUSE: u32 = 16;

/// Up to four boxes, one a lane, and what is in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Lowest x, y, z of the four boxes, in the tree's frame.
    pub low: [Vec4; 3],
    /// Highest x, y, z.
    pub high: [Vec4; 3],
    /// Index of a node, or [`LEAF`] and the slot of a triangle, or [`EMPTY`].
    pub child: [u32; 4],
}

impl Node {
    /// Squared distances from the box of a query to the four boxes.
    #[inline(always)]
    fn distances_sq(&self, query: &QueryBox) -> Vec4 {
        let mut sum = Vec4::ZERO;
        for axis in 0..3 {
            let below = self.low[axis] - query.high[axis];
            let above = query.low[axis] - self.high[axis];
            let gap = below.max(above).max(Vec4::ZERO);
            sum += gap * gap;
        }
        sum
    }
}

/// A box in the tree's frame, each bound in all four lanes.
struct QueryBox {
    low: [Vec4; 3],
    high: [Vec4; 3],
}

/// The frame of the boxes: the mesh within about -1 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxFrame {
    pub center: DVec3,
    /// A power of two, so that scaling is exact.
    pub scale: f64,
}

impl BoxFrame {
    /// An `f32` box around a point's image, wider on each side by far more than the rounding of
    /// the subtraction and of the conversion, so that distances between boxes are never too long.
    #[inline]
    pub fn around(&self, point: DVec3) -> (Vec3A, Vec3A) {
        let local = ((point - self.center) * self.scale).as_vec3a();
        let margin = local.abs() * f32::EPSILON * 2.0 + Vec3A::splat(f32::MIN_POSITIVE);
        (local - margin, local + margin)
    }

    /// The frame's squared distance that is no shorter than `distance_sq`, allowing for the
    /// rounding of [`Node::distances_sq`].
    #[inline]
    fn bound(&self, distance_sq: f64) -> f32 {
        (distance_sq * (self.scale * self.scale) * (1.0 + 1e-6)) as f32 + f32::MIN_POSITIVE
    }

    /// The same of a distance, allowing for the rounding of the sum that it is.
    fn reach(&self, distance: f64) -> f32 {
        self.bound(distance * distance * (1.0 + 1e-12))
    }
}

/// The face nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Squared distance in squared model units.
    pub distance_sq: f64,
    /// A face at that distance.
    pub face: FaceId,
    /// Where the tree keeps that face.
    pub(super) slot: u32,
}

/// The faces of one mesh, arranged for closest-point queries.
#[derive(Clone, Debug)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    /// In the order of the tree.
    pub(super) triangles: Vec<PreparedTriangle>,
    /// The face of each triangle.
    pub(super) faces: Vec<FaceId>,
    pub(super) frame: BoxFrame,
    pub(super) n_left_out: usize,
}

impl Bvh {
    /// How many faces can be found.
    pub fn n_faces(&self) -> usize {
        self.triangles.len()
    }

    /// The faces that can be found, in the order of the tree.
    pub fn faces(&self) -> &[FaceId] {
        &self.faces
    }

    /// How many faces of the mesh were left out for their coordinates.
    pub fn n_left_out(&self) -> usize {
        self.n_left_out
    }

    /// The face nearest to `point`: `None` when the tree has no face or the point is not finite.
    pub fn closest(&self, point: DVec3) -> Option<Hit> {
        self.walker().closest(point)
    }

    /// The point of the face of `hit` nearest to `point`.
    pub fn closest_point(&self, point: DVec3, hit: &Hit) -> DVec3 {
        self.triangles[hit.slot as usize].closest_point(point)
    }

    /// Asks for many points, best in an order in which neighbors follow each other.
    pub fn walker(&self) -> Walker<'_> {
        Walker {
            bvh: self,
            stack: Vec::with_capacity(64),
            last: None,
            candidates: Candidates::default(),
            n_pause: 0,
        }
    }
}

/// A node or triangle to look at, and the squared distance to its box.
#[derive(Clone, Copy)]
struct Pending {
    distance_sq: f32,
    child: u32,
}

/// Queries of one tree, each starting from the answer of the one before.
pub struct Walker<'a> {
    bvh: &'a Bvh,
    stack: Vec<Pending>,
    last: Option<u32>,
    /// Of the group of points in work.
    candidates: Candidates,
    /// Groups until the next is tried as one.
    n_pause: u32,
}

impl Walker<'_> {
    /// Starts the next query with the face of `hit`, a hit of this walker's tree.
    pub fn start_from(&mut self, hit: &Hit) {
        self.last = Some(hit.slot);
    }

    /// The squared distance from `point` to the face of `hit`, which may be of another point.
    pub fn distance_sq_to(&self, point: DVec3, hit: &Hit) -> f64 {
        self.triangle(hit).distance_sq(point)
    }

    /// The face of `hit`, ready for distances.
    pub(super) fn triangle(&self, hit: &Hit) -> &PreparedTriangle {
        &self.bvh.triangles[hit.slot as usize]
    }

    /// The face nearest to `point`: `None` when the tree has no face or the point is not finite.
    pub fn closest(&mut self, point: DVec3) -> Option<Hit> {
        if !is_usable(point) {
            return None;
        }
        let slot = self.last.unwrap_or(0);
        let distance_sq = self.bvh.triangles.get(slot as usize)?.distance_sq(point);
        let (distance_sq, slot) = self.descend(point, distance_sq, slot);
        self.last = Some(slot);
        Some(Hit { distance_sq, face: self.bvh.faces[slot as usize], slot })
    }

    /// Walks the whole tree, near boxes first, for a face nearer than that of `slot`.
    fn descend(&mut self, point: DVec3, distance_sq: f64, slot: u32) -> (f64, u32) {
        let bvh = self.bvh;
        let (low, high) = bvh.frame.around(point);
        let query = QueryBox::new(low, high);
        let (mut best, mut best_slot) = (distance_sq, slot);
        let mut bound = bvh.frame.bound(best);
        let stack = &mut self.stack;
        stack.clear();
        let mut next = Some(Pending { distance_sq: 0.0, child: 0 });
        while let Some(pending) = next {
            if pending.distance_sq > bound {
                next = stack.pop();
                continue;
            }
            let node = &bvh.nodes[pending.child as usize];
            let distances = node.distances_sq(&query);
            let mut near = distances.cmple(Vec4::splat(bound)).bitmask();
            let distances = distances.to_array();
            let first = stack.len();
            while near != 0 {
                let lane = near.trailing_zeros() as usize & 3;
                near &= near - 1;
                let child = node.child[lane];
                if child & LEAF == 0 {
                    push_far_first(stack, first, Pending { distance_sq: distances[lane], child });
                } else if child != EMPTY && child & !LEAF != best_slot && distances[lane] <= bound {
                    let found = bvh.triangles[(child & !LEAF) as usize].distance_sq(point);
                    if found < best {
                        (best, best_slot) = (found, child & !LEAF);
                        bound = bvh.frame.bound(best);
                    }
                }
            }
            next = stack.pop();
        }
        (best, best_slot)
    }

    /// The squared distance of every point, in order, into `out`; the same as [`Walker::closest`]
    /// of each, and faster where points that follow each other lie closer together than the faces
    /// are wide. Points that are not finite and trees without faces give infinity.
    pub fn distances_sq(&mut self, points: &[DVec3], out: &mut Vec<f64>) {
        out.clear();
        for group in points.chunks(GROUP) {
            self.n_pause = self.n_pause.saturating_sub(1);
            let is_group = self.n_pause == 0 && group.iter().all(|&p| is_usable(p));
            if is_group && self.group_distances_sq(group, out) {
                continue;
            }
            if is_group {
                self.n_pause = PAUSE;
            }
            let distance = |p: &DVec3| self.closest(*p).map_or(f64::INFINITY, |h| h.distance_sq);
            out.extend(group.iter().map(distance));
        }
    }

    /// Walks the tree once for all points of a group, if few faces may be nearest to one of them:
    /// otherwise says `false` and leaves `out` as it was.
    ///
    /// With `c` the middle point of the group and `r` the largest distance of the others from it,
    /// every point has a face within `d(c) + r`, and within its distance from the face nearest to
    /// `c`: a face whose box is farther than that from the box around the points is nearest to
    /// none.
    fn group_distances_sq(&mut self, points: &[DVec3], out: &mut Vec<f64>) -> bool {
        let middle = points[points.len() / 2];
        let Some(hit) = self.closest(middle) else { return false };
        let bvh = self.bvh;
        let spread = Spread::of(points, middle);
        let triangle = &bvh.triangles[hit.slot as usize];
        let first = out.len();
        out.extend(points.iter().map(|&p| triangle.distance_sq(p)));
        let most_sq = out[first..].iter().copied().fold(0.0, f64::max);
        let reach = (hit.distance_sq.sqrt() + spread.radius).min(most_sq.sqrt());
        let bound = bvh.frame.reach(reach);
        let query = spread.query(&bvh.frame);
        self.candidates.clear();
        self.stack.clear();
        self.stack.push(Pending { distance_sq: 0.0, child: 0 });
        while let Some(pending) = self.stack.pop() {
            let node = &bvh.nodes[pending.child as usize];
            let mut near = node.distances_sq(&query).cmple(Vec4::splat(bound)).bitmask();
            while near != 0 {
                let lane = near.trailing_zeros() as usize & 3;
                near &= near - 1;
                let child = node.child[lane];
                if child & LEAF == 0 {
                    self.stack.push(Pending { distance_sq: 0.0, child });
                } else if child != EMPTY && child & !LEAF != hit.slot {
                    self.candidates.push(node, lane);
                }
            }
            if self.candidates.n > MOST_CANDIDATES {
                out.truncate(first);
                return false;
            }
        }
        if self.candidates.n > 0 {
            for (distance_sq, &point) in out[first..].iter_mut().zip(points) {
                *distance_sq = self.candidates.nearest_sq(bvh, point, *distance_sq);
            }
        }
        true
    }
}

/// The box around some points, and how far they are from one of them.
struct Spread {
    low: DVec3,
    high: DVec3,
    radius: f64,
}

impl Spread {
    fn of(points: &[DVec3], middle: DVec3) -> Self {
        let (mut low, mut high) = (middle, middle);
        let mut radius_sq = 0.0f64;
        for &point in points {
            low = low.min(point);
            high = high.max(point);
            radius_sq = radius_sq.max(point.distance_squared(middle));
        }
        Self { low, high, radius: radius_sq.sqrt() }
    }

    fn query(&self, frame: &BoxFrame) -> QueryBox {
        QueryBox::new(frame.around(self.low).0, frame.around(self.high).1)
    }
}

/// Triangles that may be nearest, four boxes a node.
#[derive(Default)]
struct Candidates {
    boxes: Vec<Node>,
    n: usize,
}

impl Candidates {
    fn clear(&mut self) {
        self.boxes.clear();
        self.n = 0;
    }

    #[inline]
    fn push(&mut self, node: &Node, lane: usize) {
        if self.n & 3 == 0 {
            self.boxes.push(Node::empty());
        }
        if let Some(last) = self.boxes.last_mut() {
            last.copy_lane(self.n & 3, node, lane);
        }
        self.n += 1;
    }

    /// The least squared distance of these triangles, or the given one if that is less.
    #[inline]
    fn nearest_sq(&self, bvh: &Bvh, point: DVec3, distance_sq: f64) -> f64 {
        let mut best = distance_sq;
        let mut bound = bvh.frame.bound(best);
        let (low, high) = bvh.frame.around(point);
        let query = QueryBox::new(low, high);
        for boxes in &self.boxes {
            let distances = boxes.distances_sq(&query);
            let mut near = distances.cmple(Vec4::splat(bound)).bitmask();
            while near != 0 {
                let lane = near.trailing_zeros() as usize & 3;
                near &= near - 1;
                if boxes.child[lane] == EMPTY {
                    continue;
                }
                let slot = (boxes.child[lane] & !LEAF) as usize;
                let found = bvh.triangles[slot].distance_sq(point);
                if found < best {
                    best = found;
                    bound = bvh.frame.bound(best);
                }
            }
        }
        best
    }
}

/// Whether squared distances from the point are finite numbers.
pub(super) fn is_usable(point: DVec3) -> bool {
    point.abs().max_element() <= 1e150 && !point.is_nan()
}

/// Puts `pending` on the stack, below those from `first` on that are nearer.
#[inline]
fn push_far_first(stack: &mut Vec<Pending>, first: usize, pending: Pending) {
    stack.push(pending);
    let mut at = stack.len() - 1;
    while at > first && stack[at - 1].distance_sq < pending.distance_sq {
        stack.swap(at - 1, at);
        at -= 1;
    }
}

impl QueryBox {
    #[inline]
    fn new(low: Vec3A, high: Vec3A) -> Self {
        Self { low: low.to_array().map(Vec4::splat), high: high.to_array().map(Vec4::splat) }
    }
}

impl Node {
    /// A node whose lanes are all out of reach.
    pub fn empty() -> Self {
        Self { low: [Vec4::INFINITY; 3], high: [Vec4::NEG_INFINITY; 3], child: [EMPTY; 4] }
    }

    /// Puts a box and its content into a lane.
    pub fn set_lane(&mut self, lane: usize, low: Vec3A, high: Vec3A, child: u32) {
        for axis in 0..3 {
            self.low[axis][lane] = low[axis];
            self.high[axis][lane] = high[axis];
        }
        self.child[lane] = child;
    }

    #[inline]
    fn copy_lane(&mut self, lane: usize, from: &Node, from_lane: usize) {
        for axis in 0..3 {
            self.low[axis][lane] = from.low[axis][from_lane];
            self.high[axis][lane] = from.high[axis][from_lane];
        }
        self.child[lane] = from.child[from_lane];
    }
}
