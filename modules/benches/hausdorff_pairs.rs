//! Distances of pairs of meshes that are hard to tell apart by boxes: a million samples a side.
//!
//! All meshes have about 100,000 faces.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DQuat, DVec3};
use mve_core::Control;
use mve_modules::data::{TriMesh, VertexId};
use mve_modules::geometry::distance::hausdorff::{HausdorffOptions, hausdorff};
use mve_modules::mesh::fixtures::torus;
use mve_modules::mesh::random::IndexedRandom;

const N_FACES: u32 = 100_000;

fn mapped(mesh: &TriMesh, map: impl Fn(DVec3) -> DVec3) -> TriMesh {
    TriMesh::new(mesh.positions.iter().map(|&p| map(p)).collect(), mesh.faces.clone())
}

fn moved(mesh: &TriMesh, by: DVec3) -> TriMesh {
    mapped(mesh, |p| p + by)
}

/// Two triangles for each of `n` by `m` squares, at `place` of the square's column and row.
fn grid(n: u32, m: u32, place: impl Fn(f64, f64) -> DVec3) -> TriMesh {
    let row = m + 1;
    let at = |k: u32| place(f64::from(k / row) / f64::from(n), f64::from(k % row) / f64::from(m));
    let corner = |k: u32| k / m * row + k % m;
    let faces = (0..n * m).map(corner);
    let faces = faces.flat_map(|k| [[k, k + row, k + row + 1], [k, k + row + 1, k + 1]]);
    TriMesh::new((0..(n + 1) * row).map(at).collect(), faces.map(|f| f.map(VertexId)).collect())
}

fn sphere(radius: f64) -> TriMesh {
    grid(316, 158, |u, v| {
        let (sin, cos) = (PI * v).sin_cos();
        radius * DVec3::new(sin * (TAU * u).cos(), sin * (TAU * u).sin(), cos)
    })
}

/// Faces around one vertex at `height` over a circle.
fn fan(height: f64) -> TriMesh {
    let rim = (0..N_FACES).map(|k| TAU * f64::from(k) / f64::from(N_FACES));
    let mut positions: Vec<DVec3> = rim.map(|u| DVec3::new(u.cos(), u.sin(), 0.0)).collect();
    positions.push(DVec3::Z * height);
    let face = |k: u32| [N_FACES, k, (k + 1) % N_FACES].map(VertexId);
    TriMesh::new(positions, (0..N_FACES).map(face).collect())
}

/// A cylinder, a face as long as it is, turned away from the axes.
fn needles(n: u32) -> TriMesh {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.0);
    grid(n, 1, |u, v| turn * DVec3::new((TAU * u).cos(), (TAU * u).sin(), 10.0 * v))
}

/// Thin faces in a unit cube, each in a direction of its own.
fn straw(seed: u64) -> TriMesh {
    let random = IndexedRandom::new(seed);
    let vector = |k: u64| DVec3::from([0, 1, 2].map(|axis| random.unit(9 * k + axis) - 0.5));
    let ends =
        |k: u64| [vector(3 * k), vector(3 * k + 1), vector(3 * k) + vector(3 * k + 2) * 1e-3];
    let positions = (0..u64::from(N_FACES)).flat_map(ends).collect();
    let face = |k: u32| [3 * k, 3 * k + 1, 3 * k + 2].map(VertexId);
    TriMesh::new(positions, (0..N_FACES).map(face).collect())
}

/// Thin faces around one vertex, each in a direction of its own.
fn star(seed: u64) -> TriMesh {
    let random = IndexedRandom::new(seed);
    let ends = |k: u64| {
        let z = 2.0 * random.unit(2 * k) - 1.0;
        let (sin, cos) = (TAU * random.unit(2 * k + 1)).sin_cos();
        let end = DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
        [end, end + end.any_orthonormal_vector() * 1e-3]
    };
    let ends = (0..u64::from(N_FACES)).flat_map(ends);
    let face = |k: u32| [0, 2 * k + 1, 2 * k + 2].map(VertexId);
    let positions = std::iter::once(DVec3::ZERO).chain(ends).collect();
    TriMesh::new(positions, (0..N_FACES).map(face).collect())
}

fn copies(mesh: &TriMesh, n: usize) -> TriMesh {
    TriMesh::new(mesh.positions.clone(), mesh.faces.repeat(n))
}

fn pairs() -> Vec<(&'static str, TriMesh, TriMesh)> {
    let ring = torus(2.0, 0.5, 224);
    let face = TriMesh::new(
        vec![DVec3::ZERO, DVec3::X, DVec3::new(0.2, 0.9, 0.4)],
        vec![[0, 1, 2].map(VertexId)],
    );
    let plate = grid(224, 224, |u, v| DVec3::new(u, v, 0.0));
    let equal = copies(&face, N_FACES as usize);
    let doubled = copies(&torus(2.0, 0.5, 158), 2);
    let east = DVec3::new(0.8, 0.6, 0.05);
    vec![
        ("offset_1e5", ring.clone(), moved(&ring, east * 1e5)),
        ("offset_1e6", ring.clone(), moved(&ring, east * 1e6)),
        ("offset_1e7", ring.clone(), moved(&ring, east * 1e7)),
        ("offset_1e12", ring.clone(), moved(&ring, east * 1e12)),
        ("plate_1e5", plate.clone(), moved(&plate, DVec3::Z * 1e5)),
        ("millimeters_torus", ring.clone(), mapped(&ring, |p| p * 1000.0)),
        ("millimeters_sphere", sphere(1.0), sphere(1000.0)),
        ("sphere_1e6", sphere(1.0), sphere(1e6)),
        ("equally_far", sphere(1e-9), sphere(1.0)),
        ("sphere_5_percent", sphere(1.0), sphere(1.05)),
        ("equal_faces", equal.clone(), ring.clone()),
        ("equal_faces_moved", equal.clone(), moved(&equal, DVec3::Z)),
        ("doubled_faces", doubled, torus(2.0, 0.5, 100)),
        ("flat_hub", fan(0.0), moved(&fan(0.0), DVec3::Z * 0.1)),
        ("hub_moved", fan(0.5), moved(&fan(0.5), DVec3::new(0.01, 0.0, 0.1))),
        ("hub_above", fan(0.5), moved(&fan(0.5), DVec3::Z * 10.0)),
        ("needles", needles(N_FACES / 2), needles(N_FACES / 3)),
        ("stray_vertex", stray(&ring), moved(&ring, DVec3::X * 0.01)),
        ("straw", straw(1), straw(2)),
        ("star_moved", star(1), moved(&star(1), DVec3::new(0.01, 0.0, 0.1))),
        ("star_in_sphere", star(1), sphere(1.0)),
    ]
}

/// The mesh with one small face far away.
fn stray(mesh: &TriMesh) -> TriMesh {
    let mut mesh = mesh.clone();
    let n = mesh.positions.len() as u32;
    mesh.positions.extend([DVec3::X, DVec3::Y, DVec3::Z].map(|p| p + DVec3::splat(1e8)));
    mesh.faces.push([n, n + 1, n + 2].map(VertexId));
    mesh
}

fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("hausdorff_pairs");
    group.sample_size(10);
    let options = HausdorffOptions { n_samples: Some(1_000_000), ..HausdorffOptions::DEFAULT };
    for (name, a, b) in &pairs() {
        group.throughput(Throughput::Elements(2_000_000));
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| hausdorff(black_box(a), b, &options, Control::none()));
        });
    }
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
