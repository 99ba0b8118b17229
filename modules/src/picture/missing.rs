//! What a mesh lacks to be drawn in its colors.

use crate::data::{FaceMaterials, Layer, LayerValues, Texture, TextureRole, TriMesh, shown_name};
use crate::picture::render::{Albedo, is_colored};

/// What a mesh lacks, and what pictures show instead: ends of sentences that begin with the mesh.
pub fn missing_colors(mesh: &TriMesh, albedo: Albedo) -> Vec<String> {
    let mut missing = Vec::new();
    if albedo == Albedo::Textures {
        let materials = FaceMaterials::of(mesh).of_labels;
        let textures: Vec<&Texture> = materials
            .into_iter()
            .filter_map(|material| material?.texture(TextureRole::BaseColor))
            .collect();
        missing.extend(textures.iter().filter_map(|texture| flaw(texture)));
        let has_texcoords = mesh
            .layer(Layer::TEXCOORD)
            .is_some_and(|layer| matches!(layer.values, LayerValues::Vec2(_)));
        if !textures.is_empty() && !has_texcoords {
            missing.push("has no layer \"texcoord\", so its textures are not drawn".to_owned());
        }
    }
    if albedo != Albedo::White && !is_colored(mesh, albedo) {
        let what = match albedo {
            Albedo::Textures => "no texture, no material with a color and no layer \"color\"",
            _ => "no layer \"color\" of three numbers",
        };
        missing.push(format!("has {what}, so it is white in pictures"));
    }
    missing.sort_unstable();
    missing.dedup();
    missing
}

/// What of a texture is not drawn.
fn flaw(texture: &Texture) -> Option<String> {
    let name = shown_name(&texture.name);
    let is_readable = texture.image.as_ref().is_some_and(|image| image.pixels().is_some());
    let options = texture.options.trim();
    if !is_readable {
        Some(format!("names the texture \"{name}\", which was not read, so it is not drawn"))
    } else if !options.is_empty() {
        Some(format!("has a texture \"{name}\" whose options ({options}) pictures do not heed"))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::data::{Image, PixelKind, TextureImage};
    use crate::mesh::fixtures::{tetrahedron, textured_square};

    #[test]
    fn what_is_missing_is_named() {
        let missing = missing_colors;
        assert!(missing(&tetrahedron(), Albedo::White).is_empty());
        let found = missing(&tetrahedron(), Albedo::Colors);
        let expected = "has no layer \"color\" of three numbers, so it is white in pictures";
        assert_eq!(found, [expected]);
        let found = missing(&tetrahedron(), Albedo::Textures);
        assert!(found[0].starts_with("has no texture, no material"), "{found:?}");

        let mut mesh = textured_square(Image::filled("t", [2, 2], PixelKind::Rgb, 9));
        assert!(missing(&mesh, Albedo::Textures).is_empty());
        mesh.materials[0].textures[0].options = "-s 2 2 1 ".to_owned();
        let found = missing(&mesh, Albedo::Textures);
        assert_eq!(
            found,
            ["has a texture \"t.png\" whose options (-s 2 2 1) pictures do not heed"]
        );
        let unknown = TextureImage::of_unknown(vec![0]);
        mesh.materials[0].textures[0].image = Some(Arc::new(unknown));
        let found = missing(&mesh, Albedo::Textures);
        assert_eq!(found[1], "names the texture \"t.png\", which was not read, so it is not drawn");
        mesh.layers.retain(|layer| layer.name != Layer::TEXCOORD);
        let found = missing(&mesh, Albedo::Textures);
        assert_eq!(found[0], "has no layer \"texcoord\", so its textures are not drawn");
    }
}
