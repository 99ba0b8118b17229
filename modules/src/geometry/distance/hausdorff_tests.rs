//! Tests of the distances between two surfaces.

use std::ops::ControlFlow;

use mve_mesh::fixtures::{self, mesh_of, tetrahedron};
use mve_mesh::random::IndexedRandom;
use proptest::prelude::*;

use super::*;
use crate::cost::Quadric;
use crate::geometry::generate::subdivided_box::{BoxOptions, subdivided_box};
use crate::geometry::simplify::collapse::{SimplifyOptions, Stop, simplify};
use crate::placement::Optimal;

fn measure(a: &TriMesh, b: &TriMesh) -> Hausdorff {
    let options = HausdorffOptions { n_samples: Some(20_000), ..Default::default() };
    hausdorff(a, b, &options, Control::none()).unwrap()
}

fn square(z: f64) -> TriMesh {
    let corners = [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    mesh_of(&corners, &[[0, 1, 2], [0, 2, 3]])
}

/// The unit cube moved along x.
fn cube(x: f64) -> TriMesh {
    fixtures::cube(DVec3::X * x)
}

#[test]
fn parallel_squares_are_their_distance_apart_everywhere() {
    let found = measure(&square(0.0), &square(0.25));
    for side in [found.from_original, found.from_simplified] {
        assert_eq!((side.max, side.max_upper_bound), (0.25, Some(0.25)));
        assert!((side.mean - 0.25).abs() < 1e-12 && (side.rms - 0.25).abs() < 1e-12);
    }
    assert_eq!(found.original_distance.values, [0.25; 4]);
}

#[test]
fn a_mesh_against_itself_is_zero() {
    let found = measure(&tetrahedron(), &tetrahedron());
    assert!(found.max() < 1e-15 && found.rms() < 1e-15);
    assert!(found.max_upper_bound().unwrap() < 1e-9 * found.diagonal);
}

/// The cube moved by 1/4 along x. Of the original the face x = 0 is 1/4 from the other, which also
/// has its side faces up to 1/4 nearer: a point at height h over the nearest edge is min(1/4, …),
/// and side faces are inside the other's sides but for the first quarter.
#[test]
fn a_shifted_cube() {
    let found = measure(&cube(0.0), &cube(0.25));
    let side = found.from_original;
    assert!((side.max - 0.25).abs() < 1e-12);
    assert!((0.25 - 1e-12..0.2525 + 1e-12).contains(&side.max_upper_bound.unwrap()));
    // Face x = 0: exactly 1/4, area 1. Face x = 1 lies within the other cube, whose nearest face
    // is x = 5/4, or a side at distance s: the mean of min(1/4, s) over the unit square, s the
    // distance from its border, is the integral of (1 - 2 s)² over s from 0 to 1/4 = 7/48.
    // Four sides: distance 1/4 - x for x below 1/4, mean 1/32 each.
    let expected = (0.25 + 7.0 / 48.0 + 4.0 / 32.0) / 6.0;
    assert!((side.mean - expected).abs() < 1e-4, "{} {expected}", side.mean);
    assert!((found.from_simplified.mean - expected).abs() < 1e-4);
}

/// A point of a large triangle far from all vertices: only bisection finds it exactly.
#[test]
fn the_maximum_may_be_inside_a_face() {
    // Two copies of a corner of the flat triangle, apart: the farthest point is between them.
    let wide = mesh_of(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1e-3, 0.0]], &[[0, 1, 2]]);
    let ends = mesh_of(
        &[
            [-1.0, 0.0, 0.0],
            [-0.9, 0.0, 0.0],
            [-1.0, 0.0, 1.0],
            [1.0, 0.0, 0.0],
            [0.9, 0.0, 0.0],
            [1.0, 0.0, 1.0],
        ],
        &[[0, 1, 2], [3, 5, 4]],
    );
    let options =
        HausdorffOptions { n_samples: Some(10), max_tolerance: Some(1e-9), ..Default::default() };
    let found = hausdorff(&wide, &ends, &options, Control::none()).unwrap().from_original;
    let expected = 0.9f64.hypot(1e-3);
    assert!((found.max - expected).abs() < 1e-8, "{}", found.max);
    assert!(found.max_upper_bound.unwrap() >= expected - 1e-12);
}

