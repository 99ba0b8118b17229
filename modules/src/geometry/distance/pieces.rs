//! What the tree is built of: faces with their boxes, or, as boxes around these hold less, pieces
//! of faces, cut across their longest side.

use glam::{DVec3, Vec3A};
use mve_core::{Cancelled, Control};

use super::boxes::{EMPTY, LEAF, Node};

/// A face or a piece of it, and its box in the tree's frame.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub low: Vec3A,
    pub high: Vec3A,
    pub face: u32,
    pub piece: u32,
}

impl Item {
    /// Twice the center of the box.
    pub fn center(&self) -> Vec3A {
        self.low + self.high
    }

    /// Around a piece of a face of the mesh.
    pub fn around(face: u32, piece: u32, points: &[DVec3]) -> Self {
        let mut bounds = Bounds::EMPTY;
        for point in points {
            // Wider by the rounding of the conversion.
            let point = point.as_vec3a();
            let margin = point.abs() * f32::EPSILON + Vec3A::splat(f32::MIN_POSITIVE);
            bounds.add(point - margin, point + margin);
        }
        Self { low: bounds.low, high: bounds.high, face, piece }
    }
}

/// A box that grows.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub low: Vec3A,
    pub high: Vec3A,
}

impl Bounds {
    pub const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    pub fn add(&mut self, low: Vec3A, high: Vec3A) {
        self.low = self.low.min(low);
        self.high = self.high.max(high);
    }

    /// Half the surface area; 0 when empty.
    pub fn half_area(&self) -> f32 {
        let d = (self.high - self.low).max(Vec3A::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

/// The corners of a piece of a triangle, which is cut across its longest side.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    points: [DVec3; Self::MOST],
    n: usize,
}

impl Piece {
    /// Two of each cut, and a corner of the triangle between.
    const MOST: usize = 5;

    pub fn new([a, b, c]: [DVec3; 3], piece: u32, n_pieces: u32) -> Self {
        if n_pieces == 1 {
            return Self { points: [a, b, c, c, c], n: 3 };
        }
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| from.distance_squared(to));
        let [a, b, c] = match () {
            () if ab >= bc.max(ca) => [a, b, c],
            () if bc >= ca => [b, c, a],
            () => [c, a, b],
        };
        let side = b - a;
        // Where along the longest side the third corner is, and a point of the two others there.
        let peak = ((c - a).dot(side) / side.length_squared()).clamp(0.0, 1.0);
        let peak = if peak.is_nan() { 0.0 } else { peak };
        let opposite = |t: f64| {
            if t <= peak { a.lerp(c, t / peak) } else { c.lerp(b, (t - peak) / (1.0 - peak)) }
        };
        let [from, to] = [piece, piece + 1].map(|k| f64::from(k) / f64::from(n_pieces));
        let mut points = [a + side * from, a + side * to, c, c, c];
        let mut n = 2;
        for t in [from, to] {
            // At a peak that is an end the quotient is not a number; there the corner is.
            let point = opposite(t);
            points[n] = if point.is_finite() { point } else { c };
            n += 1;
        }
        n += usize::from(from < peak && peak < to);
        Self { points, n }
    }

    pub fn points(&self) -> &[DVec3] {
        &self.points[..self.n]
    }
}

/// The first piece of each face, to which all leaves of that face are led.
pub(super) fn one_a_face(
    nodes: &mut [Node],
    items: &[Item],
    n_faces: usize,
    control: Control,
) -> Result<Vec<Item>, Cancelled> {
    let mut slots = vec![EMPTY; n_faces];
    let mut first = Vec::with_capacity(n_faces);
    for (at, item) in items.iter().enumerate() {
        control.item(at, usize::MAX)?;
        let slot = &mut slots[item.face as usize];
        if *slot == EMPTY {
            *slot = first.len() as u32;
            first.push(*item);
        }
    }
    for (at, node) in nodes.iter_mut().enumerate() {
        control.item(at, usize::MAX)?;
        for child in node.child.iter_mut().filter(|c| **c != EMPTY && **c & LEAF != 0) {
            let item = &items[(*child & !LEAF) as usize];
            *child = LEAF | slots[item.face as usize];
        }
    }
    Ok(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first of two pieces of a right triangle with sides of 3 and 4 is cut through the middle
    /// of the longest side; the height over it is 2.4, at 1.8 of 5 from one end.
    #[test]
    fn halves_of_a_right_triangle() {
        let corners = [DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 4.0];
        for turn in 0..3 {
            let mut corners = corners;
            corners.rotate_left(turn);
            let halves = [0, 1].map(|piece| Piece::new(corners, piece, 2));
            let corners_there: Vec<usize> = halves.iter().map(|half| half.n).collect();
            assert_eq!(corners_there, [5, 4]);
            let middle = DVec3::new(1.5, 2.0, 0.0);
            for half in &halves {
                assert!(half.points().iter().any(|p| p.distance(middle) < 1e-15));
                // All within the triangle.
                let is_in =
                    |p: &DVec3| p.x > -1e-15 && p.y > -1e-15 && p.x / 3.0 + p.y / 4.0 < 1.0 + 1e-15;
                assert!(half.points().iter().all(is_in));
            }
            // The cut is as long as the height is there: 2.4 of 3.2 from the far end, 2.5 away.
            let across = middle + DVec3::new(-1.5, -1.125, 0.0);
            assert!(
                halves
                    .iter()
                    .all(|half| { half.points().iter().any(|p| p.distance(across) < 1e-14) })
            );
        }
    }

    #[test]
    fn triangles_without_extent_have_pieces() {
        for corners in [[DVec3::ONE; 3], [DVec3::ZERO, DVec3::X, DVec3::X]] {
            for piece in 0..3 {
                let piece = Piece::new(corners, piece, 3);
                assert!(piece.points().iter().all(|p| p.is_finite()));
            }
        }
    }
}
