//! The parts of a surface, ranked by their size.

use mve_core::{Cancelled, Control};

use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{FaceId, TriMesh};
use mve_mesh::union_find::UnionFind;

/// What makes faces one component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Connection {
    /// A vertex that they share.
    Vertex,
    /// An edge that they share, whatever its number of faces.
    Edge,
}

/// What makes a component large.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Largeness {
    /// Its number of faces.
    Faces,
    /// The sum of the areas of its faces; what is not finite counts as 0.
    Area,
}

/// The components of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    /// The component of each face: 0 is the largest. Of two of one size the one with the lower face
    /// comes first.
    pub of_faces: Vec<u32>,
    /// The size of each.
    pub sizes: Vec<f64>,
}

/// Finds the components, O(n log n).
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn parts(
    mesh: &TriMesh,
    connection: Connection,
    largeness: Largeness,
    control: Control,
) -> Result<Parts, Cancelled> {
    let n_faces = mesh.faces.len();
    let mut sets = UnionFind::new(n_faces);
    match connection {
        Connection::Vertex => {
            let mut first = vec![u32::MAX; mesh.positions.len()];
            for (face, corners) in mesh.faces.iter().enumerate() {
                control.part(0.0, 0.6).item(face, n_faces)?;
                for v in corners {
                    match first[v.idx()] {
                        u32::MAX => first[v.idx()] = face as u32,
                        other => _ = sets.union(other, face as u32),
                    }
                }
            }
        }
        Connection::Edge => {
            let adjacency = Adjacency::new(mesh, control.part(0.0, 0.5))?;
            for edge in (0..adjacency.edges().len() as u32).map(EdgeId) {
                control.part(0.5, 0.6).item(edge.idx(), adjacency.edges().len())?;
                for pair in adjacency.sides_of(edge).windows(2) {
                    sets.union(pair[0].face().0, pair[1].face().0);
                }
            }
        }
    }
    let control = control.part(0.6, 1.0);
    let mut sizes = vec![0.0; n_faces];
    for face in 0..n_faces as u32 {
        control.item(face as usize, n_faces)?;
        sizes[sets.find(face) as usize] += match largeness {
            Largeness::Faces => 1.0,
            Largeness::Area => {
                let [a, b, c] = mesh.corners(FaceId(face));
                let area = 0.5 * (b - a).cross(c - a).length();
                if area.is_finite() { area } else { 0.0 }
            }
        };
    }
    let mut order: Vec<u32> = (0..n_faces as u32).filter(|&face| sets.find(face) == face).collect();
    order.sort_by(|&a, &b| sizes[b as usize].total_cmp(&sizes[a as usize]));
    let mut ranks = vec![0; n_faces];
    order.iter().zip(0..).for_each(|(&set, rank)| ranks[set as usize] = rank);
    Ok(Parts {
        of_faces: (0..n_faces as u32).map(|face| ranks[sets.find(face) as usize]).collect(),
        sizes: order.iter().map(|&set| sizes[set as usize]).collect(),
    })
}

/// The parts that hang together over edges, ranked by their number of faces.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn parts_by_edges(mesh: &TriMesh, control: Control) -> Result<Parts, Cancelled> {
    parts(mesh, Connection::Edge, Largeness::Faces, control)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;

    /// A small square of two faces; two large triangles that touch in a vertex.
    fn three() -> TriMesh {
        let points = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [10.0, 0.0, 0.0],
            [14.0, 0.0, 0.0],
            [10.0, 4.0, 0.0],
            [8.0, 0.0, 0.0],
            [10.0, -2.0, 0.0],
        ];
        mesh_of(&points, &[[0, 1, 2], [4, 5, 6], [0, 2, 3], [4, 7, 8]])
    }

    #[test]
    fn components_are_ranked_by_what_is_asked_for() {
        let found = |connection, largeness| {
            parts(&three(), connection, largeness, Control::none()).unwrap()
        };
        let by_edge = found(Connection::Edge, Largeness::Area);
        assert_eq!(by_edge.of_faces, [2, 0, 2, 1]);
        assert_eq!(by_edge.sizes, [8.0, 2.0, 1.0]);
        let by_vertex = found(Connection::Vertex, Largeness::Area);
        assert_eq!((by_vertex.of_faces, by_vertex.sizes), (vec![1, 0, 1, 0], vec![10.0, 1.0]));
        let by_faces = found(Connection::Edge, Largeness::Faces);
        assert_eq!((by_faces.of_faces, by_faces.sizes), (vec![0, 1, 0, 2], vec![2.0, 1.0, 1.0]));
    }

    #[test]
    fn an_empty_mesh_has_none_and_what_is_nowhere_no_size() {
        let none = parts(&TriMesh::default(), Connection::Edge, Largeness::Area, Control::none());
        assert_eq!(none, Ok(Parts::default()));
        let mut mesh = three();
        mesh.positions[5].x = f64::NAN;
        let found = parts(&mesh, Connection::Edge, Largeness::Area, Control::none()).unwrap();
        assert_eq!(found.sizes, [2.0, 1.0, 0.0]);
    }
}
