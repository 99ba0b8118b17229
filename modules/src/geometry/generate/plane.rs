//! A flat grid.

use glam::{DVec2, DVec3};
use mve_mesh::data::TriMesh;

use super::quad;

/// What plane to make.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneOptions {
    /// Lengths along x and y in model units.
    pub size: DVec2,
    /// Squares along x and y, each in [`PlaneOptions::SEGMENTS`].
    pub segments: [u32; 2],
}

impl PlaneOptions {
    /// The default.
    pub const DEFAULT: Self = Self { size: DVec2::ONE, segments: [1, 1] };
    /// Range of the segments.
    pub const SEGMENTS: (i64, i64) = (1, 8192);
}

/// Makes a rectangle around the origin in the xy plane that looks along z: manifold, with one
/// border; m by n segments give (m + 1) (n + 1) vertices and 2 m n triangles, row by row along x.
pub fn plane(options: &PlaneOptions) -> TriMesh {
    let [m, n] = options.segments;
    // Ends and middle come out exact, and opposite sides as exact opposites.
    let along = |i: u32, n: u32| (2.0 * f64::from(i) - f64::from(n)) / (2.0 * f64::from(n));
    let point = |i: u32, j: u32| {
        DVec3::new(along(i, m) * options.size.x, along(j, n) * options.size.y, 0.0)
    };
    let positions = (0..=n).flat_map(|j| (0..=m).map(move |i| (i, j)));
    let positions = positions.map(|(i, j)| point(i, j)).collect();
    let vertex = |i: u32, j: u32| j * (m + 1) + i;
    let cells = (0..n).flat_map(|j| (0..m).map(move |i| (i, j)));
    let square =
        |(i, j)| quad([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
    TriMesh::new(positions, cells.flat_map(square).collect())
}

#[cfg(test)]
mod tests {
    use mve_core::Control;
    use mve_mesh::data::FaceId;

    use super::*;
    use crate::geometry::surface::mesh_info::mesh_info;

    #[test]
    fn counts_sides_and_direction() {
        let options = PlaneOptions { size: DVec2::new(3.0, 2.0), segments: [4, 3] };
        let mesh = plane(&options);
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (20, 24));
        let info = mesh_info(&mesh, Control::none()).unwrap();
        assert_eq!((info.n_border_loops, info.n_border_edges), (1, 14));
        assert!(info.is_manifold() && info.is_oriented());
        assert!((info.area - 6.0).abs() < 1e-14);
        let corner = DVec3::new(1.5, 1.0, 0.0);
        assert_eq!(info.bounds, Some((-corner, corner)));
        for face in 0..24 {
            let [a, b, c] = mesh.corners(FaceId(face));
            assert!((b - a).cross(c - a).z > 0.0);
        }
    }
}
