//! A hollow vase: a surface of revolution with an outer and an inner wall and a round lip.
//!
//! The profile runs in the half plane of radius r and height z from the pole under the foot over
//! the outer wall, the lip and the inner wall to the pole on the inner floor. The outer wall is a
//! Catmull-Rom spline (Catmull and Rom, "A class of local interpolating splines", Computer Aided
//! Geometric Design, 1974) in r over even steps of z; the inner wall is the same spline moved
//! inwards along its normal. Both walls are sampled in pairs, so that they stay apart at every
//! resolution.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use mve_mesh::data::{TriMesh, VertexId};

use super::quad;

/// What vase to make. The default has 7,808 triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct VaseOptions {
    /// Height of the outer wall in model units, in [`VaseOptions::HEIGHT`]; the round lip rises a
    /// little above it.
    pub height: f64,
    /// Thickness of the wall as a part of the height, in [`VaseOptions::WALL`].
    pub wall: f64,
    /// Steps around the axis, in [`VaseOptions::SEGMENTS`].
    pub segments: u32,
    /// Steps along the profile from pole to pole, in [`VaseOptions::PROFILE_SEGMENTS`].
    pub profile_segments: u32,
}

impl VaseOptions {
    /// The default.
    pub const DEFAULT: Self = Self { height: 1.0, wall: 0.035, segments: 64, profile_segments: 62 };
    /// Range of `height`.
    pub const HEIGHT: (f64, f64) = (1e-6, 1e6);
    /// Range of `wall`.
    pub const WALL: (f64, f64) = (0.005, 0.08);
    /// Range of `segments`.
    pub const SEGMENTS: (i64, i64) = (3, 4096);
    /// Range of `profile_segments`.
    pub const PROFILE_SEGMENTS: (i64, i64) = (8, 4096);
}

impl Default for VaseOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Makes a vase that stands on the xy plane around the z axis.
///
/// Options must be in their ranges. The mesh is closed and manifold, with outward orientation and
/// 2 s (m - 1) triangles for s segments around and m along the profile. The first vertex is the
/// pole under the foot, the last the one on the inner floor, with rings of s vertices between
/// them. Takes O(s m).
pub fn vase(options: &VaseOptions) -> TriMesh {
    let (s, profile) = (options.segments, profile(options));
    let n_rings = profile.len() as u32 - 2;
    let mut positions = Vec::with_capacity((s * n_rings + 2) as usize);
    positions.push(DVec3::new(0.0, 0.0, profile[0].y));
    for ring in &profile[1..profile.len() - 1] {
        positions.extend((0..s).map(|k| {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(s)).sin_cos();
            DVec3::new(ring.x * cos, ring.x * sin, ring.y)
        }));
    }
    positions.push(DVec3::new(0.0, 0.0, profile[profile.len() - 1].y));
    let vertex = |ring: u32, k: u32| 1 + ring * s + k % s;
    let last = s * n_rings + 1;
    let mut faces = Vec::with_capacity((2 * s * n_rings) as usize);
    faces.extend((0..s).map(|k| [0, vertex(0, k + 1), vertex(0, k)].map(VertexId)));
    for ring in 0..n_rings - 1 {
        for k in 0..s {
            faces.extend(quad([
                vertex(ring, k),
                vertex(ring, k + 1),
                vertex(ring + 1, k + 1),
                vertex(ring + 1, k),
            ]));
        }
    }
    let top = n_rings - 1;
    faces.extend((0..s).map(|k| [vertex(top, k), vertex(top, k + 1), last].map(VertexId)));
    TriMesh::new(positions, faces)
}

/// Radius of the outer wall at even steps of its height, for a height of 1.
const RADII: [f64; 9] = [0.190, 0.262, 0.330, 0.358, 0.328, 0.252, 0.180, 0.158, 0.215];

/// Points (radius, height) from pole to pole, one more than there are segments.
fn profile(options: &VaseOptions) -> Vec<DVec2> {
    let m = options.profile_segments;
    let n_lip = (m * 4 / 62).max(2);
    let n_wall = (m * 22 / 62).clamp(2, (m - n_lip - 2) / 2);
    let n_foot = (m - n_lip - 2 * n_wall) / 2;
    let n_floor = m - n_lip - 2 * n_wall - n_foot;
    let wall = options.wall;
    // The inner wall begins where the outer one is as high as the floor is thick.
    let floor = 1.4 * wall;
    let part = |i: u32, n: u32| f64::from(i) / f64::from(n);
    let inner = |t: f64| {
        let t = floor + (1.0 - floor) * t;
        outer(t) - wall * outer_normal(t)
    };
    let mut points: Vec<DVec2> = Vec::with_capacity(m as usize + 1);
    points.extend((0..n_foot).map(|i| DVec2::new(RADII[0] * part(i, n_foot), 0.0)));
    points.extend((0..=n_wall).map(|i| outer(part(i, n_wall))));
    // Half a circle over the rim, from the outer to the inner wall.
    let (side, center) = (0.5 * wall * outer_normal(1.0), 0.5 * (outer(1.0) + inner(1.0)));
    points.extend((1..n_lip).map(|i| {
        let angle = PI * part(i, n_lip);
        center + angle.cos() * side + angle.sin() * side.perp()
    }));
    points.extend((0..=n_wall).rev().map(|i| inner(part(i, n_wall))));
    let corner = inner(0.0);
    points
        .extend((1..=n_floor).map(|i| DVec2::new(corner.x * part(n_floor - i, n_floor), corner.y)));
    for point in &mut points {
        *point *= options.height;
    }
    points
}

