//! DAME: by how much the angles between neighboring faces changed, of two meshes with the same
//! faces.
//!
//! L. Váša and J. Rus, "Dihedral angle mesh error: a fast perception correlated distortion measure
//! for fixed connectivity triangle meshes", Computer Graphics Forum 31(5), 2012. At each edge of
//! two faces the angle between their normals, positive where the edge is convex and negative where
//! it is a valley, is compared with that of the original. The difference counts less where the
//! original is bent anyway, by exp(−(k α)²) with k = √(ln 100) / π, so that a fold of 180° counts a
//! hundredth, and more the better both faces can be seen; the value is the mean over the edges.
//!
//! How much a face is seen is asked of the caller, as shares that are 1 on average; without them
//! every edge counts the same. The scale of these weights, and that edges of more or fewer than two
//! faces, or at faces without area, do not count, are choices made here.

use std::f64::consts::PI;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{Domain, FaceId, Field, TriMesh};
use thiserror::Error;

use crate::geometry::distance::hausdorff::MeshRole;
use crate::geometry::surface::normals::face_normals;

/// A fold of 180° in the original counts this part.
const MASKED: f64 = 0.01;

/// The value, and where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Dame {
    /// Mean over the edges of the masked and weighted difference, in radians.
    pub value: f64,
    /// Mean difference without mask and weights, in radians.
    pub mean_rad: f64,
    /// The largest difference, in radians.
    pub max_rad: f64,
    /// Edges that count.
    pub n_edges: usize,
    /// Mean of the masked and weighted differences at the edges of each face; not a number without
    /// such an edge.
    pub local: Field,
}

/// Why two meshes have no value.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DameError {
    /// The meshes do not have the same faces.
    #[error(
        "the simplified mesh has {1} faces and {3} vertices, the original {0} and {2}: DAME \
         compares meshes with the same faces, whose vertices alone moved; Fmpd and Msdm2 compare \
         any"
    )]
    OtherFaces(usize, usize, usize, usize),
    /// No edge has two faces with area in both meshes.
    #[error("no edge of the {0} mesh has two faces with area, so there are no angles to compare")]
    NoEdges(MeshRole),
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Compares two meshes with the same faces. `visibility` has a share for each face. O(n log n).
///
/// # Errors
/// [`DameError`] where the faces are others or no edge counts, and when `control` ends it.
pub fn dame(
    original: &TriMesh,
    moved: &TriMesh,
    visibility: Option<&[f64]>,
    control: Control,
) -> Result<Dame, DameError> {
    if original.faces != moved.faces || original.positions.len() != moved.positions.len() {
        let counts = [original, moved].map(|mesh| (mesh.faces.len(), mesh.positions.len()));
        let [(a, n_a), (b, n_b)] = counts;
        return Err(DameError::OtherFaces(a, b, n_a, n_b));
    }
    let adjacency = Adjacency::new(original, control.part(0.0, 0.4))?;
    let normals_before = face_normals(original, control.part(0.4, 0.5))?;
    let normals_after = face_normals(moved, control.part(0.5, 0.6))?;
    let control = control.part(0.6, 1.0);
    let n_edges = adjacency.edges().len();
    let k = (1.0 / MASKED).ln().sqrt() / PI;
    let mut found = [0.0; 3];
    let mut n = 0_usize;
    let mut local = vec![(0.0, 0_u32); original.faces.len()];
    let mut has_angles_before = false;
    for edge in (0..n_edges as u32).map(EdgeId) {
        control.item(edge.idx(), n_edges)?;
        let [one, other] = adjacency.sides_of(edge) else { continue };
        let faces = [one.face(), other.face()];
        let Some(before) = dihedral_rad(original, &normals_before, &adjacency, edge) else {
            continue;
        };
        has_angles_before = true;
        let Some(after) = dihedral_rad(moved, &normals_after, &adjacency, edge) else { continue };
        let difference = (after - before).abs();
        let seen = visibility.map_or(1.0, |shares| {
            let share = |face: FaceId| shares.get(face.idx()).copied().unwrap_or(0.0);
            0.5 * (share(faces[0]) + share(faces[1]))
        });
        let value = difference * (-(k * before).powi(2)).exp() * seen;
        found = [found[0] + value, found[1] + difference, found[2].max(difference)];
        n += 1;
        for face in faces {
            let (sum, count) = local[face.idx()];
            local[face.idx()] = (sum + value, count + 1);
        }
    }
    if n == 0 {
        let role = if has_angles_before { MeshRole::Simplified } else { MeshRole::Original };
        return Err(DameError::NoEdges(role));
    }
    let values = local.into_iter().map(|(sum, count)| sum / f64::from(count)).collect();
    let (name, unit) = ("dame".to_owned(), "rad".to_owned());
    Ok(Dame {
        value: found[0] / n as f64,
        mean_rad: found[1] / n as f64,
        max_rad: found[2],
        n_edges: n,
        local: Field { name, unit, domain: Domain::Face, values },
    })
}

