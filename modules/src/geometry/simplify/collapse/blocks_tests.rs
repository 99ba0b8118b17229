//! Blocks against one queue, and what comes through the cuts.

use std::collections::HashMap;

use glam::DVec3;
use mve_mesh::adjacency::Adjacency;
use mve_mesh::data::{Domain, Layer, LayerValues, VertexId};
use mve_mesh::fixtures::torus;

use super::*;
use crate::cost::{EdgeLength, LindstromTurk, Quadric};
use crate::geometry::simplify::collapse::trial::first_prices;
use crate::geometry::simplify::collapse::{Schedule, simplify};
use crate::placement::{Endpoint, Midpoint, Optimal};

const N_BLOCK: usize = 700;

/// A wavy sheet of `2 n²` faces with a border.
fn sheet(n: u32) -> TriMesh {
    let place = |i: u32| {
        let (x, y) = (f64::from(i % (n + 1)), f64::from(i / (n + 1)));
        DVec3::new(x, y, 2.0 * (0.3 * x).sin() * (0.2 * y).cos())
    };
    let positions = (0..(n + 1) * (n + 1)).map(place).collect();
    let quad = |at: u32| {
        let a = at / n * (n + 1) + at % n;
        let [a, b, c, d] = [a, a + 1, a + n + 2, a + n + 1].map(VertexId);
        [[a, b, c], [a, c, d]]
    };
    TriMesh::new(positions, (0..n * n).flat_map(quad).collect())
}

fn options(ratio: f64) -> SimplifyOptions {
    let stop = Stop { ratio: Some(ratio), ..Stop::default() };
    SimplifyOptions { stop, ..SimplifyOptions::DEFAULT }
}

fn in_blocks(mesh: &TriMesh, cost: &mut dyn Cost, ratio: f64) -> Simplified {
    let (placement, options) = (&mut Optimal::default(), options(ratio));
    let found = simplify_in_blocks(mesh, cost, placement, options, N_BLOCK, Control::none());
    found.unwrap().unwrap()
}

fn in_one_queue(mesh: &TriMesh, ratio: f64) -> Simplified {
    let (cost, placement) = (&mut Quadric::default(), &mut Optimal::default());
    let options = SimplifyOptions { order: Schedule::Greedy, ..options(ratio) };
    simplify(mesh, cost, placement, options, Control::none()).unwrap()
}

/// Euler characteristic, and how many edges have other than two faces.
fn topology(mesh: &TriMesh) -> (i64, usize) {
    let adjacency = Adjacency::new(mesh, Control::none()).unwrap();
    let n_edges = adjacency.edges().len();
    let sides = |edge: u32| adjacency.sides_of(mve_mesh::adjacency::EdgeId(edge)).len();
    let n_odd = (0..n_edges as u32).filter(|&edge| sides(edge) != 2).count();
    (mesh.positions.len() as i64 - n_edges as i64 + mesh.faces.len() as i64, n_odd)
}

#[test]
fn joined_blocks_are_the_mesh_and_its_quadrics() {
    let mesh = sheet(40);
    let whole = |mesh: &TriMesh, origin: Origin| {
        let (cost, placement) = (&mut Quadric::default(), &mut Optimal::default());
        let control = Control::none();
        let engine =
            Engine::new(mesh, cost, placement, &mut [], options(0.1), origin, control).unwrap();
        engine.into_block().unwrap().0
    };
    let n_blocks = 5;
    let cut = Cut::new(&mesh, n_blocks, Control::none()).unwrap();
    assert!(cut.n_faces_at_cuts() > 100);
    let blocks: Vec<Block> = (0..n_blocks).map(|at| cut.block(&mesh, at)).collect();
    assert_eq!(blocks.iter().map(|block| block.faces.len()).sum::<usize>(), mesh.faces.len());
    let remains = blocks.iter().map(|block| {
        let working = whole(&block.mesh, Origin::Block(&block.is_cut));
        Remains::of(working, block, Control::none()).unwrap()
    });
    let joined = join(&mesh, remains.collect(), cut, Control::none()).unwrap();
    assert_eq!((&joined.mesh.positions, &joined.mesh.faces), (&mesh.positions, &mesh.faces));
    let joined = whole(&joined.mesh, Origin::Joined(&joined.is_cut, &joined.quadrics));
    let whole = whole(&mesh, Origin::Whole);
    let (mut n_seen, offset) = (0, DVec3::new(0.3, -0.7, 0.9));
    for vertex in (0..mesh.positions.len() as u32).map(VertexId) {
        let [found, expected] = [&joined, &whole].map(|mesh| mesh.quadric(vertex).at(offset));
        assert!((found / expected - 1.0).abs() < 1e-12, "{vertex:?} {found} {expected}");
        n_seen += 1;
    }
    assert_eq!(n_seen, 41 * 41);
}

