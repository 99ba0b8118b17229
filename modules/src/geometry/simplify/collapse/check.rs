//! What a collapse must not do: change the topology, turn a face, make it degenerate.

use glam::DVec3;

use super::complex::{Complex, flag};
use super::marks::VertexMarks;
use super::rings::{RingFace, Rings};

/// Squared ratio of height to longest edge (times that edge again) below which a new face is
/// degenerate: a height of 10⁻⁵ of the edge.
const DEGENERATE: f64 = 1e-10;

/// Two faces at an edge are folded when their normals differ by more than 150°: the cosine of what
/// is left to 180°, and of half of 150°.
const COS_NEAR_FOLD: f64 = 0.866_025_403_784_438_6;
const COS_HALF_FOLD: f64 = 0.258_819_045_102_520_74;

impl Rings {
    /// Whether merging the ends of the edge keeps the topology: the link condition for surfaces
    /// with borders and non-manifold edges (Dey et al. 1999, theorem for 2-complexes).
    ///
    /// With ω joined to everything irregular: (0) the common neighbors of the ends, ω among them,
    /// are the opposite vertices of the edge; the links share no edge; (1) the ends are not both
    /// singular vertices of the graph of irregular edges.
    pub fn keep_topology(&self, complex: &Complex, marks: &mut VertexMarks) -> bool {
        let both = complex.flags[self.kept as usize] & complex.flags[self.gone as usize];
        let is_regular = !complex.irregular[self.edge.idx()];
        if both & flag::SINGULAR != 0 || (both & flag::IRREGULAR != 0 && is_regular) {
            return false;
        }
        self.links_agree(complex, marks)
    }

    /// The part of the link condition that looks at the faces around both ends.
    fn links_agree(&self, complex: &Complex, marks: &mut VertexMarks) -> bool {
        const NEIGHBOR: u32 = 0;
        const OPPOSITE: u32 = 1;
        marks.clear();
        for face in &self.around_kept {
            if face.has(self.gone) {
                let [to_after, to_before, across] = face.edges(&complex.faces);
                let (third, to_third) = if face.after == self.gone {
                    (face.before, to_before)
                } else {
                    (face.after, to_after)
                };
                if complex.irregular[to_third.idx()] && complex.irregular[across.idx()] {
                    return false;
                }
                marks.set(third, OPPOSITE);
            } else {
                for v in [face.after, face.before] {
                    if marks.get(v).is_none() {
                        marks.set(v, NEIGHBOR);
                    }
                }
            }
        }
        let has_face = |x, y| self.around_kept.iter().any(|face| face.has(x) && face.has(y));
        self.staying_at_gone().all(|face| {
            let (x, y) = (face.after, face.before);
            match (marks.get(x), marks.get(y)) {
                (Some(NEIGHBOR), _) | (_, Some(NEIGHBOR)) => false,
                (Some(_), Some(_)) => !has_face(x, y),
                _ => true,
            }
        })
    }

    /// Whether merging the ends at `position` turns a face that stays by more than the angle of
    /// this cosine, makes it degenerate, or folds it onto the next; what is degenerate or folded
    /// already may do anything.
    pub fn turn_a_face(&self, complex: &Complex, position: DVec3, least_cosine: f64) -> bool {
        let mut reference = None;
        let mut is_even = true;
        for (vertex, face) in self.staying() {
            let moved = [complex.position(vertex), position];
            let opposite = [complex.position(face.after), complex.position(face.before)];
            let Some(normal) = turned(moved, opposite, least_cosine) else { return true };
            is_even &= is_within(normal, *reference.get_or_insert(normal), COS_HALF_FOLD);
        }
        !is_even && self.fold(complex, position)
    }

    /// Whether two faces next to each other at the merged vertex are folded as they were not.
    ///
    /// Turns add up over many collapses, and a face may end up upside down though none turned it
    /// far; so this looks at the angle that there is and not at how it changes.
    fn fold(&self, complex: &Complex, position: DVec3) -> bool {
        let at = |v: u32| complex.position(v);
        let normal = |face: &RingFace, p: DVec3| (at(face.after) - p).cross(at(face.before) - p);
        let are_folded = |a: &RingFace, b: &RingFace, p: DVec3| {
            is_within(normal(a, p), -normal(b, p), COS_NEAR_FOLD)
        };
        self.staying().any(|(v, a)| {
            self.staying().any(|(w, b)| {
                let were_folded = || v == w && are_folded(a, b, at(v));
                a.before == b.after && are_folded(a, b, position) && !were_folded()
            })
        })
    }

    /// The faces that stay, each with the end that has it.
    fn staying(&self) -> impl Iterator<Item = (u32, &RingFace)> {
        let of_kept = self.staying_at_kept().map(|face| (self.kept, face));
        of_kept.chain(self.staying_at_gone().map(|face| (self.gone, face)))
    }
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
    use super::super::order::Order;
    use super::super::ticker::Ticker;
    use super::*;
    use crate::mesh::adjacency::EdgeId;
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
        let mesh = mesh_of(&positions, &faces);
        let (mut marks, mut ticker) = (VertexMarks::new(6), Ticker::new(Control::none()));
        let order = Order::along_curve(&mesh, &mut ticker).unwrap();
        let mut complex = Complex::link(&mesh, &order, &mut marks, &mut ticker).unwrap();
        let is_inner = |v: u32| complex.position(v).x.abs() == 0.2;
        let edge = complex.edges.iter().position(|ends| ends.iter().all(|&v| is_inner(v)));
        let edge = EdgeId(edge.unwrap() as u32);
        let mut memory = Rings::default();
        let rings = complex.neighborhood(edge, &mut memory).unwrap();
        assert!(rings.keep_topology(&complex, &mut marks));
        // Any turn is allowed here. The sides of the needle meet at 11 degrees, those of the low
        // roof at 178.
        let turns = |height| rings.turn_a_face(&complex, DVec3::Z * height, -1.0);
        assert_eq!([turns(0.001), turns(10.0)], [false, true]);
    }
}
