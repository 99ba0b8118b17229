//! Tests of clusters: values worked out by hand, and what holds for every mesh.

use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, VertexId};
use mve_mesh::fixtures::{cube, mesh_of, torus};
use proptest::prelude::*;

use super::*;
use crate::geometry::edit::checks::any_mesh;
use crate::geometry::surface::mesh_info::mesh_info;

const PLAIN: ClusterOptions = ClusterOptions {
    cells: CellKind::Uniform,
    size: Size::Edge(1.0),
    representative: Representative::Important,
    weights: Weights { length: 1.0, angle: 1.0 },
    levels: 1,
    duplicates: Duplicates::Once,
    is_manifold: false,
};

fn clustered(mesh: &TriMesh, options: ClusterOptions) -> Clustered {
    let found = cluster(mesh, &options, Control::none()).unwrap();
    assert_eq!(found.mesh.check(), Ok(()));
    found
}

/// A square of four by four unit squares in the plane z = 0, each of two faces.
fn sheet() -> TriMesh {
    let points: Vec<[f64; 3]> =
        (0..25).map(|k| [f64::from(k % 5), f64::from(k / 5), 0.0]).collect();
    let faces: Vec<[u32; 3]> = (0..16)
        .map(|k| k / 4 * 5 + k % 4)
        .flat_map(|k| [[k, k + 1, k + 6], [k, k + 6, k + 5]])
        .collect();
    mesh_of(&points, &faces)
}

