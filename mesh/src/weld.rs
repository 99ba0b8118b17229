//! Joins vertices that lie at one place, or nearly so.
//!
//! Files made from STL, or exported a face at a time, give each face vertices of its own: what
//! looks like a surface is a heap of triangles. Which vertices are joined does not depend on their
//! order.

use std::collections::HashMap;

use glam::DVec3;
use mve_core::{Cancelled, Control};

use crate::adjacency::{Adjacency, EdgeId};
use crate::data::{Domain, Layer, TriMesh, VertexId};
use crate::union_find::UnionFind;

/// Tolerances below this part of the diagonal are those of rounding, and count as none.
const LEAST: f64 = 1e-12;

/// A mesh whose vertices were joined.
#[derive(Clone, Debug)]
pub struct Welded {
    /// The mesh.
    pub mesh: TriMesh,
    /// Vertices that became another one.
    pub n_joined: usize,
    /// Faces that are left out, since two of their corners became one.
    pub n_left_out: usize,
}

/// Joins vertices that are at most `tolerance` apart, in parts of the diagonal of the bounding box,
/// and those that chains of such vertices link. O(n log n) where few vertices lie within a
/// tolerance.
///
/// The joined vertex has the number and the layers of the lowest of them, and the position that is
/// least by x, then y, then z. Vertices and faces keep their order. Coordinates that are not finite
/// join nothing.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn weld(mesh: &TriMesh, tolerance: f64, control: Control) -> Result<Welded, Cancelled> {
    let mut places = same_places(&mesh.positions, control.part(0.0, 0.3))?;
    let mut positions = mesh.positions.clone();
    let distance = tolerance * finite_diagonal(mesh);
    if tolerance > LEAST && distance > 0.0 && distance.is_finite() {
        join_near(&mut positions, &mut places, distance, control.part(0.3, 0.8))?;
    }
    let mut numbers = vec![u32::MAX; positions.len()];
    let kept: Vec<usize> = (0..positions.len()).filter(|&v| places[v] == v as u32).collect();
    kept.iter().zip(0_u32..).for_each(|(&vertex, number)| numbers[vertex] = number);
    let names_twice = |[a, b, c]: [VertexId; 3]| a == b || b == c || c == a;
    let (mut faces, mut kept_faces) = (Vec::with_capacity(mesh.faces.len()), Vec::new());
    for (number, &face) in mesh.faces.iter().enumerate() {
        control.item(number, mesh.faces.len())?;
        let joined = face.map(|vertex| VertexId(numbers[places[vertex.idx()] as usize]));
        if names_twice(face) || !names_twice(joined) {
            faces.push(joined);
            kept_faces.push(number);
        }
    }
    let mut welded = TriMesh::new(kept.iter().map(|&vertex| positions[vertex]).collect(), faces);
    welded.layers = mesh.layers.iter().map(|layer| layer_of(layer, &kept, &kept_faces)).collect();
    welded.materials.clone_from(&mesh.materials);
    Ok(Welded {
        n_joined: mesh.positions.len() - kept.len(),
        n_left_out: mesh.faces.len() - kept_faces.len(),
        mesh: welded,
    })
}

/// The diagonal of the box around the finite vertices that faces use.
pub fn finite_diagonal(mesh: &TriMesh) -> f64 {
    let used = mesh.faces.iter().flatten().map(|vertex| mesh.positions[vertex.idx()]);
    let (none, start) = (DVec3::INFINITY, (DVec3::INFINITY, DVec3::NEG_INFINITY));
    let around = |(low, high): (DVec3, DVec3), p: DVec3| (low.min(p), high.max(p));
    let (low, high) = used.filter(|p| p.is_finite()).fold(start, around);
    if low == none { 0.0 } else { (high - low).length() }
}

fn layer_of(layer: &Layer, vertices: &[usize], faces: &[usize]) -> Layer {
    let index = match layer.domain {
        Domain::Vertex => vertices.iter().map(|&vertex| layer.index[vertex]).collect(),
        Domain::Face => faces.iter().map(|&face| layer.index[face]).collect(),
        Domain::Corner => {
            faces.iter().flat_map(|&face| [0, 1, 2].map(|k| layer.index[3 * face + k])).collect()
        }
    };
    Layer { index, ..layer.clone() }
}

/// For each vertex the first one at its place.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn same_places(positions: &[DVec3], control: Control) -> Result<Vec<u32>, Cancelled> {
    const EMPTY: u32 = u32::MAX;
    // Adding 0 takes the sign of -0 away.
    let bits_of = |position: DVec3| position.to_array().map(|x| (x + 0.0).to_bits());
    // An open table of first vertices, at most half full, so that a chain of full slots ends.
    let n_bits = (2 * positions.len()).next_power_of_two().max(2).trailing_zeros();
    let mut slots = vec![EMPTY; 1 << n_bits];
    let mut places = Vec::with_capacity(positions.len());
    for (vertex, &position) in positions.iter().enumerate() {
        control.item(vertex, positions.len())?;
        if !position.is_finite() {
            places.push(vertex as u32);
            continue;
        }
        let bits = bits_of(position);
        let mix = |hash: u64, bits: u64| {
            (hash ^ bits ^ bits >> 32).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
        };
        let hash = bits.into_iter().fold(0, mix).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut slot = (hash >> (64 - n_bits)) as usize;
        while slots[slot] != EMPTY && bits_of(positions[slots[slot] as usize]) != bits {
            slot = (slot + 1) & (slots.len() - 1);
        }
        if slots[slot] == EMPTY {
            slots[slot] = vertex as u32;
        }
        places.push(slots[slot]);
    }
    Ok(places)
}

