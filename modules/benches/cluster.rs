//! Clusters of vertices to a tenth of the faces, beside meshoptimizer's `simplifySloppy`.
//!
//! Both run on one thread with the mesh in memory. Meshes: bumpy tori of 100 k and 1 M faces, and
//! the Stanford bunny (69,451 faces) where it is at hand.

mod models;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use mve_core::Control;
use mve_modules::data::TriMesh;
use mve_modules::geometry::cluster::build::Duplicates;
use mve_modules::geometry::cluster::importance::Weights;
use mve_modules::geometry::cluster::place::Representative;
use mve_modules::geometry::cluster::{CellKind, ClusterOptions, Size, cluster};

fn ours(mesh: &TriMesh, cells: CellKind) -> usize {
    let options = ClusterOptions {
        cells,
        size: Size::Faces(mesh.faces.len() / 10),
        representative: Representative::Quadric,
        weights: Weights { length: 1.0, angle: 1.0 },
        levels: 1,
        duplicates: Duplicates::Once,
        is_manifold: false,
    };
    cluster(mesh, &options, Control::none()).map_or(0, |result| result.mesh.faces.len())
}

fn theirs(indices: &[u32], positions: &[[f32; 3]]) -> usize {
    let bytes = meshopt::typed_to_bytes(positions);
    let Ok(vertices) = meshopt::VertexDataAdapter::new(bytes, size_of::<[f32; 3]>(), 0) else {
        return 0;
    };
    meshopt::simplify_sloppy(indices, &vertices, indices.len() / 10, 1.0, None).len()
}

fn bench(criterion: &mut Criterion) {
    let generated = [("torus-100k", 100_000), ("torus-1M", 1_000_000)];
    let meshes = generated.map(|(name, n)| (name, Some(models::bumpy_torus(n))));
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for (name, mesh) in meshes.into_iter().chain([("bunny", models::model(models::BUNNY))]) {
        let Some(mesh) = mesh else { continue };
        let mut group = criterion.benchmark_group(format!("cluster-{name}"));
        group.sample_size(10);
        for (cells, kind) in [("uniform", CellKind::Uniform), ("floating", CellKind::Floating)] {
            group.bench_function(format!("mve {cells}"), |b| {
                alone.install(|| b.iter(|| ours(black_box(&mesh), kind)));
            });
        }
        let indices: Vec<u32> = mesh.faces.iter().flatten().map(|v| v.0).collect();
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.as_vec3().into()).collect();
        group.bench_function("meshoptimizer sloppy", |b| {
            b.iter(|| theirs(black_box(&indices), black_box(&positions)));
        });
        group.finish();
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
