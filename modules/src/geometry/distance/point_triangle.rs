//! The distance from a point to a triangle, with all that depends on the triangle alone prepared.
//!
//! The plane of the triangle is split by its three sides: a point above the inside is as far as
//! the plane, any other is as far as the nearest of the sides that it lies beyond. That the nearest
//! point of a convex polygon is on a side which faces the query point is what makes it enough to
//! look at those sides.

use glam::DVec3;

/// A triangle whose height over its longest side is below this fraction of that side has no
/// usable normal: rounding turns it by more than the thickness moves the surface. It counts as
/// its three sides, which moves the distance by at most this fraction of the longest side.
const FLAT: f64 = 1e-8;

/// A triangle, ready for many points.
#[derive(Clone, Copy, Debug)]
pub struct PreparedTriangle {
    a: DVec3,
    ab: DVec3,
    ac: DVec3,
    /// Of unit length; not a number for a flat triangle.
    normal: DVec3,
    /// `(p - a) · dual_b` is the barycentric coordinate of `p` at `b`; not a number when flat.
    dual_b: DVec3,
    /// The same at `c`.
    dual_c: DVec3,
    /// One over the squared lengths of ab, ac and bc; 0 for a side without length.
    inv_ab_sq: f64,
    inv_ac_sq: f64,
    inv_bc_sq: f64,
}

impl PreparedTriangle {
    /// Any triangle with finite corners, degenerate ones included.
    pub fn new([a, b, c]: [DVec3; 3]) -> Self {
        let (ab, ac, bc) = (b - a, c - a, c - b);
        let cross = ab.cross(ac);
        let cross_sq = cross.length_squared();
        let longest_sq = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
        let usable = cross_sq > (FLAT * longest_sq) * (FLAT * longest_sq);
        let inverse = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
        let scale = if usable { 1.0 / cross_sq } else { f64::NAN };
        Self {
            a,
            ab,
            ac,
            normal: cross * scale.sqrt(),
            dual_b: ac.cross(cross) * scale,
            dual_c: cross.cross(ab) * scale,
            inv_ab_sq: inverse(ab.length_squared()),
            inv_ac_sq: inverse(ac.length_squared()),
            inv_bc_sq: inverse(bc.length_squared()),
        }
    }

    /// The barycentric coordinates of the point of the triangle's plane below `point`: linear in
    /// it, all positive above the inside, not numbers for a flat triangle.
    #[inline]
    pub fn coordinates(&self, point: DVec3) -> [f64; 3] {
        let ap = point - self.a;
        let at_b = ap.dot(self.dual_b);
        let at_c = ap.dot(self.dual_c);
        [1.0 - at_b - at_c, at_b, at_c]
    }

    /// By how much each barycentric coordinate changes at most per length moved.
    pub fn slopes(&self) -> [f64; 3] {
        [self.dual_b + self.dual_c, self.dual_b, self.dual_c].map(DVec3::length)
    }

    /// The squared distance from `point`, in squared model units.
    #[inline]
    pub fn distance_sq(&self, point: DVec3) -> f64 {
        let ap = point - self.a;
        let at_b = ap.dot(self.dual_b);
        let at_c = ap.dot(self.dual_c);
        let at_a = 1.0 - at_b - at_c;
        if at_a >= 0.0 && at_b >= 0.0 && at_c >= 0.0 {
            let height = ap.dot(self.normal);
            return height * height;
        }
        let (best, _) = self.nearest_side(ap, [at_a, at_b, at_c]);
        best
    }

    /// The point of the triangle nearest to `point`.
    pub fn closest_point(&self, point: DVec3) -> DVec3 {
        let ap = point - self.a;
        let at_b = ap.dot(self.dual_b);
        let at_c = ap.dot(self.dual_c);
        let at_a = 1.0 - at_b - at_c;
        if at_a >= 0.0 && at_b >= 0.0 && at_c >= 0.0 {
            return self.a + (self.ab * at_b + self.ac * at_c);
        }
        let (_, offset) = self.nearest_side(ap, [at_a, at_b, at_c]);
        point - offset
    }

    /// The vector to `point` from the nearest point of the triangle: as good far away as near.
    #[inline]
    pub fn offset(&self, point: DVec3) -> DVec3 {
        let ap = point - self.a;
        let at_b = ap.dot(self.dual_b);
        let at_c = ap.dot(self.dual_c);
        let at_a = 1.0 - at_b - at_c;
        if at_a >= 0.0 && at_b >= 0.0 && at_c >= 0.0 {
            return self.normal * ap.dot(self.normal);
        }
        self.nearest_side(ap, [at_a, at_b, at_c]).1
    }

