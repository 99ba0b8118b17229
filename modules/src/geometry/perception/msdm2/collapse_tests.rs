//! The cost: what it says on meshes whose answer is known, and how it compares.

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::TriMesh;
use mve_mesh::fixtures::torus;

use super::collapse::Counting;
use super::tests::measured_published;
use crate::cost::{Msdm2, Quadric};
use crate::geometry::generate::{BoxOptions, subdivided_box};
use crate::geometry::simplify::collapse::Cost;
use crate::geometry::simplify::collapse::{Simplified, SimplifyOptions, Stop, simplify};
use crate::placement::Midpoint;
use crate::test_models::model;

fn simplified(mesh: &TriMesh, cost: &mut dyn Cost, faces: usize) -> Simplified {
    let stop = Stop { faces: Some(faces), ..Stop::default() };
    let options = SimplifyOptions { stop, ..SimplifyOptions::DEFAULT };
    simplify(mesh, cost, &mut Midpoint, options, Control::none()).unwrap()
}

/// Within the sides of a box nothing bends, before a collapse and after: it is free, and so all
/// that can go without the edges of the box goes first.
#[test]
fn flat_collapses_cost_nothing() {
    let mesh = subdivided_box(&BoxOptions { segments: 4, ..BoxOptions::DEFAULT });
    let found = simplified(&mesh, &mut Msdm2::new(&mesh, 3, Counting::Merged), 150);
    let dearest = found.statistics.largest_cost.unwrap();
    assert!(dearest < 1e-9, "{dearest}");
    assert!(measured_published(&mesh, &found.mesh).from_simplified.value < 1e-9);
    assert!((found.mesh.signed_volume() - 1.0).abs() < 1e-12);
}

/// The price of the first collapse is what the metric says after it: here edges are longer than
/// windows are wide.
#[test]
fn the_first_price_is_what_the_metric_finds() {
    for n in [8, 12, 16] {
        let mesh = torus(2.0, 0.5, n);
        let mut cost = Msdm2::new(&mesh, 3, Counting::Once);
        let found = simplified(&mesh, &mut cost, mesh.faces.len() - 2);
        let price = found.statistics.largest_cost.unwrap();
        let one_sided = measured_published(&mesh, &found.mesh).from_simplified;
        let sum = one_sided.value.powi(3) * one_sided.n_vertices as f64;
        assert!(sum > 0.0 && (price - sum).abs() < 1e-6 * sum, "{n}: {price} {sum}");
    }
}

/// On a real mesh the cost leaves less of its metric than quadrics do.
#[test]
fn the_metric_is_lower_than_by_quadrics() {
    let Some(mesh) = model("suzanne.obj") else { return };
    let by = |cost: &mut dyn Cost| {
        measured_published(&mesh, &simplified(&mesh, cost, 484).mesh).symmetric()
    };
    let quadric = by(&mut Quadric::default());
    for counting in [Counting::Merged, Counting::Once] {
        let found = by(&mut Msdm2::new(&mesh, 3, counting));
        assert!(found < 0.95 * quadric, "{counting:?}: {found} {quadric}");
    }
}

#[test]
fn threads_change_no_bit() {
    let mesh = torus(2.0, 0.5, 16);
    let on = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let mut cost = Msdm2::new(&mesh, 3, Counting::Merged);
        pool.install(|| simplified(&mesh, &mut cost, 200).mesh)
    };
    assert_eq!(on(1), on(5));
}

/// Fans of hundreds of faces, coordinates that are not numbers and meshes without a surface go
/// through.
#[test]
fn odd_meshes_go_through() {
    let rim = |k: u32| {
        let angle = f64::from(k) / 300.0 * std::f64::consts::TAU;
        DVec3::new(angle.cos(), angle.sin(), 0.1 * (7.0 * angle).sin())
    };
    let mut positions = vec![DVec3::new(0.0, 0.0, 0.3)];
    positions.extend((0..300).map(rim));
    let faces = (0..300).map(|k| [0, k + 1, (k + 1) % 300 + 1].map(mve_mesh::data::VertexId));
    let fan = TriMesh::new(positions, faces.collect());
    let mut broken = torus(2.0, 0.5, 8);
    broken.positions[3].x = f64::NAN;
    broken.positions[9].z = f64::INFINITY;
    for mesh in [fan, broken, TriMesh::default()] {
        let found = simplified(&mesh, &mut Msdm2::new(&mesh, 3, Counting::Merged), 30);
        assert_eq!(found.mesh.check(), Ok(()));
    }
}
