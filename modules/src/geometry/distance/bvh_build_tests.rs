//! Tests of the tree: it finds what a look at every face finds, and has equal faces once.

use mve_mesh::fixtures::mesh_of;

use super::*;
use crate::geometry::distance::many::ManyQueries;
use proptest::prelude::*;

fn brute_force(mesh: &TriMesh, point: DVec3) -> f64 {
    (0..mesh.faces.len())
        .map(|f| mesh.corners(FaceId(f as u32)))
        .filter(|corners| corners.iter().all(|p| p.is_finite()))
        .map(|corners| PreparedTriangle::new(corners).distance_sq(point))
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn empty_and_non_finite_meshes_find_nothing() {
    let none = Bvh::build(&TriMesh::default(), Control::none()).unwrap();
    assert_eq!(none.closest(DVec3::ZERO), None);
    let bad = mesh_of(&[[f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [f64::INFINITY; 3]], &[[0, 1, 2]]);
    let bvh = Bvh::build(&bad, Control::none()).unwrap();
    assert_eq!((bvh.n_faces(), bvh.n_left_out()), (0, 1));
    assert_eq!(bvh.closest(DVec3::ZERO), None);
}

#[test]
fn a_query_that_is_not_finite_finds_nothing() {
    let bvh = Bvh::build(&mve_mesh::fixtures::tetrahedron(), Control::none()).unwrap();
    assert_eq!(bvh.closest(DVec3::NAN), None);
    assert_eq!(bvh.closest(DVec3::INFINITY), None);
    assert!(bvh.closest(DVec3::splat(1e149)).is_some());
}

#[test]
fn of_a_thousand_copies_of_a_face_the_tree_has_one() {
    let turns = [[0, 1, 2], [2, 1, 0], [1, 2, 0], [4, 3, 5]];
    let mut corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    corners.extend_from_within(..);
    corners.extend([[0.0, 0.0, 1.0], [1.0, 1.0, 1.0]]);
    let faces: Vec<_> = (0..1000).map(|k| turns[k % 4]).chain([[0, 6, 7]]).collect();
    let bvh = Bvh::build(&mesh_of(&corners, &faces), Control::none()).unwrap();
    let hit = bvh.closest(DVec3::new(0.2, 0.2, -3.0)).unwrap();
    assert_eq!((hit.distance_sq, bvh.nodes.len(), bvh.n_faces()), (9.0, 1, 1001));
    let mut same: Vec<u32> = bvh.same_as(&hit).map(|face| face.0).collect();
    same.sort_unstable();
    assert!(same.into_iter().eq(0..1000));
    let alone = bvh.closest(DVec3::ONE).unwrap();
    assert!(bvh.same_as(&alone).eq([FaceId(1000)]));
}

/// Needles in all directions through a cube: no boxes around whole ones tell them apart.
#[test]
fn needles_across_each_other_are_found_in_cells() {
    let random = IndexedRandom::new(5);
    let vector = |k: u64| DVec3::from([0, 1, 2].map(|axis| random.unit(9 * k + axis) - 0.5));
    let n = 4000u32;
    let corners = (0..u64::from(n))
        .flat_map(|k| [vector(3 * k), vector(3 * k + 1), vector(3 * k) + vector(3 * k + 2) * 1e-3]);
    let mut points: Vec<[f64; 3]> = corners.map(|p| p.to_array()).collect();
    // Two without any extent, and one twice.
    points.extend([points[0]; 3]);
    let last = 3 * n;
    let mut faces: Vec<[u32; 3]> = (0..n).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    faces.extend([[last, last + 1, last + 2], [last, last, last], [1, 2, 0]]);
    let mesh = mesh_of(&points, &faces);
    let bvh = Bvh::build(&mesh, Control::none()).unwrap();
    assert!(bvh.lists.is_some());
    assert_eq!((bvh.n_faces(), bvh.n_left_out()), (faces.len(), 0));
    let mut walker = bvh.walker();
    for k in 0..300 {
        let point = vector(1_000_000 + k);
        let (found, expected) = (walker.closest(point).unwrap(), brute_force(&mesh, point));
        assert!((found.distance_sq.sqrt() - expected.sqrt()).abs() < 1e-14);
    }
    // Of whole faces more than 400, of pieces of them 50.
    assert!(walker.n_visits() < 30 * 300, "{}", walker.n_visits());
    let first = walker.closest(mesh.positions[1]).unwrap();
    let mut same: Vec<u32> = bvh.same_as(&first).map(|face| face.0).collect();
    same.sort_unstable();
    assert_eq!(same, [0, n + 2]);
}

#[test]
fn faces_in_one_cell_of_the_curve_are_told_apart() {
    // A grid whose faces are listed at random, and one so far away that all others share a cell.
    let n = 60_u32;
    let point = |at: u32| [f64::from(at % (n + 1)), f64::from(at / (n + 1)), 0.0];
    let mut points: Vec<_> = (0..(n + 1) * (n + 1)).map(point).collect();
    let corner = |at: u32| at / n * (n + 1) + at % n;
    let mut faces: Vec<_> =
        (0..n * n).map(|at| [corner(at), corner(at) + 1, corner(at) + n + 1]).collect();
    faces.sort_by_key(|face| IndexedRandom::new(0).bits(u64::from(face[0])));
    let stray = points.len() as u32;
    points.extend([[1e5, 0.0, 0.0], [1e5, 1.0, 0.0], [1e5, 0.0, 1.0]]);
    faces.push([stray, stray + 1, stray + 2]);
    let bvh = Bvh::build_quickly(&mesh_of(&points, &faces), Control::none()).unwrap();
    let mut walker = bvh.walker();
    for at in (0..n * n).step_by(97) {
        let [x, y, _] = point(corner(at));
        assert!(walker.closest(DVec3::new(x + 0.2, y + 0.2, 0.1)).is_some());
    }
    let n_queries = (n * n).div_ceil(97) as usize;
    assert!(walker.n_visits() < 40 * n_queries, "{} {n_queries}", walker.n_visits());
}

fn any_point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from)
}