#[test]
fn importance_is_that_of_the_formula() {
    // At the right angle the edges are 3 and 4 long; the longest of the mesh is 5.
    let mesh = mesh_of(&[[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[[0, 1, 2]]);
    let weights = Weights { length: 1.0, angle: 1.0 };
    let found = importance(&mesh, weights, Control::none()).unwrap();
    let expected = |length: f64, angle: f64| length / 5.0 + (angle / 2.0).cos();
    let angles = [90_f64.to_radians(), (4.0_f64 / 3.0).atan(), (3.0_f64 / 4.0).atan()];
    for (vertex, length) in [4.0, 5.0, 5.0].into_iter().enumerate() {
        assert!((found[vertex] - expected(length, angles[vertex])).abs() < 1e-12);
    }
    let of_length = importance(&mesh, Weights { length: 2.0, angle: 0.0 }, Control::none());
    assert_eq!(of_length.unwrap(), [1.6, 2.0, 2.0]);
}

/// The least angle may lie between edges of no common face, and at a vertex of many edges.
#[test]
fn the_least_angle_is_one_of_all_pairs() {
    let tip = [0.0, 0.0, 5.0];
    let mesh = mesh_of(
        &[tip, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.1, 0.0], [0.0, -1.0, 0.0]],
        &[[0, 1, 2], [0, 3, 4]],
    );
    let weights = Weights { length: 0.0, angle: 1.0 };
    let found = importance(&mesh, weights, Control::none()).unwrap()[0];
    let (a, b) = (DVec3::new(1.0, 0.0, -5.0), DVec3::new(1.0, 0.1, -5.0));
    assert!((found - (a.angle_between(b) / 2.0).cos()).abs() < 1e-9);

    let n = 1000;
    let turn = std::f64::consts::TAU / f64::from(n);
    let at = |k: u32| [(f64::from(k) * turn).cos(), (f64::from(k) * turn).sin(), 0.0];
    let points: Vec<_> = (0..n).map(at).chain([[0.0; 3]]).collect();
    let faces: Vec<_> = (0..n).map(|k| [n, k, (k + 1) % n]).collect();
    let hub = importance(&mesh_of(&points, &faces), weights, Control::none()).unwrap();
    assert!((hub[n as usize] - (turn / 2.0).cos()).abs() < 1e-12);
}

#[test]
fn a_grid_of_cells_keeps_the_most_important_vertex_of_each() {
    // Cells of two units: 0 and 1, 2 and 3, and 4 along both axes.
    let mut mesh = sheet();
    let weights: Vec<f64> = (0..25).map(f64::from).collect();
    let layer = Layer {
        name: "own".into(),
        domain: Domain::Vertex,
        values: LayerValues::Number(weights),
        index: (0..25).collect(),
    };
    mesh.set_layer(layer);
    let found = clustered(&mesh, ClusterOptions { size: Size::Edge(2.0), ..PLAIN });
    assert_eq!((found.n_clusters, found.edge), (9, 2.0));
    // All edges are equally long but the diagonals, which only the vertices inside and two of the
    // corners of the square have; the first of equals stands for its cell.
    let places: Vec<_> = found.mesh.positions.iter().map(|p| p.to_array()).collect();
    assert_eq!(places.len(), 9);
    assert_eq!(found.mesh.area(), 16.0 * found.mesh.area() / 16.0);
    assert_eq!(found.mesh.faces.len(), 8);
    // Attributes are those of the vertex that stands for the cell.
    let own = found.mesh.layer("own").unwrap();
    let LayerValues::Number(values) = &own.values else { panic!("numbers") };
    for (point, &index) in found.mesh.positions.iter().zip(&own.index) {
        assert_eq!(values[index as usize], 5.0 * point.y + point.x);
    }
}

#[test]
fn floating_cells_lie_around_the_most_important_vertices() {
    // On a line of vertices 1 apart, cells of edge 2.5 hold the neighbors on both sides. The tall
    // face makes its vertex the most important; the next one free is two further on.
    let points: Vec<[f64; 3]> =
        (0..7).flat_map(|k| [[f64::from(k), 0.0, 0.0], [f64::from(k), 8.0, 0.0]]).collect();
    let faces: Vec<[u32; 3]> =
        (0..6).map(|k| 2 * k).flat_map(|k| [[k, k + 2, k + 1], [k + 1, k + 2, k + 3]]).collect();
    let mesh = mesh_of(&points, &faces);
    let order = [6, 0, 2, 4, 8, 10, 12, 1, 3, 5, 7, 9, 11, 13];
    let mut importance = [0.0; 14];
    order.iter().enumerate().for_each(|(place, &vertex)| importance[vertex] = 14.0 - place as f64);
    let octants = Grid::new(bounds(&mesh), 0.01).unwrap();
    let curve = Curve::new(&mesh, octants, &importance, Control::none()).unwrap();
    let (of_vertex, n_clusters) = curve.clusters(2.5, Control::none()).unwrap();
    // Along the lower line: 3 first, then 0, then 5; 1 is as near to 0 as 2 is to 3. Along the
    // upper line every other one, and between two the more important.
    let (lower, upper) = ([0, 0, 3, 3, 3, 5, 5], [0, 0, 2, 2, 4, 4, 6]);
    let expected = (0..7).flat_map(|k| [2 * lower[k], 2 * upper[k] + 1]);
    for (vertex, center) in expected.enumerate() {
        assert_eq!(of_vertex[vertex], of_vertex[center], "{vertex}");
    }
    assert_eq!(n_clusters, 7);
    // Numbers are in the order in which they first occur.
    assert_eq!(of_vertex[..6], [0, 1, 0, 1, 2, 3]);
}

/// Any list gives what a look at all centers does.
#[test]
fn cells_of_any_size_find_their_centers() {
    let mesh = torus(2.0, 0.5, 30);
    let importance = importance(&mesh, PLAIN.weights, Control::none()).unwrap();
    let octants = Grid::new(bounds(&mesh), 1e-3).unwrap();
    let curve = Curve::new(&mesh, octants, &importance, Control::none()).unwrap();
    let mut order: Vec<usize> = (0..mesh.positions.len()).collect();
    order.sort_by(|&a, &b| (importance[b] as f32).total_cmp(&(importance[a] as f32)));
    for edge in [0.05, 0.3, 0.7, 2.0, 9.0] {
        let apart = |a: usize, b: usize| (mesh.positions[a] - mesh.positions[b]).abs();
        let mut centers: Vec<usize> = Vec::new();
        for &vertex in &order {
            if !centers.iter().any(|&c| apart(c, vertex).max_element() <= 0.5 * edge) {
                centers.push(vertex);
            }
        }
        let (of_vertex, n_clusters) = curve.clusters(edge, Control::none()).unwrap();
        assert_eq!(n_clusters, centers.len(), "{edge}");
        for vertex in 0..mesh.positions.len() {
            let own = centers.iter().filter(|&&c| apart(c, vertex).max_element() <= 0.5 * edge);
            let least = own.map(|&c| apart(c, vertex).length()).fold(f64::INFINITY, f64::min);
            let found = centers.iter().find(|&&c| of_vertex[c] == of_vertex[vertex]).unwrap();
            assert!(apart(*found, vertex).length() <= least * (1.0 + 1e-6), "{edge} {vertex}");
        }
    }
}

#[test]
fn a_quadric_point_is_the_corner_of_a_cube() {
    // Three sides meet in one cell: the point of no error is the corner, wherever vertices lie.
    let side = 0.4;
    let points = [
        [1.0, side, side],
        [side, 1.0, side],
        [side, side, 1.0],
        [1.0, 1.0, side],
        [1.0, side, 1.0],
        [side, 1.0, 1.0],
    ];
    let mesh = mesh_of(&points, &[[0, 3, 4], [1, 3, 5], [2, 4, 5]]);
    let of_vertex = [0; 6];
    let clusters = Clusters { mesh: &mesh, of_vertex: &of_vertex, n_clusters: 1 };
    let place = clusters.quadric_points(10.0, Control::none()).unwrap()[0];
    assert!(place.point.distance(DVec3::ONE) < 1e-6, "{}", place.point);
    // Not farther from the mean than it may be.
    let place = clusters.quadric_points(0.1, Control::none()).unwrap()[0];
    assert!(place.point.distance(clusters.means()[0].point) < 1e-12);
}

#[test]
fn faces_of_the_same_vertices_stay_or_go() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0, 5.0, 5.0], [6.0, 5.0, 5.0]];
    let faces = [[0, 1, 2], [1, 2, 0], [0, 2, 1], [0, 3, 4], [3, 4, 0]];
    let mesh = mesh_of(&corners, &faces);
    let n_faces = |duplicates| {
        clustered(&mesh, ClusterOptions { size: Size::Edge(0.1), duplicates, ..PLAIN }).mesh.faces
    };
    assert_eq!(n_faces(Duplicates::Keep).len(), 5);
    let ids = |faces: &[[u32; 3]]| -> Vec<_> { faces.iter().map(|f| f.map(VertexId)).collect() };
    assert_eq!(n_faces(Duplicates::Once), ids(&[[0, 1, 2], [0, 2, 1], [0, 3, 4]]));
    assert_eq!(n_faces(Duplicates::Cancel), ids(&[[0, 1, 2]]));
}

