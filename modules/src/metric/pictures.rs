//! What metrics on pictures share: how pictures are taken, and what is not in them.

use mve_core::Control;
use mve_mesh::data::TriMesh;

use super::{MeshRole, MetricError};
use crate::picture::missing::{lack_of_colors, missing_colors};
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
    if let Some(message) = lack_of_colors(&[original, simplified], view.albedo) {
        return Err(MetricError::Param { name: VIEW.albedo.spec().name, message });
    }
    let pair = view.pair(original, simplified, control)?.ok_or_else(|| {
        let message = "the original mesh has no finite extent, so no camera can look at it; a mesh \
                       with a box of some size is expected";
        MetricError::Input { mesh: MeshRole::Original, message: message.to_owned() }
    })?;
    let mut warnings = Vec::new();
    // What each lacks, and which of the meshes do.
    let mut lacking: Vec<(String, Vec<&str>)> = Vec::new();
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
        for missing in missing_colors(mesh, view.albedo) {
            match lacking.iter_mut().find(|(known, _)| *known == missing) {
                Some((_, names)) => names.push(name),
                None => lacking.push((missing, vec![name])),
            }
        }
    }
    warnings.extend(lacking.into_iter().map(|(missing, names)| match names.as_slice() {
        [name] => format!("the {name} mesh {missing}"),
        _ => format!("each of the two meshes {missing}"),
    }));
    Ok((pair, warnings))
}

#[cfg(test)]
#[path = "pictures_tests.rs"]
pub(super) mod tests;
