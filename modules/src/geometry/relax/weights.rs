//! Weights of the edges of a mesh, by which a vertex is drawn to its neighbors.

use glam::DVec3;

use mve_mesh::adjacency::{Adjacency, EdgeId, HalfEdge};
use mve_mesh::data::{TriMesh, VertexId};

/// How much each neighbor counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeWeight {
    /// Each the same (the umbrella operator): evens out the triangles, too.
    Uniform,
    /// By half the sum of the cotangents of the angles across the edge (Pinkall and Polthier 1993,
    /// Desbrun et al. 1999), none below 0: vertices hardly slide along the surface.
    Cotangent,
}

/// Which borders hold a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Borders {
    /// Vertices of a border stay.
    Fixed,
    /// They are drawn to their neighbors along the border alone.
    Curve,
    /// They are as all others.
    Free,
}

/// The weighted edges of a mesh.
pub struct Weights {
    /// The ends of each edge that counts.
    pub edges: Vec<[VertexId; 2]>,
    /// The weight of each edge for its first and for its second end.
    pub weights: Vec<[f64; 2]>,
    /// The sum of the weights at each vertex; 0 for those that stay.
    pub sums: Vec<f64>,
    /// Whether a vertex is drawn along a border alone: others are drawn to it, not it to them.
    pub is_on_border: Vec<bool>,
}

/// What holds for the edges of a mesh wherever its vertices are.
pub struct Pattern {
    is_border: Vec<bool>,
    /// Whether a vertex moves; those that are not finite do not.
    moves: Vec<bool>,
    /// Whether a vertex is drawn to border neighbors alone.
    is_on_border: Vec<bool>,
    is_finite: Vec<bool>,
}

impl Pattern {
    /// Borders are edges of one face, or of more than two. Only vertices among `chosen` move, where
    /// that is given.
    pub fn of(
        mesh: &TriMesh,
        adjacency: &Adjacency,
        borders: Borders,
        chosen: Option<&[bool]>,
    ) -> Self {
        let edges = adjacency.edges();
        let is_border: Vec<bool> = (0..edges.len() as u32)
            .map(|edge| adjacency.sides_of(EdgeId(edge)).len() != 2)
            .collect();
        let mut is_on_border = vec![false; mesh.positions.len()];
        for (ends, _) in edges.iter().zip(&is_border).filter(|(_, is)| **is) {
            ends.iter().for_each(|v| is_on_border[v.idx()] = true);
        }
        let is_finite: Vec<bool> = mesh.positions.iter().map(|p| p.is_finite()).collect();
        let stays = |at: &bool| *at && borders == Borders::Fixed;
        let both = is_finite.iter().zip(&is_on_border);
        let mut moves: Vec<bool> = both.map(|(is_finite, at)| *is_finite && !stays(at)).collect();
        if let Some(chosen) = chosen {
            moves.iter_mut().zip(chosen).for_each(|(moves, is)| *moves &= *is);
        }
        if borders != Borders::Curve {
            is_on_border.fill(false);
        }
        Self { is_border, moves, is_on_border, is_finite }
    }

    /// The weights of the edges where the vertices are now. What is not finite does not count.
    pub fn weights(&self, mesh: &TriMesh, adjacency: &Adjacency, weight: EdgeWeight) -> Weights {
        let mut found = Weights {
            edges: Vec::with_capacity(adjacency.edges().len()),
            weights: Vec::with_capacity(adjacency.edges().len()),
            sums: vec![0.0; mesh.positions.len()],
            is_on_border: self.is_on_border.clone(),
        };
        for (e, &ends) in adjacency.edges().iter().enumerate() {
            if !ends.iter().all(|v| self.is_finite[v.idx()]) {
                continue;
            }
            let both = match weight {
                EdgeWeight::Uniform => 1.0,
                EdgeWeight::Cotangent => cotangents(mesh, adjacency, EdgeId(e as u32)),
            };
            let for_end = |v: VertexId| {
                let is_drawn = self.moves[v.idx()];
                let is_along = self.is_border[e] || !self.is_on_border[v.idx()];
                // Along a border there is no angle on the other side; each neighbor counts alike.
                let own = if self.is_on_border[v.idx()] { 1.0 } else { both };
                if is_drawn && is_along { own } else { 0.0 }
            };
            let weights = ends.map(for_end);
            if weights == [0.0; 2] {
                continue;
            }
            for (v, weight) in ends.iter().zip(weights) {
                found.sums[v.idx()] += weight;
            }
            found.edges.push(ends);
            found.weights.push(weights);
        }
        found
    }
}

impl Weights {
    /// For each vertex the mean of its neighbors less itself; zero for those that stay.
    pub fn laplacian(&self, positions: &[DVec3]) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; positions.len()];
        for (&[a, b], &[to_a, to_b]) in self.edges.iter().zip(&self.weights) {
            let way = positions[b.idx()] - positions[a.idx()];
            if to_a > 0.0 {
                sums[a.idx()] += to_a * way;
            }
            if to_b > 0.0 {
                sums[b.idx()] -= to_b * way;
            }
        }
        let scaled = |(sum, weight): (&mut DVec3, &f64)| {
            *sum = if *weight > 0.0 { *sum / *weight } else { DVec3::ZERO };
        };
        sums.iter_mut().zip(&self.sums).for_each(scaled);
        sums
    }
}

/// Half the sum of the cotangents across an edge; 0 where that is less or not finite.
fn cotangents(mesh: &TriMesh, adjacency: &Adjacency, edge: EdgeId) -> f64 {
    let [a, b] = adjacency.edges()[edge.idx()].map(|v| mesh.positions[v.idx()]);
    let of_side = |side: &HalfEdge| {
        let across = mesh.faces[side.face().idx()][(side.corner() + 2) % 3];
        let apex = mesh.positions[across.idx()];
        let (u, v) = (a - apex, b - apex);
        let cotangent = u.dot(v) / u.cross(v).length();
        if cotangent.is_finite() { cotangent } else { 0.0 }
    };
    let sum: f64 = adjacency.sides_of(edge).iter().map(of_side).sum();
    (0.5 * sum).max(0.0)
}
