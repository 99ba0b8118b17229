//! Tests of which faces have which texture, and of pictures that are not as they should be.

use std::sync::Arc;

use mve_modules::data::{Domain, Image, Layer, LayerValues, Material, PixelKind, TextureRole};
use mve_modules::mesh::fixtures::tetrahedron;

use super::*;

fn image(side: usize, color: [u8; 3]) -> Option<Arc<TextureImage>> {
    let mut pixels = Image::filled("texture", [side, side], PixelKind::Rgb, 0);
    pixels.bytes = color.repeat(side * side);
    Some(Arc::new(TextureImage::new(pixels)))
}

/// A tetrahedron whose faces have a material each: of these names and pictures, and a plain one.
fn textured(textures: &[(&str, Option<Arc<TextureImage>>)]) -> TriMesh {
    let mut mesh = tetrahedron();
    let material = |(place, (name, image)): (usize, &(&str, Option<Arc<TextureImage>>))| Material {
        name: format!("material {place}"),
        statements: Vec::new(),
        textures: vec![Texture {
            role: TextureRole::BaseColor,
            keyword: "map_Kd".to_owned(),
            options: String::new(),
            name: (*name).to_owned(),
            place: 0,
            image: image.clone(),
        }],
    };
    mesh.materials = textures.iter().enumerate().map(material).collect();
    let mut names: Vec<String> =
        mesh.materials.iter().map(|material| material.name.clone()).collect();
    names.push("plain".to_owned());
    let last = names.len() as u32 - 1;
    mesh.set_layer(Layer {
        name: Layer::MATERIAL.to_owned(),
        domain: Domain::Face,
        values: LayerValues::Label(names),
        index: (0..4).map(|face| face.min(last)).collect(),
    });
    mesh
}

fn shown(textures: &[(&str, Option<Arc<TextureImage>>)], most: u32) -> Result<Pictures, String> {
    pictures(&TextureSource::Materials(Same(Arc::new(textured(textures)))), most)
}

#[test]
fn faces_have_the_texture_of_their_material() {
    let x = image(2, [1, 2, 3]);
    let mesh = textured(&[("x.png", x.clone()), ("gone.png", None), ("x.png", x)]);
    let textures = FaceTextures::of(&mesh);
    let names: Vec<_> = textures.list.iter().map(|texture| texture.name.as_str()).collect();
    assert_eq!(names, ["x.png", "gone.png"]);
    let of_faces = [0, 1, 2, 3, 4].map(|face| textures.of_face(face));
    assert_eq!(of_faces, [Some(0), Some(1), Some(0), None, None]);
    assert!(FaceTextures::of(&tetrahedron()).list.is_empty());
}

#[test]
fn pictures_are_brought_to_one_size() {
    let textures = [("x.png", image(8, [200, 10, 10])), ("y.png", image(2, [10, 200, 10]))];
    let made = shown(&textures, 4).unwrap();
    assert_eq!((made.size, made.problem, made.layers.len()), ([4, 4], None, 2));
    assert_eq!(made.layers[0].get_pixel(3, 3).0, [200, 10, 10, 255]);
    assert_eq!(made.layers[1].get_pixel(0, 3).0, [10, 200, 10, 255]);
}

#[test]
fn what_is_wrong_with_a_texture_is_said_in_a_line() {
    let cases = [
        (("gone.png", None), "texture gone.png is not there or cannot be read"),
        (("empty.png", image(0, [0; 3])), "texture empty.png has no pixels"),
    ];
    for (texture, message) in &cases {
        let found = shown(std::slice::from_ref(texture), 64).unwrap_err();
        assert!(found.starts_with(message) && !found.contains('\n'), "{found}");
    }
    let made = shown(&[("gone.png", None), ("good.png", image(2, [9; 3]))], 64).unwrap();
    assert_eq!(made.layers.len(), 2);
    assert!(made.problem.unwrap().starts_with(cases[0].1));
}

#[test]
fn smaller_versions_end_in_a_pixel() {
    let sizes: Vec<_> =
        smaller(&RgbaImage::new(10, 3)).iter().map(|picture| picture.dimensions()).collect();
    assert_eq!(sizes, [(5, 1), (2, 1), (1, 1)]);
}