#[test]
fn blocks_reach_the_target_with_the_error_of_one_queue_and_keep_the_topology() {
    let mesh = torus(1.0, 0.4, 64);
    let found = in_blocks(&mesh, &mut Quadric::default(), 0.1);
    let expected = in_one_queue(&mesh, 0.1);
    assert_eq!(found.mesh.faces.len(), expected.mesh.faces.len());
    assert_eq!(found.statistics.n_collapses, expected.statistics.n_collapses);
    assert_eq!(topology(&found.mesh), (0, 0));
    // How far the middles of faces are from the torus.
    let error = |mesh: &TriMesh| {
        let sum: f64 = mesh
            .faces
            .iter()
            .map(|face| {
                let middle: DVec3 = face.iter().map(|v| mesh.positions[v.idx()] / 3.0).sum();
                let ring = middle.truncate().length() - 1.0;
                (ring.hypot(middle.z) - 0.4).powi(2)
            })
            .sum();
        (sum / mesh.faces.len() as f64).sqrt()
    };
    let (found, expected) = (error(&found.mesh), error(&expected.mesh));
    assert!(found < 1.1 * expected, "{found} {expected}");
}

#[test]
fn borders_hold_across_blocks() {
    let mesh = sheet(60);
    let found = in_blocks(&mesh, &mut Quadric::default(), 0.05).mesh;
    assert_eq!(topology(&found).0, 1);
    let on_border =
        |p: &DVec3| [p.x, p.y].iter().any(|c| c.abs() < 0.05 || (c - 60.0).abs() < 0.05);
    let adjacency = Adjacency::new(&found, Control::none()).unwrap();
    for (at, ends) in adjacency.edges().iter().enumerate() {
        let edge = mve_mesh::adjacency::EdgeId(at as u32);
        if adjacency.sides_of(edge).len() == 1 {
            assert!(ends.iter().all(|v| on_border(&found.positions[v.idx()])), "{ends:?}");
        }
    }
}

#[test]
fn a_flat_mesh_ends_at_its_target() {
    let mut mesh = sheet(60);
    mesh.positions.iter_mut().for_each(|p| p.z = 0.0);
    for ratio in [0.3, 0.01, 0.0] {
        let found = in_blocks(&mesh, &mut Quadric::default(), ratio);
        let expected = in_one_queue(&mesh, ratio);
        assert_eq!(found.statistics.n_faces, expected.statistics.n_faces, "{ratio}");
    }
}

#[test]
fn layers_come_through_the_cuts() {
    let mut mesh = sheet(60);
    let heights = mesh.positions.iter().map(|p| p.x + 2.0 * p.y).collect();
    let n_vertices = mesh.positions.len() as u32;
    let layer =
        |name: &str, domain, values, index| Layer { name: name.to_owned(), domain, values, index };
    let names = ["left", "right"].map(str::to_owned).to_vec();
    let is_right = |face: &[VertexId; 3]| u32::from(face[0].0 % 61 >= 30);
    let sides = mesh.faces.iter().map(is_right).collect();
    // Two charts, which meet where the names do.
    let places = mesh.positions.iter().map(|p| p.truncate() / 60.0);
    let places: Vec<_> = places.clone().chain(places.map(|p| p + 1.0)).collect();
    let corners = mesh.faces.iter().flat_map(|face| {
        let chart = n_vertices * is_right(face);
        face.map(|v| v.0 + chart)
    });
    let corners = corners.collect();
    mesh.layers = vec![
        layer("height", Domain::Vertex, LayerValues::Number(heights), (0..n_vertices).collect()),
        layer(Layer::MATERIAL, Domain::Face, LayerValues::Label(names), sides),
        layer(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(places), corners),
    ];
    let found = in_blocks(&mesh, &mut Quadric::default(), 0.2).mesh;
    assert!((1438..=1440).contains(&found.faces.len()));
    let [height, material, texcoord] = &found.layers[..] else { panic!("three layers") };
    let LayerValues::Number(heights) = &height.values else { panic!("numbers") };
    for (p, &number) in found.positions.iter().zip(&height.index) {
        let (value, expected) = (heights[number as usize], p.x + 2.0 * p.y);
        assert!((value - expected).abs() < 2.0, "{value} {expected}");
    }
    let LayerValues::Label(names) = &material.values else { panic!("names") };
    let LayerValues::Vec2(places) = &texcoord.values else { panic!("places") };
    assert_eq!(names.len(), 2);
    for (at, face) in found.faces.iter().enumerate() {
        let chart = if names[material.index[at] as usize] == "right" { 1.0 } else { 0.0 };
        for (k, v) in face.iter().enumerate() {
            let expected = found.positions[v.idx()].truncate() / 60.0 + chart;
            let place = places[texcoord.index[3 * at + k] as usize];
            assert!(place.distance(expected) < 0.05, "{place} {expected}");
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let mesh = torus(1.0, 0.3, 60);
    for cost in [&mut Quadric::default() as &mut dyn Cost, &mut LindstromTurk] {
        let mut on = |n_threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| in_blocks(&mesh, cost, 0.15).mesh)
        };
        let (one, many) = (on(1), on(5));
        assert_eq!((one.positions, one.faces), (many.positions, many.faces));
    }
}

