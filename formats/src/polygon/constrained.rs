//! Cuts a polygon of any size by a constrained Delaunay triangulation of its vertices.
//!
//! The predicates of the crate spade are exact, so that nothing hangs on a tolerance. Edges are
//! inserted, each with its ends, in rounds that double, each in random company and along the
//! polygon (N. Amenta, S. Choi and G. Rote, "Incremental constructions con BRIO", SoCG 2003). So an
//! edge crosses few edges between the points that are there before it, however long it is (J. R.
//! Shewchuk and B. C. Brown, "Fast segment insertion and incremental construction of constrained
//! Delaunay triangulations", Computational Geometry 48, 2015): with all points first, each of many
//! long slanting teeth would cross up to n.
//!
//! There is no bound of n log n: the crate finds the place of a point by a walk to the vertex
//! nearest to it, which may lie behind many long thin triangles, and which looks at all neighbors
//! of a vertex on its way. A comb is slow where an end of the strip below its teeth is there early
//! and has most of the teeth as neighbors; `obj/comb` in `benches/obj.rs` measures two. Points
//! along a space-filling curve in each round are no remedy: neighbors on the curve have many teeth
//! between them.
//!
//! What the crate does not know is that several corners may lie on one point: where a polygon is
//! joined to its holes by bridges that it walks both ways, or touches itself. There a triangle
//! belongs to the corner whose wedge it lies in, the one between the edge to the next corner and
//! that to the previous.

use std::collections::HashMap;

use glam::DVec2;
use mve_core::{Cancelled, Control};
use spade::handles::{FixedDirectedEdgeHandle, FixedVertexHandle};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use mve_mesh::morton::sort_by_code;
use mve_mesh::random::IndexedRandom;

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
    let ring = without_spikes(flat, triangles, control)?;
    let is_covered = ring.len() < 3 || cover_ring(flat, &ring, triangles, control)?.is_some();
    if !is_covered {
        triangles.truncate(n_before);
    }
    Ok(is_covered)
}

/// The ring without corners that lie on a neighbor and without tips of spikes, which are walked
/// there and back. Each of them gives a flat triangle.
fn without_spikes(
    flat: &[DVec2],
    triangles: &mut Vec<[u32; 3]>,
    control: Control,
) -> Result<Vec<u32>, Cancelled> {
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
        control.item(corner as usize, usize::MAX)?;
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
    Ok(ring.split_off(first))
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
    let mut site_of: Vec<u32> = Vec::with_capacity(ring.len());
    for (place, &corner) in ring.iter().enumerate() {
        control.item(place, usize::MAX)?;
        let [x, y] = flat[corner as usize].to_array().map(|x| plain(x * scale));
        site_of.push(*known.entry([x, y].map(f64::to_bits)).or_insert_with(|| {
            sites.push(Site { point: Point2::new(x, y), corner });
            sites.len() as u32 - 1
        }));
    }
    let mut mesh = ConstrainedDelaunayTriangulation::<Site>::new();
    let mut handles: Vec<Option<FixedVertexHandle>> = vec![None; sites.len()];
    let mut last: Option<[FixedVertexHandle; 2]> = None;
    for (number, place) in insertion_order(ring.len(), control)?.into_iter().enumerate() {
        if number.is_multiple_of(EDGES) {
            control.at(0.0)?;
        }
        let next = (place as usize + 1) % ring.len();
        let ends = [place as usize, next].map(|place| site_of[place] as usize);
        let known = [handles[ends[0]], handles[ends[1]]];
        let Some(added) = insert_ends(&mut mesh, ends.map(|end| sites[end]), known, last) else {
            return Ok(None);
        };
        if mesh.try_add_constraint(added[0], added[1]).is_empty() {
            return Ok(None);
        }
        ends.into_iter().zip(added).for_each(|(end, handle)| handles[end] = Some(handle));
        last = Some(added);
    }
    let mut nodes: Vec<Node> = Vec::with_capacity(ring.len());
    for (place, &corner) in (0u32..).zip(ring) {
        if place.is_multiple_of(POINTS as u32) {
            control.at(0.0)?;
        }
        let next = (place as usize + 1) % ring.len();
        let ends = [place as usize, next].map(|place| handles[site_of[place] as usize]);
        let [Some(from), Some(to)] = ends else { return Ok(None) };
        if add_edge(&mut mesh, corner, [from, to], &mut nodes).is_none() {
            return Ok(None);
        }
    }
    assign(&mesh, &nodes, triangles, control)
}

