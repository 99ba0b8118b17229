//! What metrics at nearest points share: the trees of both meshes, and what is not in them.

use mve_core::Control;
use mve_mesh::data::TriMesh;

use super::{MeshRole, MetricError};
use crate::geometry::distance::bvh::Bvh;

/// The trees of both meshes.
pub struct Trees {
    /// Of the original.
    pub of_original: Bvh,
    /// Of the simplified mesh.
    pub of_simplified: Bvh,
}

/// Makes the trees.
///
/// # Errors
/// [`MetricError::Input`] for a mesh without a face that has finite corners, and
/// [`MetricError::Cancelled`].
pub fn trees(
    original: &TriMesh,
    simplified: &TriMesh,
    control: Control,
) -> Result<Trees, MetricError> {
    let of_original = tree(MeshRole::Original, original, control.part(0.0, 0.5))?;
    let of_simplified = tree(MeshRole::Simplified, simplified, control.part(0.5, 1.0))?;
    Ok(Trees { of_original, of_simplified })
}

fn tree(role: MeshRole, mesh: &TriMesh, control: Control) -> Result<Bvh, MetricError> {
    let input = |message| MetricError::Input { mesh: role, message };
    if mesh.faces.is_empty() {
        return Err(input(format!("the {role} mesh has no faces; surfaces are compared")));
    }
    let tree = Bvh::build(mesh, control)?;
    if tree.n_faces() == 0 {
        let n = mesh.faces.len();
        return Err(input(format!(
            "the {role} mesh has {n} faces but none with finite coordinates"
        )));
    }
    Ok(tree)
}

/// What was left out, as sentences.
pub fn warnings(original: &Bvh, simplified: &Bvh) -> Vec<String> {
    let sides = [(MeshRole::Original, original), (MeshRole::Simplified, simplified)];
    let left_out = sides.into_iter().filter(|(_, tree)| tree.n_left_out() > 0);
    let sentence = |(role, tree): (MeshRole, &Bvh)| {
        let n = tree.n_left_out();
        format!(
            "{n} faces of the {role} mesh have coordinates that are not finite and do not count"
        )
    };
    left_out.map(sentence).collect()
}
