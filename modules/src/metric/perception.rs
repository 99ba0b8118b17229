//! What perceptual metrics share: which parts of the meshes do not count, and what cannot be
//! measured.

use mve_mesh::data::TriMesh;

use super::MetricError;
use crate::geometry::perception::msdm2::{Msdm2, Msdm2Error};

impl From<Msdm2Error> for MetricError {
    fn from(error: Msdm2Error) -> Self {
        let message = error.to_string();
        match error {
            Msdm2Error::NoFaces(mesh)
            | Msdm2Error::NothingUsable(mesh, _)
            | Msdm2Error::NoExtent(mesh) => Self::Input { mesh, message },
            Msdm2Error::Cancelled(cancelled) => Self::Cancelled(cancelled),
        }
    }
}

/// What of both meshes does not count.
pub fn warnings(found: &Msdm2, original: &TriMesh, simplified: &TriMesh) -> Vec<String> {
    let sides = [
        ("original", original, &found.from_original, found.n_left_out_original),
        ("simplified", simplified, &found.from_simplified, found.n_left_out_simplified),
    ];
    let mut warnings = Vec::new();
    for (side, mesh, one_sided, n_left_out) in sides {
        if n_left_out > 0 {
            warnings.push(format!(
                "{n_left_out} faces of the {side} mesh are not finite or name a vertex twice and \
                 were left out"
            ));
        }
        let n_alone = mesh.positions.len() - one_sided.n_vertices;
        if n_alone > 0 {
            warnings.push(format!(
                "{n_alone} vertices of the {side} mesh have no usable face and do not count"
            ));
        }
    }
    warnings
}
