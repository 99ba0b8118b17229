//! The point of a triangle mesh that is closest to a given point.
//!
//! A tree of boxes over the triangles: a node has up to four children, each a node or a single
//! triangle, whose boxes are tested together. The boxes of a node are turned along its triangles
//! where that makes them smaller (Gottschalk, Lin & Manocha, "OBBTree", SIGGRAPH 1996), so that
//! long thin faces have long thin boxes. They are `f32` and taken as wider than that rounds, so
//! that they never cut off a triangle; the distance itself is `f64` in model space, and equal to
//! the least over all faces of [`PreparedTriangle::distance_sq`] to the last bits, whatever way the
//! tree was walked. Of several faces at the same distance any may be named.
//!
//! Many queries that lie near each other go through a [`Walker`], which starts each query with the
//! face that the one before found; where boxes do not help, [`many`](super::many) does.

use glam::{DVec3, Vec4};
use mve_core::{Cancelled, Control};
use mve_mesh::data::FaceId;

use super::boxes::{BoxFrame, EMPTY, LEAF, Node, QueryPoint};
use super::group::{Candidates, PointBox};
use super::lists::{ListQuery, SlotLists};
use super::point_triangle::PreparedTriangle;

/// Points that share one walk of the tree.
pub(super) const GROUP: usize = 32;
/// The points of a group with more candidates than this are asked one by one: that is faster.
const MOST_CANDIDATES: usize = 20;
/// So are those whose walk looks at more nodes than this.
const MOST_GROUP_VISITS: usize = 256;
/// Groups that are asked one by one, untried, from such a group on.
const PAUSE: u32 = 16;

/// Nodes between two looks whether the work was cancelled: a millisecond or less.
const STRIDE: usize = 1 << 15;

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
    /// Slots of the tree, in order, each with another face of the same corners.
    pub(super) copies: Vec<(u32, FaceId)>,
    pub(super) frame: BoxFrame,
    pub(super) n_left_out: usize,
    /// Where faces lie across each other, what leaves stand for: lists of slots, as several boxes
    /// have the same face. Otherwise each leaf is a slot.
    pub(super) lists: Option<SlotLists>,
}

impl Bvh {
    /// The middle of the box around the faces.
    pub fn center(&self) -> DVec3 {
        self.frame.center
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

    /// The faces with the corners of that of `hit`, itself among them.
    pub fn same_as(&self, hit: &Hit) -> impl Iterator<Item = FaceId> {
        let first = self.copies.partition_point(|&(slot, _)| slot < hit.slot);
        let copies = self.copies[first..].iter().take_while(|&&(slot, _)| slot == hit.slot);
        std::iter::once(hit.face).chain(copies.map(|&(_, face)| face))
    }

    /// Asks for many points, best in an order in which neighbors follow each other.
    pub fn walker(&self) -> Walker<'_> {
        Walker {
            bvh: self,
            stack: Vec::with_capacity(64),
            last: None,
            candidates: Candidates::default(),
            n_pause: 0,
            n_visits: 0,
            n_reported: 0,
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
    /// Nodes that single queries looked at.
    n_visits: usize,
    /// Those at the last look whether the work was cancelled.
    n_reported: usize,
}

impl<'a> Walker<'a> {
    /// Nodes that were looked at so far.
    pub fn n_visits(&self) -> usize {
        self.n_visits
    }

    /// Looks whether the work was cancelled, if the queries have done some work since it last did.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn poll(&mut self, control: &Control) -> Result<(), Cancelled> {
        if self.n_visits - self.n_reported < STRIDE {
            return Ok(());
        }
        self.n_reported = self.n_visits;
        control.at(0.0)
    }

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
        self.closest_by(point, usize::MAX)
    }

    /// The same, if no more than so many nodes have to be looked at; of a usable point.
    pub(super) fn closest_by(&mut self, point: DVec3, most_visits: usize) -> Option<Hit> {
        self.near(point, 0.0, most_visits)
    }

    /// A face at most this squared distance from a usable point, if one is found among so many
    /// nodes.
    pub(super) fn within_reach(
        &mut self,
        point: DVec3,
        distance_sq: f64,
        most_visits: usize,
    ) -> Option<Hit> {
        let found = self.near(point, distance_sq, most_visits);
        found.filter(|hit| hit.distance_sq <= distance_sq)
    }