#[test]
fn edges_enter_the_maximum_only() {
    let options = HausdorffOptions {
        n_samples: Some(2000),
        n_edge_samples: 2000,
        max_tolerance: None,
        ..Default::default()
    };
    let without = HausdorffOptions { n_edge_samples: 0, ..options };
    let (a, b) = (cube(0.0), tetrahedron());
    let with = hausdorff(&a, &b, &options, Control::none()).unwrap();
    let without = hausdorff(&a, &b, &without, Control::none()).unwrap();
    assert_eq!(with.mean(), without.mean());
    assert!(with.max() >= without.max());
    assert_eq!(with.max_upper_bound(), None);
}

#[test]
fn meshes_without_a_surface_are_errors() {
    let none = Control::none();
    let options = HausdorffOptions::default();
    let empty = hausdorff(&TriMesh::default(), &tetrahedron(), &options, none);
    assert_eq!(empty, Err(HausdorffError::NoFaces(MeshRole::Original)));
    let bad = mesh_of(&[[f64::NAN; 3]], &[[0, 0, 0]]);
    let found = hausdorff(&tetrahedron(), &bad, &options, none);
    assert_eq!(found, Err(HausdorffError::NothingFinite(MeshRole::Simplified, 1)));
}

#[test]
fn a_segment_is_measured_over_its_vertices() {
    let segment = mesh_of(&[[0.0, 0.0, 1.0], [1.0, 1.0, 3.0]], &[[0, 1, 1]]);
    let found = measure(&segment, &square(0.0)).from_original;
    assert_eq!((found.max, found.mean, found.n_samples), (3.0, 2.0, 0));
}

#[test]
fn a_face_that_is_not_finite_is_left_out() {
    let mut broken = square(0.25);
    broken.positions.push(DVec3::NAN);
    broken.faces.push([0, 1, 4].map(mve_mesh::data::VertexId));
    let found = measure(&square(0.0), &broken);
    assert_eq!((found.n_left_out_simplified, found.max()), (1, 0.25));
    assert!(found.simplified_distance.values[4].is_nan());
    assert!((measure(&broken, &square(0.0)).diagonal - 2f64.sqrt()).abs() < 1e-15);
}

#[test]
fn a_cancelled_measure_ends() {
    let control = Control::new(&|fraction| {
        if fraction > 0.3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let found = hausdorff(&cube(0.0), &cube(1.0), &HausdorffOptions::default(), control);
    assert_eq!(found, Err(HausdorffError::Cancelled(Cancelled)));
}

#[test]
fn one_thread_and_many_agree_to_the_bit() {
    let options =
        HausdorffOptions { n_samples: Some(50_000), n_edge_samples: 20_000, ..Default::default() };
    let with_threads = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| hausdorff(&cube(0.1), &tetrahedron(), &options, Control::none()).unwrap())
    };
    let one = with_threads(1);
    assert_eq!(one, with_threads(2));
    assert_eq!(one, with_threads(5));
}

/// Both surfaces are the same box: parts of one are over many coplanar triangles of the other.
/// Without cutting them along those triangles 400,000 parts leave a bound of 2e-4.
#[test]
fn two_triangulations_of_a_box_are_at_no_distance() {
    let fine = subdivided_box(&BoxOptions::default());
    let options = SimplifyOptions {
        stop: Stop { faces: Some(300), ..Stop::default() },
        ..SimplifyOptions::default()
    };
    let (mut cost, mut placement) = (Quadric::default(), Optimal::default());
    let coarse = simplify(&fine, &mut cost, &mut placement, options, Control::none()).unwrap().mesh;
    let options =
        HausdorffOptions { n_samples: Some(100), max_parts: 0, ..HausdorffOptions::DEFAULT };
    let found = hausdorff(&fine, &coarse, &options, Control::none()).unwrap();
    assert!(found.max_upper_bound().unwrap() < 1e-14 * found.diagonal, "{found:?}");
}

