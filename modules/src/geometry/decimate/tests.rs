//! Tests of decimation: values worked out by hand for each type, rule and importance.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use mve_mesh::data::{Domain, Layer, LayerValues, VertexId};
use mve_mesh::fixtures::{cube, mesh_of, tetrahedron};
use mve_mesh::quadric::Quadric;

use super::appraise::{Appraiser, Depth, Removal};
use super::kind::VertexKind;
use super::options::{EdgeChoice, ImportanceKind, Openings, RemovalKind, Sequence};
use super::quadrics::quadrics;
use super::refusal::Refusal;
use super::*;

/// The rules of the thesis.
pub const PLAIN: DecimateOptions = DecimateOptions {
    target_faces: 0,
    largest_distance: None,
    importance: ImportanceKind::EdgeSwitching,
    edge: EdgeChoice::Shortest,
    sequence: Sequence::Passes,
    removal: RemovalKind::Collapse,
    feature_angle_rad: std::f64::consts::FRAC_PI_3,
    openings: Openings { boundary: false, complex: false, corners: false },
    keeps_seams: true,
};

pub const QUADRIC: DecimateOptions = DecimateOptions {
    importance: ImportanceKind::Quadric,
    edge: EdgeChoice::Quadric,
    sequence: Sequence::Queue,
    ..PLAIN
};

pub const HOLES: DecimateOptions =
    DecimateOptions { removal: RemovalKind::Retriangulate { least_aspect: 0.04 }, ..PLAIN };

const WITH_BORDERS: DecimateOptions = DecimateOptions {
    openings: Openings { boundary: true, complex: false, corners: false },
    ..PLAIN
};

pub fn decimated(mesh: &TriMesh, options: DecimateOptions) -> Decimated {
    let found = decimate(mesh, &options, Control::none()).unwrap();
    assert_eq!(found.mesh.check(), Ok(()));
    found
}

