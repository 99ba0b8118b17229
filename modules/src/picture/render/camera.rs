//! Where pictures are taken from.

use glam::DVec3;

/// The tangent of half of the opening angle of 60°.
pub(super) const TAN_HALF_ANGLE: f64 = 0.577_350_269_189_625_8;

/// A camera with its axes; a point `p` has the camera coordinates
/// `(right, up, forward) · (p − eye)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The center of projection, in model units.
    pub eye: DVec3,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to the top of the picture.
    pub up: DVec3,
    /// Unit vector into the picture. Light falls along it: the light is at the camera, and its rays
    /// are parallel, so that a plane has one luminance however it is cut into triangles.
    pub forward: DVec3,
}

impl Camera {
    /// A camera at `eye` that looks at `target` with the y axis upward, or the z axis where it
    /// looks along the y axis. `None` where the two points are the same or not finite.
    pub fn look_at(eye: DVec3, target: DVec3) -> Option<Self> {
        let forward = (target - eye).try_normalize()?;
        // Within a degree of the y axis its direction in the picture means nothing.
        let upward = if forward.y.abs() > 0.9998 { DVec3::Z } else { DVec3::Y };
        let right = forward.cross(upward).try_normalize()?;
        Some(Self { eye, right, up: right.cross(forward), forward })
    }

    /// A point in camera coordinates: right, up, depth.
    #[inline]
    pub fn view(&self, point: DVec3) -> DVec3 {
        let from_eye = point - self.eye;
        DVec3::new(self.right.dot(from_eye), self.up.dot(from_eye), self.forward.dot(from_eye))
    }
}

/// Directions from the center of a model to its cameras, spread over the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraSet {
    /// The 20 vertices of a dodecahedron, from which P. Lindstrom and G. Turk, "Image-driven
    /// simplification", ACM Transactions on Graphics 19(3), 2000, simplify.
    Dodecahedron,
    /// The 24 vertices of a rhombicuboctahedron, from which they measure: no camera of the one set
    /// is one of the other.
    Rhombicuboctahedron,
    /// So many points of a Fibonacci lattice: about evenly spread, for any number.
    Fibonacci(usize),
    /// One camera in the direction of this unit vector, as near as all of the mesh allows.
    Toward(DVec3),
}

impl CameraSet {
    /// How many cameras it has.
    pub fn len(self) -> usize {
        match self {
            Self::Dodecahedron => 20,
            Self::Rhombicuboctahedron => 24,
            Self::Fibonacci(n) => n,
            Self::Toward(_) => 1,
        }
    }

    /// Whether it has none.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Unit vectors from the center to the cameras, in an order that stays.
    pub fn directions(self) -> Vec<DVec3> {
        match self {
            Self::Dodecahedron => dodecahedron(),
            Self::Rhombicuboctahedron => rhombicuboctahedron(),
            Self::Fibonacci(n) => fibonacci(n),
            Self::Toward(direction) => vec![direction],
        }
    }

    /// Cameras on the sphere of radius `distance` around `center`, all looking at it. Empty where
    /// the distance is not positive and finite.
    pub fn cameras(self, center: DVec3, distance: f64) -> Vec<Camera> {
        let eyes = self.directions().into_iter().map(|direction| center + distance * direction);
        if distance > 0.0 {
            eyes.filter_map(|eye| Camera::look_at(eye, center)).collect()
        } else {
            Vec::new()
        }
    }

    /// Cameras around a mesh, of which the box is given as `(lowest, highest)` corner and its
    /// points: around the center of the box, one diagonal away. Everything in the box is then in
    /// every picture of 60°. [`CameraSet::Toward`] is fitted to the points.
    pub fn around(self, (low, high): (DVec3, DVec3), points: &[DVec3]) -> Vec<Camera> {
        let diagonal = (high - low).length();
        let mut cameras = self.cameras(low.midpoint(high), diagonal);
        if let Self::Toward(_) = self {
            cameras.iter_mut().for_each(|camera| camera.fit(points, diagonal));
        }
        cameras
    }
}

