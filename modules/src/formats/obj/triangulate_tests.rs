//! Polygons whose triangles are known, and properties of all of them.

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;

fn area_of(points: &[DVec3], triangles: &[[u32; 3]]) -> (f64, DVec3) {
    let normals = triangles.iter().map(|t| 0.5 * normal_of(t.map(|i| points[i as usize])));
    normals.fold((0.0, DVec3::ZERO), |(sum, vector), n| (sum + n.length(), vector + n))
}

fn cut(points: &[DVec3]) -> (Cut, Vec<[u32; 3]>) {
    let mut triangles = Vec::new();
    let cut = Triangulator::default().cut(points, &mut triangles);
    assert_eq!(triangles.len(), points.len() - 2);
    (cut, triangles)
}

/// Asserts that the triangles cover the polygon without overlap: no sum of areas is smaller than
/// the length of the vector sum, which is the area of a plane polygon whatever its cut.
fn assert_covered(points: &[DVec3]) -> Vec<[u32; 3]> {
    let (outcome, triangles) = cut(points);
    let (sum, vector) = area_of(points, &triangles);
    assert_eq!(outcome, Cut::Exact, "{points:?}");
    assert!((sum - vector.length()).abs() <= 1e-9 * sum, "{sum} {vector} {points:?}");
    triangles
}

fn tilted(points: &[[f64; 2]]) -> Vec<DVec3> {
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -0.3);
    points.iter().map(|p| turn * DVec3::new(p[0], p[1], 3.0)).collect()
}

#[test]
fn an_arrow_is_cut_at_its_notch() {
    // The notch is vertex 3, and then, turned on by one, vertex 0.
    let arrow = tilted(&[[0.0, 0.0], [4.0, -3.0], [0.0, 6.0], [1.0, 0.5]]);
    assert_eq!(assert_covered(&arrow), [[0, 1, 3], [1, 2, 3]]);
    let turned = [arrow[3], arrow[0], arrow[1], arrow[2]];
    assert_eq!(assert_covered(&turned), [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn a_convex_quad_is_cut_from_its_first_vertex() {
    let kite = tilted(&[[0.0, 0.0], [1.0, -1.0], [5.0, 0.0], [1.0, 1.0]]);
    assert_eq!(assert_covered(&kite), [[0, 1, 2], [0, 2, 3]]);
    let on_a_side = tilted(&[[0.0, 0.0], [2.0, -1.0], [2.0, 1.0], [1.0, 0.5]]);
    assert_eq!(assert_covered(&on_a_side), [[0, 1, 3], [1, 2, 3]]);
}

#[test]
fn a_vertex_on_a_straight_edge_is_kept() {
    let mut sides = Vec::new();
    for i in 0..5 {
        sides.push([f64::from(i), 0.0]);
    }
    sides.extend([[4.0, 3.0], [2.0, 3.0], [0.0, 3.0]]);
    let points = tilted(&sides);
    let triangles = assert_covered(&points);
    for i in 0..points.len() as u32 {
        assert!(triangles.iter().flatten().any(|&v| v == i), "vertex {i} is in no triangle");
    }
    for t in &triangles {
        assert!(area_of(&points, &[*t]).0 > 0.1, "{t:?} is flat");
    }
}

#[test]
fn combs_spirals_and_stars_are_covered() {
    let comb: Vec<[f64; 2]> = (0..40)
        .map(|i| [f64::from(i / 2), if (i + 1) % 4 < 2 { 0.0 } else { 5.0 }])
        .chain([[19.0, -1.0], [0.0, -1.0]])
        .collect();
    let turns: Vec<f64> = (0..60).map(|i| f64::from(i) * 0.3).collect();
    let along =
        |offset: f64| turns.iter().map(move |&t| [(t + offset) * t.cos(), (t + offset) * t.sin()]);
    let spiral: Vec<[f64; 2]> = along(4.0).chain(along(2.0).rev()).collect();
    let star: Vec<[f64; 2]> = (0..2000)
        .map(|i| {
            let (angle, radius) = (TAU * f64::from(i) / 2000.0, 1.0 + 0.5 * f64::from(i % 2));
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    for shape in [comb, spiral, star] {
        let mut points = tilted(&shape);
        assert_covered(&points);
        points.reverse();
        assert_covered(&points);
    }
}

#[test]
fn repeated_vertices_give_flat_triangles_and_no_fan() {
    let notch =
        [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [2.0, 1.0], [0.0, 4.0], [0.0, 4.0]];
    assert_covered(&tilted(&notch));
    // A square with a square hole, joined by a bridge that is walked both ways.
    let ring = [[0.0, 0.0], [6.0, 0.0], [6.0, 6.0], [0.0, 6.0], [0.0, 0.0]];
    let hole = [[2.0, 2.0], [2.0, 4.0], [4.0, 4.0], [4.0, 2.0], [2.0, 2.0]];
    let points = tilted(&[ring, hole].concat());
    let triangles = assert_covered(&points);
    assert!((area_of(&points, &triangles).0 - 32.0).abs() < 1e-9);
}

#[test]
fn degenerate_polygons_give_a_fan() {
    let line: Vec<DVec3> = (0..7).map(|i| DVec3::splat(f64::from(i))).collect();
    assert_eq!(cut(&line).0, Cut::Fan);
    assert_eq!(cut(&[DVec3::ONE; 9]).0, Cut::Fan);
    let eight = tilted(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0], [-1.0, 1.0]]);
    assert_eq!(cut(&eight).1.len(), 3);
    assert_eq!(
        cut(&[DVec3::splat(1e308), -DVec3::splat(1e308), DVec3::X, DVec3::Y, DVec3::Z]).0,
        Cut::Fan
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A polygon that is star-shaped around the origin is simple, whatever its radii.
    #[test]
    fn star_shaped_polygons_are_covered(radii in prop::collection::vec(0.05..1.0_f64, 5..60)) {
        let n = radii.len() as f64;
        let shape: Vec<[f64; 2]> = radii.iter().enumerate().map(|(i, r)| {
            let angle = TAU * i as f64 / n;
            [r * angle.cos(), r * angle.sin()]
        }).collect();
        assert_covered(&tilted(&shape));
    }
}
