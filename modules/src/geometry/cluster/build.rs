//! The mesh that clusters leave.

use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, NO_VALUE, TriMesh, VertexId};
use mve_mesh::random::mix;
use rayon::prelude::*;

use super::grid::{Numbers, PIECE};
use super::place::Place;

/// What becomes of faces that have the same three vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Duplicates {
    /// All stay.
    Keep,
    /// Of those that turn the same way the first stays.
    Once,
    /// The same, and two that turn against each other both go.
    Cancel,
}

/// The faces whose corners are in three clusters, between the vertices of these. Vertices are in
/// the order of the clusters and faces in that of the mesh; clusters without a face have none.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn built(
    mesh: &TriMesh,
    clusters: &[u32],
    places: &[Place],
    duplicates: Duplicates,
    control: Control,
) -> Result<TriMesh, Cancelled> {
    let kept = mesh.faces.par_chunks(PIECE).enumerate().map(|(piece, faces)| {
        control.at(0.0)?;
        Ok(left(faces, (piece * PIECE) as u32, clusters))
    });
    let kept = kept.collect::<Result<Vec<_>, Cancelled>>()?.concat();
    let corners = |face: u32| mesh.faces[face as usize].map(|v| clusters[v.idx()]);
    let kept = match duplicates {
        Duplicates::Keep => kept,
        _ => without_duplicates(kept, duplicates == Duplicates::Cancel, corners),
    };
    control.at(0.4)?;
    let mut numbers = vec![NO_VALUE; places.len()];
    kept.iter().for_each(|&face| corners(face).iter().for_each(|&c| numbers[c as usize] = 0));
    let used: Vec<u32> =
        (0..places.len() as u32).filter(|&c| numbers[c as usize] != NO_VALUE).collect();
    used.iter().zip(0..).for_each(|(&cluster, number)| numbers[cluster as usize] = number);
    let vertex = |cluster: u32| VertexId(numbers[cluster as usize]);
    let faces = kept.par_iter().map(|&face| corners(face).map(vertex)).collect();
    let positions = used.iter().map(|&cluster| places[cluster as usize].point).collect();
    control.at(0.7)?;
    let sources: Vec<u32> = used.iter().map(|&cluster| places[cluster as usize].source).collect();
    let layers = mesh.layers.iter().map(|layer| layer_of(layer, &sources, &kept)).collect();
    control.at(1.0)?;
    Ok(TriMesh { positions, faces, layers, materials: mesh.materials.clone() })
}

/// How many faces [`built`] would leave: those with their corners in three cells or clusters, but
/// for the same ones.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn n_faces_left<T: Copy + Ord + Into<u64> + Send + Sync>(
    mesh: &TriMesh,
    cells: &[T],
    duplicates: Duplicates,
    control: Control,
) -> Result<usize, Cancelled> {
    let pieces = mesh.faces.par_chunks(PIECE).enumerate().map(|(piece, faces)| {
        control.at(0.0)?;
        let left = left(faces, (piece * PIECE) as u32, cells);
        if duplicates == Duplicates::Keep {
            return Ok((left.len(), Vec::new()));
        }
        // Numbers of three cells that are equal by chance, once in 2⁶³, only make the count wrong.
        let key = |face: u32| {
            let (corners, is_odd) = ordered(mesh.faces[face as usize].map(|v| cells[v.idx()]));
            let [a, b, c] = corners.map(Into::<u64>::into);
            mix(mix(mix(a) ^ b) ^ c) & !1 | u64::from(is_odd)
        };
        Ok((0, left.into_iter().map(key).collect::<Vec<_>>()))
    });
    let pieces = pieces.collect::<Result<Vec<_>, Cancelled>>()?;
    if duplicates == Duplicates::Keep {
        return Ok(pieces.iter().map(|(n, _)| n).sum());
    }
    // Which ways the faces of each number turn.
    let (mut known, mut turns) = (Numbers::default(), Vec::<u8>::new());
    for key in pieces.iter().flat_map(|(_, keys)| keys) {
        let (number, is_odd) = (known.number(key | 1) as usize, key & 1);
        turns.resize(turns.len().max(number + 1), 0);
        turns[number] |= 1 << is_odd;
    }
    let n_left = |turns: &u8| match (*turns, duplicates) {
        (0b11, Duplicates::Cancel) => 0,
        (turns, _) => turns.count_ones() as usize,
    };
    Ok(turns.iter().map(n_left).sum())
}

/// The faces of a list with their corners in three cells or clusters, counted from `first`.
fn left<T: Copy + Eq>(faces: &[[VertexId; 3]], first: u32, cells: &[T]) -> Vec<u32> {
    let mut left = vec![0; faces.len()];
    let mut n_left = 0;
    for (face, number) in faces.iter().zip(first..) {
        // Without branches: which faces stay cannot be foretold.
        left[n_left] = number;
        n_left += usize::from(is_left(face, cells));
    }
    left.truncate(n_left);
    left
}

/// Whether the corners of a face are in three cells or clusters.
#[inline]
fn is_left<T: Copy + Eq>(face: &[VertexId; 3], cells: &[T]) -> bool {
    let [a, b, c] = face.map(|vertex| cells[vertex.idx()]);
    (a != b) & (b != c) & (c != a)
}

/// Three numbers in order, and whether that takes an odd number of swaps.
#[inline]
fn ordered<T: Copy + Ord>([a, b, c]: [T; 3]) -> ([T; 3], bool) {
    let least = a.min(b).min(c);
    let [a, b, c] = match least {
        _ if least == a => [a, b, c],
        _ if least == b => [b, c, a],
        _ => [c, a, b],
    };
    if b < c { ([a, b, c], false) } else { ([a, c, b], true) }
}

/// What stays of the faces, by the vertices at their corners.
fn without_duplicates(
    mut kept: Vec<u32>,
    is_cancelled: bool,
    corners: impl Fn(u32) -> [u32; 3],
) -> Vec<u32> {
    // A number for the first two corners, and one for this and the third.
    let (mut pairs, mut triples) = (Numbers::default(), Numbers::default());
    let pair = |a: u32, b: u32| u64::from(a) << 32 | u64::from(b);
    // By number, the first face that turns either way.
    let mut firsts: Vec<[u32; 2]> = Vec::new();
    kept.retain(|&face| {
        let ([a, b, c], is_odd) = ordered(corners(face));
        let number = triples.number(pair(pairs.number(pair(a, b)), c)) as usize;
        firsts.resize(firsts.len().max(number + 1), [NO_VALUE; 2]);
        let first = &mut firsts[number][usize::from(is_odd)];
        let is_first = *first == NO_VALUE;
        *first = (*first).min(face);
        is_first
    });
    if is_cancelled {
        let mut gone: Vec<u32> =
            firsts.iter().filter(|first| !first.contains(&NO_VALUE)).flatten().copied().collect();
        gone.sort_unstable();
        kept.retain(|face| gone.binary_search(face).is_err());
    }
    kept
}

fn layer_of(layer: &Layer, vertices: &[u32], faces: &[u32]) -> Layer {
    let value = |element: u32| layer.index.get(element as usize).copied().unwrap_or(NO_VALUE);
    let index = match layer.domain {
        Domain::Vertex => vertices.iter().map(|&vertex| value(vertex)).collect(),
        Domain::Face => faces.iter().map(|&face| value(face)).collect(),
        Domain::Corner => {
            faces.iter().flat_map(|&face| [0, 1, 2].map(|k| value(3 * face + k))).collect()
        }
    };
    Layer { name: layer.name.clone(), domain: layer.domain, values: layer.values.clone(), index }
}