/// Strips of a thousandth of their length, turned against each other.
#[test]
fn slivers_over_slivers_are_at_no_distance() {
    let strips = |n: u32, turn: f64| {
        let (sin, cos) = turn.sin_cos();
        let at = |x: f64, y: f64| [cos * x - sin * y, sin * x + cos * y, 0.0];
        let points: Vec<[f64; 3]> =
            (0..=n).flat_map(|k| [-1.0, 1.0].map(|x| at(x, f64::from(k) * 1e-3))).collect();
        let faces: Vec<[u32; 3]> = (0..n)
            .flat_map(|k| [[2 * k, 2 * k + 1, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 2]])
            .collect();
        mesh_of(&points, &faces)
    };
    for turn in [0.0, 1e-12, 1e-9, 1e-7] {
        let found = measure(&strips(24, 0.0), &strips(15, turn)).from_simplified;
        let expected = 2.0 * turn;
        let bound = found.max_upper_bound.unwrap();
        assert!(found.max <= expected + 1e-15 && bound >= found.max && bound < 1e-6, "{found:?}");
    }
}

/// A sheet of `n` by `n` squares over the unit square, bent by `bend` and turned in its plane.
fn sheet(n: u32, bend: f64, turn: f64, shifts: &[f64]) -> TriMesh {
    let row = n + 1;
    let points: Vec<[f64; 3]> = (0..row * row)
        .map(|k| {
            let shift = |m: usize| shifts[m % shifts.len()] * 0.4 / f64::from(n);
            let (i, j) = (k / row, k % row);
            let (x, y) = (f64::from(i) / f64::from(n) - 0.5, f64::from(j) / f64::from(n) - 0.5);
            let (x, y) = (x + shift(k as usize), y + shift(3 * k as usize + 1));
            let (sin, cos) = turn.sin_cos();
            [cos * x - sin * y, sin * x + cos * y, bend * (3.0 * x).sin() * (2.0 * y).cos()]
        })
        .collect();
    let corner = |k: u32| k / n * row + k % n;
    let faces: Vec<[u32; 3]> = (0..n * n)
        .map(corner)
        .flat_map(|k| [[k, k + row, k + row + 1], [k, k + row + 1, k + 1]])
        .collect();
    mesh_of(&points, &faces)
}

/// No point of a grid on the faces of `from` is farther than the bound, but for rounding.
fn is_bounded(from: &TriMesh, to: &TriMesh, found: &Directed) -> bool {
    let bvh = Bvh::build(to, Control::none()).unwrap();
    let bound = found.max_upper_bound.unwrap() + 1e-14;
    let n = 12;
    (0..from.faces.len()).map(|f| from.corners(mve_mesh::data::FaceId(f as u32))).all(
        |[a, b, c]| {
            (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))).all(|(i, j)| {
                let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                let point = a + (b - a) * s + (c - a) * t;
                bvh.closest(point).is_some_and(|hit| hit.distance_sq.sqrt() <= bound)
            })
        },
    )
}

/// Thin faces in all directions through a cube.
fn straw(seed: u64, n: u32) -> TriMesh {
    let random = IndexedRandom::new(seed);
    let vector = |k: u64| DVec3::from([0, 1, 2].map(|axis| random.unit(9 * k + axis) - 0.5));
    let ends =
        |k: u64| [vector(3 * k), vector(3 * k + 1), vector(3 * k) + vector(3 * k + 2) * 1e-3];
    let points: Vec<_> = (0..u64::from(n)).flat_map(ends).map(|p| p.to_array()).collect();
    mesh_of(&points, &(0..n).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect::<Vec<_>>())
}