    /// A face at most this squared distance from a usable point, or the nearest where none is.
    pub(super) fn reach(&mut self, point: DVec3, distance_sq: f64) -> Option<Hit> {
        self.near(point, distance_sq, usize::MAX)
    }

    /// The nearest face, or one at most `enough` away, squared.
    fn near(&mut self, point: DVec3, enough: f64, most_visits: usize) -> Option<Hit> {
        let slot = self.last.unwrap_or(0);
        let distance_sq = self.bvh.triangles.get(slot as usize)?.distance_sq(point);
        let start = (distance_sq, slot);
        let (distance_sq, slot) = match &self.bvh.lists {
            _ if distance_sq <= enough => start,
            None => self.descend(point, start, enough, most_visits)?,
            Some(lists) => self.descend_to_lists(lists, point, start, enough, most_visits)?,
        };
        self.last = Some(slot);
        Some(Hit { distance_sq, face: self.bvh.faces[slot as usize], slot })
    }

    /// Up to `most` faces that are no farther than `distance` from a usable point, into `out`; of
    /// faces with the same corners one.
    pub fn within(&mut self, point: DVec3, distance: f64, most: usize, out: &mut Vec<Hit>) {
        out.clear();
        let bvh = self.bvh;
        let query = bvh.frame.query(point);
        let (limit_sq, bound) = (distance * distance, bvh.frame.reach(distance));
        self.stack.clear();
        self.stack.push(Pending { distance_sq: 0.0, child: 0 });
        while let Some(pending) = self.stack.pop() {
            let node = &bvh.nodes[pending.child as usize];
            self.n_visits += 1;
            let mut near = node.distances_sq(&query).cmple(Vec4::splat(bound)).bitmask();
            while near != 0 {
                let child = node.child[near.trailing_zeros() as usize & 3];
                near &= near - 1;
                if child & LEAF == 0 {
                    self.stack.push(Pending { distance_sq: 0.0, child });
                } else if child != EMPTY {
                    let slot = [child & !LEAF];
                    let slots = bvh.lists.as_ref().map_or(&slot[..], |lists| lists.of(slot[0]));
                    for &slot in slots {
                        let distance_sq = bvh.triangles[slot as usize].distance_sq(point);
                        // A face may have several boxes.
                        if distance_sq <= limit_sq && out.iter().all(|hit| hit.slot != slot) {
                            out.push(Hit { distance_sq, face: bvh.faces[slot as usize], slot });
                        }
                        if out.len() == most {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// Walks the tree, near boxes first, for a face nearer than that of the slot, until one is at
    /// most `enough` away.
    fn descend(
        &mut self,
        point: DVec3,
        (mut best, mut best_slot): (f64, u32),
        enough: f64,
        most_visits: usize,
    ) -> Option<(f64, u32)> {
        let bvh = self.bvh;
        let query = bvh.frame.query(point);
        let last_visit = self.n_visits.saturating_add(most_visits);
        let mut bound = bvh.frame.bound(best);
        let stack = &mut self.stack;
        stack.clear();
        let mut next = Some(Pending { distance_sq: 0.0, child: 0 });
        while let Some(pending) = next {
            if best <= enough {
                break;
            }
            if pending.distance_sq > bound {
                next = stack.pop();
                continue;
            }
            if self.n_visits >= last_visit {
                return None;
            }
            let node = &bvh.nodes[pending.child as usize];
            self.n_visits += 1;
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
        Some((best, best_slot))
    }

    /// The same in a tree of lists: first the list of the cell that the point is in, then those in
    /// the tree, if any can have something nearer.
    fn descend_to_lists(
        &mut self,
        lists: &SlotLists,
        point: DVec3,
        start: (f64, u32),
        enough: f64,
        most_visits: usize,
    ) -> Option<(f64, u32)> {
        let bvh = self.bvh;
        let local = bvh.frame.local(point);
        let query = QueryPoint::new(local);
        let mut nearest = ListQuery::new((&bvh.frame, &bvh.triangles), lists, point, &query, start);
        let last_visit = self.n_visits.saturating_add(most_visits);
        let mut seen = EMPTY;
        if let Some((list, gap)) = lists.grid.as_ref().and_then(|grid| grid.list_at(local)) {
            self.n_visits += 1 + lists.of(list).len() / 4;
            nearest.look_through(list, enough);
            if nearest.best <= enough || f64::from(nearest.bound) < gap * gap {
                return Some((nearest.best, nearest.slot));
            }
            seen = list;
        }
        let stack = &mut self.stack;
        stack.clear();
        let mut next = Some(Pending { distance_sq: 0.0, child: 0 });
        while let Some(pending) = next {
            if nearest.best <= enough {
                break;
            }
            if pending.distance_sq > nearest.bound {
                next = stack.pop();
                continue;
            }
            if self.n_visits >= last_visit {
                return None;
            }
            self.n_visits += 1;
            if pending.child & LEAF != 0 {
                let list = pending.child & !LEAF;
                self.n_visits += lists.of(list).len() / 4;
                nearest.look_through(list, enough);
                next = stack.pop();
                continue;
            }
            let node = &bvh.nodes[pending.child as usize];
            let distances = node.distances_sq(&query);
            let mut near = distances.cmple(Vec4::splat(nearest.bound)).bitmask();
            let distances = distances.to_array();
            let first = stack.len();
            while near != 0 {
                let lane = near.trailing_zeros() as usize & 3;
                near &= near - 1;
                let child = node.child[lane];
                if child != EMPTY && child != LEAF | seen {
                    push_far_first(stack, first, Pending { distance_sq: distances[lane], child });
                }
            }
            next = stack.pop();
        }
        Some((nearest.best, nearest.slot))
    }

    /// The squared distances of the points, few enough to share one walk, behind what is in `out`;
    /// `false` where asking them one by one, before `out` has anything of them, is faster.
    pub(super) fn shared_distances_sq(&mut self, group: &[DVec3], out: &mut Vec<f64>) -> bool {
        self.n_pause = self.n_pause.saturating_sub(1);
        if self.bvh.lists.is_some() || self.n_pause > 0 || !group.iter().all(|&p| is_usable(p)) {
            return false;
        }
        let is_shared = self.group_distances_sq(group, out);
        if !is_shared {
            self.n_pause = PAUSE;
        }
        is_shared
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
        let Some(hit) = self.closest_by(middle, MOST_GROUP_VISITS) else { return false };
        let bvh = self.bvh;
        let around = PointBox::of(points, middle);
        let triangle = &bvh.triangles[hit.slot as usize];
        let first = out.len();
        out.extend(points.iter().map(|&p| triangle.distance_sq(p)));
        let most_sq = out[first..].iter().copied().fold(0.0, f64::max);
        let reach = (hit.distance_sq.sqrt() + around.radius).min(most_sq.sqrt());
        let bound = bvh.frame.reach(reach);
        let query = around.query(&bvh.frame);
        let mut n_visits = 0;
        self.candidates.clear();
        self.stack.clear();
        self.stack.push(Pending { distance_sq: 0.0, child: 0 });
        while let Some(pending) = self.stack.pop() {
            let node = &bvh.nodes[pending.child as usize];
            n_visits += 1;
            let mut near = node.distances_sq_to_box(&query).cmple(Vec4::splat(bound)).bitmask();
            let mut lanes = 0;
            while near != 0 {
                let lane = near.trailing_zeros() as usize & 3;
                near &= near - 1;
                let child = node.child[lane];
                if child & LEAF == 0 {
                    self.stack.push(Pending { distance_sq: 0.0, child });
                } else if child != EMPTY && child & !LEAF != hit.slot {
                    lanes |= 1 << lane;
                    self.candidates.n += 1;
                }
            }
            if lanes != 0 {
                self.candidates.lanes.push((pending.child, lanes));
            }
            if self.candidates.n > MOST_CANDIDATES || n_visits > MOST_GROUP_VISITS {
                out.truncate(first);
                return false;
            }
        }
        if self.candidates.n > 0 {
            let parts = (&bvh.frame, &bvh.nodes[..], &bvh.triangles[..]);
            for (distance_sq, &point) in out[first..].iter_mut().zip(points) {
                *distance_sq = self.candidates.nearest_sq(parts, point, *distance_sq);
            }
        }
        true
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
