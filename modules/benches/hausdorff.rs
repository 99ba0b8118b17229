//! Distances between a mesh and a coarser one: the bunny where it is at hand, tori otherwise.
//!
//! The mesh coarser than the bunny moves its vertices to the mean of their cell in a grid. Tori are
//! of 1 k, 100 k and 1 M faces against one of a hundredth; boxes of 768 faces and of 108 are the
//! same surface. Run with `RAYON_NUM_THREADS=1` for the work of one thread.

mod models;

use std::collections::BTreeMap;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use mve_core::Control;
use mve_modules::data::{TriMesh, VertexId};
use mve_modules::geometry::distance::bvh::Bvh;
use mve_modules::geometry::distance::hausdorff::{HausdorffOptions, hausdorff};
use mve_modules::geometry::generate::subdivided_box::{BoxOptions, subdivided_box};
use mve_modules::mesh::fixtures::torus;

/// The mesh with the vertices of each cell, `n` a diagonal, drawn together.
fn clustered(mesh: &TriMesh, n: f64) -> TriMesh {
    let size = mesh.diagonal() / n;
    let cell = |p: &DVec3| (*p / size).floor().to_array().map(|x| x as i64);
    let mut cells: BTreeMap<[i64; 3], (u32, DVec3, f64)> = BTreeMap::new();
    for p in &mesh.positions {
        let next = cells.len() as u32;
        let (_, sum, count) = cells.entry(cell(p)).or_insert((next, DVec3::ZERO, 0.0));
        *sum += *p;
        *count += 1.0;
    }
    let mut positions = vec![DVec3::ZERO; cells.len()];
    for &(at, sum, count) in cells.values() {
        positions[at as usize] = sum / count;
    }
    let vertex_of = |v: VertexId| VertexId(cells[&cell(&mesh.positions[v.idx()])].0);
    let moved = mesh.faces.iter().map(|f| f.map(vertex_of));
    let faces = moved.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    TriMesh::new(positions, faces)
}

fn benches(criterion: &mut Criterion) {
    let mut pairs: Vec<(&str, TriMesh, TriMesh)> = models::TORUS_STEPS
        .map(|(name, n)| (name, torus(2.0, 0.5, n), torus(2.0, 0.5, n / 10 + 3)))
        .into();
    let boxes = [8, 3].map(|n| BoxOptions { segments: n, ..BoxOptions::default() });
    let [fine, coarse] = boxes.map(|options| subdivided_box(&options));
    pairs.push(("box", fine, coarse));
    if let Some(bunny) = models::model(models::BUNNY) {
        let coarse = clustered(&bunny, 90.0);
        pairs.push(("bunny", bunny, coarse));
    }
    let mut group = criterion.benchmark_group("bvh_build");
    group.sample_size(10);
    for (name, fine, _) in &pairs {
        group.throughput(Throughput::Elements(fine.faces.len() as u64));
        group.bench_function(BenchmarkId::from_parameter(name), |b| {
            b.iter(|| Bvh::build(black_box(fine), Control::none()));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("hausdorff");
    group.sample_size(10);
    for (name, fine, coarse) in &pairs {
        for (what, max_tolerance) in [("sampled", None), ("bounded", Some(1e-5))] {
            let options = HausdorffOptions {
                n_samples: Some(1_000_000),
                max_tolerance,
                ..Default::default()
            };
            group.throughput(Throughput::Elements(2_000_000));
            group.bench_function(BenchmarkId::new(what, name), |b| {
                b.iter(|| hausdorff(black_box(fine), coarse, &options, Control::none()));
            });
        }
    }
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
