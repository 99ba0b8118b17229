//! What a collapse does to the shapes of faces: it must not turn one too far, make it degenerate or
//! fold it onto the next, and one that turns a face far or leaves it thin had better wait.
//!
//! To wait is to stand in the queue at a multiple of the price, until something cheaper has gone.
//! No collapse is forbidden by it, so no target is missed. MeshLab divides every price by the
//! quality of the worst face that is made (`TriEdgeCollapseQuadric` of the VCG library,
//! `QualityThr`); here that is asked only of what comes up, which costs next to no time, and only
//! of faces that get worse.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::DVec3;

use super::complex::Complex;
use super::options::{SimplifyOptions, Turns};
use super::rings::{RingFace, Rings};

/// Squared ratio of height to longest edge (times that edge again) below which a new face is
/// degenerate: a height of 10⁻⁵ of the edge.
const DEGENERATE: f64 = 1e-10;

/// Two faces at an edge are folded when their normals differ by more than 150°: the cosine of what
/// is left to 180°, and of half of 150°.
const COS_NEAR_FOLD: f64 = 0.866_025_403_784_438_6;
const COS_HALF_FOLD: f64 = 0.258_819_045_102_520_74;

/// How often the price of a collapse is doubled that turns a face by more than it first may.
const TURN_DOUBLINGS: u8 = 2;
/// And how often at the most for a thin face.
const MOST_DOUBLINGS: u8 = 64;

/// What the shapes of faces must be.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShapeLimits {
    /// Cosine of the angle by which no face turns further.
    least_cosine: f64,
    /// Cosine of the angle beyond which a turn had better wait, where there is one.
    early_cosine: Option<f64>,
    /// The squared sine of the angle below which a face is thin; 0 where none is.
    thin: f64,
}

/// A collapse that leaves all faces sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// Whether a face turns by more than it first may.
    pub is_turned: bool,
    /// The squared sine of the smallest angle of the faces that get thin; 1 where none does.
    thinnest: f64,
}

impl ShapeLimits {
    /// The limits to begin with; `None` is no test. `is_patient` says that the cost lets collapses
    /// wait.
    pub fn new(options: &SimplifyOptions, is_patient: bool) -> Option<Self> {
        let (largest, early) = match options.turns {
            Turns::Adaptive if is_patient => (FRAC_PI_2, Some(FRAC_PI_4)),
            Turns::Adaptive => (FRAC_PI_4, Some(FRAC_PI_4)),
            Turns::UpTo(angle) => (angle, None),
            Turns::Any => return None,
        };
        let thin = options.sliver_angle_rad.map_or(0.0, |angle| angle.sin().powi(2));
        Some(Self { least_cosine: cosine(largest), early_cosine: early.map(cosine), thin })
    }

    /// Widens the limits as far as the options allow; whether they were narrower.
    pub fn widen(&mut self) -> bool {
        let widest = if self.early_cosine.is_some() { 0.0 } else { self.least_cosine };
        std::mem::replace(&mut self.least_cosine, widest) != widest
    }

    /// The same with turns by any angle.
    pub fn with_any_turn(self) -> Self {
        Self { least_cosine: -1.0, early_cosine: None, ..self }
    }

    /// How often the price of a collapse is to be doubled: twice for a turn, and for a thin face
    /// until it stands for the square of how much the angle is too small.
    pub fn doublings(&self, shape: Shape) -> u8 {
        let mut doublings = if shape.is_turned { TURN_DOUBLINGS } else { 0 };
        let mut square = shape.thinnest;
        while square < self.thin && doublings < MOST_DOUBLINGS {
            (square, doublings) = (2.0 * square, doublings + 1);
        }
        doublings
    }
}

/// The cosine, 0 for a right angle to the last bit.
fn cosine(angle_rad: f64) -> f64 {
    if angle_rad == FRAC_PI_2 { 0.0 } else { angle_rad.cos() }
}

impl Shape {
    /// Nothing is wrong with it.
    pub const SOUND: Self = Self { is_turned: false, thinnest: 1.0 };
}

