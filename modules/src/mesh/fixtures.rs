//! Small meshes with known properties, for tests and benches.

use glam::DVec3;

use crate::data::{TriMesh, VertexId};

/// A mesh from plain arrays.
pub fn mesh_of(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
    TriMesh::new(
        positions.iter().map(|&p| DVec3::from(p)).collect(),
        faces.iter().map(|f| f.map(VertexId)).collect(),
    )
}

/// The corner tetrahedron with legs of 1: closed, manifold, volume 1/6.
pub fn tetrahedron() -> TriMesh {
    mesh_of(
        &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    )
}

/// The cube from `low` to `low + (1, 1, 1)`, two triangles a side: closed, manifold, volume 1.
pub fn cube(low: DVec3) -> TriMesh {
    let corner = |i: u32| DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into()) + low;
    let corners: Vec<[f64; 3]> = (0..8).map(|i| corner(i).to_array()).collect();
    let quads: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[u32; 3]> =
        quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh_of(&corners, &faces)
}

/// A grid torus around z, `n` by `n` quads cut in two: closed, manifold, genus 1, 2 n² faces.
pub fn torus(radius: f64, tube_radius: f64, n: u32) -> TriMesh {
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let point = |u: u32, v: u32| {
        let from_axis = radius + tube_radius * angle(v).cos();
        [from_axis * angle(u).cos(), from_axis * angle(u).sin(), tube_radius * angle(v).sin()]
    };
    let at = |u: u32, v: u32| (u % n) * n + v % n;
    let cells = || (0..n).flat_map(|u| (0..n).map(move |v| (u, v)));
    let points: Vec<[f64; 3]> = cells().map(|(u, v)| point(u, v)).collect();
    let faces: Vec<[u32; 3]> = cells()
        .flat_map(|(u, v)| {
            let [a, b, c, d] = [at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    mesh_of(&points, &faces)
}
