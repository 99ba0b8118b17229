//! What metrics of area and volume share: the sums over the faces, and what is not in them.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, TriMesh};

use super::{MeshRole, MetricError};

/// Sums over the faces of a mesh whose corners are finite.
pub struct SurfaceSums {
    /// In squared model units.
    pub area: f64,
    /// Of the cones from one point to the faces, those that are seen from behind positive, in cubed
    /// model units: the volume within a closed surface, wherever the point lies.
    pub volume: f64,
    /// Faces that were left out for their coordinates.
    pub n_left_out: usize,
}

/// The sums over the faces of a mesh, with cones from the point `center`; O(n).
///
/// # Errors
/// [`MetricError::Input`] for a mesh without a face that has finite corners, and
/// [`MetricError::Cancelled`].
pub fn surface_sums(
    role: MeshRole,
    mesh: &TriMesh,
    center: DVec3,
    control: Control,
) -> Result<SurfaceSums, MetricError> {
    let mut sums = SurfaceSums { area: 0.0, volume: 0.0, n_left_out: 0 };
    for face in 0..mesh.faces.len() {
        control.item(face, mesh.faces.len())?;
        let [a, b, c] = mesh.corners(FaceId(face as u32));
        let across = (b - a).cross(c - a);
        if !(a.is_finite() && across.is_finite()) {
            sums.n_left_out += 1;
            continue;
        }
        sums.area += 0.5 * across.length();
        sums.volume += (a - center).dot(across) / 6.0;
    }
    if sums.n_left_out == mesh.faces.len() {
        let message = match mesh.faces.len() {
            0 => format!("the {role} mesh has no faces; surfaces are compared"),
            n => format!("the {role} mesh has {n} faces but none with finite coordinates"),
        };
        return Err(MetricError::Input { mesh: role, message });
    }
    Ok(sums)
}

/// What was left out, as sentences.
pub fn warnings(original: &SurfaceSums, simplified: &SurfaceSums) -> Vec<String> {
    let sides = [(MeshRole::Original, original), (MeshRole::Simplified, simplified)];
    let left_out = sides.into_iter().filter(|(_, sums)| sums.n_left_out > 0);
    let sentence = |(role, sums): (MeshRole, &SurfaceSums)| {
        let n = sums.n_left_out;
        format!(
            "{n} faces of the {role} mesh have coordinates that are not finite and do not count"
        )
    };
    left_out.map(sentence).collect()
}

/// The lowest and highest corner of the box around the finite vertices that faces use.
pub fn finite_bounds(mesh: &TriMesh, control: Control) -> Result<[DVec3; 2], Cancelled> {
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for (place, vertex) in mesh.faces.as_flattened().iter().enumerate() {
        control.item(place, 3 * mesh.faces.len())?;
        let position = mesh.positions[vertex.idx()];
        if position.is_finite() {
            bounds = [bounds[0].min(position), bounds[1].max(position)];
        }
    }
    Ok(bounds)
}
