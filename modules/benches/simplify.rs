//! Simplification to a tenth, beside meshoptimizer's `simplifyWithUpdate` on the same mesh.
//!
//! Both run on one thread with the mesh in memory. Meshes: tori of 1 k, 100 k and 1 M faces, and
//! the Stanford bunny (69,451 faces) where it is at hand.

mod models;

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use mve_core::Control;
use mve_modules::cost::Quadric;
use mve_modules::data::TriMesh;
use mve_modules::geometry::simplify::collapse::{SimplifyOptions, Stop, simplify};
use mve_modules::placement::Optimal;

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
    let meshes = generated.map(|(name, n)| (name, Some(models::bumpy_torus(n))));
    for (name, mesh) in meshes.into_iter().chain([("bunny", models::model(models::BUNNY))]) {
        let Some(mesh) = mesh else { continue };
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
