//! MSDM2 of real models, where they are at hand, and of tori against their halves by quadrics,
//! both directions; and halving by the cost of that name.
//!
//! Run with `RAYON_NUM_THREADS=1` for the work of one thread.

mod models;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mve_core::Control;
use mve_modules::cost::{Msdm2, Quadric};
use mve_modules::data::TriMesh;
use mve_modules::geometry::perception::msdm2::collapse::Counting;
use mve_modules::geometry::perception::msdm2::{Msdm2Options, msdm2};
use mve_modules::geometry::simplify::collapse::{SimplifyOptions, Stop, simplify};
use mve_modules::placement::{Midpoint, Optimal};

fn halved(mesh: &TriMesh) -> TriMesh {
    let stop = Stop { ratio: Some(0.5), ..Stop::default() };
    let options = SimplifyOptions { stop, ..SimplifyOptions::DEFAULT };
    let (mut cost, mut placement) = (Quadric::default(), Optimal::default());
    simplify(mesh, &mut cost, &mut placement, options, Control::none())
        .map_or_else(|_| mesh.clone(), |simplified| simplified.mesh)
}

fn benches(criterion: &mut Criterion) {
    let mut originals = models::tori();
    for name in ["spot.obj", "cow.obj", models::BUNNY] {
        originals.extend(models::model(name).map(|mesh| (name, mesh)));
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
