//! A box whose sides are grids that share the vertices on edges and corners.

use glam::DVec3;
use mve_mesh::data::TriMesh;

use super::quad;

/// What box to make. The default is the unit cube with 768 triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxOptions {
    /// Length of the edges along x, y and z in model units, each in [`BoxOptions::SIZE`].
    pub size: DVec3,
    /// Squares along each edge, in [`BoxOptions::SEGMENTS`]; 12 s² triangles in all.
    pub segments: u32,
}

impl BoxOptions {
    /// The default.
    pub const DEFAULT: Self = Self { size: DVec3::ONE, segments: 8 };
    /// Range of each component of `size`.
    pub const SIZE: (f64, f64) = (1e-6, 1e6);
    /// Range of `segments`.
    pub const SEGMENTS: (i64, i64) = (1, 1024);
}

impl Default for BoxOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Makes a box around the origin, with edges along the axes.
///
/// Options must be in their ranges. The mesh is closed and manifold, with outward orientation,
/// 6 s² + 2 vertices and 12 s² triangles; its sides are exactly flat. Takes O(s²).
pub fn subdivided_box(options: &BoxOptions) -> TriMesh {
    let lattice = Lattice { segments: options.segments };
    let s = options.segments;
    let mut positions = Vec::with_capacity(lattice.n_points());
    lattice.for_each_point(|point| {
        // Ends and middle come out exact, and opposite sides as exact opposites.
        let along = point.map(|i| (2.0 * f64::from(i) - f64::from(s)) / (2.0 * f64::from(s)));
        positions.push(DVec3::from(along) * options.size);
    });
    let mut faces = Vec::with_capacity(12 * (s as usize).pow(2));
    for axis in 0..3 {
        for (level, u_axis, v_axis) in
            [(0, (axis + 2) % 3, (axis + 1) % 3), (s, (axis + 1) % 3, (axis + 2) % 3)]
        {
            // u × v points outwards: along the axis at its upper end, against it at its lower.
            let vertex = |u, v| {
                let mut point = [0; 3];
                (point[axis], point[u_axis], point[v_axis]) = (level, u, v);
                lattice.vertex(point)
            };
            for v in 0..s {
                for u in 0..s {
                    faces.extend(quad([
                        vertex(u, v),
                        vertex(u + 1, v),
                        vertex(u + 1, v + 1),
                        vertex(u, v + 1),
                    ]));
                }
            }
        }
    }
    TriMesh::new(positions, faces)
}

/// The points of a cubic lattice that lie on its surface, numbered plane by plane in z: the lowest
/// and the highest plane are whole, those between are rings.
struct Lattice {
    segments: u32,
}

impl Lattice {
    fn n_points(&self) -> usize {
        6 * (self.segments as usize).pow(2) + 2
    }

    /// Calls `visit` for each point in the order of its number.
    fn for_each_point(&self, mut visit: impl FnMut([u32; 3])) {
        let s = self.segments;
        for z in 0..=s {
            if z == 0 || z == s {
                (0..=s).for_each(|y| (0..=s).for_each(|x| visit([x, y, z])));
            } else {
                (0..s).for_each(|x| visit([x, 0, z]));
                (0..s).for_each(|y| visit([s, y, z]));
                (0..s).for_each(|x| visit([s - x, s, z]));
                (0..s).for_each(|y| visit([0, s - y, z]));
            }
        }
    }

    /// The number of a point on the surface.
    fn vertex(&self, [x, y, z]: [u32; 3]) -> u32 {
        let s = self.segments;
        let plane = (s + 1) * (s + 1);
        let ring = match (x, y) {
            _ if z == 0 => return y * (s + 1) + x,
            _ if z == s => return plane + (s - 1) * 4 * s + y * (s + 1) + x,
            (_, 0) if x < s => x,
            (_, _) if x == s && y < s => s + y,
            (_, _) if y == s && x > 0 => 2 * s + (s - x),
            _ => 3 * s + (s - y),
        };
        plane + (z - 1) * 4 * s + ring
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::checks::{assert_no_self_intersection, assert_sphere_like};

    #[test]
    fn the_default_is_the_unit_cube_with_768_triangles() {
        let mesh = subdivided_box(&BoxOptions::default());
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (386, 768));
        assert_sphere_like(&mesh);
        assert_no_self_intersection(&mesh);
        assert_eq!((mesh.signed_volume(), mesh.area()), (1.0, 6.0));
        assert_eq!(mesh.bounds(), Some((DVec3::splat(-0.5), DVec3::splat(0.5))));
    }

    #[test]
    fn every_resolution_is_closed_and_measures_the_same() {
        let size = DVec3::new(2.0, 3.0, 0.25);
        for segments in [1, 2, 3, 5, 16] {
            let mesh = subdivided_box(&BoxOptions { size, segments });
            assert_eq!(mesh.faces.len(), 12 * (segments as usize).pow(2));
            assert_sphere_like(&mesh);
            assert!((mesh.signed_volume() - 1.5).abs() < 1e-12);
            assert!((mesh.area() - 2.0 * (6.0 + 0.5 + 0.75)).abs() < 1e-12);
        }
    }
}
