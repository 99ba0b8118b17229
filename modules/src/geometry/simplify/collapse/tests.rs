//! Tests of the engine with its parts: known answers, properties, odd input.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::sync::Mutex;

use glam::{DVec2, DVec3};
use mve_mesh::data::{Domain, Layer, LayerValues, NO_VALUE, VertexId};
use mve_mesh::fixtures::{mesh_of, tetrahedron};
use proptest::prelude::*;

use super::*;
use crate::cost::{EdgeLength, Quadric};
use crate::placement::{Endpoint, Midpoint, Optimal};

pub(super) fn run_with(
    mesh: &TriMesh,
    mut cost: impl Cost,
    mut placement: impl Placement,
    options: SimplifyOptions,
) -> Simplified {
    simplify(mesh, &mut cost, &mut placement, options, Control::none()).unwrap()
}

pub(super) fn to_faces(n: usize) -> SimplifyOptions {
    SimplifyOptions { stop: Stop { faces: Some(n), ..Stop::default() }, ..Default::default() }
}

fn by_quadric(mesh: &TriMesh, n: usize) -> Simplified {
    run_with(mesh, Quadric::default(), Optimal::default(), to_faces(n))
}

/// A grid of `n × n` squares, two triangles each, with a height for each point.
pub(super) fn grid(n: usize, height: impl Fn(f64, f64) -> f64) -> TriMesh {
    let side = n as u32 + 1;
    let point = |i: u32| {
        let (x, y) = (f64::from(i % side), f64::from(i / side));
        DVec3::new(x, y, height(x, y))
    };
    let square = |i: u32| {
        let v = i % n as u32 + i / n as u32 * side;
        let [a, b, c, d] = [v, v + 1, v + 1 + side, v + side].map(VertexId);
        [[a, b, c], [a, c, d]]
    };
    let n_squares = (n * n) as u32;
    TriMesh::new((0..side * side).map(point).collect(), (0..n_squares).flat_map(square).collect())
}

/// The cube of side 8 with 8 × 8 × 2 triangles a side: 768 faces, 386 vertices.
pub(super) fn cube() -> TriMesh {
    let mut ids = BTreeMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    let flat = grid(8, |_, _| 0.0);
    for axis in 0..3 {
        for end in [0.0, 8.0] {
            for face in &flat.faces {
                let mut corners = face.map(|v| {
                    let p = flat.positions[v.idx()];
                    let mut q = DVec3::splat(end);
                    q[(axis + 1) % 3] = p.x;
                    q[(axis + 2) % 3] = p.y;
                    *ids.entry(q.to_array().map(|x| x as u32)).or_insert_with(|| {
                        positions.push(q);
                        VertexId(positions.len() as u32 - 1)
                    })
                });
                if end == 0.0 {
                    corners.swap(1, 2);
                }
                faces.push(corners);
            }
        }
    }
    TriMesh::new(positions, faces)
}

/// A closed torus with bumps, of `2 × n × n` faces.
pub(super) fn torus(n: usize) -> TriMesh {
    let mut mesh = grid(n, |_, _| 0.0);
    let side = n as u32 + 1;
    for face in &mut mesh.faces {
        *face = face.map(|v| VertexId(v.0 % side % n as u32 + v.0 / side % n as u32 * side));
    }
    let turn = std::f64::consts::TAU / n as f64;
    for p in &mut mesh.positions {
        let (u, v) = (p.x * turn, p.y * turn);
        let r = 0.4 + 0.05 * (3.0 * u).sin() * (4.0 * v).cos();
        *p = DVec3::new((1.0 + r * v.cos()) * u.cos(), (1.0 + r * v.cos()) * u.sin(), r * v.sin());
    }
    mesh
}

/// How many times each undirected edge occurs, with the different opposite vertices.
fn edges(mesh: &TriMesh) -> BTreeMap<[u32; 2], BTreeSet<u32>> {
    let mut edges: BTreeMap<_, BTreeSet<u32>> = BTreeMap::new();
    for face in &mesh.faces {
        for k in 0..3 {
            let (a, b, c) = (face[k].0, face[(k + 1) % 3].0, face[(k + 2) % 3].0);
            edges.entry([a.min(b), a.max(b)]).or_default().insert(c);
        }
    }
    edges
}

