//! The least-squares problem of one step, and its solution by conjugate gradients.
//!
//! With the barycentric coordinates `s_i` of a joint in its face, its direction `d` and its
//! distance `r`, the sum of `w (d · Σ s_i x_i − r)²` over all joints is least in the moves `x`.
//! With `H_ij = Σ w s_i s_j d dᵀ` and `g_i = Σ w s_i r d` that is `H x = g`. `H` has a symmetric
//! block for each vertex and for each edge, and the graph stays the same from step to step.

use glam::{DMat3, DVec3};
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{TriMesh, VertexId};
use rayon::prelude::*;

use super::joints::{Joint, Joints};

/// Vertices of one chunk.
const CHUNK: usize = 4096;

/// The upper triangle of a symmetric matrix: xx, xy, xz, yy, yz, zz.
type Symmetric = [f64; 6];

/// The problem of all steps so far.
pub(super) struct System<'a> {
    mesh: &'a TriMesh,
    adjacency: &'a Adjacency,
    is_free: &'a [bool],
    /// `H` of each vertex with itself.
    own: Vec<Symmetric>,
    /// `H` of the ends of each edge.
    across: Vec<Symmetric>,
    /// `g` of each vertex.
    pull: Vec<DVec3>,
    /// The edges at each vertex and their other ends, from `starts[v]` to `starts[v + 1]`.
    spokes: Vec<(EdgeId, VertexId)>,
    starts: Vec<u32>,
}