#[test]
fn blocks_hear_a_cancel_and_report_forwards() {
    let mesh = torus(1.0, 0.4, 64);
    let last = std::sync::Mutex::new(0.0);
    let stop_at = |limit: f64| {
        *last.lock().unwrap() = 0.0;
        let report = |share: f64| {
            *last.lock().unwrap() = share;
            if share < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let (cost, placement) = (&mut Quadric::default(), &mut Optimal::default());
        let control = Control::new(&report);
        simplify_in_blocks(&mesh, cost, placement, options(0.1), N_BLOCK, control).map(|_| ())
    };
    assert_eq!(stop_at(2.0), Ok(()));
    assert!(*last.lock().unwrap() > 0.99);
    assert_eq!(stop_at(0.3), Err(Cancelled));
    assert_eq!(stop_at(0.0), Err(Cancelled));
}

#[test]
fn what_does_not_fit_is_left_alone() {
    let mesh = torus(1.0, 0.4, 32);
    let run = |options: SimplifyOptions| {
        let (cost, placement) = (&mut Quadric::default(), &mut Optimal::default());
        simplify_in_blocks(&mesh, cost, placement, options, 200, Control::none()).unwrap()
    };
    assert!(run(options(0.1)).is_some());
    assert!(run(options(0.9)).is_none());
    assert!(run(SimplifyOptions::DEFAULT).is_none());
    let cost = Stop { cost: Some(1.0), ..options(0.1).stop };
    assert!(run(SimplifyOptions { stop: cost, ..options(0.1) }).is_none());
}

#[test]
fn prices_of_a_block_are_those_of_the_whole() {
    let mesh = sheet(40);
    let cut = Cut::new(&mesh, 4, Control::none()).unwrap();
    let blocks: Vec<Block> = (0..4).map(|at| cut.block(&mesh, at)).collect();
    for (cost, placement) in [
        (&mut Quadric::default() as &mut dyn Cost, &mut Optimal::default() as &mut dyn Placement),
        (&mut LindstromTurk, &mut crate::placement::LindstromTurk),
        (&mut EdgeLength, &mut Midpoint),
        (&mut EdgeLength, &mut Endpoint),
    ] {
        let mut cost_of_block = cost.for_block().unwrap();
        let mut placement_of_block = placement.for_block().unwrap();
        let whole: HashMap<[u32; 2], f64> = first_prices(&mesh, cost, placement)
            .into_iter()
            .map(|(from, to, price)| ([from, to], price))
            .collect();
        let mut n_inner = 0;
        for block in &blocks {
            let (cost, placement) = (cost_of_block.as_mut(), placement_of_block.as_mut());
            for (from, to, price) in first_prices(&block.mesh, cost, placement) {
                if [from, to].iter().all(|v| !block.is_cut[*v as usize]) {
                    let expected = whole[&[from, to].map(|v| block.vertices[v as usize])];
                    assert!((price - expected).abs() <= 1e-9 * expected, "{price} {expected}");
                    n_inner += 1;
                }
            }
        }
        assert!(n_inner > 2000, "{n_inner}");
    }
}
