//! Cuts a polygon of any size by a constrained Delaunay triangulation of its vertices.
//!
//! The predicates of the crate spade are exact, so that nothing hangs on a tolerance. Points are
//! inserted in rounds that double, each in random company and along a curve (N. Amenta, S. Choi and
//! G. Rote, "Incremental constructions con BRIO", SoCG 2003), in O(n log n) whatever they are; the
//! order of the crate's own loader takes the square of it on circles. An edge of the polygon then
//! takes as long as it crosses edges between the points: few for outlines, but up to n for each of
//! many long, slanting teeth.
//!
//! What the crate does not know is that several corners may lie on one point: where a polygon is
//! joined to its holes by bridges that it walks both ways, or touches itself. There a triangle
//! belongs to the corner whose wedge it lies in, the one between the edge to the next corner and
//! that to the previous.

use std::cmp::Reverse;
use std::collections::HashMap;

use glam::{DVec2, DVec3};
use mve_core::{Cancelled, Control};
use spade::handles::{FixedDirectedEdgeHandle, FixedVertexHandle};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::geometry::distance::sample::IndexedRandom;
use crate::mesh::morton::morton_order;

/// Points, and edges, between two looks whether the work was cancelled.
const POINTS: usize = 1 << 10;
const EDGES: usize = 1 << 4;

/// No corner.
const NONE: u32 = u32::MAX;

/// A point of the plane and the first corner there.
#[derive(Clone, Copy)]
struct Site {
    point: Point2<f64>,
    corner: u32,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.point
    }
}

/// A corner of the ring and the edge to the next one.
struct Node {
    corner: u32,
    edge: FixedDirectedEdgeHandle,
}

/// Appends triangles that cover the counter-clockwise polygon with these corners: n - 2 of them,
/// and one more for each point at which the polygon touches one of its own edges. `false` and no
/// triangle where it crosses itself.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub(super) fn cover(
    flat: &[DVec2],
    triangles: &mut Vec<[u32; 3]>,
    control: Control,
) -> Result<bool, Cancelled> {
    let n_before = triangles.len();
    let ring = without_spikes(flat, triangles);
    let is_covered = ring.len() < 3 || cover_ring(flat, &ring, triangles, control)?.is_some();
    if !is_covered {
        triangles.truncate(n_before);
    }
    Ok(is_covered)
}

/// The ring without corners that lie on a neighbor and without tips of spikes, which are walked
/// there and back. Each of them gives a flat triangle.
fn without_spikes(flat: &[DVec2], triangles: &mut Vec<[u32; 3]>) -> Vec<u32> {
    let point = |corner: u32| flat[corner as usize];
    let is_spike = |[a, b, c]: [u32; 3]| {
        let [a, b, c] = [a, b, c].map(point);
        a == b || b == c || a == c
    };
    let mut ring: Vec<u32> = Vec::with_capacity(flat.len());
    let mut shorten = |ring: &mut Vec<u32>| {
        while let [.., a, b, c] = ring[..] {
            if !is_spike([a, b, c]) {
                return;
            }
            triangles.push([a, b, c]);
            ring.remove(ring.len() - 2);
        }
    };
    for corner in 0..flat.len() as u32 {
        ring.push(corner);
        shorten(&mut ring);
    }
    // Spikes may lie across the start, too.
    let mut first = 0;
    while ring.len() - first >= 3 {
        let [a, b, y, z] =
            [ring[first], ring[first + 1], ring[ring.len() - 2], ring[ring.len() - 1]];
        if is_spike([y, z, a]) {
            triangles.push([y, z, a]);
            ring.pop();
        } else if is_spike([z, a, b]) {
            triangles.push([z, a, b]);
            first += 1;
        } else {
            break;
        }
    }
    ring.split_off(first)
}

