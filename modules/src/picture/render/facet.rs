//! One face as the eye sees it: how much of each corner is at a pixel, and how it is lit there.

use glam::DVec3;

use super::albedo::FaceColor;

/// What the pixels of one face have in common.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// The weight of each corner for a ray is the product of the ray with these.
    across: [DVec3; 3],
    /// The light at each corner, 0 to 1.
    pub lights: [f64; 3],
    /// The color.
    pub color: FaceColor,
}

impl Facet {
    /// No face.
    pub const NONE: Self =
        Self { across: [DVec3::ZERO; 3], lights: [0.0; 3], color: FaceColor::WHITE };

    /// A white face whose pixels have no need of weights.
    pub fn flat(lights: [f64; 3]) -> Self {
        Self { lights, ..Self::NONE }
    }

    /// A face with its corners at these points.
    pub fn new(eye: DVec3, points: [DVec3; 3], lights: [f64; 3], color: FaceColor) -> Self {
        let (a, b, c) = (points[0] - eye, points[1] - eye, points[2] - eye);
        Self { across: [b.cross(c), c.cross(a), a.cross(b)], lights, color }
    }

    /// How much of each corner is where a ray meets the face, or next to it; they add up to 1.
    #[inline]
    pub fn weights(&self, ray: DVec3) -> [f64; 3] {
        let [u, v, w] = &self.across;
        let (u, v, w) = (u.dot(ray), v.dot(ray), w.dot(ray));
        // A face that is seen from behind has all three negative.
        let sign = if u + v + w < 0.0 { -1.0 } else { 1.0 };
        let (u, v, w) = ((sign * u).max(0.0), (sign * v).max(0.0), (sign * w).max(0.0));
        let sum = u + v + w;
        if sum > 0.0 && sum.is_finite() { [u / sum, v / sum, w / sum] } else { [1.0 / 3.0; 3] }
    }
}
