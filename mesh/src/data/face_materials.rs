//! Which faces of a mesh have which material.

use std::collections::HashMap;

use super::{Domain, FaceId, Layer, LayerValues, Material, TriMesh};

/// The materials that the faces of a mesh name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceMaterials<'a> {
    /// For each name of the layer [`Layer::MATERIAL`] the first material of that name, if the mesh
    /// has one.
    pub of_labels: Vec<Option<&'a Material>>,
    /// For each face the place of its name; [`super::NO_VALUE`] is beyond all of them.
    pub of_faces: &'a [u32],
}

impl<'a> FaceMaterials<'a> {
    /// Looks them up; a mesh without a layer of names over faces has none.
    pub fn of(mesh: &'a TriMesh) -> Self {
        let layer = mesh.layer(Layer::MATERIAL).filter(|layer| layer.domain == Domain::Face);
        let Some(Layer { values: LayerValues::Label(labels), index, .. }) = layer else {
            return Self::default();
        };
        let mut known: HashMap<&str, &Material> = HashMap::new();
        for material in &mesh.materials {
            known.entry(&material.name).or_insert(material);
        }
        let of_labels = labels.iter().map(|label| known.get(label.as_str()).copied()).collect();
        Self { of_labels, of_faces: index }
    }

    /// The material of a face.
    #[inline]
    pub fn of_face(&self, face: FaceId) -> Option<&'a Material> {
        *self.of_labels.get(*self.of_faces.get(face.idx())? as usize)?
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::NO_VALUE;
    use crate::fixtures::tetrahedron;

    #[test]
    fn faces_find_the_first_material_of_their_name() {
        let mut mesh = tetrahedron();
        let material = |name: &str, kd: &str| Material {
            name: name.to_owned(),
            statements: vec![("Kd".to_owned(), kd.to_owned())],
            textures: Vec::new(),
        };
        mesh.materials = vec![material("b", "1 0 0"), material("a", "0 1 0"), material("a", "0")];
        mesh.set_layer(Layer {
            name: Layer::MATERIAL.to_owned(),
            domain: Domain::Face,
            values: LayerValues::Label(["a", "nowhere", "b"].map(str::to_owned).to_vec()),
            index: vec![2, 0, NO_VALUE, 1],
        });
        let materials = FaceMaterials::of(&mesh);
        let found = [0, 1, 2, 3].map(|face| materials.of_face(FaceId(face)));
        assert_eq!(found, [Some(&mesh.materials[0]), Some(&mesh.materials[1]), None, None]);
        assert_eq!(FaceMaterials::of(&tetrahedron()), FaceMaterials::default());
    }
}