/// The outer wall at the part t of its height.
fn outer(t: f64) -> DVec2 {
    DVec2::new(radius(t)[0], t)
}

/// The unit normal of the outer wall, away from the axis.
fn outer_normal(t: f64) -> DVec2 {
    DVec2::new(1.0, -radius(t)[1]).normalize()
}

/// The radius at the part t of the height, and its derivative.
fn radius(t: f64) -> [f64; 2] {
    const LAST: usize = RADII.len() - 1;
    let scaled = t.clamp(0.0, 1.0) * LAST as f64;
    let i = (scaled as usize).min(LAST - 1);
    let x = scaled - i as f64;
    // Beyond the ends the spline goes on straight.
    let before = if i == 0 { 2.0 * RADII[0] - RADII[1] } else { RADII[i - 1] };
    let after = RADII.get(i + 2).copied().unwrap_or(2.0 * RADII[LAST] - RADII[LAST - 1]);
    let [a, b, c, d] = [before, RADII[i], RADII[i + 1], after];
    // Uniform Catmull-Rom as a polynomial in x over one step.
    let [c1, c2, c3] = [c - a, 2.0 * a - 5.0 * b + 4.0 * c - d, 3.0 * b - a - 3.0 * c + d];
    let value = b + 0.5 * x * (c1 + x * (c2 + x * c3));
    let slope = 0.5 * (c1 + x * (2.0 * c2 + 3.0 * x * c3)) * LAST as f64;
    [value, slope]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::checks::{assert_no_self_intersection, assert_sphere_like};

    /// Volume of a profile turned in s steps: each edge is a frustum over a regular polygon.
    fn volume_of(options: &VaseOptions) -> f64 {
        let s = f64::from(options.segments);
        let base = 0.5 * s * (TAU / s).sin();
        let edges = profile(options);
        let frustums = edges.windows(2).map(|edge| {
            let (p, q) = (edge[0], edge[1]);
            (q.y - p.y) * (p.x * p.x + p.x * q.x + q.x * q.x) / 3.0
        });
        base * frustums.sum::<f64>()
    }

    fn resolutions() -> impl Iterator<Item = VaseOptions> {
        [(3, 8), (3, 9), (4, 11), (5, 17), (12, 30), (16, 90)].into_iter().flat_map(
            |(segments, profile_segments)| {
                [0.005, 0.035, 0.08].map(|wall| VaseOptions {
                    wall,
                    segments,
                    profile_segments,
                    height: 2.5,
                })
            },
        )
    }

    #[test]
    fn the_default_has_7808_triangles() {
        let mesh = vase(&VaseOptions::default());
        assert_eq!(mesh.faces.len(), 7808);
        assert_sphere_like(&mesh);
        assert_no_self_intersection(&mesh);
        let expected = volume_of(&VaseOptions::default());
        assert!((mesh.signed_volume() - expected).abs() < 1e-12 * expected.abs().max(1.0));
    }

    #[test]
    fn every_resolution_is_closed_and_apart_from_itself() {
        for options in resolutions() {
            let mesh = vase(&options);
            let expected = 2 * options.segments * (options.profile_segments - 1);
            assert_eq!(mesh.faces.len(), expected as usize, "{options:?}");
            assert_sphere_like(&mesh);
            assert_no_self_intersection(&mesh);
            let volume = volume_of(&options);
            assert!((mesh.signed_volume() - volume).abs() < 1e-9, "{options:?}");
        }
    }

    #[test]
    fn a_fine_vase_comes_to_the_volume_of_its_wall() {
        let fine = |segments, profile_segments| {
            let options = VaseOptions { segments, profile_segments, ..Default::default() };
            vase(&options).signed_volume()
        };
        // The error falls with the square of the step.
        let (coarse, middle, fine) = (fine(64, 62), fine(128, 124), fine(256, 248));
        assert!((middle - fine).abs() < 0.35 * (coarse - middle).abs(), "{coarse} {middle} {fine}");
    }

    #[test]
    fn the_spline_goes_through_its_points_with_its_derivative() {
        for (i, &r) in RADII.iter().enumerate() {
            assert!((radius(i as f64 / 8.0)[0] - r).abs() < 1e-15);
        }
        for i in 1..100 {
            let t = f64::from(i) / 100.0;
            let slope = (radius(t + 1e-6)[0] - radius(t - 1e-6)[0]) / 2e-6;
            assert!((radius(t)[1] - slope).abs() < 1e-4, "{t}");
        }
    }
}
