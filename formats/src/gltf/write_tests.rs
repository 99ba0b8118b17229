//! Tests of writing glTF: what is written is read again.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{
    Domain, Image, Layer, LayerValues, Material, NO_VALUE, PixelKind, Texture, TextureImage,
    TextureRole, TriMesh,
};
use mve_mesh::fixtures::{cube, tetrahedron};

use super::*;

fn saved(mesh: &TriMesh) -> (TriMesh, Vec<String>) {
    let mut bytes = Vec::new();
    let warnings = write_glb(mesh, &mut bytes, Control::none()).unwrap();
    assert_eq!(bytes.len() % 4, 0);
    assert_eq!(bytes[8..12], (bytes.len() as u32).to_le_bytes());
    let (back, more) = read_gltf(&bytes, Vertices::Welded, Control::none()).unwrap();
    assert_eq!(more, []);
    (back, warnings)
}

fn put(mesh: &mut TriMesh, name: &str, domain: Domain, values: LayerValues, index: Vec<u32>) {
    mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
}

#[test]
fn everything_that_the_format_has_comes_back() {
    let mut mesh = cube(DVec3::ZERO);
    // One side of another material with seams all around it.
    let uvs = vec![DVec2::ZERO, DVec2::new(0.25, 0.5), DVec2::X, DVec2::ONE];
    let of_corners = (0..36).map(|corner| if corner < 6 { corner % 4 } else { 3 }).collect();
    put(&mut mesh, Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(uvs), of_corners);
    let colors = vec![DVec3::new(1.0, 0.0, 51.0 / 255.0), DVec3::splat(128.0 / 255.0)];
    let of_vertices = (0..8).map(|v| v % 2).collect();
    put(&mut mesh, Layer::COLOR, Domain::Vertex, LayerValues::Vec3(colors), of_vertices);
    let numbers = LayerValues::Number((0..8).map(|v| f64::from(v) / 4.0).collect());
    put(&mut mesh, "height", Domain::Vertex, numbers, (0..8).collect());
    let labels = LayerValues::Label(vec!["skin".to_owned()]);
    let of_faces = (0..12).map(|face| if face < 2 { 0 } else { NO_VALUE }).collect();
    put(&mut mesh, Layer::MATERIAL, Domain::Face, labels, of_faces);
    let image = Image::filled("texture", [3, 2], PixelKind::Rgb, 99);
    let texture = |role, keyword: &str, options: &str, image: &Arc<TextureImage>| Texture {
        role,
        keyword: keyword.to_owned(),
        options: options.to_owned(),
        name: "a.png".to_owned(),
        place: 4,
        image: Some(Arc::clone(image)),
    };
    let image = Arc::new(TextureImage::new(image));
    let statements = [("Kd", "1 0 0.2"), ("d", "0.5"), ("Pm", "0.25"), ("Ke", "0 1 0")];
    mesh.materials = vec![Material {
        name: "skin".to_owned(),
        statements: statements.map(|(a, b)| (a.to_owned(), b.to_owned())).to_vec(),
        textures: vec![
            texture(TextureRole::BaseColor, "map_Kd", "-clamp on ", &image),
            texture(TextureRole::Other, "map_Occlusion", "", &image),
        ],
    }];
    let (back, warnings) = saved(&mesh);
    assert!(warnings.len() == 1 && warnings[0].contains("are written for 8"), "{warnings:?}");
    assert_eq!((&back.positions, &back.faces), (&mesh.positions, &mesh.faces));
    for name in [Layer::COLOR, "height", Layer::MATERIAL] {
        assert_eq!(back.layer(name), mesh.layer(name), "{name}");
    }
    let uv = |mesh: &TriMesh| -> Vec<DVec2> {
        let layer = mesh.layer(Layer::TEXCOORD).unwrap();
        let LayerValues::Vec2(values) = &layer.values else { panic!("pairs") };
        layer.index.iter().map(|&at| values[at as usize]).collect()
    };
    assert_eq!(uv(&back), uv(&mesh));
    let (mut found, expected) = (back.materials[0].clone(), &mesh.materials[0]);
    for (texture, expected) in found.textures.iter_mut().zip(&expected.textures) {
        let pixels = texture.image.as_ref().unwrap().pixels();
        assert_eq!(pixels, expected.image.as_ref().unwrap().pixels());
        texture.image.clone_from(&expected.image);
    }
    assert_eq!(&found, expected);
}

