//! What vertices may not do: leave borders and seams, turn faces over, fold edges.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use rayon::prelude::*;

use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, TriMesh, VertexId};

/// A face keeps this cosine of its turn from where it began: 60°.
const LEAST_COSINE: f64 = 0.5;
/// And this part of its area.
const LEAST_AREA: f64 = 0.1;
/// Faces whose normals have less than this cosine fold their edge: 150°.
const FOLD_COSINE: f64 = -0.866_025_403_784_438_6;
/// A step is at most this part of the shortest side of the faces around.
const LONGEST_STEP: f64 = 0.5;
/// A move that breaks a rule is halved so often, and not made then.
const N_HALVES: usize = 6;
/// After so many rounds no vertex moves.
const N_ROUNDS: usize = 40;

/// The rules for the vertices of one mesh.
pub(super) struct Guard {
    is_free: Vec<bool>,
    is_folded: Vec<bool>,
}

impl Guard {
    pub fn new(mesh: &TriMesh, adjacency: &Adjacency, control: Control) -> Result<Self, Cancelled> {
        let mut is_free: Vec<bool> = mesh.positions.iter().map(|p| p.is_finite()).collect();
        let seams: Vec<&Layer> = mesh.layers.iter().filter(|layer| has_seams(layer)).collect();
        let n_edges = adjacency.edges().len();
        let normals = normals(mesh, &mesh.positions);
        let mut is_folded = vec![false; n_edges];
        for (number, ends) in adjacency.edges().iter().enumerate() {
            control.item(number, n_edges)?;
            let edge = EdgeId(number as u32);
            is_folded[number] = folds(adjacency, edge, &normals);
            let is_held = match faces_at(adjacency, edge) {
                Some(faces) => seams.iter().any(|layer| is_seam(layer, mesh, faces, *ends)),
                None => true,
            };
            if is_held {
                ends.iter().for_each(|v| is_free[v.idx()] = false);
            }
        }
        Ok(Self { is_free, is_folded })
    }

    /// Whether each vertex may move.
    pub fn is_free(&self) -> &[bool] {
        &self.is_free
    }

    /// How much of its move each vertex may make in one step: no more than half of the way across
    /// the faces around.
    pub fn step(
        &self,
        mesh: &TriMesh,
        moves: &[DVec3],
        adjacency: &Adjacency,
        control: Control,
    ) -> Result<Vec<f64>, Cancelled> {
        let shortest = |v: usize| {
            let sides = adjacency.corners_of(VertexId(v as u32)).iter().map(|&corner| {
                let [a, b, c] = mesh.corners(FaceId(corner / 3));
                a.distance(b).min(b.distance(c)).min(c.distance(a))
            });
            sides.fold(f64::INFINITY, f64::min)
        };
        let mut shares = vec![0.0; moves.len()];
        for (v, share) in shares.iter_mut().enumerate() {
            control.item(v, moves.len())?;
            let length = moves[v].length();
            if length > 0.0 && length.is_finite() {
                *share = (LONGEST_STEP * shortest(v) / length).min(1.0);
            }
        }
        Ok(shares)
    }

    /// Where vertices are after these shares of their moves from `now`, or as much of them as the
    /// rules allow. The mesh as it began is `start`; at `now` it obeys the rules.
    pub fn moved(
        &self,
        start: &TriMesh,
        now: &[DVec3],
        moves: &[DVec3],
        mut shares: Vec<f64>,
        adjacency: &Adjacency,
        control: Control,
    ) -> Result<Vec<DVec3>, Cancelled> {
        let before = normals(start, &start.positions);
        let places = |shares: &[f64]| -> Vec<DVec3> {
            let moved = now.iter().zip(moves).zip(shares);
            moved.map(|((now, by), &s)| if s > 0.0 { *now + s * *by } else { *now }).collect()
        };
        for round in 0..N_ROUNDS {
            control.at(1.0)?;
            let positions = places(&shares);
            let mut is_kept = true;
            for v in self.broken(start, adjacency, (&before, &positions), control)? {
                is_kept &= shares[v.idx()] == 0.0;
                shares[v.idx()] *= if round < N_HALVES { 0.5 } else { 0.0 };
            }
            if is_kept {
                return Ok(positions);
            }
        }
        Ok(now.to_vec())
    }

    /// The corners of the faces that break a rule at these positions, by what the normals were.
    fn broken(
        &self,
        mesh: &TriMesh,
        adjacency: &Adjacency,
        (before, positions): (&[DVec3], &[DVec3]),
        control: Control,
    ) -> Result<Vec<VertexId>, Cancelled> {
        let after = normals(mesh, positions);
        let mut broken = Vec::new();
        for (at, face) in mesh.faces.iter().enumerate() {
            control.item(at, mesh.faces.len())?;
            let (old, new) = (before[at], after[at]);
            let (old_length, length) = (old.length(), new.length());
            let turns = old.dot(new) < LEAST_COSINE * old_length * length;
            if turns || length < LEAST_AREA * old_length {
                broken.extend(face);
            }
        }
        for (number, &was_folded) in self.is_folded.iter().enumerate() {
            control.item(number, self.is_folded.len())?;
            let edge = EdgeId(number as u32);
            if !was_folded && folds(adjacency, edge, &after) {
                let faces = faces_at(adjacency, edge).into_iter().flatten();
                broken.extend(faces.flat_map(|face| mesh.faces[face.idx()]));
            }
        }
        // Each once, however many of its faces break a rule.
        broken.sort_unstable();
        broken.dedup();
        Ok(broken)
    }
}

/// Twice the area of each face along its normal.
fn normals(mesh: &TriMesh, positions: &[DVec3]) -> Vec<DVec3> {
    let normal = |face: &[VertexId; 3]| {
        let [a, b, c] = face.map(|v| positions[v.idx()]);
        (b - a).cross(c - a)
    };
    mesh.faces.par_iter().map(normal).collect()
}

/// The two faces of a manifold edge.
fn faces_at(adjacency: &Adjacency, edge: EdgeId) -> Option<[FaceId; 2]> {
    match adjacency.sides_of(edge) {
        [one, other] => Some([one.face(), other.face()]),
        _ => None,
    }
}

fn folds(adjacency: &Adjacency, edge: EdgeId, normals: &[DVec3]) -> bool {
    faces_at(adjacency, edge).is_some_and(|faces| {
        let [one, other] = faces.map(|face| normals[face.idx()]);
        one.dot(other) < FOLD_COSINE * one.length() * other.length()
    })
}

/// Layers whose seams hold vertices.
fn has_seams(layer: &Layer) -> bool {
    match layer.domain {
        Domain::Corner => layer.name == Layer::TEXCOORD,
        Domain::Face => layer.name == Layer::MATERIAL,
        Domain::Vertex => false,
    }
}

/// Whether two faces have different values at their edge. Equal values may stand in a layer more
/// than once.
fn is_seam(layer: &Layer, mesh: &TriMesh, faces: [FaceId; 2], ends: [VertexId; 2]) -> bool {
    match &layer.values {
        LayerValues::Label(names) => {
            let [one, other] = faces.map(|face| names.get(layer.index[face.idx()] as usize));
            one != other
        }
        LayerValues::Vec2(values) => {
            let value = |face: FaceId, end: VertexId| {
                let k = mesh.faces[face.idx()].iter().position(|v| *v == end)?;
                let value = values.get(layer.index[3 * face.idx() + k] as usize)?;
                Some(value.to_array().map(f64::to_bits))
            };
            ends.iter().any(|&end| value(faces[0], end) != value(faces[1], end))
        }
        _ => false,
    }
}
