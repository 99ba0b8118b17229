//! Tests of what goes stale around a collapse, and of the rules where a seam ends.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec2, DVec3};
use mve_mesh::adjacency::EdgeId;
use mve_mesh::data::{Domain, Layer, LayerValues, VertexId};

use super::attributes::SeamRule;
use super::marks::VertexMarks;
use super::tests::{grid, run_with, to_faces, torus};
use super::ticker::Ticker;
use super::*;
use crate::placement::{Endpoint, Midpoint};

/// Prices an edge by its length and by how many faces lie around the vertices within `rings` edges
/// of its ends, so that a collapse changes prices up to `rings` edges away.
#[derive(Clone, Copy)]
struct Crowding {
    rings: u32,
    reach: Reach,
}

impl Crowding {
    fn at(mesh: &WorkingMesh, vertex: VertexId, rings: u32) -> f64 {
        let faces = || mesh.faces_around(vertex).filter_map(|face| mesh.face(face));
        let beyond = |v: VertexId| if rings > 1 { Self::at(mesh, v, rings - 1) } else { 0.0 };
        let of = |v: &VertexId| mesh.position(vertex).distance(mesh.position(*v)) + beyond(*v);
        faces().flatten().filter(|v| *v != vertex).map(|v| of(&v)).sum()
    }
}

impl Cost for Crowding {
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        for (price, Proposal { contraction: ends, .. }) in prices.iter_mut().zip(batch) {
            let length = mesh.position(ends.kept).distance(mesh.position(ends.gone));
            let around = [ends.kept, ends.gone].map(|v| Self::at(mesh, v, self.rings));
            *price = length * (around[0] + around[1]);
        }
    }

    fn reach(&self) -> Reach {
        self.reach
    }
}

#[test]
fn what_is_beyond_the_reach_needs_no_new_price() {
    let mesh = torus(12);
    for rings in [1, 2] {
        let with = |reach| {
            let cost = Crowding { rings, reach: Reach(reach) };
            run_with(&mesh, cost, Midpoint, to_faces(60))
        };
        let [shorter, exact, all] = [rings - 1, rings, 100].map(with);
        assert_eq!(exact.mesh, all.mesh, "{rings} rings");
        assert_eq!(exact.statistics.n_faces, 60);
        assert_ne!(shorter.mesh, all.mesh, "a reach of {} should show", rings - 1);
    }
}

/// A cost that counts what it is asked.
struct Counted {
    cost: Crowding,
    renewal: Renewal,
    n_asked: Arc<AtomicUsize>,
}

impl Cost for Counted {
    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        self.n_asked.fetch_add(batch.len(), Ordering::Relaxed);
        self.cost.price(mesh, batch, prices);
    }

    fn reach(&self) -> Reach {
        self.cost.reach
    }

    fn renewal(&self) -> Renewal {
        self.renewal
    }
}

#[test]
fn lazy_prices_that_fall_little_change_no_result() {
    // One collapse changes the sum of lengths around a vertex by much less than two thirds.
    let mesh = torus(12);
    let with = |renewal| {
        let n_asked = Arc::new(AtomicUsize::new(0));
        let cost = Crowding { rings: 1, reach: Reach::NEIGHBORS };
        let cost = Counted { cost, renewal, n_asked: n_asked.clone() };
        let mesh = run_with(&mesh, cost, Midpoint, to_faces(100)).mesh;
        (mesh, n_asked.load(Ordering::Relaxed))
    };
    let (at_once, lazy) = (with(Renewal::AtOnce), with(Renewal::Lazy));
    assert_eq!(lazy.0, at_once.0);
    assert!(lazy.1 < at_once.1, "{} prices instead of {}", lazy.1, at_once.1);
}

const SHIFT: DVec2 = DVec2::new(0.5, 0.0);

