//! Tests of what costs nothing, of turns that adapt and of thin faces that wait.

use glam::DVec3;
use mve_mesh::data::VertexId;

use super::tests::{cube, grid, run_with, to_faces, torus};
use super::*;
use crate::cost::{EdgeLength, Quadric};
use crate::placement::{Midpoint, Optimal};

#[test]
fn a_cost_of_zero_leaves_what_is_flat_in_few_faces() {
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2);
    // As it is; turned, so that no plane is exact; rounded to seven digits.
    let exact = |p: DVec3| p;
    let turned = |p: DVec3| turn * p;
    let rounded = |p: DVec3| ((turn * p) * 1e6).round() / 1e6;
    for place in [&exact as &dyn Fn(DVec3) -> DVec3, &turned, &rounded] {
        let mut mesh = cube();
        mesh.positions.iter_mut().for_each(|p| *p = place(*p));
        let stop = Stop { cost: Some(0.0), ..Stop::default() };
        let options = SimplifyOptions { stop, ..SimplifyOptions::default() };
        let result = run_with(&mesh, Quadric::default(), Optimal::default(), options);
        let found = result.statistics;
        assert_eq!((found.n_faces, found.outcome), (12, Outcome::CostReached));
        assert_eq!(found.largest_cost, Some(0.0));
        assert!((result.mesh.signed_volume() - 512.0).abs() < 1e-3);
    }
    // What is bent stays: a vertex of this sheet lies off the plane of its neighbors.
    let sheet = grid(6, |x, y| 0.01 * (x * x + y * y));
    let stop = Stop { cost: Some(0.0), ..Stop::default() };
    let options = SimplifyOptions { stop, ..SimplifyOptions::default() };
    let result = run_with(&sheet, Quadric::default(), Optimal::default(), options);
    assert_eq!(result.statistics.n_faces, sheet.faces.len());
}

#[test]
fn turns_adapt_where_the_target_needs_it_and_a_fixed_limit_is_named() {
    let mesh = torus(24);
    let quarter = Turns::UpTo(std::f64::consts::FRAC_PI_4);
    let by_length = |n, turns| {
        let options = SimplifyOptions { turns, ..to_faces(n) };
        run_with(&mesh, EdgeLength, Midpoint, options).statistics
    };
    let by_quadric = |n, turns| {
        let options = SimplifyOptions { turns, ..to_faces(n) };
        run_with(&mesh, Quadric::default(), Optimal::default(), options).statistics
    };
    for narrow in [by_length(40, Turns::UpTo(0.2)), by_quadric(40, Turns::UpTo(0.2))] {
        assert_eq!((narrow.outcome, narrow.n_wide_turns), (Outcome::Exhausted, 0));
        let blocked = narrow.blocked.unwrap();
        assert!(blocked.turn > 50 && blocked.rules == 0 && blocked.price == 0, "{blocked:?}");
    }
    // A cost that is not patient keeps to 45 degrees until nothing else is left.
    let [fixed, adaptive] = [quarter, Turns::Adaptive].map(|turns| by_length(20, turns));
    assert!(fixed.blocked.unwrap().turn > 0 && fixed.n_faces > 20, "{fixed:?}");
    assert_eq!((adaptive.outcome, adaptive.blocked), (Outcome::TargetReached, None));
    assert!(adaptive.n_wide_turns > 0 && by_length(40, Turns::Adaptive).n_wide_turns == 0);
    let [fixed, adaptive] = [quarter, Turns::Adaptive].map(|turns| by_quadric(16, turns));
    assert!(adaptive.n_faces < fixed.n_faces && adaptive.blocked.unwrap().turn == 0);
}

#[test]
fn thin_faces_wait_at_no_loss() {
    let mesh = torus(40);
    let run = |sliver_angle_rad| {
        let options = SimplifyOptions { sliver_angle_rad, ..to_faces(600) };
        run_with(&mesh, Quadric::default(), Optimal::default(), options)
    };
    let n_thin = |mesh: &TriMesh| {
        let smallest = |face: &[VertexId; 3]| {
            let at = face.map(|v| mesh.positions[v.idx()]);
            let angle = |k: usize| (at[(k + 1) % 3] - at[k]).angle_between(at[(k + 2) % 3] - at[k]);
            (0..3).map(angle).fold(f64::MAX, f64::min)
        };
        mesh.faces.iter().filter(|face| smallest(face) < 10f64.to_radians()).count()
    };
    let (without, with) = (run(None), run(Some(10f64.to_radians())));
    assert_eq!(without.mesh.faces.len(), with.mesh.faces.len());
    let [before, after] = [&without, &with].map(|result| n_thin(&result.mesh));
    assert!(after * 2 < before, "{before} thin faces became {after}");
    let [cheap, dear] = [without, with].map(|result| result.statistics.largest_cost.unwrap());
    assert!(dear < 4.0 * cheap, "{cheap} became {dear}");
}
