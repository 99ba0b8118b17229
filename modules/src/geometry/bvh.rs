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

use super::bvh_build;
use super::control::{Cancelled, Control};
use super::point_triangle::PreparedTriangle;
use crate::data::{FaceId, TriMesh};

/// A child that is not there.
pub(super) const EMPTY: u32 = u32::MAX;
/// Set in a child that is a triangle.
pub(super) const LEAF: u32 = 1 << 31;

/// Points of a batch beyond this many candidate faces are asked one by one.
const MOST_CANDIDATES: usize = 64;

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
pub(super) struct Frame {
    pub center: DVec3,
    /// A power of two, so that scaling is exact.
    pub scale: f64,
}

impl Frame {
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
    pub(super) frame: Frame,
    pub(super) n_left_out: usize,
}

impl Bvh {
    /// Arranges the faces, O(n log n). Faces with a corner that is not finite, or beyond 1e150, or
    /// not there are left out and counted; degenerate faces are kept as the segment or point that
    /// they are.
    pub fn build(mesh: &TriMesh, control: Control) -> Result<Self, Cancelled> {
        bvh_build::build(mesh, control)
    }

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
        Walker { bvh: self, stack: Vec::with_capacity(64), last: None, candidates: Vec::new() }
    }
}

/// A node or triangle to look at, and the squared distance to its box.
#[derive(Clone, Copy)]
struct Pending {
    distance_sq: f32,
    child: u32,
}

/// Up to four triangles that may be nearest to a point of a batch.
struct Candidates {
    boxes: Node,
}

/// Queries of one tree, each starting from the answer of the one before.
pub struct Walker<'a> {
    bvh: &'a Bvh,
    stack: Vec<Pending>,
    last: Option<u32>,
    candidates: Vec<Candidates>,
}

impl Walker<'_> {
    /// Starts the next query with the face of `hit`, a hit of this walker's tree.
    pub fn start_from(&mut self, hit: &Hit) {
        self.last = Some(hit.slot);
    }

    /// The squared distance from `point` to the face of `hit`, which may be of another point.
    pub fn distance_sq_to(&self, point: DVec3, hit: &Hit) -> f64 {
        self.bvh.triangles[hit.slot as usize].distance_sq(point)
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
    /// of each, and fast when the points lie close together, about as far from each other as from
    /// the next face. Points that are not finite and trees without faces give infinity.
    pub fn distances_sq(&mut self, points: &[DVec3], out: &mut Vec<f64>) {
        out.clear();
        let is_batch = points.len() > 2 && points.iter().all(|&p| is_usable(p));
        if !(is_batch && self.gather(points)) {
            let each =
                points.iter().map(|&p| self.closest(p).map_or(f64::INFINITY, |h| h.distance_sq));
            out.extend(each);
            return;
        }
        for &point in points {
            out.push(self.scan(point));
        }
    }

    /// Collects the triangles that may be nearest to one of the points; says whether they are few.
    ///
    /// With `c` the middle point of the batch and `r` the largest distance of the others from it,
    /// every point has a face within `d(c) + r`: a face whose box is farther than that from the box
    /// around the points is nearest to none.
    fn gather(&mut self, points: &[DVec3]) -> bool {
        let middle = points[points.len() / 2];
        let Some(hit) = self.closest(middle) else { return false };
        let (mut low, mut high) = (points[0], points[0]);
        let mut radius_sq = 0.0f64;
        for &point in points {
            low = low.min(point);
            high = high.max(point);
            radius_sq = radius_sq.max(point.distance_squared(middle));
        }
        let bvh = self.bvh;
        let reach = hit.distance_sq.sqrt() + radius_sq.sqrt();
        let bound = bvh.frame.bound(reach * reach * (1.0 + 1e-12));
        let query = QueryBox::new(bvh.frame.around(low).0, bvh.frame.around(high).1);
        self.candidates.clear();
        let mut fill = 4;
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
                } else if child != EMPTY {
                    if fill == 4 {
                        self.candidates.push(Candidates { boxes: Node::empty() });
                        fill = 0;
                    }
                    let last = self.candidates.len() - 1;
                    self.candidates[last].boxes.copy_lane(fill, node, lane);
                    fill += 1;
                }
            }
            if self.candidates.len() * 4 > MOST_CANDIDATES {
                return false;
            }
        }
        true
    }

    /// The squared distance of a point of the batch to the nearest candidate.
    #[inline]
    fn scan(&mut self, point: DVec3) -> f64 {
        let bvh = self.bvh;
        let mut slot = self.last.unwrap_or(0);
        let mut best = bvh.triangles[slot as usize].distance_sq(point);
        let mut bound = bvh.frame.bound(best);
        let (low, high) = bvh.frame.around(point);
        let query = QueryBox::new(low, high);
        for candidates in &self.candidates {
            let distances = candidates.boxes.distances_sq(&query);
            let mut near = distances.cmple(Vec4::splat(bound)).bitmask();
            while near != 0 {
                let lane = near.trailing_zeros() as usize & 3;
                near &= near - 1;
                let candidate = candidates.boxes.child[lane];
                if candidate == EMPTY || candidate & !LEAF == slot {
                    continue;
                }
                let found = bvh.triangles[(candidate & !LEAF) as usize].distance_sq(point);
                if found < best {
                    (best, slot) = (found, candidate & !LEAF);
                    bound = bvh.frame.bound(best);
                }
            }
        }
        self.last = Some(slot);
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
