//! The parts of a surface between the seams of a layer over corners.

use mve_core::{Cancelled, Control};

use mve_mesh::adjacency::{Adjacency, EdgeId, HalfEdge};
use mve_mesh::data::{Domain, FaceId, Layer, TriMesh};
use mve_mesh::union_find::UnionFind;

/// The chart of each face.
#[derive(Clone, Debug)]
pub struct Charts {
    of_faces: Vec<u32>,
}

impl Charts {
    /// Joins the faces of two-sided edges at whose ends both have the same values.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn of(mesh: &TriMesh, layer: &Layer, control: Control) -> Result<Self, Cancelled> {
        let adjacency = Adjacency::new(mesh, control.part(0.0, 0.6))?;
        let mut sets = UnionFind::new(mesh.faces.len());
        for edge in (0..adjacency.edges().len() as u32).map(EdgeId) {
            control.part(0.6, 1.0).item(edge.idx(), adjacency.edges().len())?;
            if let [a, b] = adjacency.sides_of(edge)
                && !is_seam(mesh, layer, [*a, *b])
            {
                sets.union(a.face().0, b.face().0);
            }
        }
        Ok(Self { of_faces: (0..mesh.faces.len() as u32).map(|f| sets.find(f)).collect() })
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
