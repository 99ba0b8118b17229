//! How far the vertices of a mesh moved when it was simplified.
//!
//! The measure of error of simplification by vertex clustering and vertex decimation: each vertex
//! of the original becomes a vertex of the result, and the way between the two is its error. The
//! errors of all vertices, over the diagonal of the box of the original, are the error of the
//! whole.
//!
//! Which vertex became which, two meshes do not say. Where both have the same faces and as many
//! vertices, it is that of the same index. Elsewhere it is taken to be the nearest vertex of the
//! simplified mesh, which no vertex can have moved less than: the shift is a lower bound, exact
//! where each vertex goes to the nearest one that stays.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Field, TriMesh, VertexId};
use mve_mesh::morton::coarse_order;
use thiserror::Error;

use super::bvh::Bvh;
use super::hausdorff::MeshRole;
use super::many::ManyQueries;

/// The ways of the vertices of the original, in model units.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexShift {
    /// Of each vertex of the original; not a number where it does not count.
    pub field: Field,
    /// How many vertices count: those of faces, or all without faces, with finite coordinates.
    pub n_vertices: usize,
    /// Mean over these.
    pub mean: f64,
    /// The largest.
    pub max: f64,
    /// Whether vertices corresponded by index.
    pub is_by_index: bool,
    /// Diagonal of the box of the original.
    pub diagonal: f64,
}

/// Why there is no shift.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ShiftError {
    /// A mesh without a vertex that counts.
    #[error(
        "the {0} mesh has no vertex with finite coordinates in a face; a shift needs one on both \
         sides"
    )]
    NoVertices(MeshRole),
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Measures how far vertices moved. O(n log n).
///
/// # Errors
/// [`ShiftError`] where a mesh has no vertex that counts, and when `control` ends it.
pub fn vertex_shift(
    original: &TriMesh,
    simplified: &TriMesh,
    control: Control,
) -> Result<VertexShift, ShiftError> {
    let counted = counted(original);
    if counted.is_empty() {
        return Err(ShiftError::NoVertices(MeshRole::Original));
    }
    let is_by_index = original.faces == simplified.faces
        && original.positions.len() == simplified.positions.len();
    let shifts = match is_by_index {
        true => by_index(original, simplified, &counted, control)?,
        false => by_nearest(original, simplified, &counted, control)?,
    };
    let mut values = vec![f64::NAN; original.positions.len()];
    let (mut sum, mut max, mut n_vertices) = (0.0, 0.0_f64, 0);
    for (&vertex, &shift) in counted.iter().zip(&shifts) {
        values[vertex.idx()] = shift;
        if shift.is_finite() {
            sum += shift;
            max = max.max(shift);
            n_vertices += 1;
        }
    }
    if n_vertices == 0 {
        return Err(ShiftError::NoVertices(MeshRole::Simplified));
    }
    let (name, unit) = ("shift".to_owned(), "model units".to_owned());
    Ok(VertexShift {
        field: Field { name, unit, domain: Domain::Vertex, values },
        n_vertices,
        mean: sum / n_vertices as f64,
        max,
        is_by_index,
        diagonal: original.diagonal(),
    })
}

/// The vertices that count, in order.
fn counted(mesh: &TriMesh) -> Vec<VertexId> {
    let mut is_counted = vec![mesh.faces.is_empty(); mesh.positions.len()];
    for vertex in mesh.faces.as_flattened() {
        if let Some(is_counted) = is_counted.get_mut(vertex.idx()) {
            *is_counted = true;
        }
    }
    let finite = mesh.positions.iter().zip(is_counted).enumerate();
    let finite = finite.filter(|(_, (position, is_counted))| *is_counted && position.is_finite());
    finite.map(|(vertex, _)| VertexId(vertex as u32)).collect()
}

fn by_index(
    original: &TriMesh,
    simplified: &TriMesh,
    counted: &[VertexId],
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    let shift = |(place, vertex): (usize, &VertexId)| {
        control.item(place, counted.len())?;
        Ok(original.positions[vertex.idx()].distance(simplified.positions[vertex.idx()]))
    };
    counted.iter().enumerate().map(shift).collect()
}

