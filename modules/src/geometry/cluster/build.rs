//! The mesh that clusters leave.

use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, NO_VALUE, TriMesh, VertexId};
use rayon::prelude::*;

use super::grid::{PIECE, is_left};
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
        let numbered = faces.iter().zip((piece * PIECE) as u32..);
        let kept = numbered.filter(|(face, _)| is_left(face, clusters)).map(|(_, number)| number);
        Ok(kept.collect::<Vec<u32>>())
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

/// What stays of the faces, by the vertices at their corners.
fn without_duplicates(
    kept: Vec<u32>,
    is_cancelled: bool,
    corners: impl Fn(u32) -> [u32; 3] + Sync,
) -> Vec<u32> {
    // The corners in order, whether that takes an odd number of swaps, and the place in the list.
    let key = |(face, place): (&u32, u32)| {
        let [a, b, c] = corners(*face);
        let least = a.min(b).min(c);
        let [a, b, c] = match least {
            _ if least == a => [a, b, c],
            _ if least == b => [b, c, a],
            _ => [c, a, b],
        };
        if b < c { (a, b, c, false, place) } else { (a, c, b, true, place) }
    };
    let mut keys: Vec<_> = kept.iter().zip(0..).map(key).collect();
    keys.par_sort_unstable();
    let mut is_gone = vec![false; kept.len()];
    for equal in keys.chunk_by(|x, y| (x.0, x.1, x.2) == (y.0, y.1, y.2)) {
        let has_both = equal[0].3 != equal[equal.len() - 1].3;
        for (at, key) in equal.iter().enumerate() {
            let is_again = at > 0 && equal[at - 1].3 == key.3;
            is_gone[key.4 as usize] = is_again || (has_both && is_cancelled);
        }
    }
    let mut gone = is_gone.into_iter();
    kept.into_iter().filter(|_| !gone.next().unwrap_or(false)).collect()
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
