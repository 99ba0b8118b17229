//! Convex parts of faces, cut along the sides of a triangle.

use glam::DVec3;

use super::point_triangle::PreparedTriangle;

/// A piece that lies beyond a side by less than this part of the height over that side is not cut
/// by it: pieces as thin as the rounding of their corners are over neither of two triangles.
const SLACK: f64 = 1e-10;

/// A convex polygon.
#[derive(Clone, Copy)]
pub(super) struct Polygon {
    points: [DVec3; Self::MAX],
    pub n: usize,
}

impl Polygon {
    /// A cut adds a corner at most; a polygon with more is not made.
    const MAX: usize = 14;
    const EMPTY: Self = Self { points: [DVec3::NAN; Self::MAX], n: 0 };

    /// A triangle.
    pub fn of(corners: [DVec3; 3]) -> Self {
        let mut polygon = Self { n: 3, ..Self::EMPTY };
        polygon.points[..3].copy_from_slice(&corners);
        polygon
    }

    fn points(&self) -> &[DVec3] {
        &self.points[..self.n]
    }

    /// Adds a corner, if there is room and it is finite.
    fn push(&mut self, point: DVec3) -> Option<()> {
        *self.points.get_mut(self.n).filter(|_| point.is_finite())? = point;
        self.n += 1;
        Some(())
    }

    /// The mean of the corners.
    pub fn center(&self) -> DVec3 {
        self.points().iter().sum::<DVec3>() / self.n as f64
    }

    /// The largest squared distance of a point of the polygon from the triangle.
    pub fn most_sq(&self, target: &PreparedTriangle) -> f64 {
        self.points().iter().map(|&p| target.distance_sq(p)).fold(0.0, f64::max)
    }

    /// The piece where a barycentric coordinate is at least `-margin`, and the other; nothing
    /// when one of them would have too many corners.
    pub fn cut(&self, target: &PreparedTriangle, side: usize, margin: f64) -> Option<(Self, Self)> {
        let (mut within, mut beyond) = (Self::EMPTY, Self::EMPTY);
        let mut at = [0.0; Self::MAX];
        for (at, &point) in at.iter_mut().zip(self.points()) {
            *at = target.coordinates(point)[side] + margin;
        }
        if at[..self.n].iter().all(|&at| at > -SLACK) {
            return Some((*self, beyond));
        }
        for (k, &point) in self.points().iter().enumerate() {
            let next = (k + 1) % self.n;
            let is_within = at[k] >= 0.0;
            if is_within {
                within.push(point)?;
            } else {
                beyond.push(point)?;
            }
            if is_within != (at[next] >= 0.0) {
                let share = at[k] / (at[k] - at[next]);
                let between = point + (self.points[next] - point) * share;
                within.push(between)?;
                beyond.push(between)?;
            }
        }
        Some((within, beyond))
    }
}
