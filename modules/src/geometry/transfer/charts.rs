//! The parts of a surface between the seams of a layer over corners.

use std::collections::HashSet;

use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId, HalfEdge};
use mve_mesh::data::{Domain, FaceId, Layer, TriMesh};
use mve_mesh::union_find::UnionFind;

/// The chart of each face.
#[derive(Clone, Debug)]
pub struct Charts {
    of_faces: Vec<u32>,
    /// The faces across the edges of each where there is no seam; itself where there is none.
    across: Vec<[u32; 3]>,
    /// Whether both sides of some seam are of one chart, as on an unrolled cylinder.
    pub meet_themselves: bool,
}

impl Charts {
    /// Joins the faces of two-sided edges at whose ends both have the same values.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn of(mesh: &TriMesh, layer: &Layer, control: Control) -> Result<Self, Cancelled> {
        let adjacency = Adjacency::new(mesh, control.part(0.0, 0.6))?;
        let mut sets = UnionFind::new(mesh.faces.len());
        let mut across: Vec<[u32; 3]> = (0..mesh.faces.len() as u32).map(|f| [f; 3]).collect();
        let mut seams = Vec::new();
        for edge in (0..adjacency.edges().len() as u32).map(EdgeId) {
            control.part(0.6, 1.0).item(edge.idx(), adjacency.edges().len())?;
            if let [a, b] = adjacency.sides_of(edge) {
                if is_seam(mesh, layer, [*a, *b]) {
                    seams.push([a.face().0, b.face().0]);
                    continue;
                }
                sets.union(a.face().0, b.face().0);
                across[a.face().idx()][a.corner()] = b.face().0;
                across[b.face().idx()][b.corner()] = a.face().0;
            }
        }
        let meet_themselves = seams.into_iter().any(|[a, b]| sets.find(a) == sets.find(b));
        let of_faces = (0..mesh.faces.len() as u32).map(|f| sets.find(f)).collect();
        Ok(Self { of_faces, across, meet_themselves })
    }

    /// Which of some faces can be reached from one of them through the others and no seam.
    pub fn joined(&self, start: FaceId, among: &[FaceId]) -> HashSet<FaceId> {
        let among: HashSet<FaceId> = among.iter().copied().collect();
        let (mut joined, mut open) = (HashSet::from([start]), vec![start]);
        while let Some(face) = open.pop() {
            for next in self.across[face.idx()].map(FaceId) {
                if among.contains(&next) && joined.insert(next) {
                    open.push(next);
                }
            }
        }
        joined
    }

    /// The number of a face's chart.
    pub fn of_face(&self, face: FaceId) -> u32 {
        self.of_faces[face.idx()]
    }
}

/// Whether the faces of two sides of an edge have different values there: at one of its ends where
/// the layer is over corners, of their own where it is over faces.
pub fn is_seam(mesh: &TriMesh, layer: &Layer, sides: [HalfEdge; 2]) -> bool {
    let [one, two] = sides.map(|side| {
        let (face, k) = (side.face().idx(), side.corner());
        let at = |k: usize| match layer.domain {
            Domain::Vertex => 0,
            Domain::Face => layer.index[face],
            Domain::Corner => layer.index[3 * face + k],
        };
        let (from, to) = (mesh.faces[face][k], mesh.faces[face][(k + 1) % 3]);
        let (first, second) = (at(k), at((k + 1) % 3));
        if from < to { [first, second] } else { [second, first] }
    });
    one != two
}
