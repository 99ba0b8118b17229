//! Tests of queries that share their work: right wherever the points are, and the work bounded.

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use mve_mesh::data::{TriMesh, VertexId};
use mve_mesh::fixtures::{mesh_of, torus};
use mve_mesh::random::IndexedRandom;

use super::*;
use crate::geometry::distance::point_triangle::PreparedTriangle;

/// Two triangles for each of `n` by `n` squares of longitude and latitude.
fn sphere(radius: f64, n: u32) -> TriMesh {
    let at = |k: u32| {
        let (u, v) = (k / (n + 1), k % (n + 1));
        let (sin, cos) = (PI * f64::from(v) / f64::from(n)).sin_cos();
        let turn = TAU * f64::from(u) / f64::from(n);
        [sin * turn.cos() * radius, sin * turn.sin() * radius, cos * radius]
    };
    let points: Vec<[f64; 3]> = (0..(n + 1) * (n + 1)).map(at).collect();
    let faces: Vec<[u32; 3]> = (0..n * n)
        .map(|k| k / n * (n + 1) + k % n)
        .flat_map(|k| [[k, k + n + 1, k + n + 2], [k, k + n + 2, k + 1]])
        .collect();
    mesh_of(&points, &faces)
}

/// Faces around one vertex at this height over a circle.
fn fan(height: f64, n: u32) -> TriMesh {
    let rim = (0..n).map(|k| TAU * f64::from(k) / f64::from(n));
    let mut points: Vec<[f64; 3]> = rim.map(|turn| [turn.cos(), turn.sin(), 0.0]).collect();
    points.push([0.0, 0.0, height]);
    let faces: Vec<[u32; 3]> = (0..n).map(|k| [n, k, (k + 1) % n]).collect();
    mesh_of(&points, &faces)
}

/// Thin faces around one vertex in all directions, as long as 1.
fn star(n: u32) -> TriMesh {
    let random = IndexedRandom::new(1);
    let ends = |k: u32| {
        let z = 2.0 * random.unit(2 * u64::from(k)) - 1.0;
        let (sin, cos) = (TAU * random.unit(2 * u64::from(k) + 1)).sin_cos();
        let end = DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
        [end, end + end.any_orthonormal_vector() * 1e-3].map(|p| p.to_array())
    };
    let points: Vec<[f64; 3]> = std::iter::once([0.0; 3]).chain((0..n).flat_map(ends)).collect();
    mesh_of(&points, &(0..n).map(|k| [0, 2 * k + 1, 2 * k + 2]).collect::<Vec<_>>())
}

fn mapped(mesh: &TriMesh, map: impl Fn(DVec3) -> DVec3) -> TriMesh {
    TriMesh::new(mesh.positions.iter().map(|&p| map(p)).collect(), mesh.faces.clone())
}

fn stray(mesh: &TriMesh) -> TriMesh {
    let mut mesh = mesh.clone();
    let n = mesh.positions.len() as u32;
    mesh.positions.extend([DVec3::X, DVec3::Y, DVec3::Z].map(|p| p + DVec3::splat(1e8)));
    mesh.faces.push([n, n + 1, n + 2].map(VertexId));
    mesh
}

/// Pairs whose boxes hardly tell one face from another, each with its name.
fn pairs() -> Vec<(&'static str, TriMesh, TriMesh)> {
    let (ring, ball) = (torus(2.0, 0.5, 40), sphere(1.0, 40));
    let moved = |mesh: &TriMesh, by: DVec3| mapped(mesh, |p| p + by);
    let scaled = |by: f64| mapped(&ball, |p| p * by);
    let east = DVec3::new(0.8, 0.6, 0.05);
    let copies = TriMesh::new(ring.positions.clone(), ring.faces[..1].repeat(3200));
    vec![
        ("far", ring.clone(), moved(&ring, east * 1e5)),
        ("farther", ring.clone(), moved(&ring, east * 1e7)),
        ("as far as numbers tell", ring.clone(), moved(&ring, east * 1e13)),
        ("in millimeters", ball.clone(), scaled(1e3)),
        ("in micrometers", ball.clone(), scaled(1e6)),
        ("in the middle", scaled(1e-9), ball.clone()),
        ("in one place", scaled(0.0), ball.clone()),
        ("equal faces", copies.clone(), ring.clone()),
        ("equal faces, moved", copies.clone(), moved(&copies, DVec3::Z)),
        ("a hub", fan(0.0, 3200), moved(&fan(0.0, 3200), DVec3::Z * 0.1)),
        ("a hub within a hub", fan(0.5, 3200), moved(&fan(0.5, 3200), DVec3::new(0.01, 0.0, 0.1))),
        ("before a hub", fan(0.5, 3200), moved(&fan(0.5, 3200), DVec3::Z * 10.0)),
        ("a star", star(3200), moved(&star(3200), DVec3::new(0.01, 0.0, 0.1))),
        ("a star in a ball", star(3200), ball.clone()),
        ("a face astray", stray(&ring), moved(&ring, DVec3::X * 0.01)),
    ]
}

/// Points on the faces of a mesh, in their order.
fn points_on(mesh: &TriMesh) -> Vec<DVec3> {
    let on = |k: usize| {
        let [a, b, c] = mesh.faces[k / 2].map(|v| mesh.positions[v.idx()]);
        let (s, t) = [(0.2, 0.3), (0.6, 0.1)][k % 2];
        a + (b - a) * s + (c - a) * t
    };
    (0..2 * mesh.faces.len()).map(on).collect()
}

/// Each point has its nearest face but for rounding, and has cost a small part of all faces.
#[test]
fn hard_pairs_take_few_looks() {
    for (name, a, b) in pairs() {
        for (from, to) in [(&a, &b), (&b, &a)] {
            let bvh = Bvh::build(to, Control::none()).unwrap();
            let center = Bvh::build(from, Control::none()).unwrap().center();
            let (points, many) = (points_on(from), ManyQueries::new(&bvh, center));
            let hits = many.closest(&points, Control::none()).unwrap();
            let n_looks = many.n_looks() / points.len();
            // Where all faces are about as far as each other, a point takes many of the 3,200.
            assert!(n_looks < 700, "{name}: {n_looks} looks a point");
            let mut distances_sq = Vec::new();
            let hard = many.easy_distances_sq(&points, &mut distances_sq, &Control::none());
            for at in hard.unwrap() {
                distances_sq[at as usize] = hits[at as usize].unwrap().distance_sq;
            }
            let triangles: Vec<_> = (0..to.faces.len() as u32)
                .map(|face| PreparedTriangle::new(to.corners(mve_mesh::data::FaceId(face))))
                .collect();
            for (at, &point) in points.iter().enumerate().step_by(97) {
                let all = triangles.iter().map(|triangle| triangle.distance_sq(point));
                let expected = all.fold(f64::INFINITY, f64::min).sqrt();
                let size = 1e-14 * (expected + 1.0);
                for found in [hits[at].unwrap().distance_sq, distances_sq[at]] {
                    assert!((found.sqrt() - expected).abs() <= size, "{name}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn a_cancel_is_heard_between_points() {
    let (name, a, b) = pairs().swap_remove(3);
    let bvh = Bvh::build(&b, Control::none()).unwrap();
    let many = ManyQueries::new(&bvh, DVec3::ZERO);
    let control = Control::new(&|_| ControlFlow::Break(()));
    let found = many.closest(&points_on(&a), control);
    assert_eq!(found, Err(Cancelled), "{name}");
}