/// A grid with texture coordinates equal to position / 8, cut along `x = 4` and `x = 5` from the
/// border up to `y = 4`, where both seams end: the side to the right of a cut is shifted.
fn cut() -> TriMesh {
    let mut mesh = grid(8, |x, y| 0.3 * (x * 0.5).sin() + 0.2 * (y * 0.8).cos());
    let value = |face: &[VertexId; 3], v: VertexId| {
        let p = mesh.positions[v.idx()].truncate();
        let is_cut = (p.x == 4.0 || p.x == 5.0) && p.y < 4.0;
        let is_right = face.iter().any(|w| mesh.positions[w.idx()].x > p.x);
        p / 8.0 + if is_cut && is_right { SHIFT } else { DVec2::ZERO }
    };
    let values: Vec<DVec2> =
        mesh.faces.iter().flat_map(|face| face.map(|v| value(face, v))).collect();
    // Each corner has a value of its own: what makes a wedge is that values are equal.
    let index = (0..values.len() as u32).collect();
    mesh.layers = vec![Layer {
        name: Layer::TEXCOORD.into(),
        domain: Domain::Corner,
        values: LayerValues::Vec2(values),
        index,
    }];
    mesh
}

#[test]
fn seam_rules_at_its_end() {
    let mesh = cut();
    let (mut marks, mut ticker) =
        (VertexMarks::new(mesh.positions.len()), Ticker::new(Control::none()));
    let working = WorkingMesh::new(&mesh, Seams::Kept, &mut marks, &mut ticker).unwrap();
    let complex = &working.complex;
    // The only place left to the edge between two points of the grid, or what else holds for it.
    let rule = |from: [f64; 2], to: [f64; 2]| {
        let at = |v: u32| complex.position(v).truncate().to_array();
        let is_edge = |[a, b]: [u32; 2]| [[from, to], [to, from]].contains(&[at(a), at(b)]);
        let edge = complex.edges.iter().position(|&ends| is_edge(ends)).unwrap();
        match working.attributes.seam_rule(complex, EdgeId(edge as u32)) {
            SeamRule::OnlyAtKept => Ok(at(complex.edges[edge][0])),
            SeamRule::OnlyAtGone => Ok(at(complex.edges[edge][1])),
            other => Err(other),
        }
    };
    // Along the seam anything goes, at its end only the end, and off the seam not its vertices.
    assert_eq!(rule([4.0, 1.0], [4.0, 2.0]), Err(SeamRule::Anywhere));
    assert_eq!(rule([4.0, 3.0], [4.0, 4.0]), Ok([4.0, 4.0]));
    assert_eq!(rule([4.0, 4.0], [4.0, 5.0]), Err(SeamRule::Anywhere));
    assert_eq!(rule([3.0, 2.0], [4.0, 2.0]), Ok([4.0, 2.0]));
    assert_eq!(rule([4.0, 3.0], [5.0, 4.0]), Ok([4.0, 3.0]));
    // From seam to seam, and between the ends of two.
    assert_eq!(rule([4.0, 2.0], [5.0, 2.0]), Err(SeamRule::Nowhere));
    assert_eq!(rule([4.0, 4.0], [5.0, 4.0]), Err(SeamRule::Anywhere));
}

#[test]
fn seam_that_ends_keeps_exact_values() {
    let result = run_with(&cut(), crate::cost::Quadric::default(), Endpoint, to_faces(40)).mesh;
    let layer = result.layer(Layer::TEXCOORD).unwrap();
    let LayerValues::Vec2(values) = &layer.values else { panic!("texture coordinates are Vec2") };
    let mut n_shifted = 0;
    for (corner, v) in result.faces.iter().flatten().enumerate() {
        let DVec3 { x, y, .. } = result.positions[v.idx()];
        let off = values[layer.index[corner] as usize] - DVec2::new(x, y) / 8.0;
        assert!(off == DVec2::ZERO || (off == SHIFT && [4.0, 5.0].contains(&x) && y < 4.0));
        n_shifted += usize::from(off == SHIFT);
    }
    assert!(n_shifted > 0);
}
