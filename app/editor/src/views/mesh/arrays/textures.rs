//! Which faces of a mesh have which texture.

use std::sync::Arc;

use mve_modules::data::{FaceMaterials, Texture, TextureRole, TriMesh};

/// The textures that color a mesh by its materials, and who has which.
#[derive(Debug, Default, PartialEq)]
pub struct FaceTextures<'a> {
    /// Each picture once, or where there is none, each name.
    pub list: Vec<&'a Texture>,
    /// For each name of the layer of materials the place of its texture.
    of_labels: Vec<Option<usize>>,
    /// For each face the place of its material's name.
    of_faces: &'a [u32],
}

impl<'a> FaceTextures<'a> {
    /// Looks them up.
    pub fn of(mesh: &'a TriMesh) -> Self {
        let materials = FaceMaterials::of(mesh);
        let mut textures = Self { of_faces: materials.of_faces, ..Self::default() };
        for material in materials.of_labels {
            let texture = material.and_then(|material| material.texture(TextureRole::BaseColor));
            let place = texture.map(|texture| {
                let known = textures.list.iter().position(|known| is_same(known, texture));
                known.unwrap_or_else(|| {
                    textures.list.push(texture);
                    textures.list.len() - 1
                })
            });
            textures.of_labels.push(place);
        }
        textures
    }

    /// The place of a face's texture in [`FaceTextures::list`].
    pub fn of_face(&self, face: usize) -> Option<usize> {
        *self.of_labels.get(*self.of_faces.get(face)? as usize)?
    }
}

/// Whether two textures show one picture, or name the one that is missing.
fn is_same(a: &Texture, b: &Texture) -> bool {
    match (&a.image, &b.image) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => a.name == b.name,
        _ => false,
    }
}
