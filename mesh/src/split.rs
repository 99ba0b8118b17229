//! Gives vertices that carry several values one vertex for each, for formats without seams.

use std::collections::HashMap;

use crate::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};

/// A mesh whose values over corners are over vertices.
#[derive(Clone, Debug)]
pub struct Split {
    /// The mesh; faces keep their order, and the copies of a vertex follow each other.
    pub mesh: TriMesh,
    /// The vertex that each vertex is a copy of.
    pub sources: Vec<u32>,
}

/// Puts the layers over corners of these names over vertices, with a copy of a vertex for each set
/// of values that it has there. Other layers over vertices are copied with it. O(n log n).
///
/// # Panics
/// When the mesh is not well formed; see [`TriMesh::check`].
pub fn split_corners(mesh: &TriMesh, names: &[&str]) -> Split {
    let is_split =
        |layer: &Layer| layer.domain == Domain::Corner && names.contains(&layer.name.as_str());
    let split_layers = mesh.layers.iter().filter(|layer| is_split(layer));
    let numbers: Vec<Vec<u32>> = split_layers.map(corner_numbers).collect();
    let mut known: HashMap<(u32, Vec<u32>), u32> = HashMap::new();
    // Vertex and first corner of each copy, and the copy of each corner.
    let mut copies: Vec<(u32, u32)> = Vec::new();
    let of_corner: Vec<u32> = mesh
        .faces
        .iter()
        .flatten()
        .zip(0_u32..)
        .map(|(vertex, corner)| {
            let values = numbers.iter().map(|numbers| numbers[corner as usize]).collect();
            *known.entry((vertex.0, values)).or_insert_with(|| {
                copies.push((vertex.0, corner));
                copies.len() as u32 - 1
            })
        })
        .collect();
    let mut has_copy = vec![false; mesh.positions.len()];
    copies.iter().for_each(|(vertex, _)| has_copy[*vertex as usize] = true);
    let mut order: Vec<(u32, u32, u32)> = copies
        .iter()
        .zip(0_u32..)
        .map(|(&(vertex, corner), copy)| (vertex, corner, copy))
        .collect();
    let alone = has_copy.iter().zip(0_u32..).filter(|(has_copy, _)| !**has_copy);
    order.extend(alone.map(|(_, vertex)| (vertex, NO_VALUE, NO_VALUE)));
    order.sort_unstable();
    let mut places = vec![0; copies.len()];
    for (&(_, _, copy), place) in order.iter().zip(0_u32..) {
        if copy != NO_VALUE {
            places[copy as usize] = place;
        }
    }
    let vertex_at = |corner: usize| VertexId(places[of_corner[corner] as usize]);
    let faces = (0..mesh.faces.len()).map(|f| [0, 1, 2].map(|k| vertex_at(3 * f + k)));
    let positions = order.iter().map(|&(vertex, _, _)| mesh.positions[vertex as usize]);
    let mut split = TriMesh::new(positions.collect(), faces.collect());
    split.materials.clone_from(&mesh.materials);
    split.layers = mesh
        .layers
        .iter()
        .map(|layer| {
            let value = |&(vertex, corner, _): &(u32, u32, u32)| match layer.domain {
                Domain::Vertex => layer.index[vertex as usize],
                _ => layer.index.get(corner as usize).copied().unwrap_or(NO_VALUE),
            };
            let is_over_vertices = layer.domain == Domain::Vertex || is_split(layer);
            if !is_over_vertices {
                return layer.clone();
            }
            let index = order.iter().map(value).collect();
            Layer { domain: Domain::Vertex, index, ..layer.clone() }
        })
        .collect();
    Split { mesh: split, sources: order.into_iter().map(|(vertex, _, _)| vertex).collect() }
}

/// For each corner the first value that is equal to its own.
fn corner_numbers(layer: &Layer) -> Vec<u32> {
    let numbers = value_numbers(&layer.values);
    let number = |value: &u32| numbers.get(*value as usize).copied().unwrap_or(NO_VALUE);
    layer.index.iter().map(number).collect()
}

/// For each value the first one that is equal to it.
fn value_numbers(values: &LayerValues) -> Vec<u32> {
    fn first<K: std::hash::Hash + Eq>(keys: impl Iterator<Item = K>) -> Vec<u32> {
        let mut known: HashMap<K, u32> = HashMap::new();
        keys.zip(0_u32..).map(|(key, number)| *known.entry(key).or_insert(number)).collect()
    }
    match values {
        LayerValues::Number(values) => first(values.iter().map(|value| value.to_bits())),
        LayerValues::Vec2(values) => first(values.iter().map(|v| v.to_array().map(f64::to_bits))),
        LayerValues::Vec3(values) => first(values.iter().map(|v| v.to_array().map(f64::to_bits))),
        LayerValues::Label(values) => first(values.iter()),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::data::FaceId;
    use crate::fixtures::{cube, tetrahedron};

    #[test]
    fn a_cube_with_sharp_edges_has_three_vertices_a_corner() {
        let mut mesh = cube(DVec3::ZERO);
        mesh.positions.push(DVec3::splat(9.0));
        // The normals of its six sides, each over six corners of two faces.
        let mut values: Vec<DVec3> = Vec::new();
        let of_face = (0..12).map(|face| {
            let [a, b, c] = mesh.corners(FaceId(face));
            let normal = (b - a).cross(c - a).normalize();
            let known = values.iter().position(|value| *value == normal);
            known.unwrap_or_else(|| {
                values.push(normal);
                values.len() - 1
            }) as u32
        });
        let index = of_face.flat_map(|at| [at; 3]).collect();
        let (name, domain) = (Layer::NORMAL.to_owned(), Domain::Corner);
        mesh.set_layer(Layer { name, domain, values: LayerValues::Vec3(values), index });
        let values = LayerValues::Number((0..9).map(f64::from).collect());
        let (name, domain, index) = ("own".to_owned(), Domain::Vertex, (0..9).collect());
        mesh.set_layer(Layer { name, domain, values, index });
        let Split { mesh: split, sources } = split_corners(&mesh, &[Layer::NORMAL]);
        assert_eq!(split.check(), Ok(()));
        assert_eq!((split.positions.len(), split.area(), split.signed_volume()), (25, 6.0, 1.0));
        assert!(sources.is_sorted() && sources.last() == Some(&8));
        assert_eq!(split.layer("own").unwrap().index, sources);
        let normal = split.layer(Layer::NORMAL).unwrap();
        let LayerValues::Vec3(values) = &normal.values else { panic!("normals") };
        for face in 0..12 {
            let [a, b, c] = split.corners(FaceId(face));
            let own = normal.index[split.faces[face as usize][1].idx()];
            assert_eq!(values[own as usize], (b - a).cross(c - a).normalize());
        }
    }

    #[test]
    fn equal_values_split_nothing() {
        let mut mesh = tetrahedron();
        let values = LayerValues::Vec3(vec![DVec3::Z; 12]);
        let (name, domain, index) = (Layer::NORMAL.to_owned(), Domain::Corner, (0..12).collect());
        mesh.set_layer(Layer { name, domain, values, index });
        let split = split_corners(&mesh, &[Layer::NORMAL]);
        assert_eq!((split.mesh.positions, split.mesh.faces), (mesh.positions, mesh.faces));
    }
}
