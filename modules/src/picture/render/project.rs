//! From space to the grid of pixels: perspective, snapping, and clipping of what needs it.

use glam::DVec3;

use super::camera::{Camera, TAN_HALF_ANGLE};

/// Steps of the grid that corners are snapped to, in a pixel.
pub const STEPS: i32 = 256;

/// Corners nearer than this part of the distance at which a picture's plane of reference lies are
/// clipped: depth must stay positive.
const NEAR: f64 = 1.0 / 1024.0;

/// Corners farther out than so many times half of the picture are clipped, which bounds the
/// integers below.
const GUARD: f64 = 16.0;

/// The largest side of a picture in pixels.
pub const MAX_SIZE: usize = 8192;

/// A corner on the grid of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// Steps to the right of the left side.
    pub x: i32,
    /// Steps down from the upper side.
    pub y: i32,
    /// One over the depth, which is linear over the picture of a plane; 0 for a corner that has no
    /// place on the grid: behind the camera, far outside, or not a number.
    pub inv_depth: f32,
}

impl Corner {
    /// Whether the corner has a place on the grid.
    #[inline]
    pub fn is_placed(self) -> bool {
        self.inv_depth > 0.0
    }
}

/// A camera with a square picture of `size` × `size` pixels and an opening of 60°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// The camera.
    pub camera: Camera,
    /// Pixels in a row, and rows.
    pub size: usize,
    near: f64,
}

impl Lens {
    /// A picture of `size` pixels a side, at most [`MAX_SIZE`]; `distance` from the camera to what
    /// it looks at, in model units, decides what is too near.
    pub fn new(camera: Camera, size: usize, distance: f64) -> Self {
        Self { camera, size: size.min(MAX_SIZE), near: distance * NEAR }
    }

    /// Half of the picture's side, in steps.
    #[inline]
    fn half(&self) -> f64 {
        0.5 * f64::from(STEPS) * self.size as f64
    }

    /// The corner of a point.
    #[inline]
    pub fn corner(&self, point: DVec3) -> Corner {
        self.place(self.camera.view(point))
    }

    /// The corner of a point in camera coordinates. The grid's values are exact functions of the
    /// point: only sums, products and quotients of doubles are used.
    #[inline]
    fn place(&self, view: DVec3) -> Corner {
        let inv_depth = view.z.recip();
        let scale = inv_depth * (1.0 / TAN_HALF_ANGLE);
        let (x, y) = (view.x * scale, -view.y * scale);
        let is_inside = view.z >= self.near && x.abs() <= GUARD && y.abs() <= GUARD;
        if !is_inside {
            return Corner::default();
        }
        // The sum is positive, so cutting off the fraction rounds to the nearest step.
        let snap = |side: f64| {
            let steps = (side + 1.0) * self.half();
            (steps + (GUARD * self.half() + 0.5)) as i32 - (GUARD * self.half()) as i32
        };
        Corner { x: snap(x), y: snap(y), inv_depth: inv_depth as f32 }
    }

    /// From the eye through the center of the pixel in column `x` of row `y`; its part along the
    /// camera's `forward` is 1.
    #[inline]
    pub fn ray(&self, [x, y]: [usize; 2]) -> DVec3 {
        let side = |at: usize| ((2 * at + 1) as f64 / self.size as f64 - 1.0) * TAN_HALF_ANGLE;
        let Camera { right, up, forward, .. } = self.camera;
        forward + (right * side(x) - up * side(y))
    }

