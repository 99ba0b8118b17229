//! How important vertices are for the look of a surface.
//!
//! Source: K.-L. Low and T.-S. Tan, "Model simplification using vertex-clustering", I3D 1997,
//! section 3.1: a vertex matters where its edges are long, since large faces hang on it, and where
//! two of them are close to each other, since it is then likely to be on the silhouette.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;
use rayon::prelude::*;

use super::grid::PIECE;

/// How much the two parts of the importance count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of the longest edge at the vertex over the longest of the mesh.
    pub length: f64,
    /// Of cos(φ/2), with φ the least angle between two edges at the vertex.
    pub angle: f64,
}

/// The corners at each vertex.
struct Corners {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Corners {
    fn of(mesh: &TriMesh) -> Self {
        let mut starts = vec![0_u32; mesh.positions.len() + 2];
        mesh.faces.iter().flatten().for_each(|vertex| starts[vertex.idx() + 2] += 1);
        (2..starts.len()).for_each(|at| starts[at] += starts[at - 1]);
        let mut corners = vec![0; 3 * mesh.faces.len()];
        for (corner, vertex) in (0..).zip(mesh.faces.iter().flatten()) {
            let place = &mut starts[vertex.idx() + 1];
            corners[*place as usize] = corner;
            *place += 1;
        }
        Self { starts, corners }
    }

    fn of_vertex(&self, vertex: usize) -> &[u32] {
        &self.corners[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

/// The importance of each vertex; 0 for those without a face. Where an edge has no direction, since
/// it has no length or an end that is not finite, it has no angle to others.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn importance(
    mesh: &TriMesh,
    weights: Weights,
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    control.at(0.0)?;
    let corners = Corners::of(mesh);
    // Squared lengths of the longest edges, and the greatest cosines between edges.
    let mut parts = vec![(0.0_f64, -1.0_f64); mesh.positions.len()];
    parts.par_chunks_mut(PIECE).enumerate().try_for_each(|(piece, parts)| {
        control.at(0.0)?;
        let mut around = Around::default();
        for (part, vertex) in parts.iter_mut().zip(piece * PIECE..) {
            let corners = corners.of_vertex(vertex);
            let found = look_at_fan(mesh, vertex, corners);
            *part = found.unwrap_or_else(|| around.look(mesh, vertex, corners));
        }
        Ok(())
    })?;
    let longest = parts.iter().map(|(length, _)| *length).fold(0.0, f64::max).sqrt();
    let length_weight = if longest > 0.0 { weights.length / longest } else { 0.0 };
    Ok(parts
        .into_par_iter()
        .map(|(length, cosine)| {
            // cos(φ/2) from cos φ.
            let half = (0.5 + 0.5 * cosine).max(0.0).sqrt();
            length_weight * length.sqrt() + weights.angle * half
        })
        .collect())
}

/// What [`Around::look`] says of a vertex whose faces are a closed fan of up to eight, turned
/// alike: nearly all are, and that is seen without a branch.
fn look_at_fan(mesh: &TriMesh, vertex: usize, corners: &[u32]) -> Option<(f64, f64)> {
    const MOST: usize = 8;
    if corners.len() > MOST {
        return None;
    }
    // The vertices after and before this one in each face; a number that none has elsewhere.
    let (mut next, mut last) = ([u32::MAX; MOST], [u32::MAX - 1; MOST]);
    for (k, &corner) in corners.iter().enumerate() {
        let face = mesh.faces[corner as usize / 3];
        let at = corner as usize % 3;
        (next[k], last[k]) = (face[[1, 2, 0][at]].0, face[[2, 0, 1][at]].0);
    }
    // In a fan each neighbor is once the next one and once the last.
    let n = corners.len();
    let n_equal = |of: u32| next.iter().map(|&other| u32::from(other == of)).sum::<u32>();
    let is_fan = (0..n).fold(true, |so, k| so & (n_equal(next[k]) == 1) & (n_equal(last[k]) == 1));
    if !is_fan {
        return None;
    }
    let here = mesh.positions[vertex];
    let [mut x, mut y, mut z, mut squared] = [[0.0; MOST]; 4];
    for k in 0..n {
        let edge = mesh.positions[next[k] as usize] - here;
        (x[k], y[k], z[k], squared[k]) = (edge.x, edge.y, edge.z, edge.length_squared());
    }
    let (mut longest, mut is_whole) = (0.0_f64, true);
    for k in 0..n {
        is_whole &= (squared[k] > 0.0) & (squared[k] < f64::INFINITY);
        longest = if squared[k] > longest { squared[k] } else { longest };
        let by = 1.0 / squared[k].sqrt();
        (x[k], y[k], z[k]) = (x[k] * by, y[k] * by, z[k] * by);
    }
    let mut greatest = -1.0;
    for k in 0..n {
        for j in k + 1..n {
            let cosine = x[k] * x[j] + y[k] * y[j] + z[k] * z[j];
            greatest = if cosine > greatest { cosine } else { greatest };
        }
    }
    is_whole.then_some((longest, f64::min(greatest, 1.0)))
}

/// The edges at a vertex.
#[derive(Default)]
struct Around {
    neighbors: Vec<u32>,
    directions: Vec<DVec3>,
}

/// Up to so many edges, all pairs are looked at.
const FEW: usize = 24;

impl Around {
    /// The squared length of the longest edge at a vertex, and the greatest cosine between two.
    fn look(&mut self, mesh: &TriMesh, vertex: usize, corners: &[u32]) -> (f64, f64) {
        self.neighbors.clear();
        self.directions.clear();
        for &corner in corners {
            let face = mesh.faces[corner as usize / 3];
            let others = [face[(corner as usize + 1) % 3].0, face[(corner as usize + 2) % 3].0];
            for other in others.into_iter().filter(|&other| other as usize != vertex) {
                if corners.len() > FEW || !self.neighbors.contains(&other) {
                    self.neighbors.push(other);
                }
            }
        }
        if corners.len() > FEW {
            self.neighbors.sort_unstable();
            self.neighbors.dedup();
        }
        let here = mesh.positions[vertex];
        let mut longest = 0.0_f64;
        for &other in &self.neighbors {
            let edge = mesh.positions[other as usize] - here;
            let length = edge.length_squared();
            if length.is_finite() && length > 0.0 {
                longest = longest.max(length);
                self.directions.push(edge / length.sqrt());
            }
        }
        (longest, self.greatest_cosine())
    }

    /// The cosine between the two directions that are nearest to each other.
    fn greatest_cosine(&mut self) -> f64 {
        let directions = &mut self.directions;
        let mut greatest = -1.0_f64;
        if directions.len() > FEW {
            // Along the axis of the widest spread; what is farther apart on it than the nearest
            // two so far is no nearer pair.
            let (low, high) = directions
                .iter()
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), d| (a.min(*d), b.max(*d)));
            let axis = (high - low).max_position();
            directions.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
            for (place, a) in directions.iter().enumerate() {
                for b in &directions[place + 1..] {
                    let apart = b[axis] - a[axis];
                    if apart * apart > 2.0 - 2.0 * greatest {
                        break;
                    }
                    greatest = greatest.max(a.dot(*b));
                }
            }
        } else {
            for (place, a) in directions.iter().enumerate() {
                for b in &directions[place + 1..] {
                    greatest = greatest.max(a.dot(*b));
                }
            }
        }
        greatest.min(1.0)
    }
}
