//! What the row of controls can offer for the meshes and fields that are there.

use std::sync::Arc;

use super::look::coloring::{ColorBy, PinnedField, number_layers, source_of};
use super::look::controls::Offers;
use super::look::label_layers;
use super::look::texture::TextureSource;
use super::scene::{MeshInput, PinnedPicture};
use crate::views::memo::Same;

/// The offers for some meshes, with what may color them; what depends on the view is not there yet.
pub fn offers(meshes: &[MeshInput], fields: &[PinnedField], pictures: &[PinnedPicture]) -> Offers {
    let mut color_by: Vec<(ColorBy, String)> = vec![
        (ColorBy::Auto, "Automatic".to_owned()),
        (ColorBy::Plain, "Plain".to_owned()),
        (ColorBy::Colors, "Colors of the mesh".to_owned()),
    ];
    for field in fields {
        color_by.push((ColorBy::Field(field.title.clone()), field.title.clone()));
    }
    for layer in meshes.iter().flat_map(|input| number_layers(&input.mesh)) {
        color_by.push((ColorBy::Layer(layer.name.clone()), format!("Layer {}", layer.name)));
    }
    for layer in meshes.iter().flat_map(|input| label_layers(&input.mesh)) {
        color_by.push((ColorBy::Labels(layer.name.clone()), format!("By {}", layer.name)));
    }
    color_by.push((ColorBy::Materials, "Texture of the material".to_owned()));
    color_by.push((ColorBy::Checker, "Checkerboard in texture space".to_owned()));
    for picture in pictures {
        let text = format!("Texture {}", picture.title);
        color_by.push((ColorBy::Picture(picture.title.clone()), text));
    }
    let mut known: Vec<ColorBy> = Vec::new();
    color_by.retain(|(by, _)| {
        let is_first = !known.contains(by);
        known.push(by.clone());
        let has = |input: &MeshInput| source_of(&input.mesh, by, fields).is_some();
        is_first && (*by == ColorBy::Auto || meshes.iter().any(has))
    });
    let titles = meshes.iter().map(|input| input.title.clone()).collect();
    Offers { titles, color_by, ..Offers::default() }
}

/// The picture that is chosen as a texture.
pub fn pinned_picture(by: &ColorBy, pictures: &[PinnedPicture]) -> Option<TextureSource> {
    let is_chosen = |picture: &&PinnedPicture| *by == ColorBy::Picture(picture.title.clone());
    let picture = pictures.iter().find(is_chosen)?;
    Some(TextureSource::Pinned(Same(Arc::clone(&picture.images))))
}
