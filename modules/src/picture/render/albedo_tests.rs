//! Colors by hand: which source a face takes, and pictures between their pixels.

use mve_mesh::data::{Material, NO_VALUE, PixelKind};
use mve_mesh::fixtures::{mesh_of, textured_square};

use super::*;

/// Two by two: upper row 10 and 20, lower row 30 and 40.
fn picture() -> Image {
    let bytes = vec![10, 20, 30, 40];
    Image { name: String::new(), width: 2, height: 2, kind: PixelKind::Gray, bytes }
}

#[test]
fn a_texture_has_its_origin_at_the_lower_left_and_repeats() {
    let close = |a: DVec3, b: f64| (a * 255.0 - DVec3::splat(b)).abs().max_element() < 1e-9;
    for (at, value) in [
        ([0.25, 0.25], 30.0),
        ([0.75, 0.75], 20.0),
        ([0.5, 0.75], 15.0),
        ([0.5, 0.5], 25.0),
        ([0.0, 0.75], 15.0),
        ([-0.75, 3.25], 30.0),
        ([0.25, 0.0], 20.0),
    ] {
        assert!(close(texel(&picture(), DVec2::from(at)), value), "{at:?}");
    }
    assert_eq!(texel(&picture(), DVec2::NAN), DVec3::ONE);
}

#[test]
fn a_face_takes_texture_then_diffuse_color_then_layer() {
    // Five faces: textured, of a plain material, of one that says nothing, of none, and textured
    // but without coordinates.
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let faces = [[0, 1, 2]; 5];
    let mut mesh = textured_square(picture());
    let (old, materials) = (mesh_of(&corners, &faces), std::mem::take(&mut mesh.materials));
    let mut mesh = old;
    mesh.materials = materials;
    let plain = |name: &str, statements: &[(&str, &str)]| Material {
        name: name.to_owned(),
        statements: statements.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect(),
        textures: Vec::new(),
    };
    mesh.materials.push(plain("red", &[("Kd", "1 0 0")]));
    mesh.materials.push(plain("none", &[("Ns", "3")]));
    let layer =
        |name: &str, domain, values, index| Layer { name: name.to_owned(), domain, values, index };
    let names = LayerValues::Label(["paint", "red", "none"].map(str::to_owned).to_vec());
    mesh.set_layer(layer(Layer::MATERIAL, Domain::Face, names, vec![0, 1, 2, NO_VALUE, 0]));
    let texcoords = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
    let mut index: Vec<u32> = [0, 1, 2].repeat(5);
    index[14] = NO_VALUE;
    mesh.set_layer(layer(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(texcoords), index));
    let blue = LayerValues::Vec3(vec![DVec3::Z]);
    mesh.set_layer(layer(Layer::COLOR, Domain::Vertex, blue, vec![0, 0, NO_VALUE]));

    let colors = MeshColors::of(&mesh, Albedo::Textures).unwrap();
    let found = [0, 1, 2, 3, 4].map(|face| colors.of_face(&mesh, FaceId(face)));
    let by_layer = FaceColor::Corners([DVec3::Z, DVec3::Z, DVec3::ONE]);
    let textured = FaceColor::Picture(0, [DVec2::ZERO, DVec2::X, DVec2::Y]);
    assert_eq!(found, [textured, FaceColor::Plain(DVec3::X), by_layer, by_layer, by_layer]);
    // A quarter of the way to the second corner and a quarter to the third: the pixel 30.
    let seen = colors.at(&found[0], [0.5, 0.25, 0.25]);
    assert!((seen * 255.0 - DVec3::splat(30.0)).abs().max_element() < 1e-12);
    assert_eq!(colors.at(&found[2], [0.5, 0.0, 0.5]), DVec3::new(0.5, 0.5, 1.0));

    let colors = MeshColors::of(&mesh, Albedo::Colors).unwrap();
    assert!((0..5).all(|face| colors.of_face(&mesh, FaceId(face)) == by_layer));
    assert!(!is_colored(&mesh, Albedo::White));
    mesh.materials.truncate(0);
    mesh.layers.retain(|layer| layer.name != Layer::COLOR);
    assert!(!is_colored(&mesh, Albedo::Textures));
}