impl Camera {
    /// Moves the camera, without turning it, to where the points fill its picture of 60° up to a
    /// margin of a twentieth, in the middle of it. `diagonal` is that of their box.
    fn fit(&mut self, points: &[DVec3], diagonal: f64) {
        /// The nearest point is at least this part of the diagonal away.
        const NEAREST: f64 = 0.01;
        let tangent = 0.95 * TAN_HALF_ANGLE;
        // A point with coordinates (x, z) is in the picture of an eye at (a, c), where
        // |x − a| ≤ t (z − c): a + t c ≤ x + t z and a − t c ≥ x − t z. For all points at once,
        // a + t c ≤ least and a − t c ≥ most, which leaves some a if 2 t c ≤ least − most.
        let mut least = [f64::INFINITY; 2];
        let mut most = [f64::NEG_INFINITY; 2];
        let mut nearest = f64::INFINITY;
        for point in points {
            let seen = self.view(*point);
            nearest = nearest.min(seen.z);
            for (axis, side) in [seen.x, seen.y].into_iter().enumerate() {
                least[axis] = least[axis].min(side + tangent * seen.z);
                most[axis] = most[axis].max(side - tangent * seen.z);
            }
        }
        let depth = |axis: usize| (least[axis] - most[axis]) / (2.0 * tangent);
        let forward = depth(0).min(depth(1)).min(nearest - NEAREST * diagonal);
        let middle = |axis: usize| 0.5 * (least[axis] + most[axis]);
        let moved = self.right * middle(0) + self.up * middle(1) + self.forward * forward;
        if moved.is_finite() {
            self.eye += moved;
        }
    }
}

/// Signs of three coordinates, the last one changing fastest.
fn signs() -> impl Iterator<Item = DVec3> {
    (0..8).map(|k| {
        let sign = |bit: i32| if k & bit == 0 { 1.0 } else { -1.0 };
        DVec3::new(sign(4), sign(2), sign(1))
    })
}

fn dodecahedron() -> Vec<DVec3> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let pairs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let (small, large) = (golden.recip(), golden);
    let rectangles = pairs.into_iter().flat_map(|(s, l)| {
        let (s, l) = (s * small, l * large);
        [DVec3::new(0.0, s, l), DVec3::new(s, l, 0.0), DVec3::new(l, 0.0, s)]
    });
    signs().chain(rectangles).map(DVec3::normalize).collect()
}

fn rhombicuboctahedron() -> Vec<DVec3> {
    let long = 1.0 + 2f64.sqrt();
    let places =
        [DVec3::new(1.0, 1.0, long), DVec3::new(1.0, long, 1.0), DVec3::new(long, 1.0, 1.0)];
    places.into_iter().flat_map(|p| signs().map(move |s| (s * p).normalize())).collect()
}

