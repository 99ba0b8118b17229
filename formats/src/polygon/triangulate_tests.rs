//! Polygons whose triangles are known, and properties of all of them.

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use proptest::prelude::*;

use super::*;

fn area_of(points: &[DVec3], triangles: &[[u32; 3]]) -> (f64, DVec3) {
    let normals = triangles.iter().map(|t| 0.5 * normal_of(t.map(|i| points[i as usize])));
    normals.fold((0.0, DVec3::ZERO), |(sum, vector), n| (sum + n.length(), vector + n))
}

fn cut(points: &[DVec3]) -> (Cut, Vec<[u32; 3]>) {
    let mut triangles = Vec::new();
    let cut = Triangulator::default().cut(points, &mut triangles, Control::none()).unwrap();
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

/// A plate of n × n units, each with a square hole of half its width, whose holes are joined to the
/// border from below by bridges.
fn grating(n: i32) -> Vec<[f64; 2]> {
    let (mut points, n_units) = (Vec::new(), f64::from(n));
    for column in (0..n).map(f64::from) {
        let (left, right) = (column + 0.25, column + 0.75);
        // Up along the left sides, over the others on the way down.
        for row in (0..n).map(f64::from) {
            points.extend([[left, row], [left, row + 0.25], [left, row + 0.75]]);
        }
        for row in (0..n).rev().map(f64::from) {
            if row + 1.0 < n_units {
                points.push([left, row + 0.75]);
            }
            points.extend([[right, row + 0.75], [right, row + 0.25]]);
            points.extend([[left, row + 0.25], [left, row]]);
        }
    }
    points.extend([[n_units, 0.0], [n_units, n_units], [0.0, n_units], [0.0, 0.0]]);
    points
}

#[test]
fn many_holes_are_left_out_however_many_corners_there_are() {
    for n in [2, 5, 40] {
        let points = grating(n);
        let area = 0.75 * f64::from(n * n);
        for points in
            [tilted(&points), points.iter().map(|p| DVec3::new(p[0], 0.0, p[1])).collect()]
        {
            let (found, vector) = area_of(&points, &assert_covered(&points));
            assert!((found - area).abs() < 1e-9 * area, "{found} {area} {vector}");
        }
    }
}

#[test]
fn details_far_smaller_than_the_polygon_are_cut() {
    // Teeth of a micrometer along a kilometer, at map coordinates.
    for n in [20, 2000] {
        let step = 1000.0 / f64::from(n);
        let teeth = (0..n).flat_map(|i| {
            let x = 500_000.0 + step * f64::from(i);
            [[x, 5e6], [x + 0.5 * step, 5e6 + 1e-6]]
        });
        let shape: Vec<[f64; 2]> = teeth
            .chain([[501_000.0, 5e6], [501_000.0, 5e6 + 1.0], [500_000.0, 5e6 + 1.0]])
            .collect();
        let points: Vec<DVec3> = shape.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect();
        let (found, _) = area_of(&points, &assert_covered(&points));
        assert!((found - 1000.0).abs() < 1e-2, "{found}");
    }
}

#[test]
fn large_concave_polygons_take_no_square_of_time() {
    let n = 30_000;
    let coast: Vec<[f64; 2]> = (0..n)
        .map(|i| {
            let angle = TAU * f64::from(i) / f64::from(n);
            let radius = 2.0
                + (7.0 * angle).sin()
                + 0.3 * (91.0 * angle).cos()
                + 0.01 * f64::from(i * 7919 % 101) / 101.0;
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    assert_covered(&tilted(&coast));
    let star = (0..n).map(|i| {
        let (angle, radius) = (TAU * f64::from(i) / f64::from(n), 1.0 + 0.5 * f64::from(i % 2));
        [radius * angle.cos(), radius * angle.sin()]
    });
    assert_covered(&tilted(&star.collect::<Vec<_>>()));
    let comb: Vec<[f64; 2]> = (0..n)
        .map(|i| [f64::from(i / 2), if (i + 1) % 4 < 2 { 0.0 } else { 5000.0 }])
        .chain([[f64::from(n / 2 - 1), -1.0], [0.0, -1.0]])
        .collect();
    assert_covered(&tilted(&comb));
}

/// A tooth a unit over a strip of height 1, each a triangle with its tip moved aside by `slant`
/// times its height, which is this part of the number of teeth; and the area of all that.
fn slanting_comb(n_teeth: u32, slant: f64, height: impl Fn(u32) -> f64) -> (Vec<DVec3>, f64) {
    let (mut area, mut shape) = (f64::from(n_teeth), Vec::new());
    for k in 0..n_teeth {
        let (x, y) = (f64::from(k), f64::from(n_teeth) * height(k));
        shape.extend([[x, 0.0], [x + 0.5 + slant * y, y]]);
        area += 0.5 * y;
    }
    let end = f64::from(n_teeth);
    shape.extend([[end, 0.0], [end, -1.0], [0.0, -1.0]]);
    (shape.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect(), area)
}

/// Each tooth crosses thousands of edges of a triangulation of the corners alone: with all points
/// inserted first, this takes minutes.
#[test]
fn long_slanting_teeth_take_no_square_of_time() {
    let random = mve_mesh::random::IndexedRandom::new(3);
    for (slant, is_even) in [(0.3, true), (2.0, true), (0.7, false)] {
        let height = |k: u32| if is_even { 1.0 } else { random.unit(u64::from(k)) };
        let (mut points, area) = slanting_comb(20_000, slant, height);
        for _ in 0..2 {
            let (found, _) = area_of(&points, &assert_covered(&points));
            assert!((found - area).abs() < 1e-9 * area, "{found} {area}");
            points.reverse();
        }
    }
}

/// Cuts until the look of this number whether to go on; returns how many there were.
fn cut_until(points: &[DVec3], last: usize) -> (Result<Cut, Cancelled>, usize) {
    let n_looks = AtomicUsize::new(0);
    let look = |_| match n_looks.fetch_add(1, Ordering::Relaxed) {
        n if n < last => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    let control = Control::new(&look);
    let cut = Triangulator::default().cut(points, &mut Vec::new(), control);
    (cut, n_looks.into_inner())
}

#[test]
fn a_cancel_is_heard_at_any_stage() {
    let (comb, _) = slanting_comb(20_000, 0.3, |_| 1.0);
    // A star of chords, each from one side to the other.
    let chord = |k: u32| TAU * f64::from(k * 10_000 % 20_001) / 20_001.0;
    let crossing: Vec<DVec3> =
        (0..20_001).map(|k| DVec3::new(chord(k).cos(), chord(k).sin(), 0.0)).collect();
    for points in [comb, crossing] {
        let (_, all) = cut_until(&points, usize::MAX);
        for last in [0, 3, all / 3, all - 1] {
            assert_eq!(cut_until(&points, last), (Err(Cancelled), last + 1), "of {all}");
        }
    }
}

#[test]
fn spikes_and_corners_on_own_edges_lose_no_area() {
    // A square with a spike outside that is walked there and back, and one inside.
    let mut shape = vec![[0.0, 0.0], [2.0, 0.0], [5.0, 0.0], [9.0, 0.0], [5.0, 0.0], [2.0, 0.0]];
    shape.extend([[2.0, 2.0], [1.0, 1.0], [2.0, 2.0], [0.0, 2.0]]);
    for n_more in [0, 200] {
        let mut points = shape.clone();
        let more = (1..=n_more).map(|i| [0.0, 2.0 - 2.0 * f64::from(i) / f64::from(n_more + 1)]);
        points.extend(more);
        let points: Vec<DVec3> = points.iter().map(|p| DVec3::new(p[0], p[1], 1.0)).collect();
        assert!((area_of(&points, &assert_covered(&points)).0 - 4.0).abs() < 1e-12);
    }
    // A hole that touches the side of the square, its corner in the midst of an edge.
    let mut shape = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0], [2.0, 0.0]];
    shape.extend([[1.0, 2.0], [3.0, 2.0], [2.0, 0.0]]);
    let points: Vec<DVec3> = shape.iter().map(|p| DVec3::new(p[0], p[1], 1.0)).collect();
    let mut triangles = Vec::new();
    let cut = Triangulator::default().cut(&points, &mut triangles, Control::none());
    assert_eq!(cut, Ok(Cut::Exact));
    assert!((area_of(&points, &triangles).0 - 14.0).abs() < 1e-12);
}

#[test]
fn work_on_one_polygon_is_no_debt_of_the_next() {
    let n = 3000;
    let crossing: Vec<DVec3> = (0..n)
        .map(|i| {
            let angle = TAU * 7.0 * f64::from(i) / f64::from(n);
            let radius = 1.0 + 0.5 * (3.1 * angle).sin();
            DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        })
        .collect();
    let comb: Vec<[f64; 2]> = (0..200)
        .map(|i| [f64::from(i / 2), if (i + 1) % 4 < 2 { 0.0 } else { 5.0 }])
        .chain([[99.0, -1.0], [0.0, -1.0]])
        .collect();
    let mut triangulator = Triangulator::default();
    for _ in 0..4 {
        let mut triangles = Vec::new();
        let control = Control::none();
        assert_eq!(triangulator.cut(&crossing, &mut triangles, control), Ok(Cut::Fan));
        assert_eq!(triangles.len(), crossing.len() - 2);
        let cut = triangulator.cut(&tilted(&comb), &mut triangles, control);
        assert_eq!(cut, Ok(Cut::Exact));
    }
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
