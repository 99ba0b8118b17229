//! What metrics on pictures share: how pictures are taken, and what is not in them.

use mve_core::Control;

use super::{MeshRole, MetricError};
use crate::data::TriMesh;
use crate::picture::missing::missing_colors;
use crate::picture::view::{Pair, View, ViewDefaults, ViewParams, n_unseen};

/// The view of all metrics on pictures.
pub const VIEW: ViewParams = ViewParams::new(ViewDefaults {
    cameras: "Rhombicuboctahedron",
    resolution: 512,
    albedo: "White",
    shading: "Flat",
    sides: "Both",
    background: 0,
});

/// Pictures of both meshes, and warnings about what is not in them.
pub fn take_pair(
    view: &View,
    original: &TriMesh,
    simplified: &TriMesh,
    control: Control,
) -> Result<(Pair, Vec<String>), MetricError> {
    let pair = view.pair(original, simplified, control)?.ok_or_else(|| {
        let message = "the original mesh has no finite extent, so no camera can look at it; a mesh \
                       with a box of some size is expected";
        MetricError::Input { mesh: MeshRole::Original, message: message.to_owned() }
    })?;
    let mut warnings = Vec::new();
    for (name, mesh) in [("original", original), ("simplified", simplified)] {
        match (mesh.faces.len(), n_unseen(mesh)) {
            (0, _) => {
                warnings.push(format!("the {name} mesh has no faces; its pictures are empty"));
                continue;
            }
            (_, 0) => {}
            (_, n) => warnings.push(format!(
                "{n} faces of the {name} mesh have coordinates that are not finite and are in no \
                 picture"
            )),
        }
        let missing = missing_colors(mesh, view.albedo).into_iter();
        warnings.extend(missing.map(|missing| format!("the {name} mesh {missing}")));
    }
    Ok((pair, warnings))
}

#[cfg(test)]
#[path = "pictures_tests.rs"]
pub(super) mod tests;
