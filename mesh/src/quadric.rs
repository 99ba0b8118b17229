//! Quadric error functions, kept relative to a moving origin.
//!
//! A quadric sums squared distances to weighted planes (M. Garland and P. S. Heckbert, "Surface
//! simplification using quadric error metrics", SIGGRAPH 1997, sections 4 and 5). Deviation from
//! the paper: the function is stored about a point near its planes, not about the model's origin,
//! so that rounding is relative to the length of an edge, not to the size of the model; adding
//! quadrics of two vertices shifts one of them first.

use glam::DVec3;

/// `Q(d) = dᵀ A d + 2 b·d + c` of an offset `d` from the origin that the holder remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quadric {
    /// Upper triangle of `A`: xx, xy, xz, yy, yz, zz.
    pub a: [f64; 6],
    /// The linear part, halved.
    pub b: DVec3,
    /// The value at the origin.
    pub c: f64,
}

impl Quadric {
    /// Squared distance to the plane of unit normal `normal` that lies `offset` along it from the
    /// origin, times `weight`.
    #[inline]
    pub fn from_plane(normal: DVec3, offset: f64, weight: f64) -> Self {
        let DVec3 { x, y, z } = normal;
        let w = normal * weight;
        Self {
            a: [w.x * x, w.x * y, w.x * z, w.y * y, w.y * z, w.z * z],
            b: w * -offset,
            c: weight * offset * offset,
        }
    }

    /// Adds another quadric about the same origin.
    #[inline]
    pub fn add(&mut self, other: &Self) {
        for (mine, theirs) in self.a.iter_mut().zip(other.a) {
            *mine += theirs;
        }
        self.b += other.b;
        self.c += other.c;
    }

    /// Adds another quadric about the same origin, so many times.
    #[inline]
    pub fn add_scaled(&mut self, other: &Self, by: f64) {
        for (mine, theirs) in self.a.iter_mut().zip(other.a) {
            *mine += by * theirs;
        }
        self.b += by * other.b;
        self.c += by * other.c;
    }

    /// Multiplies all weights.
    #[inline]
    pub fn scale(&mut self, by: f64) {
        self.a.iter_mut().for_each(|entry| *entry *= by);
        self.b *= by;
        self.c *= by;
    }

    /// The same function about an origin moved by `by`: `shifted(by).at(d) == at(d + by)`.
    #[inline]
    pub fn shifted(&self, by: DVec3) -> Self {
        let a_by = self.times(by);
        Self { a: self.a, b: self.b + a_by, c: self.c + by.dot(a_by + 2.0 * self.b) }
    }

    /// The value at an offset from the origin. Rounding may make it slightly negative.
    #[inline]
    pub fn at(&self, d: DVec3) -> f64 {
        d.dot(self.times(d) + 2.0 * self.b) + self.c
    }

    /// Sum of the weights of its planes: the trace of `A`, because each normal has length 1.
    #[inline]
    pub fn weight(&self) -> f64 {
        self.a[0] + self.a[3] + self.a[5]
    }

    /// `A d`.
    #[inline]
    fn times(&self, d: DVec3) -> DVec3 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        DVec3::new(
            xx * d.x + xy * d.y + xz * d.z,
            xy * d.x + yy * d.y + yz * d.z,
            xz * d.x + yz * d.y + zz * d.z,
        )
    }

    /// The offset of least value; where the planes leave it open, the one nearest to `start`.
    ///
    /// Three proximal steps `d ← d − (A + εI)⁻¹ (A d + b)` from `start`, `ε = stiffness × trace A`
    /// (R. T. Rockafellar, "Monotone operators and the proximal point algorithm", 1976). A
    /// direction whose eigenvalue is λ keeps `(ε / (λ + ε))³` of its distance to the minimum: it
    /// is solved exactly where λ ≫ ε and not moved where λ ≪ ε, so that a flat area or a straight
    /// crease needs no case of its own. `None` where there is no finite answer (no planes).
    #[inline]
    pub fn minimum_near(&self, start: DVec3, stiffness: f64) -> Option<DVec3> {
        let eps = stiffness * self.weight();
        let [xx, xy, xz, yy, yz, zz] = self.a;
        // L D Lᵀ of A + εI, which is positive definite: ε is far above the rounding of A.
        let d0 = 1.0 / (xx + eps);
        let (l10, l20) = (xy * d0, xz * d0);
        let d1 = 1.0 / (yy + eps - l10 * xy);
        let yz_left = yz - l20 * xy;
        let l21 = yz_left * d1;
        let d2 = 1.0 / (zz + eps - l20 * xz - l21 * yz_left);
        let solve = |r: DVec3| {
            let y1 = r.y - l10 * r.x;
            let y2 = r.z - l20 * r.x - l21 * y1;
            let z = y2 * d2;
            let y = y1 * d1 - l21 * z;
            DVec3::new(r.x * d0 - l10 * y - l20 * z, y, z)
        };
        // The gradient after a step is ε times the step, so `A d` is needed only once.
        let first = solve(self.times(start) + self.b);
        let second = solve(eps * first);
        let third = solve(eps * second);
        let found = start - (first + (second + third));
        found.is_finite().then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> Quadric {
        let mut q = Quadric::from_plane(DVec3::X, 1.0, 2.0);
        q.add(&Quadric::from_plane(DVec3::Y, -2.0, 1.0));
        q.add(&Quadric::from_plane(DVec3::Z, 0.5, 4.0));
        q
    }

    #[test]
    fn value_is_weighted_squared_distance() {
        // Distances 1, 2 and 0.5 with weights 2, 1 and 4.
        assert_eq!(corner().at(DVec3::ZERO), 2.0 + 4.0 + 1.0);
        assert_eq!(corner().weight(), 7.0);
    }

    #[test]
    fn shift_moves_the_origin() {
        let by = DVec3::new(0.25, -0.5, 2.0);
        assert_eq!(corner().shifted(by).at(DVec3::ONE), corner().at(DVec3::ONE + by));
    }

    #[test]
    fn three_planes_meet_in_their_corner() {
        let found = corner().minimum_near(DVec3::ZERO, 1e-6).unwrap();
        assert!((found - DVec3::new(1.0, -2.0, 0.5)).length() < 1e-14, "{found}");
    }

    #[test]
    fn flat_area_and_straight_crease_move_least() {
        let mut q = Quadric::from_plane(DVec3::Z, 1.0, 3.0);
        let flat = q.minimum_near(DVec3::new(5.0, 7.0, 0.0), 1e-6).unwrap();
        assert!((flat - DVec3::new(5.0, 7.0, 1.0)).length() < 1e-14, "{flat}");
        q.add(&Quadric::from_plane(DVec3::Y, 2.0, 3.0));
        let crease = q.minimum_near(DVec3::new(5.0, 7.0, 0.0), 1e-6).unwrap();
        assert!((crease - DVec3::new(5.0, 2.0, 1.0)).length() < 1e-14, "{crease}");
        assert_eq!(Quadric::default().minimum_near(DVec3::ZERO, 1e-6), None);
    }
}