impl<'a> System<'a> {
    /// Without joints; vertices that are not free stay where they are.
    pub fn new(mesh: &'a TriMesh, adjacency: &'a Adjacency, is_free: &'a [bool]) -> Self {
        let edges = adjacency.edges();
        let mut starts = vec![0; mesh.positions.len() + 1];
        for v in edges.iter().flatten() {
            starts[v.idx() + 1] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut next = starts.clone();
        let mut spokes = vec![(EdgeId::NONE, VertexId(0)); 2 * edges.len()];
        for (number, &[a, b]) in (0..).zip(edges) {
            for (from, to) in [(a, b), (b, a)] {
                spokes[next[from.idx()] as usize] = (EdgeId(number), to);
                next[from.idx()] += 1;
            }
        }
        Self {
            mesh,
            adjacency,
            is_free,
            own: vec![Symmetric::default(); mesh.positions.len()],
            across: vec![Symmetric::default(); edges.len()],
            pull: vec![DVec3::ZERO; mesh.positions.len()],
            spokes,
            starts,
        }
    }

    /// Adds joints: those of both surfaces weigh the same.
    pub fn add(&mut self, joints: &Joints, control: Control) -> Result<(), Cancelled> {
        let Joints { of_original, of_simplified } = joints;
        let balance = of_original.len() as f64 / of_simplified.len().max(1) as f64;
        for (joints, weight) in [(of_original, 1.0), (of_simplified, balance)] {
            for (at, joint) in joints.iter().enumerate() {
                control.item(at, joints.len())?;
                self.add_joint(joint, weight);
            }
        }
        Ok(())
    }

    fn add_joint(&mut self, joint: &Joint, weight: f64) {
        let DVec3 { x, y, z } = joint.direction;
        let outer = [x * x, x * y, x * z, y * y, y * z, z * z].map(|entry| weight * entry);
        let add = |block: &mut Symmetric, share: f64| {
            block.iter_mut().zip(outer).for_each(|(sum, entry)| *sum += share * entry);
        };
        let corners = self.mesh.faces[joint.face.idx()];
        let edges = self.adjacency.edges_of(joint.face);
        let pull = weight * joint.distance * joint.direction;
        for k in 0..3 {
            let (v, share, next) = (corners[k].idx(), joint.shares[k], joint.shares[(k + 1) % 3]);
            self.pull[v] += share * pull;
            add(&mut self.own[v], share * share);
            match edges[k] {
                // Both corners are one vertex.
                EdgeId::NONE => add(&mut self.own[v], 2.0 * share * next),
                edge => add(&mut self.across[edge.idx()], share * next),
            }
        }
    }

    /// The moves of all vertices, to a thousandth. A spring holds each where it is, `stiffness`
    /// times as strong as its joints do.
    pub fn solve(&self, stiffness: f64, control: Control) -> Result<Vec<DVec3>, Cancelled> {
        const MOST_ITERATIONS: usize = 40;
        const LEAST_SQ: f64 = 1e-6;
        let held = |own: &Symmetric| {
            let spring = stiffness * (own[0] + own[3] + own[5]);
            let [xx, xy, xz, yy, yz, zz] = *own;
            [xx + spring, xy, xz, yy + spring, yz, zz + spring]
        };
        let own: Vec<Symmetric> = self.own.iter().map(held).collect();
        let inverse = |own: &Symmetric| {
            let inverse = matrix(own).inverse();
            if inverse.is_finite() { inverse } else { DMat3::ZERO }
        };
        let inverse: Vec<DMat3> = own.par_iter().map(inverse).collect();
        let n = self.mesh.positions.len();
        let mut moves = vec![DVec3::ZERO; n];
        let pulls = self.pull.iter().zip(self.is_free);
        let mut left: Vec<DVec3> =
            pulls.map(|(pull, is_free)| if *is_free { *pull } else { DVec3::ZERO }).collect();
        let eased = |left: &[DVec3]| -> Vec<DVec3> {
            left.iter().zip(&inverse).map(|(left, inverse)| *inverse * *left).collect()
        };
        let mut along = eased(&left);
        let mut size = dot(&left, &along);
        let first = size;
        let mut product = vec![DVec3::ZERO; n];
        for iteration in 0..MOST_ITERATIONS {
            control.at(iteration as f64 / MOST_ITERATIONS as f64)?;
            if size <= LEAST_SQ * first {
                break;
            }
            self.times(&own, &along, &mut product);
            let length = size / dot(&along, &product);
            if !length.is_finite() {
                break;
            }
            moves.iter_mut().zip(&along).for_each(|(x, along)| *x += length * *along);
            left.iter_mut().zip(&product).for_each(|(left, product)| *left -= length * *product);
            let eased = eased(&left);
            let next = dot(&left, &eased);
            along.iter_mut().zip(&eased).for_each(|(along, eased)| {
                *along = *eased + next / size * *along;
            });
            size = next;
        }
        Ok(moves)
    }

    /// Takes what the joints say along to where the vertices are now, `part` as loud.
    pub fn remember(&mut self, from: &[DVec3], to: &[DVec3], part: f64) {
        // Of infinite coordinates, too, which stay, the difference is none.
        let way = |(from, to): (&DVec3, &DVec3)| if from == to { DVec3::ZERO } else { *to - *from };
        let moved: Vec<DVec3> = from.iter().zip(to).map(way).collect();
        let mut done = vec![DVec3::ZERO; moved.len()];
        self.times(&self.own, &moved, &mut done);
        self.pull.iter_mut().zip(&done).for_each(|(pull, done)| *pull = part * (*pull - *done));
        let blocks = self.own.iter_mut().chain(&mut self.across);
        blocks.flatten().for_each(|entry| *entry *= part);
    }

    /// The matrix with these blocks of the vertices times moves; zero for those that are not free.
    fn times(&self, own: &[Symmetric], x: &[DVec3], out: &mut [DVec3]) {
        let row = |v: usize| {
            let mut sum = times(&own[v], x[v]);
            for &(edge, other) in &self.spokes[self.starts[v] as usize..self.starts[v + 1] as usize]
            {
                sum += times(&self.across[edge.idx()], x[other.idx()]);
            }
            sum
        };
        out.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, out)| {
            for (v, out) in (chunk * CHUNK..).zip(out) {
                *out = if self.is_free[v] { row(v) } else { DVec3::ZERO };
            }
        });
    }
}

/// Sums chunk by chunk, so that threads change no bit.
fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    let chunks = a.par_chunks(CHUNK).zip(b.par_chunks(CHUNK));
    let of_chunk = |(a, b): (&[DVec3], &[DVec3])| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum();
    chunks.map(of_chunk).collect::<Vec<f64>>().into_iter().sum()
}

#[inline]
fn times([xx, xy, xz, yy, yz, zz]: &Symmetric, v: DVec3) -> DVec3 {
    DVec3::new(
        xx * v.x + xy * v.y + xz * v.z,
        xy * v.x + yy * v.y + yz * v.z,
        xz * v.x + yz * v.y + zz * v.z,
    )
}

fn matrix(&[xx, xy, xz, yy, yz, zz]: &Symmetric) -> DMat3 {
    DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
}
