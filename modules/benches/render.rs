//! Pictures of meshes and their similarity: tori of 1 k, 100 k and 1 M faces, and the Stanford
//! bunny (69,451 faces) where it is at hand.
//!
//! `picture` is one picture on one thread, from a camera a diagonal away, by faces and by pixels a
//! second; `cameras` all 24 of a rhombicuboctahedron at 512² on all threads; `ssim` two pictures of
//! 512² on one thread.

mod models;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mve_core::Control;
use mve_modules::data::{PixelKind, TriMesh};
use mve_modules::picture::render::{
    Albedo, CameraSet, Frame, Lens, NormalSource, PictureOptions, Shading, Sides, Surface, Visible,
    picture,
};
use mve_modules::picture::ssim::ssim;

fn surface(mesh: &TriMesh, shading: Shading) -> Option<Surface<'_>> {
    Surface::new(mesh, shading, NormalSource::Faces, Albedo::White, Control::none()).ok()
}

fn options(size: usize) -> PictureOptions {
    PictureOptions { size, sides: Sides::Both, background: 0, kind: PixelKind::Gray, samples: 1 }
}

fn benches(criterion: &mut Criterion) {
    let mut meshes = models::tori();
    meshes.extend(models::model(models::BUNNY).map(|mesh| ("bunny", mesh)));
    let set = CameraSet::Rhombicuboctahedron;
    for shading in [Shading::Flat, Shading::Gouraud] {
        let mut group = criterion.benchmark_group(format!("picture/{shading:?}"));
        group.sample_size(10);
        for (name, mesh) in &meshes {
            let Some((frame, surface)) = Frame::around(set, mesh).zip(surface(mesh, shading))
            else {
                continue;
            };
            for size in [256, 512] {
                let lens = Lens::new(frame.cameras[3], size, frame.distance);
                group.throughput(Throughput::Elements(mesh.faces.len() as u64));
                group.bench_function(BenchmarkId::new(*name, size), |b| {
                    b.iter(|| picture(black_box(&surface), &lens, "", &options(size), || Ok(())));
                });
            }
        }
    }
    let mut group = criterion.benchmark_group("visible");
    group.sample_size(10);
    for (name, mesh) in &meshes {
        let Some(frame) = Frame::around(set, mesh) else { continue };
        for size in [256, 512] {
            let lens = Lens::new(frame.cameras[3], size, frame.distance);
            group.throughput(Throughput::Elements((size * size) as u64));
            group.bench_function(BenchmarkId::new(*name, size), |b| {
                b.iter(|| Visible::new(black_box(mesh), &lens, Sides::Both));
            });
        }
    }
    group.finish();
    let mut group = criterion.benchmark_group("cameras");
    group.sample_size(10);
    for (name, mesh) in &meshes {
        let Some(frame) = Frame::around(set, mesh) else { continue };
        group.bench_function(BenchmarkId::from_parameter(name), |b| {
            b.iter(|| {
                let surface = surface(black_box(mesh), Shading::Gouraud)?;
                frame.pictures(&surface, &options(512), Control::none()).ok()
            });
        });
    }
    group.finish();
    let noise = |k: usize| (k.wrapping_mul(2_654_435_761) >> 13) as u8;
    let [a, b] = [1, 3].map(|n| (0..512 * 512).map(|k| noise(n * k)).collect::<Vec<u8>>());
    criterion.bench_function("ssim/512", |bench| {
        bench.iter(|| ssim(black_box(&a), black_box(&b), [512, 512], Control::none()));
    });
}

criterion_group!(all, benches);
criterion_main!(all);
