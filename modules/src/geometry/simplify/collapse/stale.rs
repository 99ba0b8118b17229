//! Which prices are asked for again, and when.
//!
//! A collapse makes the prices of the edges within reach stale. They are asked for again at once, or
//! when their edges come up, as [`Renewal`] says; edges that were put off because they could not
//! collapse are tried again when their neighborhood has changed.

use super::engine::{Engine, Scratch};
use super::state::{Collapsing, flag, next_in_face, previous_in_face};
use super::{Reach, Renewal};

/// How many of the edges that come up next are priced, or read, along with the first: their loads
/// from memory overlap.
const AHEAD: usize = 12;

/// How many of the edges that probably come up next are priced along with others, where
/// [`Renewal::Lazy`] holds: enough of them to share among threads.
const COMPANY: usize = 16;

/// A stale edge waits at this part of its earlier price, where [`Renewal::Lazy`] holds.
const WAITING_SHARE: f64 = 1.0 / 3.0;

/// Waiting edges at a neighbor of the merged vertex are looked at up to this valence.
const MAX_WAKE_VALENCE: usize = 1024;

impl Engine<'_> {
    /// Lists the edges that are to be priced now that two vertices have merged into this one.
    #[inline]
    pub(super) fn list_stale(&mut self, merged: u32) {
        if self.is_lazy && self.reach == Reach::MERGED {
            self.mark_stale();
        } else {
            self.find_stale(merged);
            if self.renewal == Renewal::Lazy {
                self.put_off(merged);
            }
        }
        self.wake_parked(merged);
        self.scratch.edges.sort_unstable();
        self.scratch.edges.dedup();
    }

    /// Lists the edge that has come up with a stale price, and stale ones that follow.
    #[inline]
    pub(super) fn list_coming(&mut self, first: u32) {
        let Self { state, queue, scratch: Scratch { edges, .. }, .. } = self;
        let is_stale = |&edge: &u32| edge != first && queue.is_stale(edge);
        edges.clear();
        edges.push(first);
        edges.extend(queue.coming().take(AHEAD).filter(is_stale));
        if self.renewal == Renewal::Lazy {
            edges.extend(queue.coming_late().take(COMPANY).filter(is_stale));
            edges.sort_unstable();
            edges.dedup();
        }
        warm_ends(state, edges.iter().copied());
    }

    /// Lists the edges within reach of a merge.
    fn find_stale(&mut self, merged: u32) {
        let Scratch { edges, ring, .. } = &mut self.scratch;
        edges.clear();
        ring.clear();
        ring.push(merged);
        self.marks.clear();
        self.marks.is_new(merged);
        let mut from = 0;
        for _ in 0..=self.reach.0 {
            let to = ring.len();
            for at in from..to {
                let vertex = ring[at];
                for corner in self.state.corners_around(vertex) {
                    let before = previous_in_face(corner);
                    for (half_edge, other) in [(corner, next_in_face(corner)), (before, before)] {
                        let other = self.state.vertex_at(other);
                        if self.marks.is_new(other) {
                            ring.push(other);
                            edges.push(self.state.edge_at(half_edge));
                        } else if vertex != merged {
                            // An edge between vertices that are both known; sorted out below.
                            edges.push(self.state.edge_at(half_edge));
                        }
                    }
                }
            }
            from = to;
        }
    }

    /// Marks the prices of the edges at the merged vertex as stale, and lists those that were put
    /// off, to be priced at once.
    fn mark_stale(&mut self) {
        let Scratch { edges, ring, merged, .. } = &mut self.scratch;
        edges.clear();
        ring.clear();
        for &(edge, other) in &merged.spokes {
            self.queue.mark_stale(edge);
            if !self.queue.contains(edge) {
                edges.push(edge);
            }
            if self.state.flags[other as usize] & flag::PARKED != 0 {
                ring.push(other);
            }
        }
    }

    /// Adds the edges that were put off at the neighbors of the merged vertex.
    fn wake_parked(&mut self, merged: u32) {
        let Scratch { edges, ring, rings, .. } = &mut self.scratch;
        self.state.flags[merged as usize] &= !flag::PARKED;
        for &vertex in ring.iter() {
            if self.state.flags[vertex as usize] & flag::PARKED == 0
                || !self.state.gather(vertex, MAX_WAKE_VALENCE, &mut rings.kept)
            {
                continue;
            }
            self.state.flags[vertex as usize] &= !flag::PARKED;
            for spoke in &rings.kept {
                let [to_after, to_before, _] = spoke.edges(&self.state.faces);
                edges.extend([to_after, to_before].iter().filter(|&&e| !self.queue.contains(e)));
            }
        }
    }

    /// Leaves the edges at a vertex in the list, and those that do not wait; the others are put off.
    /// Stale ones that come up soon join the list.
    fn put_off(&mut self, merged: u32) {
        let Self { state, queue, scratch: Scratch { edges, .. }, .. } = self;
        edges.retain(|&edge| {
            let is_at_once = state.edges[edge as usize].contains(&merged) || !queue.contains(edge);
            if !is_at_once {
                queue.put_off(edge, WAITING_SHARE);
            }
            is_at_once
        });
        let soon = queue.coming().take(AHEAD).chain(queue.coming_late().take(COMPANY));
        edges.extend(soon.filter(|&edge| queue.is_stale(edge)));
    }
}

/// Reads what pricing these edges will read. The loads do not wait for each other here, as they do
/// in the work itself, so they overlap. It changes no result.
fn warm_ends(state: &Collapsing, edges: impl Iterator<Item = u32>) {
    let mut sum = 0.0;
    for [kept, gone] in edges.map(|edge| state.edges[edge as usize]) {
        for v in [kept as usize, gone as usize] {
            sum += state.vertices.get(v).map_or(0.0, |vertex| vertex.position.x);
            sum += state.quadrics.get(v).map_or(0.0, |quadric| quadric.a[0] + quadric.c);
        }
    }
    std::hint::black_box(sum);
}