    /// Calls `each` with every triangle that is left of one of which some corner has no place: it
    /// is cut off at the near plane and at the sides of a frustum 16 times as wide as the picture.
    /// Orientation is kept. Rare, so not fast.
    pub fn clip(&self, corners: [DVec3; 3], mut each: impl FnMut([Corner; 3])) {
        if !corners.iter().all(|corner| corner.is_finite()) {
            return;
        }
        let mut polygon: Vec<DVec3> = corners.map(|corner| self.camera.view(corner)).to_vec();
        // A little within the guard, so that what is cut has a place in spite of rounding.
        let side = GUARD * TAN_HALF_ANGLE * (1.0 - 1e-9);
        let planes: [&dyn Fn(DVec3) -> f64; 5] = [
            &|p| p.z - self.near * (1.0 + 1e-9),
            &|p| side * p.z - p.x,
            &|p| side * p.z + p.x,
            &|p| side * p.z - p.y,
            &|p| side * p.z + p.y,
        ];
        for height in planes {
            polygon = cut(&polygon, height);
        }
        let placed: Vec<Corner> = polygon.iter().map(|&view| self.place(view)).collect();
        if placed.len() < 3 || !placed.iter().all(|corner| corner.is_placed()) {
            return;
        }
        for pair in placed[1..].windows(2) {
            each([placed[0], pair[0], pair[1]]);
        }
    }
}

/// The part of a convex polygon at a height of at least 0 (I. E. Sutherland and G. W. Hodgman,
/// "Reentrant polygon clipping", CACM 17(1), 1974). Two faces at an edge get the same point where
/// the edge is cut: it is computed from the inner end.
fn cut(polygon: &[DVec3], height: &dyn Fn(DVec3) -> f64) -> Vec<DVec3> {
    let mut left = Vec::with_capacity(polygon.len() + 1);
    for (k, &to) in polygon.iter().enumerate() {
        let from = polygon[(k + polygon.len() - 1) % polygon.len()];
        let (h_from, h_to) = (height(from), height(to));
        if (h_from >= 0.0) != (h_to >= 0.0) {
            let (inner, outer, h_inner, h_outer) =
                if h_from >= 0.0 { (from, to, h_from, h_to) } else { (to, from, h_to, h_from) };
            left.push(inner + (outer - inner) * (h_inner / (h_inner - h_outer)));
        }
        if h_to >= 0.0 {
            left.push(to);
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens() -> Lens {
        let camera = Camera::look_at(DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO).unwrap();
        Lens::new(camera, 64, 2.0)
    }

    #[test]
    fn points_at_the_rim_are_at_the_rim() {
        let lens = lens();
        // At depth 2 the picture is 2 · 2 tan 30° wide.
        let rim = 2.0 / 3f64.sqrt();
        let upper_left = lens.corner(DVec3::new(-rim, rim, 0.0));
        assert_eq!((upper_left.x, upper_left.y, upper_left.inv_depth), (0, 0, 0.5));
        let middle = lens.corner(DVec3::ZERO);
        assert_eq!((middle.x, middle.y), (32 * STEPS, 32 * STEPS));
        let out = lens.corner(DVec3::new(-3.0 * rim, 0.0, 0.0));
        assert_eq!((out.x, out.y), (-64 * STEPS, 32 * STEPS));
    }

    #[test]
    fn what_has_no_place_says_so() {
        let lens = lens();
        for point in [[0.0, 0.0, 2.0], [0.0, 0.0, 5.0], [1e300, 0.0, 0.0], [f64::NAN; 3]] {
            assert!(!lens.corner(point.into()).is_placed(), "{point:?}");
        }
    }

    #[test]
    fn a_triangle_through_the_camera_plane_keeps_its_front_part() {
        let lens = lens();
        let mut found = Vec::new();
        // The part before the camera spans depths up to 2 along one edge.
        let corners = [[0.0, 0.0, 0.0], [0.1, 0.0, 4.0], [0.0, 0.1, 4.0]].map(DVec3::from);
        lens.clip(corners, |triangle| found.push(triangle));
        assert!(found.iter().flatten().any(|&corner| corner == lens.corner(DVec3::ZERO)));
        assert!(found.iter().flatten().all(|corner| corner.is_placed()));
        lens.clip([DVec3::new(0.0, 0.0, 9.0); 3], |_| panic!("behind"));
        lens.clip([DVec3::NAN; 3], |_| panic!("nowhere"));
        let huge = [[-1e200, -1e200, 0.0], [1e200, -1e200, 0.0], [0.0, 1e200, 0.0]];
        let mut n = 0;
        lens.clip(huge.map(DVec3::from), |_| n += 1);
        assert!(n >= 2);
    }
}