#[test]
fn long_thin_faces_are_bounded_in_few_parts() {
    let n = 2000;
    let (a, b) = (straw(1, n), straw(2, n));
    let options =
        HausdorffOptions { n_samples: Some(100), max_parts: n as usize, ..Default::default() };
    let found = hausdorff(&a, &b, &options, Control::none()).unwrap();
    for (from, to, side) in [(&a, &b, found.from_original), (&b, &a, found.from_simplified)] {
        // Quartered, they would be bounded by 8 times the largest distance by then.
        assert!(side.max_upper_bound.unwrap() <= side.max * 1.010001, "{side:?}");
        assert!(is_bounded(from, to, &side));
    }
}

fn soup() -> impl Strategy<Value = TriMesh> {
    let point = prop::array::uniform3(-1.0..1.0f64);
    prop::collection::vec(point, 3..30).prop_map(|points| {
        let faces: Vec<[u32; 3]> =
            (0..points.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        mesh_of(&points, &faces)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The bound holds on surfaces that nearly coincide, flat ones included, however coarse the
    /// tolerance and however early the search ends.
    #[test]
    fn no_point_of_a_sheet_is_beyond_the_bound(
        (n, m) in (1u32..9, 1u32..9),
        shifts in prop::collection::vec(-1.0..1.0f64, 7),
        bend in prop::sample::select(vec![0.0, 1e-9, 1e-3, 0.1]),
        turn in prop::sample::select(vec![0.0, 1e-9, 0.3, 0.8]),
        tolerance in prop::sample::select(vec![1e-4, 1e-2, 0.3]),
        max_parts in prop::sample::select(vec![0, 300, 20_000]),
    ) {
        let (a, b) = (sheet(n, bend, 0.0, &shifts), sheet(m, bend, turn, &shifts));
        let options = HausdorffOptions {
            n_samples: Some(10), max_tolerance: Some(tolerance), max_parts, ..Default::default()
        };
        let found = hausdorff(&a, &b, &options, Control::none()).unwrap();
        for (from, to, side) in [(&a, &b, found.from_original), (&b, &a, found.from_simplified)] {
            prop_assert!(side.max <= side.max_upper_bound.unwrap());
            prop_assert!(is_bounded(from, to, &side), "{:?}", side);
        }
    }

    /// Swapping the meshes swaps the directions; means lie below RMS, RMS below the maximum, and
    /// the bracket of the maximum holds every vertex and is as narrow as asked for.
    #[test]
    fn properties(a in soup(), b in soup()) {
        let options = HausdorffOptions {
            n_samples: Some(500), max_tolerance: Some(1e-3), ..Default::default()
        };
        let ab = hausdorff(&a, &b, &options, Control::none()).unwrap();
        let ba = hausdorff(&b, &a, &options, Control::none()).unwrap();
        prop_assert_eq!(ab.from_original.mean, ba.from_simplified.mean);
        prop_assert_eq!(&ab.original_distance, &ba.simplified_distance);
        for side in [ab.from_original, ab.from_simplified] {
            prop_assert!(side.mean <= side.rms * (1.0 + 1e-12) && side.rms <= side.max);
            prop_assert!(side.max <= ab.max());
            let bound = side.max_upper_bound.unwrap();
            prop_assert!(side.max <= bound && bound <= side.max * 1.001001 + 1e-9 * ab.diagonal);
        }
        prop_assert!(is_bounded(&a, &b, &ab.from_original));
        prop_assert!(is_bounded(&b, &a, &ab.from_simplified));
        let n = a.faces.len() * 3;
        prop_assert!(ab.original_distance.values[..n].iter().all(|&d| d <= ab.from_original.max));
    }
}