/// What a collapse must keep: Euler number of the used part, components, kinds of edges.
#[derive(Debug, PartialEq)]
struct Topology {
    euler: i64,
    n_components: usize,
    has_border: bool,
    /// At least 2: whether an inner edge is left over does not count.
    most_faces_at_an_edge: usize,
}

fn topology(mesh: &TriMesh) -> Topology {
    let edges = edges(mesh);
    let used: BTreeSet<u32> = mesh.faces.iter().flatten().map(|v| v.0).collect();
    let distinct: BTreeSet<[u32; 3]> = mesh
        .faces
        .iter()
        .map(|f| {
            let mut f = f.map(|v| v.0);
            f.sort_unstable();
            f
        })
        .collect();
    let mut root: BTreeMap<u32, u32> = used.iter().map(|&v| (v, v)).collect();
    fn find(root: &BTreeMap<u32, u32>, mut v: u32) -> u32 {
        while root[&v] != v {
            v = root[&v];
        }
        v
    }
    for [a, b] in edges.keys() {
        let (a, b) = (find(&root, *a), find(&root, *b));
        root.insert(a.max(b), a.min(b));
    }
    Topology {
        euler: used.len() as i64 - edges.len() as i64 + distinct.len() as i64,
        n_components: used.iter().filter(|&&v| root[&v] == v).count(),
        has_border: edges.values().any(|o| o.len() == 1),
        most_faces_at_an_edge: edges.values().map(BTreeSet::len).max().map_or(0, |n| n.max(2)),
    }
}

#[test]
fn cube_stays_a_cube() {
    for n in [300, 100, 12] {
        let result = by_quadric(&cube(), n);
        let mesh = &result.mesh;
        assert_eq!((mesh.faces.len(), result.statistics.outcome), (n, Outcome::TargetReached));
        assert_eq!(topology(mesh).euler, 2);
        assert!((mesh.signed_volume() - 512.0).abs() < 1e-10, "{}", mesh.signed_volume());
        // No face is folded over another: areas would add up to more.
        assert!((mesh.area() - 384.0).abs() < 1e-10, "{}", mesh.area());
        for p in &mesh.positions {
            let to_side = p.to_array().into_iter().map(|x: f64| x.abs().min((x - 8.0).abs()));
            assert!(to_side.fold(f64::MAX, f64::min) < 1e-12, "{p} is off the sides");
        }
    }
    let end = by_quadric(&cube(), 0).statistics;
    assert_eq!((end.outcome, end.n_faces < 12), (Outcome::Exhausted, true));
}

#[test]
fn tetrahedron_and_single_triangle_have_no_collapse() {
    let triangle = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    for mesh in [tetrahedron(), triangle] {
        let result = by_quadric(&mesh, 0);
        assert_eq!(result.mesh, mesh);
        assert_eq!(result.statistics.outcome, Outcome::Exhausted);
        assert!(result.statistics.n_rejected_link > 0);
    }
}

#[test]
fn every_pair_of_parts_keeps_the_topology_of_a_torus() {
    let mesh = torus(40);
    let quadric = Quadric::default();
    let results = [
        run_with(&mesh, EdgeLength, Midpoint, to_faces(400)),
        run_with(&mesh, EdgeLength, Endpoint, to_faces(400)),
        run_with(&mesh, EdgeLength, Optimal::default(), to_faces(400)),
        run_with(&mesh, quadric, Midpoint, to_faces(400)),
        run_with(&mesh, quadric, Endpoint, to_faces(400)),
        run_with(&mesh, quadric, Optimal::default(), to_faces(400)),
    ];
    for result in results {
        assert_eq!(result.statistics.outcome, Outcome::TargetReached);
        assert_eq!(topology(&result.mesh), topology(&mesh));
        let ratio = result.mesh.signed_volume() / mesh.signed_volume();
        // Midpoints cut off what is convex, most of all by edge length.
        assert!((0.85..1.02).contains(&ratio), "{ratio}");
    }
}

#[test]
fn endpoint_takes_vertices_of_the_input() {
    let mesh = torus(24);
    let result = run_with(&mesh, Quadric::default(), Endpoint, to_faces(200));
    let bits = |p: &DVec3| p.to_array().map(f64::to_bits);
    let input: BTreeSet<_> = mesh.positions.iter().map(bits).collect();
    assert!(result.mesh.positions.iter().all(|p| input.contains(&bits(p))));
}