/// How many edges have one face and how many more than two, and the Euler number of the vertices,
/// edges and faces, but for faces that name a vertex twice.
pub fn topology(mesh: &TriMesh) -> (usize, usize, i64) {
    let mut edges: HashMap<[u32; 2], usize> = HashMap::new();
    let is_face = |f: &&[VertexId; 3]| f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
    let faces: Vec<_> = mesh.faces.iter().filter(is_face).collect();
    for face in &faces {
        for k in 0..3 {
            let (a, b) = (face[k].0, face[(k + 1) % 3].0);
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let mut vertices: Vec<VertexId> = faces.iter().copied().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let n_of = |is: fn(usize) -> bool| edges.values().filter(|n| is(**n)).count();
    let euler = vertices.len() as i64 - edges.len() as i64 + faces.len() as i64;
    (n_of(|n| n == 1), n_of(|n| n > 2), euler)
}

/// A vertex at the first point with neighbors at the others, in order, all around.
fn fan(center: [f64; 3], ring: &[[f64; 3]]) -> TriMesh {
    let n = ring.len() as u32;
    let points: Vec<_> = [center].into_iter().chain(ring.iter().copied()).collect();
    let faces: Vec<_> = (0..n).map(|k| [0, k + 1, (k + 1) % n + 1]).collect();
    mesh_of(&points, &faces)
}

/// The corners of a square around the z axis, each 1 away from it.
const DIAMOND: [[f64; 3]; 4] =
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];

/// What is said of the vertex at a point.
fn appraised(mesh: &TriMesh, options: DecimateOptions, at: DVec3) -> Result<Removal, Refusal> {
    let mesh = StarMesh::new(mesh, true, Control::none()).unwrap();
    let vertex = mesh.positions.iter().position(|&p| p == at).unwrap() as u32;
    let quadrics: Vec<Quadric> =
        quadrics(&mesh, options.openings.boundary, Control::none()).unwrap();
    let mut appraiser = Appraiser::new(options, mesh.positions.len());
    appraiser.appraise(&mesh, &quadrics, vertex, Depth::All)
}

fn kinds(mesh: &TriMesh) -> Vec<Option<VertexKind>> {
    let none = DecimateOptions { target_faces: mesh.faces.len(), ..PLAIN };
    decimated(mesh, none).kinds
}

/// A grid of `n` by `n` unit squares, each of two faces, at a height.
pub fn sheet(n: u32, height: impl Fn(f64, f64) -> f64) -> TriMesh {
    let side = n + 1;
    let at = |k: u32| (f64::from(k % side), f64::from(k / side));
    let points: Vec<[f64; 3]> =
        (0..side * side).map(at).map(|(x, y)| [x, y, height(x, y)]).collect();
    let faces: Vec<[u32; 3]> = (0..n * n)
        .map(|k| k / n * side + k % n)
        .flat_map(|k| [[k, k + 1, k + side + 1], [k, k + side + 1, k + side]])
        .collect();
    mesh_of(&points, &faces)
}

#[test]
fn types_are_those_of_the_faces_around() {
    use VertexKind::{Boundary, Complex, Corner, InteriorEdge, Simple};
    let flat = fan([0.0; 3], &DIAMOND);
    assert_eq!(kinds(&flat), [Simple, Boundary, Boundary, Boundary, Boundary].map(Some));
    assert_eq!(kinds(&cube(DVec3::ZERO)), [Some(Corner); 8]);
    // A roof of 90 degrees: two edges of its ridge meet in the middle.
    let roof = fan(
        [0.0; 3],
        &[
            [1.0, 0.0, 0.0],
            [1.0, 1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, -1.0],
        ],
    );
    assert_eq!(kinds(&roof)[0], Some(InteriorEdge));
    // Half a roof: the ridge ends in the middle, on a floor that bends by 45 degrees in all.
    let dart = fan(
        [0.0; 3],
        &[[1.0, 0.0, 0.7], [0.5, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [0.5, -1.0, 0.0]],
    );
    assert_eq!(kinds(&dart)[0], Some(Simple));
    // Three faces at an edge; two faces at a vertex; the same face twice; a vertex without faces.
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    let three = mesh_of(&points, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    assert_eq!(kinds(&three), [Complex, Complex, Boundary, Boundary, Boundary].map(Some));
    let bow = mesh_of(&points, &[[0, 1, 2], [0, 3, 4]]);
    assert_eq!(kinds(&bow)[0], Some(Complex));
    let twice = mesh_of(&points, &[[0, 1, 2], [2, 1, 0]]);
    assert_eq!(kinds(&twice), [Some(Complex), Some(Complex), Some(Complex), None, None]);
}

/// A face that looks the other way changes no type, nor does a hub of many faces.
#[test]
fn types_do_not_depend_on_orientation_or_on_the_number_of_faces() {
    let mut mesh = fan([0.0, 0.0, 0.1], &DIAMOND);
    mesh.faces[2].swap(0, 1);
    mesh.faces[0].swap(1, 2);
    assert_eq!(kinds(&mesh)[0], Some(VertexKind::Simple));
    for n in [3_u32, 24, 25, 1000] {
        let turn = std::f64::consts::TAU / f64::from(n);
        let at = |k: u32| [(f64::from(k) * turn).cos(), (f64::from(k) * turn).sin(), 0.0];
        let ring: Vec<_> = (0..n).map(at).collect();
        let mut mesh = fan([0.0; 3], &ring);
        assert_eq!(kinds(&mesh)[0], Some(VertexKind::Simple), "{n}");
        // In another order and in part turned.
        mesh.faces.sort_by_key(|face| face[1].0.wrapping_mul(7919) % 101);
        mesh.faces.iter_mut().step_by(3).for_each(|face| face.swap(0, 2));
        assert_eq!(kinds(&mesh)[0], Some(VertexKind::Simple), "{n}");
        mesh.faces.pop();
        assert_eq!(kinds(&mesh)[0], Some(VertexKind::Boundary), "{n}");
        if n > 3 {
            mesh.faces.remove(mesh.faces.len() / 2);
            let expected = kinds(&mesh)[0];
            let is_split = expected == Some(VertexKind::Complex);
            assert!(is_split || expected == Some(VertexKind::Boundary), "{n}");
        }
    }
}

/// With the tip 3/4 above the middle of the square the lines are 3/5 apart: of the line of an edge,
/// in the plane of the z axis, from the line across, through the middle.
#[test]
fn importances_are_those_of_the_formulas() {
    let tip = DVec3::new(0.0, 0.0, 0.75);
    let mesh = fan(tip.to_array(), &DIAMOND);
    let distance = |importance| {
        let options = DecimateOptions { importance, feature_angle_rad: 3.0, ..QUADRIC };
        appraised(&mesh, options, tip).unwrap().distance
    };
    assert!((distance(ImportanceKind::EdgeSwitching) - 4.0 * 0.6).abs() < 1e-12);
    // The centers of the faces are a third as high.
    assert!((distance(ImportanceKind::MeanPlane) - 0.5).abs() < 1e-12);
    // At a corner two of the tip's four planes, x + y + 4/3 z = 1 and so on, are 6/√34 away; those
    // and the two of the corner have equal weights.
    let expected = (2.0 * 36.0 / 34.0 / 6.0_f64).sqrt();
    assert!((distance(ImportanceKind::Quadric) - expected).abs() < 1e-12);
    // In a plane there is no importance, convex or not.
    let flat = fan([0.1, 0.1, 0.0], &[DIAMOND[0], DIAMOND[1], [-0.2, 0.0, 0.0], DIAMOND[3]]);
    for importance in [ImportanceKind::EdgeSwitching, ImportanceKind::MeanPlane] {
        let options = DecimateOptions { importance, ..PLAIN };
        let found = appraised(&flat, options, DVec3::new(0.1, 0.1, 0.0)).unwrap();
        assert!(found.distance < 1e-15);
    }
}

#[test]
fn on_lines_importance_is_the_distance_from_the_line() {
    // A ridge that bends by 0.2 in the middle.
    let roof = fan(
        [0.0, 0.0, 0.2],
        &[
            [1.0, 0.0, 0.0],
            [1.0, 1.0, -1.5],
            [-1.0, 1.0, -1.5],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, -1.5],
        ],
    );
    let found = appraised(&roof, PLAIN, DVec3::new(0.0, 0.0, 0.2)).unwrap();
    assert!((found.distance - 0.2).abs() < 1e-12);
    // A border that bends by 0.3; it stays unless the rule is opened.
    let points = [[0.0, -0.3, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-1.0, 0.0, 0.0]];
    let border = mesh_of(&points, &[[0, 1, 2], [0, 2, 3]]);
    let at = DVec3::from(points[0]);
    assert_eq!(appraised(&border, PLAIN, at), Err(Refusal::Kind));
    let found = appraised(&border, WITH_BORDERS, at).unwrap();
    assert!((found.distance - 0.3).abs() < 1e-12);
    let left = decimated(&border, DecimateOptions { target_faces: 1, ..WITH_BORDERS });
    assert_eq!(left.mesh.faces.len(), 1);
}

/// The edge to (0.5, 0) is the shortest, but the line of the outer edge at x = 0.4 lies between;
/// the next is that to (0.4, 0.8).
#[test]
fn the_shortest_edge_that_passes_the_half_plane_test_goes() {
    let ring =
        [[0.5, 0.0, 0.0], [0.4, 0.8, 0.0], [0.4, 3.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    let found = decimated(&fan([0.0; 3], &ring), PLAIN);
    assert_eq!((found.n_removed, found.mesh.faces.len()), (1, 3));
    let target = found.mesh.positions.iter().position(|p| p.to_array() == ring[1]).unwrap();
    assert!(found.mesh.faces.iter().all(|face| face.iter().any(|v| v.idx() == target)));
    // Without the edge in between the shortest goes.
    let found = decimated(&fan([0.0; 3], &[ring[0], [0.6, 0.8, 0.0], ring[3], ring[4]]), PLAIN);
    let target = found.mesh.positions.iter().position(|p| p.to_array() == ring[0]).unwrap();
    assert!(found.mesh.faces.iter().all(|face| face.iter().any(|v| v.idx() == target)));
}

/// Three of the corners of the square are in one plane with the tip but for 0.001; the edge to the
/// fourth is the shortest and costs most.
#[test]
fn the_edge_of_least_quadric_error_is_another_one() {
    let ring = [[0.5, 0.0, -0.2], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.001], [0.0, -1.0, 0.0]];
    let target = |edge| {
        let options = DecimateOptions { edge, ..PLAIN };
        let mesh = decimated(&fan([0.0; 3], &ring), options).mesh;
        let in_all = |v: &u32| mesh.faces.iter().all(|face| face.contains(&VertexId(*v)));
        let all: Vec<_> = (0..4).filter(in_all).map(|v| mesh.positions[v as usize].x).collect();
        all
    };
    assert!(target(EdgeChoice::Shortest).contains(&0.5));
    assert!(!target(EdgeChoice::Quadric).contains(&0.5));
}

#[test]
fn topology_is_kept_whatever_is_asked_for() {
    for options in [PLAIN, QUADRIC, HOLES] {
        let options = DecimateOptions { feature_angle_rad: 3.2, ..options };
        assert_eq!(decimated(&tetrahedron(), options).mesh.faces.len(), 4);
        // A double pyramid over a triangle or a square ends as a tetrahedron.
        for n in [3_usize, 4] {
            let ring: Vec<_> = if n == 4 {
                DIAMOND.to_vec()
            } else {
                vec![[1.0, 0.0, 0.0], [-0.5, 0.8, 0.0], [-0.5, -0.8, 0.0]]
            };
            let mut mesh = fan([0.0, 0.0, 1.0], &ring);
            mesh.positions.push(DVec3::new(0.0, 0.0, -1.0));
            let bottom = VertexId(n as u32 + 1);
            let below = mesh.faces.clone().into_iter().map(|[_, a, b]| [bottom, b, a]);
            mesh.faces.extend(below);
            let found = decimated(&mesh, options);
            assert_eq!(topology(&found.mesh), (0, 0, 2));
            assert!(found.mesh.faces.len() >= 4);
        }
    }
    // A face at an edge of three stays, for else that would be one of two.
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    let three = mesh_of(&points, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    for removal in [RemovalKind::Collapse, HOLES.removal] {
        let found = decimated(&three, DecimateOptions { removal, ..WITH_BORDERS });
        assert_eq!(topology(&found.mesh), (6, 1, 1));
    }
    // A border of three edges stays, as does a face alone.
    let hole = fan([0.0; 3], &[[1.0, 0.0, 0.0], [-0.5, 0.8, 0.0], [-0.5, -0.8, 0.0]]);
    let found = decimated(&hole, WITH_BORDERS);
    assert_eq!(topology(&found.mesh), (3, 0, 1));
    assert_eq!(found.mesh.faces.len(), 1);
}

/// Of the quadrangle with one corner bent inwards only one diagonal lies within.
#[test]
fn a_hole_is_cut_where_it_can_be() {
    let ring = [[3.0, 0.0, 0.0], [-1.0, 2.0, 0.0], [0.0, 0.0, 0.0], [-1.0, -2.0, 0.0]];
    let found = decimated(&fan([1.0, 0.0, 0.0], &ring), HOLES);
    assert_eq!((found.n_removed, found.mesh.faces.len()), (1, 2));
    let on_diagonal = |v: &&VertexId| found.mesh.positions[v.idx()].y == 0.0;
    assert!(found.mesh.faces.iter().all(|face| face.iter().filter(on_diagonal).count() == 2));
    assert!((found.mesh.area() - 6.0).abs() < 1e-12);
}

/// In the square each corner is 1 from the diagonal, which is 2 long; in the flat quadrangle 0.3
/// and 0.1 from the long one, and the short one is no better: 1 from 0.4, which is the best.
#[test]
fn the_aspect_of_a_cut_is_a_distance_over_a_length() {
    let removed = |ring: &[[f64; 3]], least_aspect| {
        let removal = RemovalKind::Retriangulate { least_aspect };
        decimated(&fan([0.0, 0.0, 0.05], ring), DecimateOptions { removal, ..PLAIN }).n_removed
    };
    assert_eq!([removed(&DIAMOND, 0.49), removed(&DIAMOND, 0.51)], [1, 0]);
    let flat = [[1.0, 0.0, 0.0], [0.0, 0.3, 0.0], [-1.0, 0.0, 0.0], [0.0, -0.1, 0.0]];
    assert_eq!([removed(&flat, 2.49), removed(&flat, 2.51)], [1, 0]);
}

/// Two tetrahedra that touch at a vertex have nothing to give until they are parted there.
#[test]
fn complex_vertices_are_split_where_that_is_opened() {
    let mut mesh = tetrahedron();
    let second = tetrahedron();
    mesh.positions.extend(second.positions[1..].iter().map(|&p| -p));
    let other = |v: VertexId| if v.0 == 0 { v } else { VertexId(v.0 + 3) };
    mesh.faces.extend(second.faces.iter().map(|&[a, b, c]| [a, c, b].map(other)));
    assert_eq!(topology(&decimated(&mesh, PLAIN).mesh), (0, 0, 3));
    let openings = Openings { complex: true, ..Openings::default() };
    let found = decimated(&mesh, DecimateOptions { openings, ..PLAIN });
    assert_eq!((found.n_split, found.mesh.positions.len()), (1, 8));
    assert_eq!(topology(&found.mesh), (0, 0, 4));
    // Three faces at an edge become three sheets.
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    let three = mesh_of(&points, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    let found = decimated(&three, DecimateOptions { openings, ..PLAIN });
    assert_eq!((found.n_split, topology(&found.mesh)), (4, (9, 0, 3)));
}

/// At the corners of a cube the surface parts, and then its borders go.
#[test]
fn corners_are_split_where_that_is_opened() {
    let cube = cube(DVec3::ZERO);
    assert_eq!(decimated(&cube, PLAIN).mesh.faces.len(), 12);
    let openings = Openings { corners: true, boundary: true, complex: false };
    let options = DecimateOptions { openings, target_faces: 8, ..PLAIN };
    let found = decimated(&cube, options);
    assert!(found.n_split > 0 && found.mesh.faces.len() <= 8);
    let is_corner = |p: &DVec3| cube.positions.contains(p);
    assert!(found.mesh.positions.iter().all(is_corner));
}

/// Two charts with texture coordinates 10 apart, which meet at x = 4, and a name for each.
fn charts() -> TriMesh {
    let mut mesh = sheet(8, |x, y| 0.1 * (x * 1.3 + y).sin());
    let chart = |face: &[VertexId; 3]| {
        u32::from(face.iter().map(|v| mesh.positions[v.idx()].x).sum::<f64>() > 12.0)
    };
    let charts: Vec<u32> = mesh.faces.iter().map(chart).collect();
    let texcoord = |(f, v): (usize, &VertexId)| {
        mesh.positions[v.idx()].truncate() + DVec2::splat(10.0 * f64::from(charts[f]))
    };
    let corners =
        mesh.faces.iter().enumerate().flat_map(|(f, face)| face.iter().map(move |v| (f, v)));
    let texcoords: Vec<DVec2> = corners.map(texcoord).collect();
    let index = (0..texcoords.len() as u32).collect();
    let layer =
        |name: &str, domain, values, index| Layer { name: name.to_owned(), domain, values, index };
    let texcoords = layer(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(texcoords), index);
    let names = LayerValues::Label(["left", "right"].map(str::to_owned).to_vec());
    let groups = layer(Layer::GROUP, Domain::Face, names, charts);
    let heights = LayerValues::Number(mesh.positions.iter().map(|p| p.z).collect());
    let index = (0..mesh.positions.len() as u32).collect();
    let heights = layer("height", Domain::Vertex, heights, index);
    mesh.layers = vec![texcoords, groups, heights];
    mesh
}

#[test]
fn attributes_stay_with_their_vertices_and_seams_in_place() {
    let mesh = charts();
    let openings = Openings { boundary: true, ..Openings::default() };
    for options in [PLAIN, QUADRIC, HOLES, DecimateOptions { openings, ..QUADRIC }] {
        let options = DecimateOptions { target_faces: 70, ..options };
        let found = decimated(&mesh, options).mesh;
        assert!(found.faces.len() < 100, "{}", found.faces.len());
        let LayerValues::Vec2(texcoords) = &found.layers[0].values else { panic!() };
        let LayerValues::Number(heights) = &found.layers[2].values else { panic!() };
        for (f, face) in found.faces.iter().enumerate() {
            for (k, v) in face.iter().enumerate() {
                let expected = found.positions[v.idx()].truncate()
                    + DVec2::splat(10.0 * f64::from(found.layers[1].index[f]));
                assert_eq!(texcoords[found.layers[0].index[3 * f + k] as usize], expected);
            }
        }
        for (v, point) in found.positions.iter().enumerate() {
            assert_eq!(heights[found.layers[2].index[v] as usize], point.z);
        }
    }
}
