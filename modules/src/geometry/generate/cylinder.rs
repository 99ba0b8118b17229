//! A cylinder around z, with or without caps.

use glam::DVec3;
use mve_mesh::data::{TriMesh, VertexId};

use super::{quad, ring};

/// What cylinder to make.
#[derive(Clone, Debug, PartialEq)]
pub struct CylinderOptions {
    /// Of the circle that the corners lie on, in model units.
    pub radius: f64,
    /// Length along z in model units.
    pub height: f64,
    /// Steps around z, in [`CylinderOptions::SEGMENTS`].
    pub segments: u32,
    /// Steps along z, in [`CylinderOptions::HEIGHT_SEGMENTS`].
    pub height_segments: u32,
    /// Whether both ends are closed, each by a fan around a vertex in its middle.
    pub is_capped: bool,
}

impl CylinderOptions {
    /// The default.
    pub const DEFAULT: Self =
        Self { radius: 0.5, height: 1.0, segments: 32, height_segments: 1, is_capped: true };
    /// Range of `segments`.
    pub const SEGMENTS: (i64, i64) = (3, 8192);
    /// Range of `height_segments`.
    pub const HEIGHT_SEGMENTS: (i64, i64) = (1, 8192);
}

/// Makes a cylinder around the origin and z: manifold, with outward orientation.
///
/// s segments and h along the height give s (h + 1) vertices in rings from below and 2 s h
/// triangles. Caps add a vertex and s triangles each, the lower one first, and close it.
pub fn cylinder(options: &CylinderOptions) -> TriMesh {
    let (s, h) = (options.segments, options.height_segments);
    let mut positions = Vec::with_capacity((s * (h + 1) + 2) as usize);
    for k in 0..=h {
        let along = (2.0 * f64::from(k) - f64::from(h)) / (2.0 * f64::from(h));
        positions.extend(ring(options.radius, along * options.height, s));
    }
    let vertex = |ring: u32, k: u32| ring * s + k % s;
    let mut faces = Vec::with_capacity((2 * s * (h + 1)) as usize);
    for (ring, k) in (0..h).flat_map(|ring| (0..s).map(move |k| (ring, k))) {
        let [a, b] = [vertex(ring, k), vertex(ring, k + 1)];
        faces.extend(quad([a, b, vertex(ring + 1, k + 1), vertex(ring + 1, k)]));
    }
    if options.is_capped {
        let below = positions.len() as u32;
        positions.push(DVec3::NEG_Z * 0.5 * options.height);
        positions.push(DVec3::Z * 0.5 * options.height);
        faces.extend((0..s).map(|k| [below, vertex(0, k + 1), vertex(0, k)].map(VertexId)));
        faces.extend((0..s).map(|k| [below + 1, vertex(h, k), vertex(h, k + 1)].map(VertexId)));
    }
    TriMesh::new(positions, faces)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use mve_core::Control;

    use super::*;
    use crate::geometry::generate::checks::{assert_no_self_intersection, assert_sphere_like};
    use crate::geometry::surface::mesh_info::mesh_info;

    #[test]
    fn capped_ones_are_closed_and_have_the_volume_of_a_prism() {
        for (segments, height_segments) in [(3, 1), (4, 3), (32, 2)] {
            let options = CylinderOptions {
                segments,
                height_segments,
                height: 3.0,
                ..CylinderOptions::DEFAULT
            };
            let mesh = cylinder(&options);
            assert_eq!(mesh.positions.len() as u32, segments * (height_segments + 1) + 2);
            assert_eq!(mesh.faces.len() as u32, 2 * segments * (height_segments + 1));
            assert_sphere_like(&mesh);
            assert_no_self_intersection(&mesh);
            let n = f64::from(segments);
            let expected = 3.0 * 0.25 * 0.5 * n * (TAU / n).sin();
            assert!((mesh.signed_volume() - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn an_open_one_is_a_tube() {
        let mesh = cylinder(&CylinderOptions { is_capped: false, ..CylinderOptions::DEFAULT });
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (64, 64));
        let info = mesh_info(&mesh, Control::none()).unwrap();
        assert_eq!((info.n_border_loops, info.euler_characteristic), (2, 0));
        assert!(info.is_manifold() && info.is_oriented());
    }
}
