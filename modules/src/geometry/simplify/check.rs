//! What a collapse must not do: change the topology, turn a face, make it degenerate.

use glam::DVec3;

use super::connectivity::{Marks, Rings};
use super::state::{Collapsing, Spoke, flag};

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
    pub(super) fn link_condition_holds(
        &mut self,
        edge: u32,
        rings: &mut Rings,
        marks: &mut Marks,
    ) -> bool {
        let [kept, gone] = self.edges[edge as usize];
        let both = self.flags[kept as usize] & self.flags[gone as usize];
        if both & flag::CORNER != 0
            || (both & flag::IRREGULAR != 0 && !self.irregular[edge as usize])
        {
            return false;
        }
        self.gather(kept, MAX_VALENCE, &mut rings.kept)
            && self.gather(gone, MAX_VALENCE, &mut rings.gone)
            && self.links_agree(kept, gone, rings, marks)
    }

    /// The part of the link condition that looks at the faces around both ends.
    fn links_agree(&self, kept: u32, gone: u32, rings: &Rings, marks: &mut Marks) -> bool {
        const NEIGHBOR: u32 = 0;
        const OPPOSITE: u32 = 1;
        marks.clear();
        for spoke in &rings.kept {
            if spoke.has(gone) {
                let [to_after, to_before, across] = spoke.edges(&self.faces);
                let (third, to_third) = if spoke.after == gone {
                    (spoke.before, to_before)
                } else {
                    (spoke.after, to_after)
                };
                if self.irregular[to_third as usize] && self.irregular[across as usize] {
                    return false;
                }
                marks.set(third, OPPOSITE);
            } else {
                for v in [spoke.after, spoke.before] {
                    if marks.get(v).is_none() {
                        marks.set(v, NEIGHBOR);
                    }
                }
            }
        }
        let has_face = |x, y| rings.kept.iter().any(|spoke| spoke.has(x) && spoke.has(y));
        rings.gone.iter().filter(|spoke| !spoke.has(kept)).all(|spoke| {
            let (x, y) = (spoke.after, spoke.before);
            match (marks.get(x), marks.get(y)) {
                (Some(NEIGHBOR), _) | (_, Some(NEIGHBOR)) => false,
                (Some(_), Some(_)) => !has_face(x, y),
                _ => true,
            }
        })
    }

    /// Whether merging the ends of an edge at `position` turns a face that stays by more than the
    /// angle of this cosine, or makes it degenerate; a face that is degenerate already may do anything.
    pub(super) fn turns_a_face(
        &self,
        edge: u32,
        rings: &Rings,
        position: DVec3,
        least_cosine: f64,
    ) -> bool {
        let [kept, gone] = self.edges[edge as usize];
        let turns = |vertex: u32, other: u32, spokes: &[Spoke]| {
            let from = self.vertices[vertex as usize].position;
            spokes.iter().any(|spoke| {
                !spoke.has(other) && {
                    let at = |v: u32| self.vertices[v as usize].position;
                    turns([from, position], [at(spoke.after), at(spoke.before)], least_cosine)
                }
            })
        };
        turns(kept, gone, &rings.kept) || turns(gone, kept, &rings.gone)
    }
}

/// Whether a face of corners `x` and `y` turns or degenerates when its third moves.
#[inline]
fn turns([from, to]: [DVec3; 2], [x, y]: [DVec3; 2], least_cosine: f64) -> bool {
    let old = (x - from).cross(y - from);
    let new = (x - to).cross(y - to);
    let (old_square, new_square) = (old.length_squared(), new.length_squared());
    let opposite = (x - y).length_squared();
    let is_sound = |square: f64, at: DVec3| {
        let longest = (x - at).length_squared().max((y - at).length_squared());
        square >= DEGENERATE * longest.max(opposite).powi(2)
    };
    // What is no number is not sound, so it need not count as turned.
    // This is `dot < cosine × √product` without the root.
    let dot = new.dot(old);
    let (side, limit) = (dot * dot, least_cosine * least_cosine * old_square * new_square);
    let is_turned =
        if least_cosine > 0.0 { dot < 0.0 || side < limit } else { dot < 0.0 && side > limit };
    (is_turned || !is_sound(new_square, to)) && is_sound(old_square, from)
}
