//! Simplificator as its parameters say.

use mve_core::testing::Trial;
use mve_mesh::data::VertexId;
use mve_mesh::fixtures::mesh_of;
use serde_json::json;

use crate::geometry::generate::{BoxOptions, subdivided_box};
use crate::prelude::*;

fn simplified(params: &[(&str, serde_json::Value)]) -> TriMesh {
    simplified_from(subdivided_box(&BoxOptions::DEFAULT), params)
}

fn simplified_from(mesh: TriMesh, params: &[(&str, serde_json::Value)]) -> TriMesh {
    let trial = Trial::of(&super::MODULE).input("mesh", mesh);
    let trial = params.iter().fold(trial, |trial, (name, value)| trial.set(name, value.clone()));
    trial.run().unwrap()["mesh"].clone().take().unwrap()
}

#[test]
fn a_box_keeps_its_volume_and_area_by_quadrics() {
    let mesh = simplified(&[("target_faces", json!(12))]);
    assert_eq!(mesh.faces.len(), 12);
    assert!((mesh.signed_volume() - 1.0).abs() < 1e-9 && (mesh.area() - 6.0).abs() < 1e-9);
}

#[test]
fn faces_that_share_no_vertices_are_joined_where_that_is_asked_for() {
    let whole = subdivided_box(&BoxOptions::DEFAULT);
    let corners = whole.faces.iter().flatten().map(|vertex| whole.positions[vertex.idx()]);
    let faces = (0..whole.faces.len() as u32).map(|f| [0, 1, 2].map(|k| VertexId(3 * f + k)));
    let soup = TriMesh::new(corners.collect(), faces.collect());
    assert_eq!(simplified_from(soup.clone(), &[]).faces.len(), 768);
    let welded = simplified_from(soup, &[("weld", json!(0.0)), ("target_faces", json!(12))]);
    assert_eq!(welded.faces.len(), 12);
    assert!((welded.signed_volume() - 1.0).abs() < 1e-9);
}

#[test]
fn a_missed_target_names_the_limit_and_what_to_set() {
    let run = |flip_angle: serde_json::Value| {
        let trial = Trial::of(&super::MODULE).input("mesh", ball());
        trial.set("target_faces", json!(8)).set("flip_angle", flip_angle).log().unwrap()
    };
    let lines = run(json!(1.0)).join("\n");
    assert!(lines.contains("more than flip_angle 1 (set flip_angle higher)"), "{lines}");
    assert!(!run(json!(null)).join("\n").contains("flip_angle"));
}

/// A ball of 768 faces.
fn ball() -> TriMesh {
    let mut mesh = subdivided_box(&BoxOptions::DEFAULT);
    let (low, high) = mesh.bounds().unwrap();
    mesh.positions.iter_mut().for_each(|p| *p = (*p - low.midpoint(high)).normalize());
    mesh
}

#[test]
fn quadrics_begin_and_the_cost_ends_where_that_is_asked_for() {
    let run = |head_start: serde_json::Value, target: i64| {
        simplified_from(
            ball(),
            &[
                ("cost", json!("LindstromTurk")),
                ("placement", json!("LindstromTurk")),
                ("target_faces", json!(target)),
                ("head_start", head_start),
            ],
        )
    };
    // The volume is kept by the cost alone, so what is lost of it says how much it did.
    let lost = |mesh: &TriMesh| (ball().signed_volume() - mesh.signed_volume()).abs();
    let [alone, half, hardly] = [json!(null), json!(2.0), json!(1.0)].map(|start| run(start, 80));
    assert_eq!([alone.faces.len(), half.faces.len(), hardly.faces.len()], [80; 3]);
    assert!(lost(&alone) < 1e-9 && lost(&half) > 1e-6, "{} {}", lost(&alone), lost(&half));
    assert!(lost(&hardly) > 2.0 * lost(&half), "{} {}", lost(&hardly), lost(&half));
    // There is nothing to begin with.
    assert_eq!(run(json!(3.0), 400).positions, run(json!(null), 400).positions);
}

#[test]
fn targets_placements_and_costs_are_followed() {
    assert_eq!(simplified(&[]).faces.len(), 384);
    assert_eq!(simplified(&[("ratio", json!(0.25))]).faces.len(), 192);
    let by_cost = [("ratio", json!(null)), ("largest_cost", json!(0.0))];
    assert_eq!(simplified(&by_cost).faces.len(), 12);
    let ends = simplified(&[("placement", json!("Endpoint")), ("cost", json!("EdgeLength"))]);
    let originals = subdivided_box(&BoxOptions::DEFAULT).positions;
    assert!(ends.positions.iter().all(|p| originals.contains(p)));
}

/// Two faces over one edge, turned by 160 degrees, and a face of half a degree at one of them.
#[test]
fn statistics_count_folds_and_slivers_of_the_result() {
    let (sin, cos) = f64::to_radians(160.0).sin_cos();
    let tops = [[0.0, 1.0, 0.0], [0.0, -cos, sin]];
    let points = [[0.0; 3], [1.0, 0.0, 0.0], tops[0], tops[1], [-0.01, 1.0, 0.0]];
    let mesh = mesh_of(&points, &[[0, 1, 2], [1, 0, 3], [0, 2, 4]]);
    let trial = Trial::of(&super::MODULE).input("mesh", mesh).set("ratio", 1.0);
    let outputs = trial.run().unwrap();
    let found = outputs["statistics"].get::<Measures>().unwrap();
    let number = |name: &str| found.0.iter().find(|m| m.name == name).unwrap().value;
    assert_eq!([number("folded_edges"), number("slivers")], [1.0, 1.0]);
}

#[test]
fn places_of_the_input_stay_so_where_quadrics_begin() {
    let ends = simplified_from(ball(), &[("placement", json!("Endpoint")), ("ratio", json!(0.1))]);
    let originals = ball().positions;
    assert!(ends.positions.iter().all(|p| originals.contains(p)));
}

#[test]
fn small_components_are_kept_or_go() {
    // A ball, and two of a hundredth of its size beside it.
    let big = ball();
    let n = big.positions.len() as u32;
    let mut mesh = big.clone();
    for shift in 1..3_u32 {
        let place = |p: &glam::DVec3| *p * 0.01 + 2.0 * f64::from(shift) * glam::DVec3::X;
        mesh.positions.extend(big.positions.iter().map(place));
        let moved = |face: &[VertexId; 3]| face.map(|v| VertexId(v.0 + shift * n));
        mesh.faces.extend(big.faces.iter().map(moved));
    }
    let run = |policy: &str| {
        let params = [("small_components", json!(policy)), ("target_faces", json!(1700))];
        simplified_from(mesh.clone(), &params)
    };
    let n_right_of_it = |mesh: &TriMesh| mesh.positions.iter().filter(|p| p.x > 1.5).count();
    assert_eq!(run("Removed").faces.len(), big.faces.len());
    assert_eq!(n_right_of_it(&run("Removed")), 0);
    let kept = run("Kept");
    assert_eq!(kept.faces.len(), 1700);
    let small =
        |mesh: &TriMesh| mesh.positions.iter().copied().filter(|p| p.x > 1.5).collect::<Vec<_>>();
    assert_eq!(small(&kept), small(&mesh));
    assert!(n_right_of_it(&run("Simplified")) < 2 * n as usize);
}
