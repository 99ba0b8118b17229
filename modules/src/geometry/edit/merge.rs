//! Two meshes as one, with the layers of both.

use std::collections::HashMap;

use thiserror::Error;

use mve_mesh::data::{Domain, Layer, LayerValues, Material, NO_VALUE, TriMesh, VertexId};

/// Why two meshes were not put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("together they have {n_elements} {what}, more than 4,294,967,294")]
pub struct TooLarge {
    /// How many there would be.
    pub n_elements: usize,
    /// Of what.
    pub what: &'static str,
}

/// A merged mesh.
#[derive(Clone, Debug)]
pub struct Merged {
    /// The vertices and faces of the first mesh, then those of the second.
    pub mesh: TriMesh,
    /// Names of layers and materials of the second mesh that it has under another name now, as
    /// "old → new".
    pub renamed: Vec<String>,
}

/// Puts two meshes together without joining anything. O(n).
///
/// Layers of one name, kind and domain become one; a layer over vertices in one mesh and over
/// corners in the other becomes one over corners. What only one mesh has has no value in the other.
/// Layers of one name that hold different kinds, and different materials of one name, keep apart:
/// that of the second mesh gets a new name.
///
/// # Errors
/// [`TooLarge`] when indices would not fit.
pub fn merge(first: TriMesh, second: &TriMesh) -> Result<Merged, TooLarge> {
    let all_vertices = first.positions.len() + second.positions.len();
    let all_corners = 3 * (first.faces.len() + second.faces.len());
    for (n_elements, what) in [(all_vertices, "vertices"), (all_corners, "corners")] {
        if n_elements >= NO_VALUE as usize {
            return Err(TooLarge { n_elements, what });
        }
    }
    let mut renamed = Vec::new();
    let mut mesh = first;
    let names = add_materials(&mut mesh.materials, &second.materials, &mut renamed);
    let old = Sizes::of(&mesh);
    let shift = mesh.positions.len() as u32;
    let mut layers: Vec<Layer> = std::mem::take(&mut mesh.layers);
    let first_faces = mesh.faces.clone();
    mesh.positions.extend_from_slice(&second.positions);
    mesh.faces.extend(second.faces.iter().map(|face| face.map(|v| VertexId(v.0 + shift))));
    let n_of_first = layers.len();
    for theirs in &second.layers {
        let mut theirs = theirs.clone();
        if let LayerValues::Label(labels) = &mut theirs.values
            && theirs.name == Layer::MATERIAL
        {
            for label in labels {
                if let Some(new) = names.get(label.as_str()) {
                    label.clone_from(new);
                }
            }
        }
        let known = layers[..n_of_first].iter().position(|ours| ours.name == theirs.name);
        let fitting = known.filter(|&place| is_one_kind(&layers[place], &theirs));
        if let Some(place) = fitting {
            let ours = &mut layers[place];
            if ours.domain != theirs.domain {
                over_corners(ours, &first_faces);
                over_corners(&mut theirs, &second.faces);
            }
            append(ours, &theirs);
            continue;
        }
        if known.is_some() {
            let is_free =
                |name: &str| layers.iter().chain(&second.layers).all(|layer| layer.name != name);
            let name = free_name(&theirs.name, is_free);
            renamed.push(format!("{} → {name}", theirs.name));
            theirs.name = name;
        }
        let mut index = vec![NO_VALUE; old.n_elements(theirs.domain)];
        index.append(&mut theirs.index);
        theirs.index = index;
        layers.push(theirs);
    }
    for layer in &mut layers {
        let n_elements = mesh.n_elements(layer.domain);
        layer.index.resize(n_elements, NO_VALUE);
    }
    mesh.layers = layers;
    Ok(Merged { mesh, renamed })
}

struct Sizes {
    n_vertices: usize,
    n_faces: usize,
}

impl Sizes {
    fn of(mesh: &TriMesh) -> Self {
        Self { n_vertices: mesh.positions.len(), n_faces: mesh.faces.len() }
    }

    fn n_elements(&self, domain: Domain) -> usize {
        match domain {
            Domain::Vertex => self.n_vertices,
            Domain::Corner => 3 * self.n_faces,
            Domain::Face => self.n_faces,
        }
    }
}

fn is_one_kind(a: &Layer, b: &Layer) -> bool {
    let is_same_kind = std::mem::discriminant(&a.values) == std::mem::discriminant(&b.values);
    let is_face = |layer: &Layer| layer.domain == Domain::Face;
    is_same_kind && is_face(a) == is_face(b)
}

/// Turns a layer over vertices into one over corners.
fn over_corners(layer: &mut Layer, faces: &[[VertexId; 3]]) {
    if layer.domain == Domain::Vertex {
        layer.index = faces.iter().flatten().map(|v| layer.index[v.idx()]).collect();
        layer.domain = Domain::Corner;
    }
}

/// Adds the values and the index of a layer to those of another one of its kind. Equal names are
/// one value.
fn append(ours: &mut Layer, theirs: &Layer) {
    let start = ours.values.len() as u32;
    let numbers: Vec<u32> = match (&mut ours.values, &theirs.values) {
        (LayerValues::Label(a), LayerValues::Label(b)) => {
            let mut known: HashMap<String, u32> = HashMap::new();
            for (name, number) in a.iter().zip(0..) {
                known.entry(name.clone()).or_insert(number);
            }
            let number_of = |name: &String| {
                *known.entry(name.clone()).or_insert_with(|| {
                    a.push(name.clone());
                    a.len() as u32 - 1
                })
            };
            b.iter().map(number_of).collect()
        }
        (LayerValues::Number(a), LayerValues::Number(b)) => numbered(a, b, start),
        (LayerValues::Vec2(a), LayerValues::Vec2(b)) => numbered(a, b, start),
        (LayerValues::Vec3(a), LayerValues::Vec3(b)) => numbered(a, b, start),
        _ => Vec::new(),
    };
    let number = |value: &u32| numbers.get(*value as usize).copied().unwrap_or(NO_VALUE);
    ours.index.extend(theirs.index.iter().map(number));
}

