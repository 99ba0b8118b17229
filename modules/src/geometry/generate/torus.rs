//! A torus around z.

use std::f64::consts::TAU;

use mve_mesh::data::TriMesh;

use super::{quad, ring};

/// What torus to make.
#[derive(Clone, Debug, PartialEq)]
pub struct TorusOptions {
    /// From the center to the middle of the tube, in model units.
    pub radius: f64,
    /// Of the tube. Larger than `radius`, the surface goes through itself.
    pub tube_radius: f64,
    /// Steps around z, in [`TorusOptions::SEGMENTS`].
    pub segments: u32,
    /// Steps around the tube, in [`TorusOptions::SEGMENTS`].
    pub tube_segments: u32,
}

impl TorusOptions {
    /// The default.
    pub const DEFAULT: Self =
        Self { radius: 1.0, tube_radius: 0.25, segments: 48, tube_segments: 24 };
    /// Range of both numbers of steps.
    pub const SEGMENTS: (i64, i64) = (3, 8192);
}

/// Makes a torus around the origin and z: closed, manifold, with outward orientation and one
/// handle; s segments and t of the tube give s t vertices and 2 s t triangles. Vertices follow each
/// other around z, tube step by tube step, from the outer equator upwards.
pub fn torus(options: &TorusOptions) -> TriMesh {
    let (s, t) = (options.segments, options.tube_segments);
    let mut positions = Vec::with_capacity((s * t) as usize);
    for k in 0..t {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(t)).sin_cos();
        let from_axis = options.radius + options.tube_radius * cos;
        positions.extend(ring(from_axis, options.tube_radius * sin, s));
    }
    let vertex = |step: u32, k: u32| (step % t) * s + k % s;
    let mut faces = Vec::with_capacity((2 * s * t) as usize);
    for (step, k) in (0..t).flat_map(|step| (0..s).map(move |k| (step, k))) {
        let [a, b] = [vertex(step, k), vertex(step, k + 1)];
        faces.extend(quad([a, b, vertex(step + 1, k + 1), vertex(step + 1, k)]));
    }
    TriMesh::new(positions, faces)
}

#[cfg(test)]
mod tests {
    use mve_core::Control;

    use super::*;
    use crate::geometry::generate::checks::assert_no_self_intersection;
    use crate::geometry::surface::mesh_info::mesh_info;

    #[test]
    fn every_resolution_is_closed_with_one_handle() {
        for (segments, tube_segments) in [(3, 3), (3, 5), (8, 4), (48, 24)] {
            let options = TorusOptions { segments, tube_segments, ..TorusOptions::DEFAULT };
            let mesh = torus(&options);
            assert_eq!(mesh.check(), Ok(()));
            assert_eq!(mesh.positions.len() as u32, segments * tube_segments);
            let info = mesh_info(&mesh, Control::none()).unwrap();
            assert_eq!((info.n_faces as u32, info.genus), (2 * segments * tube_segments, Some(1)));
            assert!(info.is_closed() && info.is_manifold() && info.is_oriented());
            assert_eq!(info.n_doubled_vertices + info.n_zero_area_faces, 0);
            assert!(mesh.signed_volume() > 0.0);
            assert_no_self_intersection(&mesh);
        }
    }

    /// 2 π² R r² in the limit.
    #[test]
    fn a_fine_torus_has_nearly_its_volume() {
        let fine = TorusOptions { segments: 256, tube_segments: 256, ..TorusOptions::DEFAULT };
        let expected = 0.5 * TAU * TAU * 0.0625;
        let found = torus(&fine).signed_volume();
        assert!(found < expected && found > 0.9995 * expected, "{found} {expected}");
    }
}
