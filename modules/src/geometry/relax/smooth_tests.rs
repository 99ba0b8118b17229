//! Tests of smoothing.

use mve_mesh::fixtures::{mesh_of, torus};
use proptest::prelude::*;

use super::*;
use crate::geometry::edit::checks::any_mesh;
use crate::geometry::generate::ico_sphere;
use crate::test_models::model;

const LAPLACE: SmoothOptions = SmoothOptions {
    method: SmoothMethod::Laplace { lambda: 0.5 },
    steps: 1,
    weight: EdgeWeight::Uniform,
    borders: Borders::Free,
    keeps_volume: false,
};

fn smoothed(mesh: &TriMesh, options: SmoothOptions) -> TriMesh {
    smooth(mesh.clone(), &options, None, Control::none()).unwrap().mesh
}

/// A pyramid over the unit square without its bottom, with its top at height 1.
fn tent() -> TriMesh {
    let points =
        [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    mesh_of(&points, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
}

#[test]
fn a_step_by_hand() {
    // The top goes half of the way to the mean of the corners; each corner to that of its three
    // neighbors.
    let found = smoothed(&tent(), LAPLACE);
    assert_eq!(found.positions[4], DVec3::new(0.0, 0.0, 0.5));
    let expected = DVec3::new(-1.0, -1.0, 0.0).lerp(DVec3::new(0.0, 0.0, 1.0 / 3.0), 0.5);
    assert!((found.positions[0] - expected).length() < 1e-15);
    let fixed = smoothed(&tent(), SmoothOptions { borders: Borders::Fixed, ..LAPLACE });
    assert_eq!((fixed.positions[0], fixed.positions[4].z), (tent().positions[0], 0.5));
    // Along the border the mean of two neighbors of a square is its middle.
    let curve = smoothed(&tent(), SmoothOptions { borders: Borders::Curve, ..LAPLACE });
    assert_eq!(curve.positions[0], DVec3::new(-0.5, -0.5, 0.0));
    assert_eq!(curve.positions[4].z, 0.5);
}

#[test]
fn steps_forth_and_back_by_hand() {
    let method = SmoothMethod::Taubin { lambda: 0.5, mu: -0.6 };
    let options = SmoothOptions { method, borders: Borders::Fixed, ..LAPLACE };
    // 1 → 1 − 0.5 = 0.5 → 0.5 + 0.6 · 0.5.
    assert!((smoothed(&tent(), options).positions[4].z - 0.8).abs() < 1e-15);
}

#[test]
fn an_implicit_step_by_hand() {
    // With the border fixed at 0 the top is z = 1 / (1 + λ), with any weights.
    for weight in [EdgeWeight::Uniform, EdgeWeight::Cotangent] {
        let method = SmoothMethod::Implicit { lambda: 3.0 };
        let options = SmoothOptions { method, weight, borders: Borders::Fixed, ..LAPLACE };
        let found = smooth(tent(), &options, None, Control::none()).unwrap();
        assert!(found.is_solved && (found.mesh.positions[4].z - 0.25).abs() < 1e-12);
        let two = smoothed(&tent(), SmoothOptions { steps: 2, ..options });
        assert!((two.positions[4].z - 0.0625).abs() < 1e-12);
    }
}

/// The equation is put in: each vertex less λ times the way to the mean of its neighbors is what it
/// was.
#[test]
fn an_implicit_step_solves_its_equation() {
    let mut mesh = torus(2.0, 0.5, 16);
    mesh.faces.truncate(400);
    for borders in [Borders::Free, Borders::Fixed, Borders::Curve] {
        let method = SmoothMethod::Implicit { lambda: 20.0 };
        let options = SmoothOptions { method, borders, ..LAPLACE };
        let found = smooth(mesh.clone(), &options, None, Control::none()).unwrap();
        assert!(found.is_solved);
        let adjacency = Adjacency::new(&mesh, Control::none()).unwrap();
        let pattern = Pattern::of(&mesh, &adjacency, borders, None);
        let weights = pattern.weights(&mesh, &adjacency, EdgeWeight::Uniform);
        let ways = weights.laplacian(&found.mesh.positions);
        for (v, way) in ways.iter().enumerate() {
            let left = found.mesh.positions[v] - 20.0 * *way;
            assert!((left - mesh.positions[v]).length() < 1e-8, "{borders:?} {v}");
        }
    }
}

/// In the plane the cotangent weights of a point within its neighbors put it where it is.
#[test]
fn cotangents_let_nothing_slide_in_a_plane() {
    let ring = (0..6).map(|k| (std::f64::consts::TAU * f64::from(k) / 6.0).sin_cos());
    let mut points: Vec<[f64; 3]> = ring.map(|(sin, cos)| [cos, sin, 0.0]).collect();
    points.push([0.1, 0.05, 0.0]);
    let faces: Vec<[u32; 3]> = (0..6).map(|k| [k, (k + 1) % 6, 6]).collect();
    let mesh = mesh_of(&points, &faces);
    let by = |weight| {
        let how = SmoothOptions { weight, borders: Borders::Fixed, ..LAPLACE };
        let found = smoothed(&mesh, how);
        found.positions.iter().zip(&mesh.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
    };
    assert!(by(EdgeWeight::Cotangent) < 1e-15, "{}", by(EdgeWeight::Cotangent));
    assert!(by(EdgeWeight::Uniform) > 0.01);
}

#[test]
fn noise_goes_and_the_volume_stays() {
    let round = ico_sphere(1.0, 3, Control::none()).unwrap();
    let mut rough = round.clone();
    let bumps = (0..rough.positions.len()).map(|v| if v % 2 == 0 { 0.98 } else { 1.02 });
    rough.positions.iter_mut().zip(bumps).for_each(|(p, bump)| *p *= bump);
    let roughness = |mesh: &TriMesh| {
        let mean = mesh.positions.iter().map(|p| p.length()).sum::<f64>() / 642.0;
        mesh.positions.iter().map(|p| (p.length() / mean - 1.0).powi(2)).sum::<f64>().sqrt()
    };
    let methods = [
        SmoothMethod::Laplace { lambda: 0.5 },
        SmoothMethod::Taubin { lambda: 0.5, mu: -0.53 },
        SmoothMethod::Implicit { lambda: 5.0 },
    ];
    for method in methods {
        let options = SmoothOptions { method, steps: 10, keeps_volume: true, ..LAPLACE };
        let found = smooth(rough.clone(), &options, None, Control::none()).unwrap();
        let volume = found.mesh.signed_volume();
        assert!(found.has_volume && (volume / rough.signed_volume() - 1.0).abs() < 1e-12);
        assert!(roughness(&found.mesh) < 0.5 * roughness(&rough), "{method:?}");
        let free = smoothed(&rough, SmoothOptions { keeps_volume: false, ..options });
        let kept = free.signed_volume() / rough.signed_volume();
        let is_taubin = matches!(method, SmoothMethod::Taubin { .. });
        assert!(if is_taubin { kept > 0.985 } else { kept < 0.97 }, "{method:?} {kept}");
    }
}

/// A long implicit step on a scan comes to its end, and bends less than before.
#[test]
fn an_implicit_step_smooths_the_bunny() {
    let Some(mesh) = model("stanford-bunny.obj") else { return };
    for weight in [EdgeWeight::Uniform, EdgeWeight::Cotangent] {
        let method = SmoothMethod::Implicit { lambda: 20.0 };
        let options = SmoothOptions { method, weight, borders: Borders::Fixed, ..LAPLACE };
        let found = smooth(mesh.clone(), &options, None, Control::none()).unwrap();
        assert!(found.is_solved && found.mesh.area() < 0.99 * mesh.area(), "{weight:?}");
    }
}

#[test]
fn an_open_mesh_has_no_volume_to_keep() {
    let options = SmoothOptions { keeps_volume: true, ..LAPLACE };
    assert!(!smooth(tent(), &options, None, Control::none()).unwrap().has_volume);
}

proptest! {
    #[test]
    fn any_mesh_stays_a_mesh(
        mesh in any_mesh(),
        method in prop_oneof![
            Just(SmoothMethod::Laplace { lambda: 1.0 }),
            Just(SmoothMethod::Taubin { lambda: 0.5, mu: -0.53 }),
            Just(SmoothMethod::Implicit { lambda: 100.0 }),
        ],
        weight in prop_oneof![Just(EdgeWeight::Uniform), Just(EdgeWeight::Cotangent)],
        borders in prop_oneof![Just(Borders::Fixed), Just(Borders::Curve), Just(Borders::Free)],
        keeps_volume in any::<bool>(),
    ) {
        let options = SmoothOptions { method, steps: 3, weight, borders, keeps_volume };
        let found = smoothed(&mesh, options);
        prop_assert_eq!(found.check(), Ok(()));
        prop_assert_eq!(&found.faces, &mesh.faces);
        let is_small = |p: &DVec3| p.abs().cmplt(DVec3::splat(1e9)).all();
        if mesh.positions.iter().all(is_small) && !keeps_volume {
            prop_assert!(found.positions.iter().all(|p| p.is_finite()));
        }
    }
}
