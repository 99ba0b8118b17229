//! MSDM2 of real models, where they are at hand, and of tori against their halves by quadrics,
//! both directions; and halving by the cost of that name.
//!
//! Run with `RAYON_NUM_THREADS=1` for the work of one thread.

use std::hint::black_box;
use std::path::Path;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use mve_modules::cost::{Msdm2, Quadric};
use mve_modules::data::{TriMesh, VertexId};
use mve_modules::geometry::control::Control;
use mve_modules::geometry::msdm2::collapse::Counting;
use mve_modules::geometry::msdm2::{Msdm2Options, msdm2};
use mve_modules::geometry::simplify::{SimplifyOptions, Stop, simplify};
use mve_modules::mesh::fixtures::torus;
use mve_modules::placement::{Midpoint, Optimal};

/// Positions and faces of an OBJ file of triangles.
fn model(name: &str) -> Option<TriMesh> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/models");
    let folder = std::env::var_os("MVE_MODELS").map_or(beside, Into::into);
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (models, _) = tobj::load_obj(folder.join(name), &options).ok()?;
    let mesh = &models.first()?.mesh;
    let faces = mesh.indices.chunks_exact(3).map(|f| [f[0], f[1], f[2]].map(VertexId)).collect();
    Some(TriMesh::new(mesh.positions.chunks_exact(3).map(DVec3::from_slice).collect(), faces))
}

fn halved(mesh: &TriMesh) -> TriMesh {
    let stop = Stop { ratio: Some(0.5), ..Stop::default() };
    let options = SimplifyOptions { stop, ..SimplifyOptions::DEFAULT };
    let (mut cost, mut placement) = (Quadric::default(), Optimal::default());
    simplify(mesh, &mut cost, &mut placement, options, Control::none())
        .map_or_else(|_| mesh.clone(), |simplified| simplified.mesh)
}

fn benches(criterion: &mut Criterion) {
    let mut originals: Vec<(&str, TriMesh)> =
        [("1k", 24), ("100k", 224), ("1M", 708)].map(|(n, k)| (n, torus(2.0, 0.5, k))).into();
    for name in ["spot.obj", "cow.obj", "stanford-bunny.obj"] {
        originals.extend(model(name).map(|mesh| (name, mesh)));
    }
    let mut group = criterion.benchmark_group("msdm2");
    group.sample_size(10);
    for (name, mesh) in &originals {
        let half = halved(mesh);
        let n_vertices = mesh.positions.len() + half.positions.len();
        group.throughput(Throughput::Elements(n_vertices as u64));
        group.bench_function(BenchmarkId::from_parameter(name), |b| {
            b.iter(|| msdm2(black_box(mesh), &half, &Msdm2Options::DEFAULT, Control::none()));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("msdm2_cost");
    group.sample_size(10);
    for (name, mesh) in originals.iter().filter(|(name, _)| ["1k", "cow.obj"].contains(name)) {
        group.bench_function(BenchmarkId::from_parameter(name), |b| {
            b.iter(|| {
                let stop = Stop { faces: Some(mesh.faces.len() * 30 / 58), ..Stop::default() };
                let options = SimplifyOptions { stop, ..SimplifyOptions::DEFAULT };
                let mut cost = Msdm2::new(mesh, 3, Counting::Merged);
                simplify(mesh, &mut cost, &mut Midpoint, options, Control::none()).is_ok()
            });
        });
    }
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
