//! What a collapse must not do: change the topology, turn a face, make it degenerate.

use glam::DVec3;

use super::connectivity::Marks;
use super::state::{Collapsing, NONE, flag, next_in_face, previous_in_face};

/// The most faces that a vertex may have to take part in a collapse. It bounds the time of one
/// collapse, so that a fan of a million faces around one vertex takes no quadratic time; the
/// fan shrinks from its rim until its center is within the bound.
const MAX_VALENCE: usize = 1024;

/// Squared ratio of height to longest edge (times that edge again) below which a new face is
/// degenerate: a height of 10⁻⁵ of the edge.
const DEGENERATE: f64 = 1e-10;

impl Collapsing {
    /// Whether merging the ends of an edge keeps the topology: the link condition for surfaces
    /// with borders and non-manifold edges (Dey et al. 1999, theorem for 2-complexes).
    ///
    /// With ω joined to everything irregular: (0) the common neighbors of the ends, ω among them,
    /// are the opposite vertices of the edge; the links share no edge; (1) the ends are not both
    /// corners of the graph of irregular edges.
    pub(super) fn link_condition_holds(&mut self, edge: u32, marks: &mut Marks) -> bool {
        const NEIGHBOR: u32 = 0;
        const OPPOSITE: u32 = 1;
        let [kept, gone] = self.edges[edge as usize];
        let both = self.vertices[kept as usize].flags & self.vertices[gone as usize].flags;
        if both & flag::CORNER != 0
            || (both & flag::IRREGULAR != 0 && !self.irregular[edge as usize])
        {
            return false;
        }
        if self.prune(kept, MAX_VALENCE).is_none() || self.prune(gone, MAX_VALENCE).is_none() {
            return false;
        }
        marks.clear();
        let mut corner = self.vertices[kept as usize].first;
        while corner != NONE {
            let (after, before) = (next_in_face(corner), previous_in_face(corner));
            let (x, y) = (self.vertex_at(after), self.vertex_at(before));
            if x == gone {
                if self.are_irregular(before, after) {
                    return false;
                }
                marks.set(y, OPPOSITE);
            } else if y == gone {
                if self.are_irregular(corner, after) {
                    return false;
                }
                marks.set(x, OPPOSITE);
            } else {
                for v in [x, y] {
                    if marks.get(v).is_none() {
                        marks.set(v, NEIGHBOR);
                    }
                }
            }
            corner = self.next_at(corner);
        }
        let mut corner = self.vertices[gone as usize].first;
        while corner != NONE {
            let x = self.vertex_at(next_in_face(corner));
            let y = self.vertex_at(previous_in_face(corner));
            if x != kept && y != kept {
                match (marks.get(x), marks.get(y)) {
                    (Some(NEIGHBOR), _) | (_, Some(NEIGHBOR)) => return false,
                    (Some(_), Some(_)) if self.has_face(kept, x, y) => return false,
                    _ => {}
                }
            }
            corner = self.next_at(corner);
        }
        true
    }

    fn are_irregular(&self, half_edge: u32, other: u32) -> bool {
        let is_irregular = |h: u32| self.irregular[self.edge_at(h) as usize];
        is_irregular(half_edge) && is_irregular(other)
    }

    fn has_face(&self, vertex: u32, x: u32, y: u32) -> bool {
        self.corners_around(vertex).any(|corner| {
            let face = &self.face_at(corner).vertices;
            face.contains(&x) && face.contains(&y)
        })
    }

    /// Whether merging the ends of an edge at `position` turns a face that stays by more than the
    /// angle of this cosine, or makes it degenerate; a face that is degenerate already may do anything.
    pub(super) fn turns_a_face(&self, edge: u32, position: DVec3, least_cosine: f64) -> bool {
        let [kept, gone] = self.edges[edge as usize];
        self.turns_around(kept, gone, position, least_cosine)
            || self.turns_around(gone, kept, position, least_cosine)
    }

    fn turns_around(&self, vertex: u32, other: u32, position: DVec3, least_cosine: f64) -> bool {
        let from = self.vertices[vertex as usize].position;
        let mut corner = self.vertices[vertex as usize].first;
        while corner != NONE {
            let x = self.vertex_at(next_in_face(corner));
            let y = self.vertex_at(previous_in_face(corner));
            corner = self.next_at(corner);
            if x == other || y == other || x == NONE {
                continue;
            }
            let (x, y) = (self.vertices[x as usize].position, self.vertices[y as usize].position);
            let old = (x - from).cross(y - from);
            let new = (x - position).cross(y - position);
            let (old_square, new_square) = (old.length_squared(), new.length_squared());
            let opposite = (x - y).length_squared();
            let is_sound = |square: f64, at: DVec3| {
                let longest = (x - at).length_squared().max((y - at).length_squared());
                square >= DEGENERATE * longest.max(opposite).powi(2)
            };
            // What is no number is not sound, so it need not count as turned.
            let is_turned = new.dot(old) < least_cosine * (old_square * new_square).sqrt();
            if (is_turned || !is_sound(new_square, position)) && is_sound(old_square, from) {
                return true;
            }
        }
        false
    }
}
