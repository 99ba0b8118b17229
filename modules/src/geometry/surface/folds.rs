//! Folds and slivers: what a surface has that no one wants, however small its distances are.
//!
//! A folded edge is one of two faces whose normals are more than 150° apart, the faces being turned
//! to one side first; a sliver is a face with an angle of less than 1°. A face without area is a
//! sliver and folds nothing; one with a coordinate that is not finite is neither.

use glam::DVec3;
use mve_core::{Cancelled, Control};

use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{FaceId, TriMesh};

/// cos 150°.
const FOLD_COS: f64 = -0.866_025_403_784_438_6;

/// tan 1°.
const SLIVER_TAN: f64 = 0.017_455_064_928_217_585;

/// Edges of exactly two faces that fold these onto each other.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn n_folded_edges(
    mesh: &TriMesh,
    adjacency: &Adjacency,
    control: Control,
) -> Result<usize, Cancelled> {
    let n_edges = adjacency.edges().len();
    let mut n_folded = 0;
    for edge in (0..n_edges as u32).map(EdgeId) {
        control.item(edge.idx(), n_edges)?;
        let [one, other] = adjacency.sides_of(edge) else { continue };
        let [a, b] = [one, other].map(|side| cross(mesh, side.face()));
        let cos = if adjacency.is_oriented(mesh, edge) { a.dot(b) } else { -a.dot(b) };
        n_folded += usize::from(cos < FOLD_COS * a.length() * b.length());
    }
    Ok(n_folded)
}

/// Faces with an angle of less than 1°.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn n_slivers(mesh: &TriMesh, control: Control) -> Result<usize, Cancelled> {
    let mut n_slivers = 0;
    for face in (0..mesh.faces.len() as u32).map(FaceId) {
        control.item(face.idx(), mesh.faces.len())?;
        let [a, b, c] = mesh.corners(face);
        // The sine of each angle is the same area over the lengths beside it.
        let area = cross(mesh, face).length();
        let cosines = [(b - a).dot(c - a), (c - b).dot(a - b), (a - c).dot(b - c)];
        let is_thin = area == 0.0 || cosines.iter().any(|cos| area < SLIVER_TAN * cos);
        n_slivers += usize::from(is_thin && area.is_finite());
    }
    Ok(n_slivers)
}

/// The normal of a face, twice its area long.
fn cross(mesh: &TriMesh, face: FaceId) -> DVec3 {
    let [a, b, c] = mesh.corners(face);
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of};

    use super::*;
    use crate::test_models::model;

    fn found(mesh: &TriMesh) -> [usize; 2] {
        let adjacency = Adjacency::new(mesh, Control::none()).unwrap();
        let n_folded = n_folded_edges(mesh, &adjacency, Control::none()).unwrap();
        [n_folded, n_slivers(mesh, Control::none()).unwrap()]
    }

    /// Two faces over one edge along x: one flat in +y, the other bent away from the flat
    /// continuation by this angle.
    fn hinge(angle_deg: f64) -> TriMesh {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let tops = [[0.0, 1.0, 0.0], [0.0, -cos, sin]];
        mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], tops[0], tops[1]], &[[0, 1, 2], [1, 0, 3]])
    }

    #[test]
    fn an_edge_is_folded_from_150_degrees_on_whichever_way_its_faces_look() {
        for (angle_deg, expected) in [(0.0, 0), (90.0, 0), (149.9, 0), (150.1, 1), (180.0, 1)] {
            for angle_deg in [angle_deg, -angle_deg] {
                let mut mesh = hinge(angle_deg);
                assert_eq!(found(&mesh), [expected, 0], "{angle_deg}");
                mesh.faces[1].swap(1, 2);
                assert_eq!(found(&mesh), [expected, 0], "{angle_deg} turned");
            }
        }
        assert_eq!(found(&cube(DVec3::ZERO)), [0, 0]);
    }

    /// The angle at the origin of (0, 0), (1, 0), (1, h) has the tangent h; beside it stands a
    /// right angle, and what is left is 90° less it.
    #[test]
    fn a_sliver_has_an_angle_of_less_than_a_degree_at_any_size() {
        for (angle_deg, expected) in [(0.99, 1), (1.01, 0), (45.0, 0), (88.99, 0), (89.01, 1)] {
            for size in [1e-12, 1.0, 1e12] {
                let h = size * f64::to_radians(angle_deg).tan();
                let corners = [[0.0; 3], [size, 0.0, 0.0], [size, h, 0.0]];
                for face in [[0, 1, 2], [1, 2, 0], [2, 1, 0]] {
                    assert_eq!(found(&mesh_of(&corners, &[face])), [0, expected], "{angle_deg}");
                }
            }
        }
    }

    #[test]
    fn what_has_no_area_is_a_sliver_and_what_is_nowhere_is_nothing() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0]];
        let flat = [[0, 1, 2], [0, 0, 1], [0, 1, 3], [1, 0, 2]];
        assert_eq!(found(&mesh_of(&points, &flat)), [0, 3]);
    }

    /// Counts of numpy over the same files, by `measure.py` of `tests/peers`.
    #[test]
    fn real_models() {
        let rows = [
            ("cow.obj", [9, 0]),
            ("fandisk.obj", [0, 0]),
            ("stanford-bunny.obj", [1, 1]),
            ("suzanne.obj", [10, 0]),
            ("hoppe/cessna.obj.gz", [76, 263]),
            ("hoppe/standingblob.obj.gz", [33, 860]),
            ("bodies/person1_scan.obj.gz", [87, 0]),
        ];
        for (name, expected) in rows {
            let Some(mesh) = model(name) else { return };
            assert_eq!(found(&mesh), expected, "{name}");
        }
    }
}