proptest! {
    /// Single queries, seeded or not, and batches agree with the least over all faces, far
    /// from the origin and for large and small models too.
    #[test]
    fn agrees_with_brute_force(
        corners in prop::collection::vec(any_point(), 3..120),
        picks in prop::collection::vec(prop::array::uniform3(0u32..120), 1..120),
        queries in prop::collection::vec(any_point(), 3..24),
        shift in prop::sample::select(vec![0.0, 1.0, 1e6]),
        scale in prop::sample::select(vec![1e-30, 1e-3, 1.0, 1e40]),
        spread in prop::sample::select(vec![0.01, 1.0, 50.0]),
    ) {
        let place = |p: DVec3| (p + DVec3::splat(shift)) * scale;
        let n = corners.len() as u32;
        let points: Vec<[f64; 3]> = corners.iter().map(|&p| place(p).to_array()).collect();
        let faces: Vec<[u32; 3]> = picks.iter().map(|f| f.map(|v| v % n)).collect();
        let mesh = mesh_of(&points, &faces);
        let bvh = Bvh::build(&mesh, Control::none()).unwrap();
        let queries: Vec<DVec3> = queries.iter().map(|&q| place(q * spread)).collect();
        let expected: Vec<f64> = queries.iter().map(|&q| brute_force(&mesh, q)).collect();
        let mut walker = bvh.walker();
        let many = ManyQueries::new(&bvh, queries[0]);
        let batch = many.closest(&queries, Control::none()).unwrap();
        let rounding = 1e-14 * scale * (1.0 + spread);
        let cells = Bvh::of_cells(&mesh, &Control::none()).unwrap();
        prop_assert!(cells.lists.is_some());
        let mut in_cells = cells.walker();
        let together = ManyQueries::new(&cells, queries[0]);
        let together = together.closest(&queries, Control::none()).unwrap();
        let quick = Bvh::build_quickly(&mesh, Control::none()).unwrap();
        let reach = 0.5 * scale;
        let near = ManyQueries::new(&quick, queries[0]);
        let near = near.nearby(&queries, reach, Control::none()).unwrap();
        for (((&query, &expected), near), together) in
            queries.iter().zip(&expected).zip(near).zip(together)
        {
            let found = quick.closest(query).unwrap().distance_sq;
            prop_assert!((found.sqrt() - expected.sqrt()).abs() <= rounding);
            let together = together.unwrap().distance_sq.sqrt();
            prop_assert!((together - expected.sqrt()).abs() <= rounding);
            let near = near.unwrap().distance_sq.sqrt();
            prop_assert!(near <= reach || (near - expected.sqrt()).abs() <= rounding);
        }
        for ((&query, &expected), batch) in queries.iter().zip(&expected).zip(batch) {
            let single = bvh.closest(query).unwrap().distance_sq;
            let seeded = walker.closest(query).unwrap().distance_sq;
            let cell = in_cells.closest(query).unwrap().distance_sq;
            for found in [single, seeded, cell, batch.unwrap().distance_sq] {
                prop_assert!((found.sqrt() - expected.sqrt()).abs() <= rounding);
            }
        }
    }
}
