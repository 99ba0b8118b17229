//! What a mesh lacks to be drawn in its colors.

use mve_mesh::data::{
    FaceMaterials, Layer, LayerValues, Texture, TextureRole, TriMesh, shown_name,
};

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
        missing.extend(flaws(&textures));
        let has_texcoords = mesh
            .layer(Layer::TEXCOORD)
            .is_some_and(|layer| matches!(layer.values, LayerValues::Vec2(_)));
        if !textures.is_empty() && !has_texcoords {
            missing.push("has no layer \"texcoord\", so its textures are not drawn".to_owned());
        }
    }
    // What is wrong with its textures is why it is white.
    if missing.is_empty() && albedo != Albedo::White && !is_colored(mesh, albedo) {
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

/// Why pictures in these colors would be those of white surfaces, under another name: none of the
/// meshes has any. `None` where they are asked for in white, or have no faces.
pub fn lack_of_colors(meshes: &[&TriMesh], albedo: Albedo) -> Option<String> {
    let drawn = || meshes.iter().filter(|mesh| !mesh.faces.is_empty());
    if albedo == Albedo::White || drawn().any(|mesh| is_colored(mesh, albedo)) {
        return None;
    }
    let missing = missing_colors(drawn().next()?, albedo).join(", and it ");
    let which = match meshes.len() {
        1 => "the mesh has no colors",
        _ => "neither mesh has colors to compare",
    };
    Some(format!("{which}: it {missing}; choose White, or a mesh with colors"))
}

/// What of textures is not drawn, in a sentence a cause.
fn flaws(textures: &[&Texture]) -> Vec<String> {
    let is_read =
        |texture: &Texture| texture.image.as_ref().is_some_and(|image| image.pixels().is_some());
    let (read, unread): (Vec<&Texture>, Vec<&Texture>) =
        textures.iter().partition(|texture| is_read(texture));
    let mut flaws = Vec::new();
    flaws.extend(names(&unread).map(|(n, names)| match n {
        1 => format!("names the texture {names}, which was not read, so it is not drawn"),
        n => format!("names {n} textures that were not read, so they are not drawn: {names}"),
    }));
    let odd: Vec<&Texture> =
        read.into_iter().filter(|texture| !texture.options.trim().is_empty()).collect();
    let options = odd.first().map_or("", |texture| texture.options.trim());
    flaws.extend(names(&odd).map(|(n, names)| match n {
        1 => format!("has a texture {names} whose options ({options}) pictures do not heed"),
        n => format!("has {n} textures whose options ({options}) pictures do not heed: {names}"),
    }));
    flaws
}

/// How many different names textures have, and the first of them.
fn names(textures: &[&Texture]) -> Option<(usize, String)> {
    /// More say nothing new.
    const MOST: usize = 3;
    let mut names: Vec<&str> = textures.iter().map(|texture| texture.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let shown = names.iter().take(MOST).map(|name| format!("\"{}\"", shown_name(name)));
    let shown = shown.collect::<Vec<_>>().join(", ");
    let more = if names.len() > MOST { ", …" } else { "" };
    (!names.is_empty()).then(|| (names.len(), shown + more))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mve_mesh::data::{Image, PixelKind, TextureImage};
    use mve_mesh::fixtures::{tetrahedron, textured_square};

    use super::*;

    #[test]
    fn colors_that_no_mesh_has_are_refused_for_one_reason() {
        let (white, empty) = (tetrahedron(), TriMesh::default());
        let textured = textured_square(Image::filled("t", [2, 2], PixelKind::Rgb, 9));
        let lack = |meshes: &[&TriMesh], albedo| lack_of_colors(meshes, albedo);
        assert_eq!(lack(&[&white, &white], Albedo::White), None);
        assert_eq!(lack(&[&empty], Albedo::Colors), None);
        assert_eq!(lack(&[&white, &textured], Albedo::Textures), None);
        let why = "it has no layer \"color\" of three numbers, so it is white in pictures; choose \
                   White, or a mesh with colors";
        let one = lack(&[&white], Albedo::Colors).unwrap();
        assert_eq!(one, format!("the mesh has no colors: {why}"));
        let two = lack(&[&empty, &white], Albedo::Colors).unwrap();
        assert_eq!(two, format!("neither mesh has colors to compare: {why}"));
    }

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
        let unread = "names the texture \"t.png\", which was not read, so it is not drawn";
        assert_eq!(found, [unread], "one cause, one sentence");
        let texture =
            |name: &str| Texture { name: name.to_owned(), ..mesh.materials[0].textures[0].clone() };
        let many = ["d", "a", "c", "b", "a"].map(texture);
        assert_eq!(
            flaws(&many.iter().collect::<Vec<_>>()),
            ["names 4 textures that were not read, so they are not drawn: \"a\", \"b\", \"c\", …"]
        );
        mesh.layers.retain(|layer| layer.name != Layer::TEXCOORD);
        let found = missing(&mesh, Albedo::Textures);
        assert_eq!(found[0], "has no layer \"texcoord\", so its textures are not drawn");
    }
}
