//! Fits whose answers are known by other means.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Domain, Layer, LayerValues, VertexId};
use mve_mesh::fixtures::{mesh_of, torus};

use super::*;
use crate::cost::Quadric;
use crate::geometry::distance::hausdorff::{HausdorffOptions, hausdorff};
use crate::geometry::generate::{BoxOptions, subdivided_box};
use crate::geometry::simplify::collapse::{SimplifyOptions, Stop, simplify};
use crate::placement::Optimal;
use crate::test_models::model;

fn fitted(mesh: &TriMesh, original: &TriMesh, n_steps: usize) -> Refitted {
    let options = RefitOptions { n_steps, samples_per_face: 60.0, ..RefitOptions::DEFAULT };
    refit(mesh, original, options, Control::none()).unwrap()
}

fn simplified(mesh: &TriMesh, stop: Stop) -> TriMesh {
    let options = SimplifyOptions { stop, ..SimplifyOptions::default() };
    let (mut cost, mut placement) = (Quadric::default(), Optimal::default());
    simplify(mesh, &mut cost, &mut placement, options, Control::none()).unwrap().mesh
}

/// An octahedron in the unit sphere, each face cut in `4^n`, its vertices pushed out.
fn sphere(n_cuts: u32) -> TriMesh {
    let points = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut faces: Vec<[DVec3; 3]> = (0..8)
        .map(|octant: u32| {
            let signs = DVec3::from([0, 1, 2].map(|k| 1.0 - 2.0 * f64::from(octant >> k & 1)));
            let [a, b, c] = points.map(|p| DVec3::from(p) * signs);
            if octant.count_ones().is_multiple_of(2) { [a, b, c] } else { [a, c, b] }
        })
        .collect();
    for _ in 0..n_cuts {
        let cut = |[a, b, c]: [DVec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(cut).collect();
    }
    let mut positions: Vec<DVec3> = Vec::new();
    let mut id = |p: DVec3| {
        let known = positions.iter().position(|q| q.distance(p) < 1e-9);
        let at = known.unwrap_or(positions.len());
        if known.is_none() {
            positions.push(p);
        }
        VertexId(at as u32)
    };
    let faces = faces.into_iter().map(|face| face.map(&mut id)).collect();
    TriMesh::new(positions, faces)
}

/// The mean square of the distances between the unit sphere and an octahedron of this radius, half
/// from either, by midpoints of a fine grid. By symmetry it is that of one face and its octant.
fn mean_square(radius: f64) -> f64 {
    let n = 200;
    let [a, b, c] = [DVec3::X, DVec3::Y, DVec3::Z].map(|p| radius * p);
    let height = radius / 3f64.sqrt();
    let (mut there, mut there_weight, mut here) = (0.0, 0.0, 0.0);
    for i in 0..n {
        for j in 0..n {
            // A point of the face, uniform by area: the square root turns a square into a triangle.
            let (u, v) = ((i as f64 + 0.5) / n as f64, (j as f64 + 0.5) / n as f64);
            let root = u.sqrt();
            let point = (1.0 - root) * a + root * (1.0 - v) * b + root * v * c;
            here += (1.0 - point.length()).powi(2) / (n * n) as f64;
            // A point of the octant, uniform by area, and its distance from the face, which is that
            // from its plane where it stands above it; the sides of the face turn away below.
            let (z, phi) = (u, 0.5 * PI * v);
            let r = (1.0 - z * z).sqrt();
            let point = DVec3::new(r * phi.cos(), r * phi.sin(), z);
            let foot =
                point - (point.dot(DVec3::ONE) / 3f64.sqrt() - height) * DVec3::ONE / 3f64.sqrt();
            let nearest = nearest_of_face(point, foot, [a, b, c]);
            there += (point - nearest).length_squared();
            there_weight += 1.0;
        }
    }
    0.5 * (here + there / there_weight)
}

/// The nearest point of a face of the octahedron: its foot, or the nearest of its sides.
fn nearest_of_face(point: DVec3, foot: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    if foot.min_element() >= 0.0 {
        return foot;
    }
    let side = |from: DVec3, to: DVec3| {
        let t = (point - from).dot(to - from) / (to - from).length_squared();
        from + t.clamp(0.0, 1.0) * (to - from)
    };
    let sides = [side(a, b), side(b, c), side(c, a)];
    sides.into_iter().min_by(|p, q| p.distance(point).total_cmp(&q.distance(point))).unwrap()
}

#[test]
fn an_octahedron_takes_the_radius_of_least_error_around_a_sphere() {
    // From outside: inscribed, its middle is nearer to the sphere than its vertices end.
    let mut outside = sphere(0);
    outside.positions.iter_mut().for_each(|p| *p *= 1.6);
    let found = fitted(&outside, &sphere(5), 12);
    let radii: Vec<f64> = found.mesh.positions.iter().map(|p| p.length()).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let best = (1000..2000)
        .map(|k| f64::from(k) / 1000.0)
        .min_by(|a, b| mean_square(*a).total_cmp(&mean_square(*b)))
        .unwrap();
    assert!((mean - best).abs() < 0.01, "{mean} {best} {radii:?}");
    assert!(
        (found.after.unwrap().rms().powi(2) / mean_square(best) - 1.0).abs() < 0.05,
        "{:?}",
        found.after
    );
}

#[test]
fn a_box_stays_as_it_is_to_the_last_digits() {
    let original = subdivided_box(&BoxOptions::DEFAULT);
    let mesh = simplified(&original, Stop { faces: Some(60), ..Stop::default() });
    let found = fitted(&mesh, &original, 6).mesh;
    let moved = found.positions.iter().zip(&mesh.positions).map(|(p, q)| p.distance(*q));
    assert!(moved.fold(0.0, f64::max) < 1e-9);
    assert!((found.signed_volume() - 1.0).abs() < 1e-9 && (found.area() - 6.0).abs() < 1e-9);
}

#[test]
fn a_vertex_that_left_its_face_comes_back_and_edges_stay_sharp() {
    let original = subdivided_box(&BoxOptions::DEFAULT);
    let mut mesh = original.clone();
    let (low, high) = mesh.bounds().unwrap();
    // How many sides of the box a vertex lies on: one in a face, two on an edge.
    let n_sides = |p: DVec3| {
        let sides = [0, 1, 2].map(|k| p[k] == low[k] || p[k] == high[k]);
        sides.iter().filter(|is_on| **is_on).count()
    };
    for n in [1, 2] {
        let at = mesh.positions.iter().position(|p| n_sides(*p) == n).unwrap();
        let out = mesh.positions[at] - 0.5 * (low + high);
        mesh.positions[at] += 0.1 * out;
    }
    let before = fitted(&mesh, &original, 0).after.unwrap().max();
    let found = fitted(&mesh, &original, 10);
    assert!(
        before > 0.05 && found.after.unwrap().max() < 0.02 * before,
        "{before} {:?}",
        found.after
    );
}

#[test]
fn neither_direction_nor_the_maximum_gets_worse_on_real_meshes() {
    let fine = torus(2.0, 0.5, 60);
    let models = [Some(fine), model("cow.obj"), model("fandisk.obj")].into_iter().flatten();
    for original in models {
        let mesh = simplified(&original, Stop { ratio: Some(0.1), ..Stop::default() });
        let found = refit(&mesh, &original, RefitOptions::DEFAULT, Control::none()).unwrap().mesh;
        let measure = |mesh| {
            let options = HausdorffOptions { n_samples: Some(50_000), ..HausdorffOptions::DEFAULT };
            hausdorff(&original, mesh, &options, Control::none()).unwrap()
        };
        let (before, after) = (measure(&mesh), measure(&found));
        for [before, after] in [
            [before.from_original.rms, after.from_original.rms],
            [before.from_simplified.rms, after.from_simplified.rms],
        ] {
            assert!(after < 0.9 * before, "{after} {before}");
        }
        // Bounds of the maximum are known to a hundredth.
        assert!(after.max() <= 1.01 * before.max(), "{} {}", after.max(), before.max());
    }
}

/// A square of `n` by `n` cells at a height, with texture coordinates that are its x and y.
fn square(n: u32, height: f64) -> TriMesh {
    let at = |i: u32, j: u32| [f64::from(i) / f64::from(n), f64::from(j) / f64::from(n), height];
    let positions: Vec<[f64; 3]> = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let id = |i: u32, j: u32| j * (n + 1) + i;
    let cell = |i: u32, j: u32| {
        let (a, b, c, d) = (id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
        [[a, b, c], [a, c, d]]
    };
    let faces: Vec<[u32; 3]> = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect();
    let mut mesh = mesh_of(&positions, &faces);
    let values = LayerValues::Vec2(positions.iter().map(|p| DVec2::new(p[0], p[1])).collect());
    let index = mesh.faces.iter().flatten().map(|v| v.0).collect();
    mesh.set_layer(Layer { name: Layer::TEXCOORD.into(), domain: Domain::Corner, values, index });
    mesh
}

#[test]
fn borders_stay_and_the_inside_goes_to_the_original() {
    let (low, high) = (square(6, 0.0), square(12, 0.1));
    let found = fitted(&low, &high, 20).mesh;
    for (before, after) in low.positions.iter().zip(&found.positions) {
        let is_border = [before.x, before.y].iter().any(|x| *x == 0.0 || *x == 1.0);
        if is_border {
            assert_eq!(before, after);
        }
    }
    let middle = found.positions[3 * 7 + 3];
    assert!((middle.z - 0.1).abs() < 0.01, "{middle}");
}

#[test]
fn attributes_are_those_of_the_place_and_seams_stay() {
    let mut mesh = square(4, 0.0);
    // The right half has coordinates of its own: the line in the middle is a seam.
    let Some(layer) = mesh.layers.first_mut() else { panic!("texture coordinates") };
    let LayerValues::Vec2(values) = &mut layer.values else { panic!("texture coordinates") };
    let n = values.len() as u32;
    values.extend(values.clone().iter().map(|v| *v + DVec2::new(5.0, 0.0)));
    for (corner, value) in layer.index.iter_mut().enumerate() {
        let face = &mesh.faces[corner / 3];
        let is_right = face.iter().map(|v| mesh.positions[v.idx()].x).sum::<f64>() > 1.5;
        *value += if is_right { n } else { 0 };
    }
    let adjacency = Adjacency::new(&mesh, Control::none()).unwrap();
    let guard = Guard::new(&mesh, &adjacency, Control::none()).unwrap();
    let free: Vec<DVec3> = (0..mesh.positions.len())
        .filter(|&v| guard.is_free()[v])
        .map(|v| mesh.positions[v])
        .collect();
    // Of three by three inner vertices the middle column lies on the seam.
    assert_eq!(free.len(), 6);
    assert!(free.iter().all(|p| p.x != 0.5));

    // The same values, one for each corner: no more seams than before.
    let mut by_corner = mesh.clone();
    let layer = &mut by_corner.layers[0];
    let LayerValues::Vec2(values) = &layer.values else { panic!("texture coordinates") };
    let values: Vec<DVec2> = layer.index.iter().map(|value| values[*value as usize]).collect();
    layer.index = (0..values.len() as u32).collect();
    layer.values = LayerValues::Vec2(values);
    let guard_by_corner = Guard::new(&by_corner, &adjacency, Control::none()).unwrap();
    assert_eq!(guard_by_corner.is_free(), guard.is_free());

    let mut moved = mesh.clone();
    let by = DVec3::new(0.1, 0.06, 0.0);
    let places = moved.positions.iter_mut().zip(guard.is_free());
    places.filter(|(_, is_free)| **is_free).for_each(|(place, _)| *place += by);
    attributes::carry(&mesh, &adjacency, &mut moved, Control::none()).unwrap();
    moved.check().unwrap();
    let layer = moved.layer(Layer::TEXCOORD).unwrap();
    let LayerValues::Vec2(values) = &layer.values else { panic!("texture coordinates") };
    for (corner, value) in layer.index.iter().enumerate() {
        let place = moved.positions[moved.faces[corner / 3][corner % 3].idx()];
        let value = values[*value as usize];
        let offset = value.x - place.x;
        assert!(offset.abs() < 1e-12 || (offset - 5.0).abs() < 1e-12, "{value} {place}");
        assert!((value.y - place.y).abs() < 1e-12, "{value} {place}");
    }
}

#[test]
fn meshes_without_a_surface_are_named_and_odd_ones_survive() {
    let fine = torus(2.0, 0.5, 12);
    let refit = |mesh: &TriMesh, original: &TriMesh| {
        refit(mesh, original, RefitOptions::DEFAULT, Control::none())
    };
    let empty = TriMesh::default();
    let no_surface = |role| RefitError::NoSurface(role);
    assert_eq!(refit(&fine, &empty).unwrap_err(), no_surface(MeshRole::Original));
    assert_eq!(refit(&empty, &fine).unwrap_err(), no_surface(MeshRole::Simplified));
    let far = TriMesh {
        positions: fine.positions.iter().map(|p| *p * f64::INFINITY).collect(),
        ..fine.clone()
    };
    assert_eq!(refit(&far, &fine).unwrap_err(), no_surface(MeshRole::Simplified));
    let odd = mesh_of(
        &[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f64::NAN, 0.0, 0.0]],
        &[[0, 1, 2], [0, 1, 3], [1, 0, 3], [0, 1, 3], [0, 0, 1], [4, 0, 1], [3, 3, 3]],
    );
    let found = refit(&odd, &fine).unwrap().mesh;
    assert_eq!(found.faces, odd.faces);
    let mut partly = fine.clone();
    partly.positions[7].x = f64::INFINITY;
    let found = refit(&partly, &fine).unwrap().mesh;
    assert_eq!(found.positions[7], partly.positions[7]);
}
