//! Normals of a mesh whose vertices have moved.

use std::collections::HashMap;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Domain, Layer, LayerValues, TriMesh, VertexId};

use crate::geometry::surface::normals::face_normals;

/// Computes the values of the layer of normals anew where there is one; which corners of a vertex
/// share a normal stays as it is.
///
/// A normal is the mean of those of the faces at its corners. Where these cancel, or there is no
/// such face, it stays what it was. Elements without a normal get none.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn renew_normals(mesh: &mut TriMesh, control: Control) -> Result<(), Cancelled> {
    let place = mesh.layers.iter().position(|layer| layer.name == Layer::NORMAL);
    let Some(place) = place else { return Ok(()) };
    let normals = face_normals(mesh, control.part(0.0, 0.5))?;
    let layer = &mesh.layers[place];
    let LayerValues::Vec3(old) = &layer.values else { return Ok(()) };
    let mut values: Vec<DVec3> = Vec::with_capacity(old.len());
    let mut first_values: Vec<u32> = Vec::with_capacity(old.len());
    let mut index = layer.index.clone();
    match layer.domain {
        Domain::Face => {
            for (value, normal) in index.iter_mut().zip(&normals) {
                if (*value as usize) < old.len() {
                    first_values.push(*value);
                    *value = values.len() as u32;
                    values.push(*normal);
                }
            }
        }
        Domain::Vertex | Domain::Corner => {
            // One value for each that a vertex has: others may share it by chance.
            let mut known: HashMap<(VertexId, u32), u32> = HashMap::new();
            let is_vertex = layer.domain == Domain::Vertex;
            for (corner, &vertex) in mesh.faces.iter().flatten().enumerate() {
                control.part(0.5, 1.0).item(corner, 3 * mesh.faces.len())?;
                let element = if is_vertex { vertex.idx() } else { corner };
                let value = layer.index[element];
                if value as usize >= old.len() {
                    continue;
                }
                let number = *known.entry((vertex, value)).or_insert_with(|| {
                    first_values.push(value);
                    values.push(DVec3::ZERO);
                    values.len() as u32 - 1
                });
                values[number as usize] += normals[corner / 3];
                index[element] = number;
            }
            if is_vertex {
                // Those without a face keep what they had.
                let mut has_face = vec![false; mesh.positions.len()];
                mesh.faces.iter().flatten().for_each(|v| has_face[v.idx()] = true);
                for (value, _) in index.iter_mut().zip(has_face).filter(|(_, has)| !has) {
                    if (*value as usize) < old.len() {
                        first_values.push(*value);
                        values.push(DVec3::ZERO);
                        *value = values.len() as u32 - 1;
                    }
                }
            }
        }
    }
    for (value, before) in values.iter_mut().zip(first_values) {
        *value = value.try_normalize().unwrap_or(old[before as usize]);
    }
    let layer = &mut mesh.layers[place];
    (layer.values, layer.index) = (LayerValues::Vec3(values), index);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of};

    use super::*;
    use crate::geometry::surface::normals::{NormalWeight, corner_normal_layer};

    /// A cube becomes a slanted prism: each of its six sides keeps one normal, its own.
    #[test]
    fn seams_of_normals_stay_where_they_are() {
        let mut mesh = cube(DVec3::ZERO);
        let layer = corner_normal_layer(&mesh, NormalWeight::Angle, 0.8, Control::none()).unwrap();
        mesh.set_layer(layer);
        mesh.positions.iter_mut().for_each(|p| p.x += 0.5 * p.z);
        renew_normals(&mut mesh, Control::none()).unwrap();
        assert_eq!(mesh.check(), Ok(()));
        let layer = mesh.layer(Layer::NORMAL).unwrap();
        assert_eq!(layer.values.len(), 24);
        let LayerValues::Vec3(values) = &layer.values else { panic!("normals") };
        for (corner, value) in layer.index.iter().enumerate() {
            let [a, b, c] = mesh.corners(mve_mesh::data::FaceId(corner as u32 / 3));
            let expected = (b - a).cross(c - a).normalize();
            assert!((values[*value as usize] - expected).length() < 1e-15);
        }
    }

    #[test]
    fn what_has_no_face_or_no_area_keeps_its_normal() {
        let mut mesh = mesh_of(&[[0.0; 3]; 4], &[[0, 1, 2]]);
        let values = LayerValues::Vec3(vec![DVec3::X, DVec3::Y]);
        let (name, index) = (Layer::NORMAL.to_owned(), vec![0, 0, 0, 1]);
        mesh.set_layer(Layer { name, domain: Domain::Vertex, values, index });
        renew_normals(&mut mesh, Control::none()).unwrap();
        let layer = mesh.layer(Layer::NORMAL).unwrap();
        assert_eq!((mesh.check(), &layer.index[..]), (Ok(()), &[0, 1, 2, 3][..]));
        let expected = vec![DVec3::X, DVec3::X, DVec3::X, DVec3::Y];
        assert_eq!(layer.values, LayerValues::Vec3(expected));
    }
}