    /// The unit normal; not a number for a flat triangle.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The length of the longest side.
    #[inline]
    pub fn longest_side(&self) -> f64 {
        let [ab, ac, bc] = [self.ab, self.ac, self.ac - self.ab].map(DVec3::length_squared);
        ab.max(ac).max(bc).sqrt()
    }

    /// The corners as seen from `point`.
    pub fn corners_from(&self, point: DVec3) -> [DVec3; 3] {
        let a = self.a - point;
        [a, a + self.ab, a + self.ac]
    }

    /// Squared length of, and, the vector from the nearest side that the point lies beyond.
    ///
    /// Coordinates that are not numbers (a flat triangle) look at every side.
    #[inline]
    fn nearest_side(&self, ap: DVec3, [at_a, at_b, at_c]: [f64; 3]) -> (f64, DVec3) {
        let mut best = (f64::INFINITY, DVec3::ZERO);
        let mut look = |from: DVec3, side: DVec3, inv_sq: f64| {
            let t = (from.dot(side) * inv_sq).clamp(0.0, 1.0);
            let offset = from - side * t;
            let distance_sq = offset.length_squared();
            if distance_sq < best.0 {
                best = (distance_sq, offset);
            }
        };
        if at_c.is_nan() || at_c < 0.0 {
            look(ap, self.ab, self.inv_ab_sq);
        }
        if at_b.is_nan() || at_b < 0.0 {
            look(ap, self.ac, self.inv_ac_sq);
        }
        if at_a.is_nan() || at_a < 0.0 {
            look(ap - self.ab, self.ac - self.ab, self.inv_bc_sq);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RIGHT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn every_region_of_a_right_triangle() {
        let triangle = PreparedTriangle::new(RIGHT);
        let cases = [
            (DVec3::new(0.25, 0.25, 2.0), DVec3::new(0.25, 0.25, 0.0)),
            (DVec3::new(-3.0, -4.0, 0.0), DVec3::ZERO),
            (DVec3::new(2.0, -1.0, 1.0), DVec3::X),
            (DVec3::new(-1.0, 3.0, 0.0), DVec3::Y),
            (DVec3::new(0.5, -2.0, 0.0), DVec3::new(0.5, 0.0, 0.0)),
            (DVec3::new(-2.0, 0.5, 1.0), DVec3::new(0.0, 0.5, 0.0)),
            (DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.5, 0.5, 0.0)),
        ];
        for (point, expected) in cases {
            let found = triangle.closest_point(point);
            assert!(found.distance(expected) < 1e-15, "{point}: {found}");
            let distance_sq = point.distance_squared(expected);
            assert!((triangle.distance_sq(point) - distance_sq).abs() < 1e-14);
        }
    }

    #[test]
    fn a_degenerate_triangle_is_its_longest_side() {
        let segment = PreparedTriangle::new([DVec3::ZERO, DVec3::X, DVec3::X * 3.0]);
        assert_eq!(segment.distance_sq(DVec3::new(2.0, 2.0, 0.0)), 4.0);
        assert_eq!(segment.closest_point(DVec3::new(2.0, 2.0, 0.0)), DVec3::X * 2.0);
        let point = PreparedTriangle::new([DVec3::ONE; 3]);
        assert_eq!(point.distance_sq(DVec3::ZERO), 3.0);
    }

    fn any_point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from)
    }

    proptest! {
        /// No point of a fine grid on the triangle is nearer, and the closest point attains it.
        #[test]
        fn no_point_of_the_triangle_is_nearer(
            a in any_point(), b in any_point(), c in any_point(), p in any_point(),
        ) {
            let triangle = PreparedTriangle::new([a, b, c]);
            let distance = triangle.distance_sq(p).sqrt();
            let n = 60;
            let mut least = f64::INFINITY;
            for i in 0..=n {
                for j in 0..=n - i {
                    let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                    least = least.min(p.distance(a + (b - a) * s + (c - a) * t));
                }
            }
            prop_assert!(distance <= least + 1e-12);
            prop_assert!(distance >= least - 2.0 * 3.5 / f64::from(n));
            prop_assert!((triangle.closest_point(p).distance(p) - distance).abs() < 1e-7);
        }
    }
}