#[test]
fn order_of_vertices_and_faces_does_not_matter() {
    let mesh = torus(16);
    let n = mesh.positions.len() as u32;
    // 7 has no factor in common with 17 × 17.
    let mut shuffled = mesh.clone();
    for v in 0..n {
        shuffled.positions[(v * 7 % n) as usize] = mesh.positions[v as usize];
    }
    shuffled.faces.iter_mut().flatten().for_each(|v| v.0 = v.0 * 7 % n);
    shuffled.faces.reverse();
    let surface = |mesh: &TriMesh| {
        let points =
            |f: &[VertexId; 3]| f.map(|v| mesh.positions[v.idx()].to_array().map(f64::to_bits));
        mesh.faces.iter().map(points).collect::<BTreeSet<_>>()
    };
    assert_eq!(surface(&by_quadric(&mesh, 100).mesh), surface(&by_quadric(&shuffled, 100).mesh));
}

#[test]
fn boundary_policies_do_what_they_say() {
    let mesh = grid(12, |x, y| 0.2 * (x * 0.7).sin() * (y * 0.9).cos());
    let area_seen_from_above = |mesh: &TriMesh| {
        let flat = mesh.positions.iter().map(|p| DVec3::new(p.x, p.y, 0.0)).collect();
        TriMesh::new(flat, mesh.faces.clone()).area()
    };
    let weighted = by_quadric(&mesh, 60).mesh;
    assert!((area_seen_from_above(&weighted) - 144.0).abs() < 0.5);
    let options = SimplifyOptions { boundary: Boundary::Locked, ..to_faces(100) };
    let locked = run_with(&mesh, EdgeLength, Midpoint, options);
    let border = |mesh: &TriMesh| {
        let on_border = |p: &&DVec3| [0.0, 12.0].contains(&p.x) || [0.0, 12.0].contains(&p.y);
        mesh.positions.iter().filter(on_border).map(|p| p.to_array().map(f64::to_bits)).collect()
    };
    let kept: BTreeSet<_> = border(&mesh);
    assert_eq!(kept.len(), 48);
    assert_eq!(border(&locked.mesh), kept);
    assert!(locked.statistics.n_faces <= 100, "{:?}", locked.statistics);
}

#[test]
fn stops_at_the_cost() {
    let mesh = grid(10, |_, _| 0.0);
    let stop = Stop { cost: Some(1.2), ..Stop::default() };
    let options = SimplifyOptions { stop, ..SimplifyOptions::default() };
    let statistics = run_with(&mesh, EdgeLength, Midpoint, options).statistics;
    assert_eq!(statistics.outcome, Outcome::CostReached);
    assert!(statistics.largest_cost.is_some_and(|cost| cost <= 1.2));
    assert!(statistics.n_faces < 200);
}

#[test]
fn control_cancels_and_sees_progress() {
    let mesh = torus(30);
    let (mut cost, mut placement) = (Quadric::default(), Optimal::default());
    let cancel = Control::new(&|_| ControlFlow::Break(()));
    assert!(simplify(&mesh, &mut cost, &mut placement, to_faces(10), cancel).is_err());
    let last = Mutex::new(0.0);
    let report = |fraction| {
        let mut last = last.lock().unwrap();
        assert!(fraction >= *last);
        *last = fraction;
        ControlFlow::Continue(())
    };
    let control = Control::new(&report);
    simplify(&mesh, &mut cost, &mut placement, to_faces(100), control).unwrap();
    assert!(last.into_inner().unwrap() > 0.99);
}