fn by_nearest(
    original: &TriMesh,
    simplified: &TriMesh,
    vertices: &[VertexId],
    control: Control,
) -> Result<Vec<f64>, ShiftError> {
    let targets = counted(simplified);
    if targets.is_empty() {
        return Err(ShiftError::NoVertices(MeshRole::Simplified));
    }
    // A tree of triangles that are points.
    let points = targets.iter().map(|vertex| simplified.positions[vertex.idx()]).collect();
    let faces = (0..targets.len() as u32).map(|point| [VertexId(point); 3]).collect();
    let tree = Bvh::build(&TriMesh::new(points, faces), control.part(0.0, 0.3))?;
    let places: Vec<DVec3> = vertices.iter().map(|v| original.positions[v.idx()]).collect();
    let order = coarse_order(&places, control.part(0.3, 0.4))?;
    let sorted: Vec<DVec3> = order.iter().map(|&at| places[at as usize]).collect();
    let hits = ManyQueries::new(&tree, tree.center()).closest(&sorted, control.part(0.4, 1.0))?;
    let mut shifts = vec![f64::NAN; places.len()];
    for (at, hit) in order.into_iter().zip(hits) {
        shifts[at as usize] = hit.map_or(f64::NAN, |hit| hit.distance_sq.sqrt());
    }
    Ok(shifts)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of, torus};

    use super::*;

    /// Rossignac and Borrel's clustering by hand: the four vertices of a square go to two.
    #[test]
    fn vertices_go_to_the_nearest_one_that_stays() {
        let square = mesh_of(
            &[[0.0; 3], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0], [0.0, 4.0, 0.0], [9.0; 3]],
            &[[0, 1, 2], [0, 2, 3]],
        );
        let points = [[0.0, 1.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.5, 0.0]];
        let triangle = mesh_of(&points, &[[0, 1, 2]]);
        let found = vertex_shift(&square, &triangle, Control::none()).unwrap();
        assert_eq!(found.field.values[..4], [1.0, 0.0, 0.5, 3.0]);
        assert!(found.field.values[4].is_nan(), "it has no face");
        assert_eq!((found.n_vertices, found.mean, found.max), (4, 4.5 / 4.0, 3.0));
        assert_eq!((found.diagonal, found.is_by_index), (5.0, false));
    }

    #[test]
    fn meshes_of_the_same_faces_correspond_by_index() {
        let (mesh, mut moved) = (cube(DVec3::ZERO), cube(DVec3::X));
        moved.positions[3].x += 1.0;
        let found = vertex_shift(&mesh, &moved, Control::none()).unwrap();
        assert_eq!((found.mean, found.max), (9.0 / 8.0, 2.0));
        assert!(found.is_by_index);
    }

    #[test]
    fn the_tree_finds_what_a_loop_finds() {
        let (fine, coarse) = (torus(2.0, 0.5, 24), torus(2.1, 0.4, 7));
        let found = vertex_shift(&fine, &coarse, Control::none()).unwrap();
        let nearest = |p: &DVec3| coarse.positions.iter().map(|q| p.distance(*q)).reduce(f64::min);
        for (p, shift) in fine.positions.iter().zip(&found.field.values) {
            assert!((nearest(p).unwrap() - shift).abs() < 1e-12);
        }
    }

    #[test]
    fn a_mesh_without_vertices_is_named() {
        let mesh = cube(DVec3::ZERO);
        let shift = |a: &TriMesh, b: &TriMesh| vertex_shift(a, b, Control::none()).unwrap_err();
        let nothing = TriMesh::default();
        assert_eq!(shift(&nothing, &mesh), ShiftError::NoVertices(MeshRole::Original));
        assert_eq!(shift(&mesh, &nothing), ShiftError::NoVertices(MeshRole::Simplified));
        let mut broken = mesh.clone();
        broken.positions.iter_mut().for_each(|p| p.x = f64::NAN);
        assert_eq!(shift(&mesh, &broken), ShiftError::NoVertices(MeshRole::Simplified));
    }
}