fn numbered<T: Copy>(ours: &mut Vec<T>, theirs: &[T], start: u32) -> Vec<u32> {
    ours.extend_from_slice(theirs);
    (start..start + theirs.len() as u32).collect()
}

/// Adds materials, and says which names of theirs have become others.
fn add_materials(
    ours: &mut Vec<Material>,
    theirs: &[Material],
    renamed: &mut Vec<String>,
) -> HashMap<String, String> {
    let mut names = HashMap::new();
    let n_of_first = ours.len();
    for material in theirs {
        let same_name = ours[..n_of_first].iter().find(|known| known.name == material.name);
        match same_name {
            None => ours.push(material.clone()),
            Some(known) if known == material => {}
            // Only the first material of a name counts, so that one alone has a new name.
            Some(_) if names.contains_key(&material.name) => {}
            Some(_) => {
                let is_free = |name: &str| ours.iter().chain(theirs).all(|m| m.name != name);
                let name = free_name(&material.name, is_free);
                renamed.push(format!("{} → {name}", material.name));
                names.insert(material.name.clone(), name.clone());
                ours.push(Material { name, ..material.clone() });
            }
        }
    }
    names
}

fn free_name(name: &str, is_free: impl Fn(&str) -> bool) -> String {
    let mut number = 2_u64;
    loop {
        let candidate = format!("{name}_{number}");
        if is_free(&candidate) {
            return candidate;
        }
        number += 1;
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::fixtures::{cube, tetrahedron};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::edit::checks::{any_mesh, layered_square};

    #[test]
    fn both_meshes_are_there_and_values_follow() {
        let found = merge(layered_square(), &layered_square()).unwrap();
        assert!(found.renamed.is_empty());
        let mesh = found.mesh;
        assert_eq!(mesh.check(), Ok(()));
        assert_eq!((mesh.faces.len(), mesh.area(), mesh.materials.len()), (4, 2.0, 1));
        let material = mesh.layer(Layer::MATERIAL).unwrap();
        assert_eq!((&material.index[..], material.values.len()), (&[0, 1, 0, 1][..], 2));
        assert_eq!(mesh.layer("height").unwrap().index, [0, 1, 2, 3, 4, 5, 6, 7]);
        let two = merge(tetrahedron(), &cube(DVec3::ONE)).unwrap().mesh;
        assert!((two.signed_volume() - 7.0 / 6.0).abs() < 1e-14);
    }

    #[test]
    fn what_one_alone_has_is_missing_in_the_other() {
        let mesh = merge(tetrahedron(), &layered_square()).unwrap().mesh;
        assert_eq!(mesh.check(), Ok(()));
        assert_eq!(
            mesh.layer(Layer::MATERIAL).unwrap().index,
            [[NO_VALUE; 4].as_slice(), &[0, 1]].concat()
        );
        let mesh = merge(layered_square(), &tetrahedron()).unwrap().mesh;
        assert_eq!(mesh.check(), Ok(()));
        assert_eq!(mesh.layer("height").unwrap().index[4..], [NO_VALUE; 4]);
    }

    #[test]
    fn other_kinds_and_other_materials_of_one_name_keep_apart() {
        let mut other = layered_square();
        other.materials[0].statements = vec![("Kd".to_owned(), "1 0 0".to_owned())];
        let height = Layer {
            name: "height".to_owned(),
            domain: Domain::Face,
            values: LayerValues::Number(vec![9.0]),
            index: vec![0; 2],
        };
        other.set_layer(height);
        let found = merge(layered_square(), &other).unwrap();
        assert_eq!(found.renamed, ["a → a_2", "height → height_2"]);
        assert_eq!(found.mesh.check(), Ok(()));
        let LayerValues::Label(labels) = &found.mesh.layer(Layer::MATERIAL).unwrap().values else {
            panic!("labels")
        };
        assert_eq!(labels, &["a", "b", "a_2"]);
        assert_eq!(found.mesh.layer(Layer::MATERIAL).unwrap().index, [0, 1, 2, 1]);
        assert_eq!(found.mesh.layer("height_2").unwrap().index, [NO_VALUE, NO_VALUE, 0, 0]);
    }

    #[test]
    fn vertices_and_corners_of_one_name_become_corners() {
        let mut other = layered_square();
        let corner = Layer {
            name: "height".to_owned(),
            domain: Domain::Corner,
            values: LayerValues::Number(vec![9.0]),
            index: vec![0; 6],
        };
        other.set_layer(corner);
        let found = merge(layered_square(), &other).unwrap().mesh;
        let height = found.layer("height").unwrap();
        assert_eq!((found.check(), height.domain), (Ok(()), Domain::Corner));
        assert_eq!(height.index, [0, 1, 2, 0, 2, 3, 4, 4, 4, 4, 4, 4]);
    }

    proptest! {
        #[test]
        fn any_two_meshes_are_one(one in any_mesh(), two in any_mesh()) {
            let found = merge(one.clone(), &two).unwrap().mesh;
            prop_assert_eq!(found.check(), Ok(()));
            prop_assert_eq!(found.faces.len(), one.faces.len() + two.faces.len());
        }
    }
}