/// The order in which to insert edges: half of them last, half of the others before, and so on.
fn insertion_order(n: usize, control: Control) -> Result<Vec<u32>, Cancelled> {
    let random = IndexedRandom::new(0);
    let mut order = Vec::with_capacity(n);
    for place in 0..n as u32 {
        control.item(place as usize, usize::MAX)?;
        let round = u64::from(u64::BITS - random.bits(u64::from(place)).trailing_zeros());
        order.push((round, place));
    }
    sort_by_code(&mut order, control)?;
    Ok(order.into_iter().map(|(_, place)| place).collect())
}

/// The vertices of both ends of an edge, inserted where they are not known. Points are found by a
/// walk, which is short from the edge before, and from one end of an edge to the other.
fn insert_ends(
    mesh: &mut ConstrainedDelaunayTriangulation<Site>,
    ends: [Site; 2],
    known: [Option<FixedVertexHandle>; 2],
    last: Option<[FixedVertexHandle; 2]>,
) -> Option<[FixedVertexHandle; 2]> {
    let mut found = known;
    if let ([None, None], Some(last)) = (found, last) {
        let apart = |hint: FixedVertexHandle, end: usize| {
            mesh.vertex(hint).position().distance_2(ends[end].point)
        };
        let pairs = last.into_iter().flat_map(|hint| [(hint, 0), (hint, 1)]);
        let nearest = pairs.min_by(|a, b| apart(a.0, a.1).total_cmp(&apart(b.0, b.1)));
        let (hint, end) = nearest?;
        found[end] = Some(mesh.insert_with_hint(ends[end], hint).ok()?);
    }
    for end in 0..2 {
        if found[end].is_none() {
            found[end] = Some(
                match found[1 - end] {
                    Some(from) => {
                        let hint = neighbor_toward(mesh, from, ends[end].point);
                        mesh.insert_with_hint(ends[end], hint)
                    }
                    None => mesh.insert(ends[end]),
                }
                .ok()?,
            );
        }
    }
    found[0].zip(found[1]).map(|(from, to)| [from, to])
}

/// Of a vertex and the neighbor that lies most in the direction of a point, the nearer to it: a
/// start for the walk there. From the vertex alone the crate goes to the first neighbor that is
/// nearer to the point, which may be one with neighbors everywhere, and looks at all of these.
fn neighbor_toward(
    mesh: &ConstrainedDelaunayTriangulation<Site>,
    from: FixedVertexHandle,
    point: Point2<f64>,
) -> FixedVertexHandle {
    let at = |p: Point2<f64>| DVec2::new(p.x, p.y);
    let vertex = mesh.vertex(from);
    let start = at(vertex.position());
    let way = at(point) - start;
    let along = |to: DVec2| way.dot(to - start) / (to - start).length();
    let neighbors = vertex.out_edges().map(|edge| edge.to());
    let ahead = neighbors
        .map(|neighbor| (along(at(neighbor.position())), neighbor))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match ahead {
        Some((_, neighbor)) if neighbor.position().distance_2(point) < way.length_squared() => {
            neighbor.fix()
        }
        _ => from,
    }
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
    control: Control,
) -> Result<Option<()>, Cancelled> {
    let mut corners = vec![[NONE; 3]; mesh.num_all_faces()];
    for (place, node) in nodes.iter().enumerate() {
        control.item(place, usize::MAX)?;
        let before = &nodes[(place + nodes.len() - 1) % nodes.len()];
        if fill_wedge(mesh, [before, node], &mut corners).is_none() {
            return Ok(None);
        }
    }
    let n_before = triangles.len();
    for (place, triangle) in corners.into_iter().enumerate() {
        control.item(place, usize::MAX)?;
        if triangle == [NONE; 3] {
            continue;
        }
        if triangle.contains(&NONE) {
            return Ok(None);
        }
        triangles.push(triangle);
    }
    Ok((triangles.len() - n_before + 2 == nodes.len()).then_some(()))
}

/// Gives the corner of a node the triangles between its edge and that of the node before; `None`
/// where another corner has one of them.
fn fill_wedge(
    mesh: &ConstrainedDelaunayTriangulation<Site>,
    [before, node]: [&Node; 2],
    corners: &mut [[u32; 3]],
) -> Option<()> {
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
            return Some(());
        }
    }
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
