//! The least-squares problem of one step, and its solution by conjugate gradients.
//!
//! With the barycentric coordinates `s_i` of a joint in its face, its direction `d` and its
//! distance `r`, the sum of `w (d · Σ s_i x_i − r)²` over all joints is least in the moves `x`.
//! Each face keeps the part of its own joints: `H_ij = Σ w s_i s_j d dᵀ`, `g_i = Σ w s_i r d`.

use glam::{DMat3, DVec3};
use mve_core::{Cancelled, Control};
use rayon::prelude::*;

use super::joints::{Joint, Joints};
use crate::data::{TriMesh, VertexId};
use crate::mesh::adjacency::Adjacency;

/// Vertices of one chunk.
const CHUNK: usize = 4096;

/// The upper triangle of a symmetric matrix: xx, xy, xz, yy, yz, zz.
type Symmetric = [f64; 6];

/// What the joints of one face say of its corners.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Element {
    /// `H` of the corners 00, 01, 02, 11, 12, 22; each block is symmetric.
    blocks: [Symmetric; 6],
    /// `g` of each corner.
    pull: [DVec3; 3],
}

/// Which block of an [`Element`] is that of two corners.
const BLOCK: [[usize; 3]; 3] = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];

impl Element {
    fn add(&mut self, joint: &Joint, weight: f64) {
        let DVec3 { x, y, z } = joint.direction;
        let outer = [x * x, x * y, x * z, y * y, y * z, z * z];
        for (i, share) in joint.shares.into_iter().enumerate() {
            self.pull[i] += weight * share * joint.distance * joint.direction;
            for (j, other) in joint.shares.into_iter().enumerate().skip(i) {
                let block = &mut self.blocks[BLOCK[i][j]];
                block.iter_mut().zip(outer).for_each(|(sum, o)| *sum += weight * share * other * o);
            }
        }
    }

    /// Row `i` of `H x` at the three corners.
    #[inline]
    fn row(&self, i: usize, x: [DVec3; 3]) -> DVec3 {
        let times = |j: usize| times(&self.blocks[BLOCK[i][j]], x[j]);
        times(0) + times(1) + times(2)
    }
}

/// One step's problem.
pub(super) struct System<'a> {
    mesh: &'a TriMesh,
    adjacency: &'a Adjacency,
    is_free: &'a [bool],
    elements: Vec<Element>,
    /// The spring of each vertex.
    springs: Vec<f64>,
    /// The inverse of the diagonal block of each vertex.
    inverse: Vec<DMat3>,
}

impl<'a> System<'a> {
    /// Adds joints to what elements remember.
    pub fn new(
        (mesh, adjacency): (&'a TriMesh, &'a Adjacency),
        is_free: &'a [bool],
        stiffness: f64,
        mut elements: Vec<Element>,
        joints: &Joints,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let Joints { of_original, of_simplified } = joints;
        let balance = of_original.len() as f64 / of_simplified.len().max(1) as f64;
        for (joints, weight) in [(of_original, 1.0), (of_simplified, balance)] {
            for (at, joint) in joints.iter().enumerate() {
                control.item(at, joints.len())?;
                elements[joint.face.idx()].add(joint, weight);
            }
        }
        let diagonal = |v: usize| {
            let mut sum = Symmetric::default();
            for &corner in adjacency.corners_of(VertexId(v as u32)) {
                let k = corner as usize % 3;
                let block = &elements[corner as usize / 3].blocks[BLOCK[k][k]];
                sum.iter_mut().zip(block).for_each(|(sum, part)| *sum += part);
            }
            let spring = stiffness * (sum[0] + sum[3] + sum[5]);
            [sum[0], sum[3], sum[5]] = [sum[0], sum[3], sum[5]].map(|entry| entry + spring);
            let inverse = matrix(&sum).inverse();
            (spring, if inverse.is_finite() { inverse } else { DMat3::ZERO })
        };
        let (springs, inverse) = (0..mesh.positions.len()).into_par_iter().map(diagonal).unzip();
        Ok(Self { mesh, adjacency, is_free, elements, springs, inverse })
    }

    /// The moves of all vertices, to a thousandth.
    pub fn solve(&self, control: Control) -> Result<Vec<DVec3>, Cancelled> {
        const MOST_ITERATIONS: usize = 40;
        const LEAST_SQ: f64 = 1e-6;
        let n = self.mesh.positions.len();
        let mut moves = vec![DVec3::ZERO; n];
        let mut left: Vec<DVec3> = (0..n).into_par_iter().map(|v| self.pull(v)).collect();
        let eased = |left: &[DVec3]| -> Vec<DVec3> {
            left.iter().zip(&self.inverse).map(|(left, inverse)| *inverse * *left).collect()
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
            self.times(&along, &mut product);
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

    /// What the elements say at the places where the vertices are now, `part` as loud.
    pub fn remembered(self, from: &[DVec3], to: &[DVec3], part: f64) -> Vec<Element> {
        let mut elements = self.elements;
        elements.par_iter_mut().zip(&self.mesh.faces).for_each(|(element, face)| {
            let moved = face.map(|v| to[v.idx()] - from[v.idx()]);
            let done = [0, 1, 2].map(|i| element.row(i, moved));
            element
                .pull
                .iter_mut()
                .zip(done)
                .for_each(|(pull, done)| *pull = part * (*pull - done));
            element.blocks.iter_mut().flatten().for_each(|entry| *entry *= part);
        });
        elements
    }

    fn pull(&self, v: usize) -> DVec3 {
        let corners = self.adjacency.corners_of(VertexId(v as u32)).iter();
        let at = |&corner: &u32| self.elements[corner as usize / 3].pull[corner as usize % 3];
        if self.is_free[v] { corners.map(at).sum() } else { DVec3::ZERO }
    }

    /// The matrix times moves; those of vertices that are not free are zero.
    fn times(&self, x: &[DVec3], out: &mut [DVec3]) {
        let row = |v: usize| {
            let mut sum = self.springs[v] * x[v];
            for &corner in self.adjacency.corners_of(VertexId(v as u32)) {
                let face = corner as usize / 3;
                let x = self.mesh.faces[face].map(|v| x[v.idx()]);
                sum += self.elements[face].row(corner as usize % 3, x);
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
