//! A curved sheet of some thickness, with hills, hollows, saddles and sharp rims.
//!
//! The lower sheet is the upper one moved down, not offset along its normals: so the sheets never
//! meet, whatever the height, and the volume is the area of the base times the thickness, exactly
//! and at every resolution. Measured across, a slope is thinner than a level part.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use mve_mesh::data::TriMesh;

use super::quad;

/// What surface to make. The default has 4,352 triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Length of the base along x and y in model units, in [`SurfaceOptions::LENGTH`].
    pub size: f64,
    /// Height of the highest hill over the middle level in model units, in
    /// [`SurfaceOptions::HEIGHT`]; 0 gives a flat plate.
    pub height: f64,
    /// Thickness along z in model units, in [`SurfaceOptions::LENGTH`].
    pub thickness: f64,
    /// Squares along each side, in [`SurfaceOptions::SEGMENTS`].
    pub segments: u32,
    /// Squares across a rim, in [`SurfaceOptions::RIM_SEGMENTS`].
    pub rim_segments: u32,
}

impl SurfaceOptions {
    /// The default.
    pub const DEFAULT: Self =
        Self { size: 1.0, height: 0.18, thickness: 0.03, segments: 32, rim_segments: 1 };
    /// Range of `size` and `thickness`.
    pub const LENGTH: (f64, f64) = (1e-6, 1e6);
    /// Range of `height`.
    pub const HEIGHT: (f64, f64) = (0.0, 1e6);
    /// Range of `segments`.
    pub const SEGMENTS: (i64, i64) = (1, 2048);
    /// Range of `rim_segments`.
    pub const RIM_SEGMENTS: (i64, i64) = (1, 256);
}

impl Default for SurfaceOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Makes a curved sheet over a square around the origin in the xy plane.
///
/// Options must be in their ranges. The mesh is closed and manifold, with outward orientation and
/// 4 n² + 8 n r triangles for n segments and r rim segments. Vertices come sheet by sheet from the
/// highest down, the two outer ones row by row, those between around the rim. Takes O(n² + n r).
pub fn surface(options: &SurfaceOptions) -> TriMesh {
    let (n, r) = (options.segments, options.rim_segments);
    let row = n + 1;
    let (top, bottom) = (0, row * row + (r - 1) * 4 * n);
    let mut positions = Vec::with_capacity((bottom + row * row) as usize);
    for level in 0..=r {
        let offset = options.thickness * (0.5 - f64::from(level) / f64::from(r));
        let mut push = |[i, j]: [u32; 2]| positions.push(point(options, i, j, offset));
        if level == 0 || level == r {
            (0..=n).for_each(|j| (0..=n).for_each(|i| push([i, j])));
        } else {
            (0..4 * n).for_each(|k| push(rim_point(n, k)));
        }
    }
    let mut faces = Vec::with_capacity((4 * n * n + 8 * n * r) as usize);
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] =
                [j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i];
            faces.extend(quad([top + a, top + b, top + c, top + d]));
            faces.extend(quad([bottom + a, bottom + d, bottom + c, bottom + b]));
        }
    }
    let rim = |level: u32, k: u32| {
        let k = k % (4 * n);
        let [i, j] = rim_point(n, k);
        match level {
            0 => top + j * row + i,
            _ if level == r => bottom + j * row + i,
            _ => row * row + (level - 1) * 4 * n + k,
        }
    };
    for level in 0..r {
        for k in 0..4 * n {
            let (upper, lower) =
                ([rim(level, k), rim(level, k + 1)], [rim(level + 1, k), rim(level + 1, k + 1)]);
            faces.extend(quad([lower[0], lower[1], upper[1], upper[0]]));
        }
    }
    TriMesh::new(positions, faces)
}

/// Grid point k of the 4 n around the rim, counter-clockwise from above.
fn rim_point(n: u32, k: u32) -> [u32; 2] {
    let along = k % n;
    match k / n {
        0 => [along, 0],
        1 => [n, along],
        2 => [n - along, n],
        _ => [0, n - along],
    }
}

fn point(options: &SurfaceOptions, i: u32, j: u32, offset: f64) -> DVec3 {
    let n = f64::from(options.segments);
    let base = DVec2::new(2.0 * f64::from(i) - n, 2.0 * f64::from(j) - n) / n;
    let z = options.height * relief(base) + offset;
    (0.5 * options.size * base).extend(z)
}

/// Height over the square from -1 to 1 in u and v, between -1 and 1: a diagonal swell, two
/// crossed waves that make the saddles, and one round hill.
fn relief(p: DVec2) -> f64 {
    let swell = 0.42 * (0.9 * PI * (0.55 * p.x + 0.8 * p.y) - 0.4).sin();
    let waves = 0.38 * (1.25 * PI * p.x + 0.6).sin() * (1.15 * PI * p.y - 0.35).cos();
    let hill = 0.55 * (-5.0 * p.distance_squared(DVec2::new(-0.35, 0.3))).exp();
    swell + waves + hill
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::checks::{assert_no_self_intersection, assert_sphere_like};

    #[test]
    fn the_default_has_4352_triangles() {
        let mesh = surface(&SurfaceOptions::default());
        assert_eq!(mesh.faces.len(), 4352);
        assert_sphere_like(&mesh);
        assert_no_self_intersection(&mesh);
        assert!((mesh.signed_volume() - 0.03).abs() < 1e-12, "{}", mesh.signed_volume());
    }

    #[test]
    fn every_resolution_is_closed_with_the_volume_of_its_base() {
        for (segments, rim_segments) in [(1, 1), (1, 3), (2, 1), (3, 2), (20, 4)] {
            let options = SurfaceOptions {
                size: 2.0,
                height: 1.5,
                segments,
                rim_segments,
                ..Default::default()
            };
            let mesh = surface(&options);
            let n_faces = 4 * segments * segments + 8 * segments * rim_segments;
            assert_eq!(mesh.faces.len(), n_faces as usize);
            assert_sphere_like(&mesh);
            assert_no_self_intersection(&mesh);
            assert!((mesh.signed_volume() - 4.0 * 0.03).abs() < 1e-12);
        }
    }

    #[test]
    fn the_relief_keeps_to_its_range_and_has_a_saddle() {
        let at = |i: i32, j: i32| relief(DVec2::new(f64::from(i), f64::from(j)) / 100.0);
        let (mut low, mut high, mut n_saddles) = (f64::MAX, f64::MIN, 0);
        for i in -100..=100 {
            for j in -100..=100 {
                let height = at(i, j);
                (low, high) = (low.min(height), high.max(height));
                let around = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
                let is_above = around.map(|(x, y)| at(i + x, j + y) > height);
                // Around a saddle the heights change sides four times.
                let n_changes = (0..8).filter(|&k| is_above[k] != is_above[(k + 1) % 8]).count();
                n_saddles += usize::from(n_changes == 4);
            }
        }
        assert!((-1.0..-0.5).contains(&low) && (0.5..=1.0).contains(&high), "{low} {high}");
        assert!(n_saddles >= 1, "{n_saddles}");
    }
}
