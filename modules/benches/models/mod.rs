//! The meshes that benches have in common: generated tori, and real models where they are at hand.

// Each bench uses a part of this.
#![allow(dead_code)]

use std::path::Path;

use glam::DVec3;
use mve_modules::data::{TriMesh, VertexId};
use mve_modules::mesh::fixtures::torus;
use mve_modules::mesh::testing;

/// The model that benches measure where they measure one: 69,451 faces.
pub const BUNNY: &str = "stanford-bunny.obj";

/// The bytes of a file among the models; `None`, after a line saying so, where it is not there.
pub fn bytes(name: &str) -> Option<Vec<u8>> {
    std::fs::read(testing::model(name)?).ok()
}

/// Positions and faces of the first object of an OBJ file among the models, read by another
/// program's reader, so that a slip of mve's own changes no bench but its own.
pub fn model(name: &str) -> Option<TriMesh> {
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let no_mtl = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let bytes = bytes(name)?;
    let (models, _) = tobj::load_obj_buf(&mut bytes.as_slice(), &options, no_mtl).ok()?;
    let mesh = &models.first()?.mesh;
    let positions = mesh.positions.chunks_exact(3).map(DVec3::from_slice).collect();
    let faces = mesh.indices.chunks_exact(3).map(|f| [f[0], f[1], f[2]].map(VertexId)).collect();
    Some(TriMesh::new(positions, faces))
}

/// How many steps around a torus give about 1 k, 100 k and 1 M faces.
pub const TORUS_STEPS: [(&str, u32); 3] = [("1k", 24), ("100k", 224), ("1M", 708)];

/// Smooth tori of about 1 k, 100 k and 1 M faces.
pub fn tori() -> Vec<(&'static str, TriMesh)> {
    TORUS_STEPS.map(|(name, n)| (name, torus(2.0, 0.5, n))).into()
}

/// A closed torus with bumps of two sizes, of about `n_faces` faces: no two edges cost the same.
pub fn bumpy_torus(n_faces: usize) -> TriMesh {
    let side = ((n_faces / 2) as f64).sqrt() as usize;
    let turn = std::f64::consts::TAU / side as f64;
    let point = |i: usize| {
        let (u, v) = ((i / side) as f64 * turn, (i % side) as f64 * turn);
        let coarse = 0.03 * (7.0 * u).sin() * (9.0 * v).cos();
        let r = 0.4 + coarse + 0.003 * (61.0 * u + 37.0 * v).sin();
        DVec3::new((1.0 + r * v.cos()) * u.cos(), (1.0 + r * v.cos()) * u.sin(), r * v.sin())
    };
    let square = |i: usize| {
        let id = |down: usize, right: usize| {
            VertexId(((i / side + down) % side * side + (i % side + right) % side) as u32)
        };
        [[id(0, 0), id(1, 0), id(1, 1)], [id(0, 0), id(1, 1), id(0, 1)]]
    };
    let n = side * side;
    TriMesh::new((0..n).map(point).collect(), (0..n).flat_map(square).collect())
}
