//! Spheres: of an icosahedron, subdivided, or of segments and rings.

use std::f64::consts::PI;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{TriMesh, VertexId};

use super::{quad, ring};
use crate::geometry::surface::subdivide::{Scheme, SubdivideError, subdivide};

/// Range of the subdivisions of [`ico_sphere`].
pub const SUBDIVISIONS: (i64, i64) = (0, 10);
/// Range of the segments of [`uv_sphere`].
pub const SEGMENTS: (i64, i64) = (3, 8192);
/// Range of the rings of [`uv_sphere`].
pub const RINGS: (i64, i64) = (2, 8192);

/// Corners of an icosahedron whose edges have length 2, by three rectangles of the golden ratio.
const FACES: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// Makes a sphere around the origin: an icosahedron, each of whose faces is cut into four by the
/// middles of its edges, again and again, with all vertices moved onto the sphere each time.
///
/// `subdivisions` is in [`SUBDIVISIONS`]. The mesh is closed and manifold, with outward
/// orientation, 10 · 4ⁿ + 2 vertices, on the sphere, and 20 · 4ⁿ triangles.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn ico_sphere(radius: f64, subdivisions: u32, control: Control) -> Result<TriMesh, Cancelled> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let signs = [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let mut positions = Vec::with_capacity(12);
    positions.extend(signs.map(|(one, two)| DVec3::new(one, two * golden, 0.0)));
    positions.extend(signs.map(|(one, two)| DVec3::new(0.0, one, two * golden)));
    positions.extend(signs.map(|(one, two)| DVec3::new(two * golden, 0.0, one)));
    let mut mesh = TriMesh::new(positions, FACES.map(|face| face.map(VertexId)).to_vec());
    let onto = |mesh: &mut TriMesh| mesh.positions.iter_mut().for_each(|p| *p = p.normalize());
    onto(&mut mesh);
    for level in 0..subdivisions {
        // Each level takes four times as long as the one before it.
        let share = |level: u32| 0.25_f64.powi((subdivisions - level) as i32);
        let part = control.part(share(level), share(level + 1));
        mesh = match subdivide(mesh, Scheme::Midpoint, 1, part) {
            Ok(mesh) => mesh,
            Err(SubdivideError::Cancelled(cancelled)) => return Err(cancelled),
            // At most 20 · 4¹⁰ faces: it takes more than three times as many.
            Err(SubdivideError::TooManyFaces { .. }) => return Err(Cancelled),
        };
        onto(&mut mesh);
    }
    mesh.positions.iter_mut().for_each(|p| *p *= radius);
    Ok(mesh)
}

/// Makes a sphere around the origin of segments around z and rings from pole to pole.
///
/// `segments` is in [`SEGMENTS`], `rings` in [`RINGS`]. The mesh is closed and manifold, with
/// outward orientation: s segments and r rings give s (r − 1) + 2 vertices, on the sphere, and
/// 2 s (r − 1) triangles. The first vertex is the pole below, the last the one above.
pub fn uv_sphere(radius: f64, segments: u32, rings: u32) -> TriMesh {
    let (s, n_rings) = (segments, rings - 1);
    let mut positions = Vec::with_capacity((s * n_rings + 2) as usize);
    positions.push(DVec3::NEG_Z * radius);
    for k in 1..rings {
        let (sin, cos) = (PI * f64::from(k) / f64::from(rings)).sin_cos();
        positions.extend(ring(radius * sin, -radius * cos, s));
    }
    positions.push(DVec3::Z * radius);
    let vertex = |ring: u32, k: u32| 1 + ring * s + k % s;
    let last = s * n_rings + 1;
    let mut faces = Vec::with_capacity((2 * s * n_rings) as usize);
    faces.extend((0..s).map(|k| [0, vertex(0, k + 1), vertex(0, k)].map(VertexId)));
    for (ring, k) in (0..n_rings - 1).flat_map(|ring| (0..s).map(move |k| (ring, k))) {
        let [a, b] = [vertex(ring, k), vertex(ring, k + 1)];
        faces.extend(quad([a, b, vertex(ring + 1, k + 1), vertex(ring + 1, k)]));
    }
    let top = n_rings - 1;
    faces.extend((0..s).map(|k| [vertex(top, k), vertex(top, k + 1), last].map(VertexId)));
    TriMesh::new(positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::checks::{assert_no_self_intersection, assert_sphere_like};

    fn assert_on_sphere(mesh: &TriMesh, radius: f64) {
        assert!(mesh.positions.iter().all(|p| (p.length() - radius).abs() < 1e-14 * radius));
    }

    #[test]
    fn an_icosahedron_has_its_volume() {
        let mesh = ico_sphere(1.0, 0, Control::none()).unwrap();
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (12, 20));
        assert_sphere_like(&mesh);
        // (5/12) (3 + √5) a³ with the edge a = 4 / √(10 + 2 √5).
        let root = 5.0_f64.sqrt();
        let edge = 4.0 / (10.0 + 2.0 * root).sqrt();
        let expected = 5.0 / 12.0 * (3.0 + root) * edge.powi(3);
        assert!((mesh.signed_volume() - expected).abs() < 1e-14);
    }

    #[test]
    fn finer_ones_come_to_the_sphere() {
        for (n, error) in [(1, 0.16), (2, 0.045), (3, 0.012), (4, 0.003)] {
            let mesh = ico_sphere(2.0, n, Control::none()).unwrap();
            assert_eq!(mesh.positions.len(), 10 * 4_usize.pow(n) + 2);
            assert_eq!(mesh.faces.len(), 20 * 4_usize.pow(n));
            assert_sphere_like(&mesh);
            assert_on_sphere(&mesh, 2.0);
            let missing = 1.0 - mesh.signed_volume() / (4.0 / 3.0 * PI * 8.0);
            assert!(missing > 0.0 && missing < error, "{n}: {missing}");
        }
    }

    #[test]
    fn segments_and_rings_at_every_resolution() {
        for (segments, rings) in [(3, 2), (3, 3), (4, 7), (32, 16)] {
            let mesh = uv_sphere(0.5, segments, rings);
            assert_eq!(mesh.positions.len() as u32, segments * (rings - 1) + 2);
            assert_eq!(mesh.faces.len() as u32, 2 * segments * (rings - 1));
            assert_sphere_like(&mesh);
            assert_no_self_intersection(&mesh);
            assert_on_sphere(&mesh, 0.5);
        }
        // An octahedron.
        assert!((uv_sphere(1.0, 4, 2).signed_volume() - 4.0 / 3.0).abs() < 1e-15);
    }
}
