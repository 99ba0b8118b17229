//! A mesh as a PLY file on the disk, with its pictures beside it.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use mve_core::{Control, ModuleError};
use mve_mesh::data::{Domain, Field, Layer, LayerValues, TextureRole, TriMesh};
use mve_mesh::split::split_corners;

use super::{PlyOptions, Precision, write_ply};
use crate::rounding::Rounding;
use crate::{obj, save_atomic};

/// Saves a mesh, and a field over its vertices or faces. Vertices with several normals or colors
/// are split. What is changed or left out comes back in sentences.
///
/// # Errors
/// With the path, where a file cannot be written or the mesh cannot be said in the format (see
/// [`write_ply`]); that `control` ended it.
pub fn save(
    mesh: Arc<TriMesh>,
    field: Option<Arc<Field>>,
    options: PlyOptions,
    path: &Path,
    control: Control,
) -> Result<Vec<String>, ModuleError> {
    let mut warnings = Vec::new();
    let (mesh, field) = with_values_over_vertices(mesh, field, &mut warnings);
    let is_bright = |color: &DVec3| color.min_element() < 0.0 || color.max_element() > 1.0;
    if let Some(LayerValues::Vec3(colors)) = mesh.layer(Layer::COLOR).map(|layer| &layer.values)
        && colors.iter().any(is_bright)
    {
        warnings.push("colors outside 0 to 1 are cut to that range".to_owned());
    }
    if options.precision == Precision::Float
        && let Some(rounding) = Rounding::of_floats(&mesh)
    {
        warnings
            .push(format!("{rounding}; set precision to Double, or move the mesh to the origin"));
    }
    let mesh = with_pictures(mesh, path, control, &mut warnings)?;
    save_atomic(path, |out| write_ply(&mesh, field.as_deref(), options, out, control))?;
    Ok(warnings)
}

/// Saves the pictures of base colors beside the file, and names them there.
fn with_pictures(
    mesh: Arc<TriMesh>,
    path: &Path,
    control: Control,
    warnings: &mut Vec<String>,
) -> Result<Arc<TriMesh>, ModuleError> {
    if mesh.materials.is_empty() {
        return Ok(mesh);
    }
    let mut colors = mesh.materials.clone();
    for material in &mut colors {
        material.textures.retain(|texture| texture.role == TextureRole::BaseColor);
    }
    if colors != mesh.materials || colors.iter().any(|material| !material.statements.is_empty()) {
        let text = "of materials PLY has a place for the picture of the base color alone";
        warnings.push(text.to_owned());
    }
    let materials = obj::save_pictures(&colors, path, "-ply-textures", control)?;
    Ok(Arc::new(TriMesh { materials, ..(*mesh).clone() }))
}

/// Splits vertices that have several normals or colors, and says so.
fn with_values_over_vertices(
    mesh: Arc<TriMesh>,
    field: Option<Arc<Field>>,
    warnings: &mut Vec<String>,
) -> (Arc<TriMesh>, Option<Arc<Field>>) {
    let is_over_corners =
        |name: &&str| mesh.layer(name).is_some_and(|layer| layer.domain == Domain::Corner);
    let names: Vec<&str> =
        [Layer::NORMAL, Layer::COLOR].into_iter().filter(is_over_corners).collect();
    // What does not fit the mesh is refused later.
    let fits = field.as_ref().is_none_or(|field| field.check_fits(&mesh).is_ok());
    if names.is_empty() || !fits || mesh.check().is_err() {
        return (mesh, field);
    }
    let split = split_corners(&mesh, &names);
    let (n_before, n_after) = (mesh.positions.len(), split.mesh.positions.len());
    if n_after > n_before {
        warnings.push(format!(
            "{n_after} vertices are written for {n_before}, since vertices have several values of {}",
            names.join(" and ")
        ));
    }
    let field = field.map(|field| match field.domain {
        Domain::Vertex => {
            let values = split.sources.iter().map(|&v| field.values[v as usize]).collect();
            Arc::new(Field { values, ..(*field).clone() })
        }
        _ => field,
    });
    (Arc::new(split.mesh), field)
}
