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

/// Two faces at an edge are folded when their normals differ by more than 150°: the cosine of what
/// is left to 180°, and of half of 150°.
const COS_NEAR_FOLD: f64 = 0.866_025_403_784_438_6;
const COS_HALF_FOLD: f64 = 0.258_819_045_102_520_74;

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
    /// angle of this cosine, makes it degenerate, or folds it onto the next; what is degenerate or
    /// folded already may do anything.
    pub(super) fn turns_a_face(
        &self,
        edge: u32,
        rings: &Rings,
        position: DVec3,
        least_cosine: f64,
    ) -> bool {
        let [kept, gone] = self.edges[edge as usize];
        let mut reference = None;
        let mut is_even = true;
        for (vertex, spoke) in staying(kept, gone, rings) {
            let at = |v: u32| self.vertices[v as usize].position;
            let moved = [at(vertex), position];
            let opposite = [at(spoke.after), at(spoke.before)];
            let Some(normal) = turned(moved, opposite, least_cosine) else { return true };
            is_even &= is_within(normal, *reference.get_or_insert(normal), COS_HALF_FOLD);
        }
        !is_even && self.folds(kept, gone, rings, position)
    }

    /// Whether two faces next to each other at the merged vertex are folded as they were not.
    ///
    /// Turns add up over many collapses, and a face may end up upside down though none turned it
    /// far; so this looks at the angle that there is and not at how it changes.
    fn folds(&self, kept: u32, gone: u32, rings: &Rings, position: DVec3) -> bool {
        let at = |v: u32| self.vertices[v as usize].position;
        let normal = |spoke: &Spoke, p: DVec3| (at(spoke.after) - p).cross(at(spoke.before) - p);
        let are_folded =
            |a: &Spoke, b: &Spoke, p: DVec3| is_within(normal(a, p), -normal(b, p), COS_NEAR_FOLD);
        staying(kept, gone, rings).any(|(v, a)| {
            staying(kept, gone, rings).any(|(w, b)| {
                let were_folded = || v == w && are_folded(a, b, at(v));
                a.before == b.after && are_folded(a, b, position) && !were_folded()
            })
        })
    }
}

/// The faces that stay when two vertices merge, each with its end.
fn staying(kept: u32, gone: u32, rings: &Rings) -> impl Iterator<Item = (u32, &Spoke)> {
    let of_kept = rings.kept.iter().filter(move |spoke| !spoke.has(gone));
    let of_gone = rings.gone.iter().filter(move |spoke| !spoke.has(kept));
    of_kept.map(move |spoke| (kept, spoke)).chain(of_gone.map(move |spoke| (gone, spoke)))
}

/// Whether the angle between two vectors is at most that of a cosine above zero.
#[inline]
fn is_within(a: DVec3, b: DVec3, cosine: f64) -> bool {
    let dot = a.dot(b);
    dot > 0.0 && dot * dot >= cosine * cosine * a.length_squared() * b.length_squared()
}

/// The new normal of a face of corners `x` and `y` whose third moves, not of length 1; `None` when
/// it turns too far or the face degenerates.
#[inline]
fn turned([from, to]: [DVec3; 2], [x, y]: [DVec3; 2], least_cosine: f64) -> Option<DVec3> {
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
    let is_worse = (is_turned || !is_sound(new_square, to)) && is_sound(old_square, from);
    (!is_worse).then_some(new)
}

#[cfg(test)]
mod tests {
    use super::super::pulse::Pulse;
    use super::*;
    use crate::mesh::fixtures::mesh_of;
    use mve_core::Control;

    #[test]
    fn needle_over_a_thin_rhombus_is_a_fold() {
        let positions = [
            [1.0, 0.0, 0.0],
            [0.0, 0.1, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, -0.1, 0.0],
            [-0.2, 0.0, 0.0],
            [0.2, 0.0, 0.0],
        ];
        let faces = [[0, 1, 5], [1, 2, 4], [1, 4, 5], [2, 3, 4], [3, 0, 5], [3, 5, 4]];
        let (mut marks, mut pulse) = (Marks::new(6), Pulse::new(Control::none()));
        let mut state =
            Collapsing::link(&mesh_of(&positions, &faces), &mut marks, &mut pulse).unwrap();
        let is_inner = |v: u32| state.vertices[v as usize].position.x.abs() == 0.2;
        let edge = state.edges.iter().position(|ends| ends.iter().all(|&v| is_inner(v)));
        let edge = edge.unwrap() as u32;
        let mut rings = Rings::default();
        assert!(state.link_condition_holds(edge, &mut rings, &mut marks));
        // Any turn is allowed here. The sides of the needle meet at 11 degrees, those of the low
        // roof at 178.
        let turns = |height| state.turns_a_face(edge, &rings, DVec3::Z * height, -1.0);
        assert_eq!([turns(0.001), turns(10.0)], [false, true]);
    }
}