#[test]
fn fan_of_many_faces_ends() {
    let n = 20_000;
    let rim = (0..n).map(|i| {
        let angle = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
        [angle.cos(), angle.sin(), 0.0]
    });
    let positions: Vec<_> = std::iter::once([0.0; 3]).chain(rim).collect();
    let faces: Vec<_> = (0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect();
    let result = by_quadric(&mesh_of(&positions, &faces), 16);
    assert_eq!(result.statistics.n_faces, 16);
    assert!((result.mesh.area() - std::f64::consts::PI).abs() < 0.2);
}

#[test]
fn odd_input_is_ordinary() {
    let cube = cube();
    // Two-sided: a copy of every face the other way round, as one simplex.
    let mut doubled = cube.clone();
    doubled.faces.extend(cube.faces.iter().map(|&[a, b, c]| [a, c, b]));
    let result = by_quadric(&doubled, 600);
    assert_eq!(result.statistics.n_faces, 600);
    assert_eq!(topology(&result.mesh), topology(&cube));
    // Degenerate faces, an isolated vertex, a face out of range and points that are no numbers.
    let mut odd = cube.clone();
    odd.faces.extend([[VertexId(0); 3], [VertexId(0), VertexId(0), VertexId(1)]]);
    odd.faces.push([VertexId(0), VertexId(1), VertexId(9999)]);
    odd.positions.push(DVec3::ONE);
    odd.positions[40].x = f64::NAN;
    odd.positions[80].y = f64::INFINITY;
    let result = by_quadric(&odd, 100);
    assert_eq!(topology(&result.mesh).euler, 2);
    assert_eq!(result.mesh.positions.iter().filter(|p| !p.is_finite()).count(), 2);
    for mesh in [TriMesh::default(), mesh_of(&[[0.0; 3]; 3], &[[0, 1, 2], [0, 2, 1]])] {
        assert_eq!(by_quadric(&mesh, 0).mesh.faces, mesh.faces);
    }
}

fn soup() -> impl Strategy<Value = TriMesh> {
    let coordinate = prop_oneof![
        8 => -2.0..2.0,
        4 => (-2i32..3).prop_map(f64::from),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, 1e300, -1e-300]),
    ];
    let points = prop::collection::vec(prop::array::uniform3(coordinate), 3..14);
    points.prop_flat_map(|points| {
        let n = points.len() as u32;
        prop::collection::vec(prop::array::uniform3(0..n), 0..60)
            .prop_map(move |faces| mesh_of(&points, &faces))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn soup_keeps_its_topology(mesh in soup(), n in 0usize..30, flip in any::<bool>()) {
        let proper: Vec<_> = mesh.faces.iter().copied()
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        let before = topology(&TriMesh::new(mesh.positions.clone(), proper));
        let mut options = to_faces(n);
        if flip {
            options.turns = Turns::Any;
        }
        for result in [
            run_with(&mesh, EdgeLength, Midpoint, options),
            run_with(&mesh, Quadric::default(), Endpoint, options),
            run_with(&mesh, Quadric::default(), Optimal::default(), options),
        ] {
            prop_assert!(result.mesh.check().is_ok());
            if result.statistics.outcome == Outcome::TargetReached {
                prop_assert!(result.mesh.faces.len() <= n);
            }
            prop_assert_eq!(&topology(&result.mesh), &before);
        }
    }
}

/// A grid with texture coordinates equal to position / 8, and a seam along `x = 4` beyond which
/// they are shifted by 10. Every corner of one side shares the values of the other layers.
pub(super) fn textured() -> TriMesh {
    textured_on(grid(8, |x, y| 0.3 * (x * 0.5).sin() + 0.2 * (y * 0.8).cos()))
}

fn textured_on(mut mesh: TriMesh) -> TriMesh {
    let at = |f: usize, k: usize| mesh.positions[mesh.faces[f][k].idx()];
    let is_right = |f: usize| (0..3).map(|k| at(f, k).x).sum::<f64>() > 12.0;
    let texcoords: Vec<DVec2> = (0..3 * mesh.faces.len())
        .map(|c| {
            let shift = if is_right(c / 3) { 10.0 } else { 0.0 };
            at(c / 3, c % 3).truncate() / 8.0 + DVec2::new(shift, 0.0)
        })
        .collect();
    let groups = (0..mesh.faces.len()).map(|f| u32::from(is_right(f))).collect();
    let n_corners = texcoords.len() as u32;
    let heights = mesh.positions.iter().map(|p| p.x).collect();
    let n_vertices = mesh.positions.len() as u32;
    mesh.layers = vec![
        Layer {
            name: Layer::TEXCOORD.into(),
            domain: Domain::Corner,
            values: LayerValues::Vec2(texcoords),
            index: (0..n_corners).collect(),
        },
        Layer {
            name: Layer::GROUP.into(),
            domain: Domain::Face,
            values: LayerValues::Label(vec!["left".into(), "right".into()]),
            index: groups,
        },
        Layer {
            name: "x".into(),
            domain: Domain::Vertex,
            values: LayerValues::Number(heights),
            index: (0..n_vertices).collect(),
        },
        Layer {
            name: Layer::NORMAL.into(),
            domain: Domain::Vertex,
            values: LayerValues::Vec3(vec![DVec3::Z]),
            index: vec![0; n_vertices as usize],
        },
    ];
    mesh
}

fn texcoord(mesh: &TriMesh, corner: usize) -> DVec2 {
    let layer = mesh.layer(Layer::TEXCOORD).unwrap();
    let LayerValues::Vec2(values) = &layer.values else { panic!("texture coordinates are Vec2") };
    values[layer.index[corner] as usize]
}

/// How far a face of either side reaches over the seam, which was at x = 4.
fn off_seam(mesh: &TriMesh) -> f64 {
    let group = mesh.layer(Layer::GROUP).unwrap();
    let LayerValues::Label(names) = &group.values else { panic!("groups are labels") };
    let over = mesh.faces.iter().zip(&group.index).flat_map(|(face, &side)| {
        let sign = if names[side as usize] == "right" { -1.0 } else { 1.0 };
        face.map(|v| sign * (mesh.positions[v.idx()].x - 4.0))
    });
    over.fold(0.0, f64::max)
}

#[test]
fn seams_stay_and_values_follow() {
    let mesh = textured();
    let result = by_quadric(&mesh, 40).mesh;
    assert_eq!((result.check(), result.faces.len()), (Ok(()), 39));
    let group = result.layer(Layer::GROUP).unwrap();
    let LayerValues::Label(names) = &group.values else { panic!("groups are labels") };
    for f in 0..result.faces.len() {
        let is_right = names[group.index[f] as usize] == "right";
        for k in 0..3 {
            let p = result.positions[result.faces[f][k].idx()];
            let shift = if is_right { 10.0 } else { 0.0 };
            let off = texcoord(&result, 3 * f + k) - DVec2::new(shift, 0.0) - p.truncate() / 8.0;
            // A twentieth of the texture: the way a vertex moves off its edge.
            assert!(off.length() < 0.05, "{off} at {p}");
        }
    }
    // The seam curves with the surface, and each of its edges has two planes at right angles to the
    // faces there, which lean. Where edges merge these cannot all hold, so a vertex leaves the
    // plane of the seam a little: 2.2e-5 of an edge was measured.
    assert!(off_seam(&result) < 3e-5, "{}", off_seam(&result));
    // On a flat sheet they are one plane.
    let flat = by_quadric(&textured_on(grid(8, |_, _| 0.0)), 40).mesh;
    assert!(off_seam(&flat) < 1e-12, "{}", off_seam(&flat));
    let normals = result.layer(Layer::NORMAL).unwrap();
    assert_eq!(normals.values, LayerValues::Vec3(vec![DVec3::Z]));
}

#[test]
fn endpoint_keeps_exact_values() {
    let result = run_with(&textured(), Quadric::default(), Endpoint, to_faces(50)).mesh;
    for (f, face) in result.faces.iter().enumerate() {
        for (k, v) in face.iter().enumerate() {
            let left = result.positions[v.idx()].truncate() / 8.0;
            let found = texcoord(&result, 3 * f + k);
            assert!([left, left + DVec2::new(10.0, 0.0)].contains(&found), "{found}, not {left}");
        }
    }
    let layer = result.layer("x").unwrap();
    let LayerValues::Number(values) = &layer.values else { panic!("x is a number") };
    for (p, &value) in result.positions.iter().zip(&layer.index) {
        assert_eq!(p.x, values[value as usize]);
    }
}

#[test]
fn missing_values_stay_missing() {
    let mut mesh = textured();
    for layer in &mut mesh.layers {
        layer.index.fill(NO_VALUE);
    }
    let result = by_quadric(&mesh, 30).mesh;
    assert!(result.layers.iter().all(|l| l.index.iter().all(|&v| v == NO_VALUE)));
    assert_eq!(result.check(), Ok(()));
}
