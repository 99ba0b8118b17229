//! Which prices are asked for again, and when.
//!
//! A collapse makes the prices of the edges within reach stale. They are asked for again at once,
//! or when their edges come up, as [`Renewal`] says; edges that are parked because they could not
//! collapse are tried again when their neighborhood has changed.

use mve_mesh::adjacency::EdgeId;

use super::complex::{Complex, flag, next_in_face, previous_in_face};
use super::marks::VertexMarks;
use super::merge::Merged;
use super::mesh::WorkingMesh;
use super::proposal::{Reach, Renewal};
use super::queue::Queue;
use super::rings::RingFace;

/// How many of the edges that come up next are priced, or read, along with the first: their loads
/// from memory overlap.
const AHEAD: usize = 12;

/// How many of the edges that probably come up next are priced along with others, where
/// [`Renewal::Lazy`] holds: enough of them to share among threads.
const COMPANY: usize = 16;

/// Parked edges at a neighbor of the merged vertex are looked at up to this valence.
const MAX_WAKE_VALENCE: usize = 1024;

/// Finds the edges that are due to be priced again.
pub(super) struct Renewer {
    /// Whether edges are priced again only when they come up: the price of one that is stale is
    /// not above the one of now.
    is_lazy: bool,
    reach: Reach,
    renewal: Renewal,
    /// A stale edge waits at this part of its earlier price.
    waiting_share: f64,
    ring: Vec<u32>,
    ring_faces: Vec<RingFace>,
}

impl Renewer {
    /// `only_grows` says that no price falls by a collapse nearby.
    pub fn new(only_grows: bool, reach: Reach, renewal: Renewal, waiting_share: f64) -> Self {
        let is_lazy = only_grows && reach == Reach::MERGED;
        let (ring, ring_faces) = (Vec::new(), Vec::new());
        Self { is_lazy, reach, renewal, waiting_share, ring, ring_faces }
    }

    /// Lists the edges that are due now that two vertices have merged.
    #[inline]
    pub fn list_after(
        &mut self,
        merged: &Merged,
        mesh: &mut WorkingMesh,
        queue: &mut Queue,
        marks: &mut VertexMarks,
        due: &mut Vec<EdgeId>,
    ) {
        due.clear();
        if self.is_lazy {
            self.mark_stale(&mesh.complex, merged, queue, due);
        } else {
            self.list_within_reach(&mesh.complex, merged.kept, marks, due);
            if self.renewal == Renewal::Lazy {
                put_off(&mesh.complex, merged.kept, self.waiting_share, queue, due);
            }
        }
        self.wake_parked(&mut mesh.complex, merged.kept, queue, due);
        due.sort_unstable();
        due.dedup();
    }

    /// Lists the edge that has come up with a stale price, and stale ones that follow.
    #[inline]
    pub fn list_coming(
        &self,
        first: EdgeId,
        mesh: &WorkingMesh,
        queue: &Queue,
        due: &mut Vec<EdgeId>,
    ) {
        let is_stale = |&edge: &EdgeId| edge != first && queue.is_stale(edge);
        due.clear();
        due.push(first);
        due.extend(queue.coming().take(AHEAD).filter(is_stale));
        if self.renewal == Renewal::Lazy {
            due.extend(queue.coming_late().take(COMPANY).filter(is_stale));
            due.sort_unstable();
            due.dedup();
        }
        warm_ends(mesh, due);
    }

    /// Lists the edges within reach of a merge, and the vertices there.
    fn list_within_reach(
        &mut self,
        complex: &Complex,
        merged: u32,
        marks: &mut VertexMarks,
        due: &mut Vec<EdgeId>,
    ) {
        let ring = &mut self.ring;
        ring.clear();
        ring.push(merged);
        marks.clear();
        marks.mark(merged);
        let mut from = 0;
        for _ in 0..=self.reach.0 {
            let to = ring.len();
            for at in from..to {
                let vertex = ring[at];
                for corner in complex.corners_around(vertex) {
                    let before = previous_in_face(corner);
                    for (half_edge, other) in [(corner, next_in_face(corner)), (before, before)] {
                        let other = complex.vertex_at(other);
                        if marks.mark(other) {
                            ring.push(other);
                            due.push(complex.edge_at(half_edge));
                        } else if vertex != merged {
                            // An edge between vertices that are both known; sorted out later.
                            due.push(complex.edge_at(half_edge));
                        }
                    }
                }
            }
            from = to;
        }
    }

    /// Marks the prices of the edges at the merged vertex as stale, and lists those that are
    /// held up, to be priced at once, and the neighbors that have parked edges.
    fn mark_stale(
        &mut self,
        complex: &Complex,
        merged: &Merged,
        queue: &mut Queue,
        due: &mut Vec<EdgeId>,
    ) {
        self.ring.clear();
        for &(edge, other) in &merged.edges {
            queue.mark_stale(edge);
            if queue.is_held_up(edge) {
                due.push(edge);
            }
            if complex.flags[other as usize] & flag::PARKED != 0 {
                self.ring.push(other);
            }
        }
    }

    /// Adds the edges that are held up at the vertices of the ring.
    fn wake_parked(
        &mut self,
        complex: &mut Complex,
        merged: u32,
        queue: &Queue,
        due: &mut Vec<EdgeId>,
    ) {
        complex.flags[merged as usize] &= !flag::PARKED;
        for &vertex in &self.ring {
            if complex.flags[vertex as usize] & flag::PARKED == 0
                || !complex.ring_faces(vertex, MAX_WAKE_VALENCE, &mut self.ring_faces)
            {
                continue;
            }
            complex.flags[vertex as usize] &= !flag::PARKED;
            for face in &self.ring_faces {
                let [to_after, to_before, _] = face.edges(&complex.faces);
                due.extend([to_after, to_before].iter().filter(|&&e| queue.is_held_up(e)));
            }
        }
    }
}

/// Takes an edge off the queue until something near it changes.
pub(super) fn park(complex: &mut Complex, queue: &mut Queue, edge: EdgeId) {
    queue.remove(edge);
    mark_parked(complex, edge);
}

/// Notes at both ends of an edge that it waits for a change.
pub(super) fn mark_parked(complex: &mut Complex, edge: EdgeId) {
    for v in complex.ends(edge) {
        complex.flags[v as usize] |= flag::PARKED;
    }
}

/// Leaves the edges at a vertex in the list, and those that do not wait; the others are put off.
/// Stale ones that come up soon join the list.
fn put_off(complex: &Complex, merged: u32, share: f64, queue: &mut Queue, due: &mut Vec<EdgeId>) {
    due.retain(|&edge| {
        let is_at_once = complex.ends(edge).contains(&merged) || !queue.contains(edge);
        if !is_at_once {
            queue.put_off(edge, share);
        }
        is_at_once
    });
    let soon = queue.coming().take(AHEAD).chain(queue.coming_late().take(COMPANY));
    due.extend(soon.filter(|&edge| queue.is_stale(edge)));
}

/// Reads what pricing these edges will read. The loads do not wait for each other here, as they do
/// in the work itself, so they overlap. It changes no result.
fn warm_ends(mesh: &WorkingMesh, edges: &[EdgeId]) {
    let mut sum = 0.0;
    for v in edges.iter().flat_map(|&edge| mesh.complex.ends(edge)) {
        sum += mesh.complex.vertices.get(v as usize).map_or(0.0, |vertex| vertex.position.x);
        sum += mesh.quadrics.get(v).map_or(0.0, |quadric| quadric.a[0] + quadric.c);
    }
    std::hint::black_box(sum);
}
