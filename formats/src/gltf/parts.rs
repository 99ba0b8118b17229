//! The nodes of a glTF file that a mesh is written as, and the order of its vertices there.

use std::ops::Range;

use mve_core::{Cancelled, Control};

use mve_mesh::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};

/// A node.
pub(super) struct Part {
    pub name: Option<String>,
    pub vertices: Range<u32>,
    /// The faces of each material, by its number in the layer; [`NO_VALUE`] for none.
    pub materials: Vec<(u32, Vec<u32>)>,
}

/// One part for each object, with the vertices of each together; one for all where objects share a
/// vertex, which is said.
pub(super) fn parts(
    mesh: TriMesh,
    warnings: &mut Vec<String>,
    control: Control,
) -> Result<(TriMesh, Vec<Part>), Cancelled> {
    let n = mesh.positions.len() as u32;
    if n == 0 {
        return Ok((mesh, Vec::new()));
    }
    let objects = match mesh.layer(Layer::OBJECT) {
        Some(Layer { domain: Domain::Face, values: LayerValues::Label(names), index, .. }) => {
            Some((names.clone(), index.clone()))
        }
        _ => None,
    };
    let whole = |mesh: TriMesh, control: Control| {
        let materials = by_material(&mesh, 0..mesh.faces.len() as u32, control)?;
        Ok((mesh, vec![Part { name: None, vertices: 0..n, materials }]))
    };
    let Some((names, index)) = objects else { return whole(mesh, control) };
    let Some(owners) = owners(&mesh, &index) else {
        warnings.push("objects share vertices, so they are written as one".to_owned());
        return whole(mesh, control);
    };
    // Objects in the order of their first face; those of none are one, too.
    let mut order: Vec<u32> = Vec::new();
    let mut is_known = vec![false; names.len() + 1];
    for &object in &index {
        let place = (object as usize).min(names.len());
        if !std::mem::replace(&mut is_known[place], true) {
            order.push(place as u32);
        }
    }
    let mut of_objects: Vec<Vec<u32>> = vec![Vec::new(); names.len() + 1];
    let first = order.first().copied().unwrap_or_default();
    let mut last = first;
    for (vertex, owner) in (0_u32..).zip(owners) {
        // A vertex of no face goes with the one before it.
        last = owner.map_or(last, |owner| owner.min(names.len() as u32));
        of_objects[last as usize].push(vertex);
    }
    let mut faces_of: Vec<Vec<u32>> = vec![Vec::new(); names.len() + 1];
    for (face, &object) in (0_u32..).zip(&index) {
        faces_of[(object as usize).min(names.len())].push(face);
    }
    let mut sources = Vec::with_capacity(n as usize);
    let mut parts = Vec::new();
    for place in order {
        let start = sources.len() as u32;
        sources.extend(&of_objects[place as usize]);
        let faces = faces_of[place as usize].iter().copied();
        parts.push(Part {
            name: names.get(place as usize).cloned(),
            vertices: start..sources.len() as u32,
            materials: by_material(&mesh, faces, control)?,
        });
    }
    Ok((reordered(mesh, &sources), parts))
}

/// The object of each vertex that faces use; `None` where one has two.
fn owners(mesh: &TriMesh, index: &[u32]) -> Option<Vec<Option<u32>>> {
    let mut owners = vec![None; mesh.positions.len()];
    for (face, &object) in mesh.faces.iter().zip(index) {
        for vertex in face {
            if *owners[vertex.idx()].get_or_insert(object) != object {
                return None;
            }
        }
    }
    Some(owners)
}

/// Faces by the number of their material, in the order of the numbers; those of none come last.
fn by_material(
    mesh: &TriMesh,
    faces: impl Iterator<Item = u32>,
    control: Control,
) -> Result<Vec<(u32, Vec<u32>)>, Cancelled> {
    let index = match mesh.layer(Layer::MATERIAL) {
        Some(Layer { domain: Domain::Face, values: LayerValues::Label(_), index, .. }) => {
            index.as_slice()
        }
        _ => &[],
    };
    let mut all: std::collections::BTreeMap<u32, Vec<u32>> = std::collections::BTreeMap::new();
    for (number, face) in faces.enumerate() {
        control.item(number, mesh.faces.len())?;
        let material = index.get(face as usize).copied().unwrap_or(NO_VALUE);
        all.entry(material).or_default().push(face);
    }
    Ok(all.into_iter().collect())
}

/// The mesh with its vertices in another order.
fn reordered(mut mesh: TriMesh, sources: &[u32]) -> TriMesh {
    let mut places = vec![0; sources.len()];
    for (place, &source) in (0_u32..).zip(sources) {
        places[source as usize] = place;
    }
    mesh.positions = sources.iter().map(|&source| mesh.positions[source as usize]).collect();
    for vertex in mesh.faces.iter_mut().flatten() {
        *vertex = VertexId(places[vertex.idx()]);
    }
    for layer in mesh.layers.iter_mut().filter(|layer| layer.domain == Domain::Vertex) {
        layer.index = sources.iter().map(|&source| layer.index[source as usize]).collect();
    }
    mesh
}