#[test]
fn targets_are_met_within_a_hundredth() {
    let mesh = torus(2.0, 0.5, 150);
    for cells in [CellKind::Uniform, CellKind::Floating] {
        for representative in
            [Representative::Important, Representative::Mean, Representative::Quadric]
        {
            let options = ClusterOptions { cells, representative, ..PLAIN };
            let size = Size::Faces(4000);
            let found = clustered(&mesh, ClusterOptions { size, ..options });
            let n = found.mesh.faces.len() as f64;
            assert!((n / 4000.0 - 1.0).abs() <= 0.01, "{cells:?} {representative:?} {n}");
            let shift = 0.01 * mesh.diagonal();
            let found = clustered(&mesh, ClusterOptions { size: Size::Shift(0.01), ..options });
            assert!((found.shift / shift - 1.0).abs() <= 0.01, "{cells:?} {}", found.shift);
        }
    }
    let per_axis = clustered(&mesh, ClusterOptions { size: Size::PerAxis(10), ..PLAIN });
    assert!((per_axis.edge - 0.5).abs() < 1e-9);
}

/// A plate whose sides share a cell.
#[test]
fn a_thin_plate_stays_a_solid_where_parts_stay_apart() {
    let mut plate = torus(2.0, 0.5, 60);
    plate.positions.iter_mut().for_each(|p| p.z *= 1e-3);
    let options = ClusterOptions { size: Size::Edge(0.4), ..PLAIN };
    let glued = clustered(&plate, options);
    let before = mesh_info(&glued.mesh, Control::none()).unwrap();
    assert!(before.n_non_manifold_edges > 0);
    let apart = clustered(&plate, ClusterOptions { is_manifold: true, ..options });
    let after = mesh_info(&apart.mesh, Control::none()).unwrap();
    assert!(after.is_manifold() && apart.mesh.faces.len() > glued.mesh.faces.len() / 2);
}

