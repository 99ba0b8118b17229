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