/// The lattice of R. Swinbank and R. J. Purser, "Fibonacci grids: a novel approach to global
/// modelling", 2006: equal steps of height, turned by the golden angle from one to the next. The
/// turn is repeated by multiplication, so that no library's sine enters.
fn fibonacci(n: usize) -> Vec<DVec3> {
    // Cosine and sine of π (3 − √5).
    let (cosine, sine) = (-0.737_368_878_078_319_8, 0.675_490_294_261_523_7);
    let (mut x, mut z) = (1.0f64, 0.0f64);
    let mut points = Vec::with_capacity(n);
    for k in 0..n {
        let y = 1.0 - (2 * k + 1) as f64 / n as f64;
        let radius = (1.0 - y * y).max(0.0).sqrt();
        points.push(DVec3::new(radius * x, y, radius * z).normalize());
        (x, z) = (cosine * x - sine * z, sine * x + cosine * z);
        let length = (x * x + z * z).sqrt();
        (x, z) = (x / length, z / length);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distance to the nearest other point, of all points.
    fn gaps(points: &[DVec3]) -> Vec<f64> {
        let gap = |p: &DVec3| {
            let others = points.iter().filter(|q| *q != p).map(|q| q.distance(*p));
            others.fold(f64::INFINITY, f64::min)
        };
        points.iter().map(gap).collect()
    }

    #[test]
    fn solids_have_equal_edges() {
        // Edge over circumradius: dodecahedron 4 / (√3 (1 + √5)), rhombicuboctahedron
        // 2 / √(5 + 2√2).
        let sets = [
            (CameraSet::Dodecahedron, 20, 4.0 / (3f64.sqrt() * (1.0 + 5f64.sqrt()))),
            (CameraSet::Rhombicuboctahedron, 24, 2.0 / (5.0 + 2.0 * 2f64.sqrt()).sqrt()),
        ];
        for (set, n, edge) in sets {
            let points = set.directions();
            assert_eq!(points.len(), n);
            assert!(gaps(&points).iter().all(|gap| (gap - edge).abs() < 1e-15), "{set:?}");
        }
    }

    #[test]
    fn the_lattice_is_spread_evenly() {
        let points = CameraSet::Fibonacci(200).directions();
        let golden_angle = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let flat = |p: DVec3| glam::DVec2::new(p.x, p.z).normalize();
        let turn = flat(points[99]).perp_dot(flat(points[100]));
        assert!((turn - golden_angle.sin()).abs() < 1e-12);
        // Evenly spread points of n on the sphere are about √(4π / n) apart.
        let even = (4.0 * std::f64::consts::PI / 200.0).sqrt();
        assert!(gaps(&points).iter().all(|gap| (0.7..1.3).contains(&(gap / even))));
    }

    #[test]
    fn one_direction_fills_the_picture() {
        let cube: Vec<DVec3> = signs().collect();
        let bounds = (DVec3::splat(-1.0), DVec3::ONE);
        let camera = CameraSet::Toward(DVec3::Z).around(bounds, &cube)[0];
        // The front of the cube, 2 wide, is 0.95 of the picture: 1 / (0.95 tan 30°) before it.
        let expected = 1.0 + 1.0 / (0.95 * 3f64.sqrt().recip());
        assert!(camera.eye.distance(DVec3::new(0.0, 0.0, expected)) < 1e-12, "{camera:?}");
        // From anywhere some point is on the margin on both sides of one direction, and none
        // beyond it, whatever else is in the box.
        let away: Vec<DVec3> = cube.iter().map(|p| *p * DVec3::new(3.0, 1.0, 0.2)).collect();
        let bounds = (DVec3::new(-3.0, -1.0, -0.2), DVec3::new(3.0, 1.0, 0.2));
        for direction in rhombicuboctahedron() {
            let camera = CameraSet::Toward(direction).around(bounds, &away)[0];
            let slope = |p: &DVec3| camera.view(*p) / (camera.view(*p).z * TAN_HALF_ANGLE);
            let spans = [0, 1].map(|axis| {
                let sides = || away.iter().map(|p| slope(p)[axis]);
                (sides().fold(1.0, f64::min), sides().fold(-1.0, f64::max))
            });
            let is_full = |(low, high): (f64, f64)| (low + 0.95).abs() + (high - 0.95).abs() < 1e-9;
            assert!(spans.iter().any(|span| is_full(*span)), "{direction} {spans:?}");
            assert!(spans.iter().all(|(low, high)| *low > -0.9501 && *high < 0.9501));
        }
        // Points in a line of sight, and none at all.
        let line = [DVec3::Z, DVec3::ZERO];
        let camera = CameraSet::Toward(DVec3::Z).around((DVec3::ZERO, DVec3::Z), &line)[0];
        assert!(camera.eye.distance(DVec3::new(0.0, 0.0, 1.01)) < 1e-12, "{camera:?}");
        assert_eq!(CameraSet::Toward(DVec3::Z).around((DVec3::ZERO, DVec3::Z), &[]).len(), 1);
    }

    #[test]
    fn axes_are_right_handed_and_stand_a_look_along_y() {
        for eye in [DVec3::new(3.0, 1.0, 2.0), DVec3::Y, -DVec3::Y] {
            let camera = Camera::look_at(eye, DVec3::ZERO).unwrap();
            assert!((camera.right.cross(camera.up) + camera.forward).length() < 1e-15);
            assert!(
                (camera.view(DVec3::ZERO) - DVec3::new(0.0, 0.0, eye.length())).length() < 1e-15
            );
        }
        assert_eq!(Camera::look_at(DVec3::ONE, DVec3::ONE), None);
        assert_eq!(Camera::look_at(DVec3::NAN, DVec3::ONE), None);
        assert!(CameraSet::Dodecahedron.cameras(DVec3::ZERO, 0.0).is_empty());
    }
}