/// The angle between the normals at an edge of two faces, positive at a ridge, negative in a
/// valley; `None` where a face has no normal. Where the faces do not run the same way around, one
/// normal is turned, so that the angle is that of the surface.
fn dihedral_rad(
    mesh: &TriMesh,
    normals: &[DVec3],
    adjacency: &Adjacency,
    edge: EdgeId,
) -> Option<f64> {
    let [one, other] = adjacency.sides_of(edge) else { return None };
    let [a, b] = [one, other].map(|side| normals[side.face().idx()]);
    if a == DVec3::ZERO || b == DVec3::ZERO {
        return None;
    }
    let b = if adjacency.is_oriented(mesh, edge) { b } else { -b };
    let angle = a.cross(b).length().atan2(a.dot(b));
    // The corner of the other face that is not on the edge lies before or behind the first face.
    let [from, _] = adjacency.edges()[edge.idx()];
    let apex = mesh.faces[other.face().idx()][(other.corner() + 2) % 3];
    let height = (mesh.positions[apex.idx()] - mesh.positions[from.idx()]).dot(a);
    Some(if height > 0.0 { -angle } else { angle })
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of, torus};

    use super::*;

    fn measured(a: &TriMesh, b: &TriMesh) -> Result<Dame, DameError> {
        dame(a, b, None, Control::none())
    }

    /// Two faces at an edge, the second bent down by an angle.
    fn hinge(degrees: f64) -> TriMesh {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, -cos, -sin]];
        mesh_of(&points, &[[0, 1, 2], [1, 0, 3]])
    }

    #[test]
    fn one_edge_by_hand() {
        let found = measured(&hinge(0.0), &hinge(30.0)).unwrap();
        assert!((found.value - PI / 6.0).abs() < 1e-12, "a flat original masks nothing");
        assert_eq!(found.n_edges, 1);
        // From a ridge of 90° to a valley of 45°: 135°, masked by 100^(−1/4).
        let found = measured(&hinge(90.0), &hinge(-45.0)).unwrap();
        assert!((found.mean_rad - 0.75 * PI).abs() < 1e-12, "{found:?}");
        assert!((found.value - 0.75 * PI * 0.01_f64.powf(0.25)).abs() < 1e-12);
        assert!(found.local.values.iter().all(|value| (value - found.value).abs() < 1e-15));
        // Half as well seen, half as much.
        let half = dame(&hinge(0.0), &hinge(30.0), Some(&[0.25, 0.75]), Control::none()).unwrap();
        assert!((half.value - PI / 12.0).abs() < 1e-12);
    }

    #[test]
    fn a_cube_that_is_stretched_has_its_angles_and_turned_faces_have_them_too() {
        let mesh = cube(DVec3::ZERO);
        let mut long = mesh.clone();
        long.positions.iter_mut().for_each(|position| position.x *= 3.0);
        let found = measured(&mesh, &long).unwrap();
        assert_eq!(found.n_edges, 18);
        assert!(found.max_rad < 1e-12);
        let mut turned = [hinge(90.0), hinge(60.0)];
        turned.iter_mut().for_each(|mesh| mesh.faces[1].swap(0, 1));
        let found = measured(&turned[0], &turned[1]).unwrap();
        assert!((found.mean_rad - PI / 6.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn other_faces_and_faces_without_area_are_errors() {
        let error = measured(&torus(2.0, 0.5, 8), &torus(2.0, 0.5, 9)).unwrap_err();
        assert_eq!(error, DameError::OtherFaces(128, 162, 64, 81));
        let mut flat = hinge(0.0);
        flat.positions[3] = flat.positions[0];
        let error = measured(&hinge(0.0), &flat).unwrap_err();
        assert_eq!(error, DameError::NoEdges(MeshRole::Simplified));
        let nothing = TriMesh::default();
        let error = measured(&nothing, &nothing).unwrap_err();
        assert_eq!(error, DameError::NoEdges(MeshRole::Original));
    }
}
