//! Simplification to a tenth, beside meshoptimizer's `simplifyWithUpdate` on the same mesh.
//!
//! Both run on one thread with the mesh in memory. Meshes: tori of 1 k, 100 k and 1 M faces, and
//! the Stanford bunny (69,451 faces) where the folder that `MVE_MODELS` names has it, or else
//! `../shared/models` beside the workspace.

use std::hint::black_box;
use std::path::PathBuf;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use mve_modules::cost::Quadric;
use mve_modules::data::{TriMesh, VertexId};
use mve_modules::geometry::control::Control;
use mve_modules::geometry::simplify::{SimplifyOptions, Stop, simplify};
use mve_modules::placement::Optimal;

/// A closed torus with bumps of two sizes, of about `n_faces` faces.
fn torus(n_faces: usize) -> TriMesh {
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

fn bunny() -> Option<TriMesh> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/models");
    let folder = std::env::var_os("MVE_MODELS").map_or(PathBuf::from(beside), PathBuf::from);
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (models, _) = tobj::load_obj(folder.join("stanford-bunny.obj"), &options).ok()?;
    let mesh = &models.first()?.mesh;
    let positions = mesh.positions.chunks_exact(3).map(DVec3::from_slice).collect();
    let faces = mesh.indices.chunks_exact(3).map(|f| [f[0], f[1], f[2]].map(VertexId)).collect();
    Some(TriMesh::new(positions, faces))
}

fn ours(mesh: &TriMesh) -> TriMesh {
    let options = SimplifyOptions {
        stop: Stop { ratio: Some(0.1), ..Stop::default() },
        ..SimplifyOptions::default()
    };
    let (mut cost, mut placement) = (Quadric::default(), Optimal::default());
    simplify(mesh, &mut cost, &mut placement, options, Control::none())
        .map_or_else(|_| TriMesh::default(), |result| result.mesh)
}

fn theirs((mut indices, mut positions): (Vec<u32>, Vec<[f32; 3]>)) -> usize {
    let target = indices.len() / 10;
    let options = meshopt::SimplifyOptions::empty();
    meshopt::simplify_with_update(
        &mut indices,
        &mut positions,
        &mut [],
        &[],
        0,
        None,
        target,
        1.0,
        options,
        None,
    )
}

fn bench(criterion: &mut Criterion) {
    let generated = [("torus-1k", 1_000), ("torus-100k", 100_000), ("torus-1M", 1_000_000)];
    let meshes = generated.map(|(name, n)| (name, Some(torus(n))));
    for (name, mesh) in meshes.into_iter().chain([("bunny", bunny())]) {
        let Some(mesh) = mesh else {
            eprintln!("skipped {name}: not found");
            continue;
        };
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10);
        group.bench_function("mve quadric optimal", |b| b.iter(|| ours(black_box(&mesh))));
        let arrays = || {
            let indices: Vec<u32> = mesh.faces.iter().flatten().map(|v| v.0).collect();
            let positions: Vec<_> = mesh.positions.iter().map(|p| p.as_vec3().into()).collect();
            (indices, positions)
        };
        group.bench_function("meshoptimizer with update", |b| {
            b.iter_batched(arrays, theirs, BatchSize::LargeInput)
        });
        group.finish();
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