/// Joins places that are near to each other, and moves what is joined to one position.
fn join_near(
    positions: &mut [DVec3],
    places: &mut [u32],
    distance: f64,
    control: Control,
) -> Result<(), Cancelled> {
    // All points of one cell are near to each other, and what is near lies at most two cells away.
    let cell_of = |p: DVec3| (p / (0.5 * distance)).to_array().map(|x| x.floor() as i64);
    let is_first = |v: &u32| places[*v as usize] == *v && positions[*v as usize].is_finite();
    let ids = (0..positions.len() as u32).filter(is_first);
    let mut sorted: Vec<([i64; 3], u32)> =
        ids.map(|v| (cell_of(positions[v as usize]), v)).collect();
    sorted.sort_unstable();
    let in_cell = |cell: [i64; 3]| {
        let start = sorted.partition_point(|(other, _)| *other < cell);
        let length = sorted[start..].iter().take_while(|(other, _)| *other == cell).count();
        &sorted[start..start + length]
    };
    let is_near = |a: u32, b: u32| {
        positions[a as usize].distance_squared(positions[b as usize]) <= distance * distance
    };
    let mut sets = UnionFind::new(positions.len());
    let cells: Vec<_> = sorted.chunk_by(|a, b| a.0 == b.0).collect();
    for (at, own) in cells.iter().enumerate() {
        control.item(at, cells.len())?;
        let (cell, first) = own[0];
        for (_, vertex) in own.iter().filter(|(_, vertex)| is_near(first, *vertex)) {
            sets.union(first, *vertex);
        }
        for step in steps_ahead() {
            let others = in_cell([0, 1, 2].map(|k| cell[k].saturating_add(step[k])));
            let pairs = || own.iter().flat_map(|a| others.iter().map(move |b| (a.1, b.1)));
            for (a, b) in pairs().filter(|(a, b)| is_near(*a, *b)) {
                sets.union(a, b);
            }
        }
    }
    let mut least: HashMap<u32, DVec3> = HashMap::new();
    for (_, vertex) in &sorted {
        let position = positions[*vertex as usize];
        let known = least.entry(sets.find(*vertex)).or_insert(position);
        if position.to_array() < known.to_array() {
            *known = position;
        }
    }
    for place in places.iter_mut() {
        *place = sets.find(*place);
    }
    for (vertex, position) in least {
        positions[vertex as usize] = position;
    }
    Ok(())
}

/// One of each pair of opposite steps to a cell at most two away.
fn steps_ahead() -> impl Iterator<Item = [i64; 3]> {
    let sides = || -2..=2_i64;
    let all = sides().flat_map(move |x| sides().flat_map(move |y| sides().map(move |z| [x, y, z])));
    all.filter(|step| *step > [0, 0, 0])
}

/// How many of these edges have their ends at the same two places as another one of them.
pub fn coincident(places: &[u32], edges: impl Iterator<Item = [VertexId; 2]>) -> usize {
    let mut ends: Vec<[u32; 2]> = edges
        .map(|[a, b]| {
            let (a, b) = (places[a.idx()], places[b.idx()]);
            [a.min(b), a.max(b)]
        })
        .collect();
    ends.sort_unstable();
    ends.chunk_by(|a, b| a == b).map(<[_]>::len).filter(|n_equal| *n_equal > 1).sum()
}

/// How many border edges lie on another one: the surface looks whole there and is not. Says 0
/// without a look where there are so few vertices that a surface without handles has none twice; on
/// one with handles, which has fewer, a short cut is then not seen.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn coincident_border_edges(mesh: &TriMesh, control: Control) -> Result<usize, Cancelled> {
    // A closed surface without handles has half as many vertices as faces, and two more; borders
    // add to that.
    if 2 * mesh.positions.len() <= mesh.faces.len() + 4 {
        return Ok(0);
    }
    let places = same_places(&mesh.positions, control)?;
    if places.iter().zip(0_u32..).all(|(place, vertex)| *place == vertex) {
        return Ok(0);
    }
    let adjacency = Adjacency::new(mesh, control)?;
    let edges = adjacency.edges().iter().zip(0_u32..);
    let borders = edges.filter(|(_, edge)| adjacency.sides_of(EdgeId(*edge)).len() == 1);
    Ok(coincident(&places, borders.map(|(ends, _)| *ends)))
}

#[cfg(test)]
#[path = "weld_tests.rs"]
mod tests;
