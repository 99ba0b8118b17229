//! Parts the surface at vertices that stay, so that it can be decimated farther.
//!
//! Source: W. Schroeder, "A topology modifying progressive decimation algorithm", IEEE
//! Visualization 1997, section 3.2: a vertex gets a copy for each part of the faces around it. At
//! a complex vertex a part is what edges of exactly two of these faces join, at a corner what lies
//! between two feature edges.

use mve_core::{Cancelled, Control};
use mve_mesh::union_find::UnionFind;

use super::kind::feature_edges;
use super::options::Openings;
use super::star::{Form, Star};
use super::star_mesh::StarMesh;

/// The most faces of a vertex that is split: handing over faces is quadratic.
const MOST_FACES: usize = 1 << 12;

/// Splits vertices, and names each with its copies, in order: `[vertex, copy]`.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn split_vertices(
    mesh: &mut StarMesh,
    openings: Openings,
    feature_cos: f64,
    control: Control,
) -> Result<Vec<[u32; 2]>, Cancelled> {
    let mut star = Star::default();
    let mut copies = Vec::new();
    let n_vertices = mesh.positions.len();
    for vertex in 0..n_vertices as u32 {
        control.item(vertex as usize, n_vertices)?;
        let n_faces = mesh.corners_of(vertex).len();
        if !(2..=MOST_FACES).contains(&n_faces) {
            continue;
        }
        let parts = match star.look(mesh, vertex) {
            Form::Other if openings.complex => fans(&star),
            Form::Closed if openings.corners => sectors(&star, feature_cos),
            _ => continue,
        };
        for part in parts.iter().skip(1) {
            let copy = mesh.copy_vertex(vertex);
            mesh.hand_over(part, vertex, copy);
            copies.push([vertex, copy]);
        }
    }
    Ok(copies)
}

/// The corners of a star that edges of two faces join.
fn fans(star: &Star) -> Vec<Vec<u32>> {
    let mut ends: Vec<(u32, u32)> = Vec::with_capacity(2 * star.blades.len());
    for (place, blade) in (0..).zip(&star.blades) {
        ends.extend([(blade.next, place), (blade.before, place)]);
    }
    ends.sort_unstable();
    let mut sets = UnionFind::new(star.blades.len());
    for edge in ends.chunk_by(|one, other| one.0 == other.0) {
        if let [one, other] = edge {
            sets.union(one.1, other.1);
        }
    }
    let mut parts: Vec<Vec<u32>> = Vec::new();
    let mut of_root = vec![None; star.blades.len()];
    for (place, blade) in (0..).zip(&star.blades) {
        let part = *of_root[sets.find(place) as usize].get_or_insert(parts.len());
        if part == parts.len() {
            parts.push(Vec::new());
        }
        parts[part].push(blade.corner);
    }
    parts
}

/// The corners of a star between feature edges; none unless there are three of these.
fn sectors(star: &Star, feature_cos: f64) -> Vec<Vec<u32>> {
    let edges: Vec<usize> = feature_edges(star, feature_cos).collect();
    if edges.len() < 3 {
        return Vec::new();
    }
    let n = star.blades.len();
    let mut parts = vec![Vec::new()];
    // Edge `i` is before face `i`.
    for step in 0..n {
        let face = (edges[0] + step) % n;
        if step > 0 && edges.contains(&face) {
            parts.push(Vec::new());
        }
        if let Some(part) = parts.last_mut() {
            part.push(star.blades[face].corner);
        }
    }
    parts
}