#[test]
fn objects_are_nodes_if_they_are_apart() {
    let (mut mesh, second) = (tetrahedron(), tetrahedron());
    mesh.positions.extend(&second.positions);
    // The faces of both take turns, and so do their vertices.
    mesh.positions.swap(3, 4);
    let faces = [[0, 2, 1], [3, 6, 5], [0, 1, 4], [3, 5, 7], [0, 4, 2], [3, 7, 6], [1, 2, 4]];
    mesh.faces = faces.iter().map(|face| face.map(mve_mesh::data::VertexId)).collect();
    let labels = LayerValues::Label(vec!["one".to_owned(), "two".to_owned()]);
    let index: Vec<u32> = vec![0, 1, 0, 1, 0, 1, 0];
    put(&mut mesh, Layer::OBJECT, Domain::Face, labels, index);
    let (back, warnings) = saved(&mesh);
    assert_eq!(warnings, Vec::<String>::new());
    // Welding joins nothing of two nodes, though they lie on each other.
    assert_eq!((back.positions.len(), back.faces.len()), (8, 7));
    assert_eq!(back.layer(Layer::OBJECT).unwrap().index, [0, 0, 0, 0, 1, 1, 1]);
    assert_eq!(back.positions[..4], tetrahedron().positions);
    mesh.faces[0][0] = mve_mesh::data::VertexId(3);
    let (back, warnings) = saved(&mesh);
    assert!(warnings[0].contains("objects share vertices"), "{warnings:?}");
    assert_eq!((back.faces.len(), back.layer(Layer::OBJECT)), (7, None));
}

#[test]
fn a_mesh_far_away_keeps_its_shape_and_points_stay() {
    let mesh = cube(DVec3::new(1e9 + 0.25, -7e8, 3.0));
    let (back, warnings) = saved(&mesh);
    assert_eq!((&back.positions, warnings), (&mesh.positions, Vec::new()));
    assert_eq!(saved(&TriMesh::default()).0, TriMesh::default());
    let mut bytes = Vec::new();
    let points = TriMesh::new(vec![DVec3::X, DVec3::Y], Vec::new());
    write_glb(&points, &mut bytes, Control::none()).unwrap();
    let (back, warnings) = read_gltf(&bytes, Vertices::Welded, Control::none()).unwrap();
    assert_eq!((back.positions, warnings.len()), (points.positions, 1));
}

#[test]
fn colors_of_faces_are_those_of_their_corners() {
    let mut mesh = tetrahedron();
    let colors = LayerValues::Vec3(vec![DVec3::X, DVec3::Y]);
    put(&mut mesh, Layer::COLOR, Domain::Face, colors, vec![0, 1, 1, 1]);
    let (back, _) = saved(&mesh);
    let color = back.layer(Layer::COLOR).unwrap();
    assert_eq!((color.domain, back.positions.len()), (Domain::Corner, 4));
    assert_eq!(color.index, [[0; 3], [1; 3], [1; 3], [1; 3]].concat());
}

#[test]
fn a_mesh_that_cannot_be_said_is_refused() {
    let mut mesh = tetrahedron();
    mesh.positions[2].y = f64::NAN;
    let error = write_glb(&mesh, &mut Vec::new(), Control::none()).unwrap_err();
    assert!(error.to_string().contains("vertex 2 is at 0 NaN 0"), "{error}");
}