impl Rings {
    /// What merging the ends at `position` does to the faces that stay, which may be anything
    /// without limits; `None` where the position is not finite, or it turns a face too far, makes
    /// it degenerate, or folds it onto the next. What is degenerate or folded already may do
    /// anything.
    pub fn shape_after(
        &self,
        complex: &Complex,
        position: DVec3,
        limits: Option<&ShapeLimits>,
    ) -> Option<Shape> {
        let mut shape = Shape::SOUND;
        let Some(limits) = limits else { return position.is_finite().then_some(shape) };
        let mut reference = None;
        let mut is_even = true;
        for (vertex, face) in self.staying() {
            let moved = [complex.position(vertex), position];
            let opposite = [complex.position(face.after), complex.position(face.before)];
            let normal = shape.add(moved, opposite, limits)?;
            is_even &= is_within(normal, *reference.get_or_insert(normal), COS_HALF_FOLD);
        }
        let is_sound = position.is_finite() && (is_even || !self.fold(complex, position));
        is_sound.then_some(shape)
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

impl Shape {
    /// Adds a face of corners `x` and `y` whose third moves. Its new normal, not of length 1;
    /// `None` when it turns too far or the face degenerates.
    #[inline]
    fn add(
        &mut self,
        [from, to]: [DVec3; 2],
        [x, y]: [DVec3; 2],
        limits: &ShapeLimits,
    ) -> Option<DVec3> {
        let old = (x - from).cross(y - from);
        let new = (x - to).cross(y - to);
        let (old_square, new_square) = (old.length_squared(), new.length_squared());
        let opposite = (x - y).length_squared();
        // The squared lengths of the sides, the longest first, where the corner is.
        let sides = |at: DVec3| {
            let (p, q) = ((x - at).length_squared(), (y - at).length_squared());
            (p.max(q).max(opposite), p, q)
        };
        let is_sound = |square: f64, longest: f64| square >= DEGENERATE * longest.powi(2);
        // This is `dot < cosine × √product` without the root.
        let dot = new.dot(old);
        let (side, product) = (dot * dot, old_square * new_square);
        let is_beyond = |cosine: f64| {
            let limit = cosine * cosine * product;
            if cosine > 0.0 { dot < 0.0 || side < limit } else { dot < 0.0 && side > limit }
        };
        let (longest, p, q) = sides(to);
        // What is no number is not sound, so it need not count as turned.
        if is_beyond(limits.least_cosine) || !is_sound(new_square, longest) {
            return (!is_sound(old_square, sides(from).0)).then_some(new);
        }
        if limits.early_cosine.is_some_and(is_beyond) {
            self.is_turned |= is_sound(old_square, sides(from).0);
        }
        if new_square < limits.thin * longest.powi(2) {
            // The smallest angle lies between the two longest sides.
            let angle = |square: f64, (longest, p, q): (f64, f64, f64)| {
                square / (longest * p.min(q).max(p.max(q).min(opposite)))
            };
            let new_angle = angle(new_square, (longest, p, q));
            if new_angle < limits.thin && new_angle < angle(old_square, sides(from)) {
                self.thinnest = self.thinnest.min(new_angle);
            }
        }
        Some(new)
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::adjacency::EdgeId;
    use mve_mesh::fixtures::mesh_of;

    use super::super::marks::VertexMarks;
    use super::super::order::Order;
    use super::super::ticker::Ticker;
    use super::*;
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
        let options = SimplifyOptions { turns: Turns::UpTo(3.0), ..SimplifyOptions::DEFAULT };
        let limits = ShapeLimits::new(&options, false).unwrap().with_any_turn();
        // Any turn is allowed here. The sides of the needle meet at 11 degrees, those of the low
        // roof at 178.
        let turns =
            |height| rings.shape_after(&complex, DVec3::Z * height, Some(&limits)).is_none();
        assert_eq!([turns(0.001), turns(10.0)], [false, true]);
    }

    /// A face over the side from (0, 0) to (1, 0) whose third corner moves from one height over its
    /// middle to another.
    fn moved(heights: [f64; 2], turns: Turns) -> (ShapeLimits, Option<Shape>) {
        let options = SimplifyOptions { turns, ..SimplifyOptions::DEFAULT };
        let limits = ShapeLimits::new(&options, true).unwrap();
        let corners = heights.map(|height| DVec3::new(0.5, height, 0.0));
        let mut shape = Shape::SOUND;
        let is_sound = shape.add(corners, [DVec3::ZERO, DVec3::X], &limits).is_some();
        (limits, is_sound.then_some(shape))
    }

    #[test]
    fn a_thin_face_waits_by_the_square_of_how_thin_it_is() {
        // The angle at either end of the side has the tangent 2 × height.
        let doublings = |degrees: [f64; 2]| {
            let heights = degrees.map(|angle| 0.5 * angle.to_radians().tan());
            let (limits, shape) = moved(heights, Turns::Adaptive);
            limits.doublings(shape.unwrap())
        };
        // A third of 3 degrees costs 9 times as much, which is more than 2³.
        assert_eq!(
            [20.0, 3.1, 2.9, 1.6, 1.0].map(|angle| doublings([45.0, angle])),
            [0, 0, 1, 2, 4]
        );
        // One that was thinner before is no reason to wait.
        assert_eq!(doublings([0.5, 1.0]), 0);
    }

    #[test]
    fn turns_beyond_45_degrees_wait_and_beyond_90_are_none() {
        let turned = |degrees: f64, turns| {
            let options = SimplifyOptions { turns, ..SimplifyOptions::DEFAULT };
            let limits = ShapeLimits::new(&options, true).unwrap();
            let (sin, cos) = degrees.to_radians().sin_cos();
            let corners = [DVec3::new(0.5, 1.0, 0.0), DVec3::new(0.5, cos, sin)];
            let mut shape = Shape::SOUND;
            shape.add(corners, [DVec3::ZERO, DVec3::X], &limits)?;
            Some(limits.doublings(shape))
        };
        let adaptive = [44.0, 46.0, 89.0, 91.0].map(|angle| turned(angle, Turns::Adaptive));
        assert_eq!(adaptive, [Some(0), Some(2), Some(2), None]);
        let limit = Turns::UpTo(60f64.to_radians());
        assert_eq!([59.0, 61.0].map(|angle| turned(angle, limit)), [Some(0), None]);
    }
}