#[test]
fn rounds_are_those_of_one_after_the_other() {
    let mesh = torus(2.0, 0.5, 80);
    let at = |mesh: &TriMesh, edge, levels| {
        let size = Size::Edge(edge);
        clustered(mesh, ClusterOptions { size, levels, ..PLAIN }).mesh
    };
    let twice = at(&at(&mesh, 0.1, 1), 0.2, 1);
    assert_eq!(at(&mesh, 0.2, 2), twice);
    assert_ne!(at(&mesh, 0.2, 1), twice);
}

/// Turning the model turns the grid in it: the thesis says so, and this is how much.
#[test]
fn a_turned_model_gives_another_result() {
    let mesh = torus(2.0, 0.5, 80);
    let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let mut turned = mesh.clone();
    turned.positions.iter_mut().for_each(|p| *p = turn * *p);
    let options = ClusterOptions { size: Size::Edge(0.3), ..PLAIN };
    for cells in [CellKind::Uniform, CellKind::Floating] {
        let n_faces =
            |mesh: &TriMesh| clustered(mesh, ClusterOptions { cells, ..options }).mesh.faces.len();
        let (straight, turned) = (n_faces(&mesh), n_faces(&turned));
        let change = turned as f64 / straight as f64 - 1.0;
        assert!(change != 0.0 && change.abs() < 0.5, "{cells:?} {straight} {turned}");
    }
}

#[test]
fn what_is_odd_gives_a_result_or_an_error() {
    let none = clustered(&TriMesh::default(), PLAIN);
    assert_eq!((none.mesh.faces.len(), none.n_clusters), (0, 0));
    let one = clustered(&cube(DVec3::ZERO), ClusterOptions { size: Size::Edge(1e300), ..PLAIN });
    assert_eq!((one.n_clusters, one.mesh.faces.len(), one.mesh.positions.len()), (1, 0, 0));
    let small = ClusterOptions { size: Size::Edge(1e-9), ..PLAIN };
    let refused = cluster(&cube(DVec3::ZERO), &small, Control::none()).unwrap_err();
    assert_eq!(refused, ClusterError::TooSmall(1e-9));
    // A vertex that is nowhere stays, and far away ones do not make the grid coarser.
    let mut mesh = cube(DVec3::ZERO);
    mesh.positions[0] = DVec3::NAN;
    mesh.positions.push(DVec3::splat(1e9));
    let kept = clustered(&mesh, ClusterOptions { size: Size::Edge(0.5), ..PLAIN });
    assert_eq!(kept.mesh.faces.len(), 12);
    assert!(kept.mesh.corners(FaceId(0)).iter().any(|p| p.is_nan()));
}

proptest! {
    #[test]
    fn any_mesh_gives_a_mesh_and_the_same_for_any_threads(
        mesh in any_mesh(),
        edge in 0.01_f64..3.0,
        floating in any::<bool>(),
        which in 0..3_usize,
        is_manifold in any::<bool>(),
    ) {
        let cells = if floating { CellKind::Floating } else { CellKind::Uniform };
        let all = [Representative::Important, Representative::Mean, Representative::Quadric];
        let representative = all[which];
        let size = Size::Edge(edge);
        let options = ClusterOptions { cells, size, representative, is_manifold, ..PLAIN };
        let found = cluster(&mesh, &options, Control::none());
        prop_assume!(!matches!(found, Err(ClusterError::TooSmall(_))));
        let found = found.unwrap();
        prop_assert_eq!(found.mesh.check(), Ok(()));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let alone = pool.install(|| cluster(&mesh, &options, Control::none())).unwrap();
        prop_assert_eq!(format!("{:?}", alone.mesh), format!("{:?}", found.mesh));
        if is_manifold {
            let info = mesh_info(&found.mesh, Control::none()).unwrap();
            prop_assert_eq!(info.n_non_manifold_edges, 0);
        }
    }
}