fn cover_ring(
    flat: &[DVec2],
    ring: &[u32],
    triangles: &mut Vec<[u32; 3]>,
    control: Control,
) -> Result<Option<()>, Cancelled> {
    let scale = scale_of(flat);
    let mut known: HashMap<[u64; 2], u32> = HashMap::new();
    let mut sites: Vec<Site> = Vec::new();
    let site_of: Vec<u32> = ring
        .iter()
        .map(|&corner| {
            let [x, y] = flat[corner as usize].to_array().map(|x| plain(x * scale));
            *known.entry([x, y].map(f64::to_bits)).or_insert_with(|| {
                sites.push(Site { point: Point2::new(x, y), corner });
                sites.len() as u32 - 1
            })
        })
        .collect();
    let mut mesh = ConstrainedDelaunayTriangulation::<Site>::new();
    let mut handles = vec![FixedVertexHandle::from_index(0); sites.len()];
    for (place, number) in insertion_order(&sites, control)?.into_iter().enumerate() {
        if place.is_multiple_of(POINTS) {
            control.at(0.0)?;
        }
        let Ok(handle) = mesh.insert(sites[number as usize]) else { return Ok(None) };
        handles[number as usize] = handle;
    }
    let mut nodes: Vec<Node> = Vec::with_capacity(ring.len());
    for (place, &corner) in ring.iter().enumerate() {
        if place.is_multiple_of(EDGES) {
            control.at(0.0)?;
        }
        let next = (place + 1) % ring.len();
        let ends = [place, next].map(|place| handles[site_of[place] as usize]);
        if add_edge(&mut mesh, corner, ends, &mut nodes).is_none() {
            return Ok(None);
        }
    }
    Ok(assign(&mesh, &nodes, triangles))
}

/// The order in which to insert points: half of them last, half of the others before, and so on.
fn insertion_order(sites: &[Site], control: Control) -> Result<Vec<u32>, Cancelled> {
    let random = IndexedRandom::new(0);
    let points: Vec<DVec3> = sites.iter().map(|s| DVec3::new(s.point.x, s.point.y, 0.0)).collect();
    let mut order = morton_order(&points, control.part(0.0, 0.0))?;
    order.sort_by_key(|&number| Reverse(random.bits(u64::from(number)).trailing_zeros()));
    Ok(order)
}

/// Adds the edge from a corner to the next, with a node for each part where it meets other points;
/// `None` where it crosses another one.
fn add_edge(
    mesh: &mut ConstrainedDelaunayTriangulation<Site>,
    corner: u32,
    [from, to]: [FixedVertexHandle; 2],
    nodes: &mut Vec<Node>,
) -> Option<()> {
    let edges = mesh.try_add_constraint(from, to);
    let mut at = from;
    for edge in edges {
        let handle = mesh.directed_edge(edge);
        let corner = if at == from { corner } else { handle.from().data().corner };
        // Both ends as they follow each other on the way.
        let is_forth = handle.from().fix() == at;
        nodes.push(Node { corner, edge });
        at = is_forth.then(|| handle.to().fix())?;
    }
    (at == to).then_some(())
}

/// Gives each corner the triangles in its wedge; `None` unless they cover the polygon once.
fn assign(
    mesh: &ConstrainedDelaunayTriangulation<Site>,
    nodes: &[Node],
    triangles: &mut Vec<[u32; 3]>,
) -> Option<()> {
    let mut corners = vec![[NONE; 3]; mesh.num_all_faces()];
    for (place, node) in nodes.iter().enumerate() {
        let before = &nodes[(place + nodes.len() - 1) % nodes.len()];
        let last = mesh.directed_edge(before.edge).rev().fix();
        let mut edge = mesh.directed_edge(node.edge);
        loop {
            let face = edge.face().as_inner()?;
            let own = edge.from().fix();
            let k = face.vertices().iter().position(|vertex| vertex.fix() == own)?;
            let slot = &mut corners[face.fix().index()][k];
            (*slot == NONE).then_some(())?;
            *slot = node.corner;
            edge = edge.prev().rev();
            if edge.fix() == last {
                break;
            }
        }
    }
    let n_before = triangles.len();
    for triangle in corners.into_iter().filter(|triangle| *triangle != [NONE; 3]) {
        (!triangle.contains(&NONE)).then_some(())?;
        triangles.push(triangle);
    }
    (triangles.len() - n_before + 2 == nodes.len()).then_some(())
}

/// The power of two that brings the coordinates to where the crate takes them; mostly 1.
fn scale_of(flat: &[DVec2]) -> f64 {
    let most = flat.iter().fold(0.0_f64, |most, point| most.max(point.abs().max_element()));
    let exponent = most.to_bits() >> 52;
    if (1e-20..1e50).contains(&most) || exponent == 0 {
        return 1.0;
    }
    // 2 to the minus exponent, without the bias of 1023 on both sides.
    f64::from_bits((2046 - exponent).max(1) << 52)
}

/// Zero without a sign, also for what the crate finds too small.
fn plain(x: f64) -> f64 {
    if x.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { x }
}
