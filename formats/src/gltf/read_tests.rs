//! Tests of reading glTF: documents by hand.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Domain, Layer, LayerValues, TriMesh};
use proptest::prelude::*;
use serde_json::{Value as Json, json};

use super::*;
use crate::ReadError;

fn read_bytes(bytes: &[u8], vertices: Vertices) -> Result<(TriMesh, Vec<String>), String> {
    match read_gltf(bytes, vertices, Control::none()) {
        Ok((mesh, warnings)) => {
            assert_eq!(mesh.check(), Ok(()));
            Ok((mesh, warnings.iter().map(ToString::to_string).collect()))
        }
        Err(ReadError::Wrong(message)) => Err(message),
        Err(ReadError::Cancelled(_)) => Err("cancelled".to_owned()),
    }
}

fn read(document: &Json) -> Result<(TriMesh, Vec<String>), String> {
    read_bytes(document.to_string().as_bytes(), Vertices::AsInFile)
}

/// A document with these lists of bytes as buffers, each with a view of all of it.
fn document(buffers: &[Vec<u8>], accessors: Json, primitive: Json) -> Json {
    let uri = |bytes: &Vec<u8>| format!("data:;base64,{}", BASE64_STANDARD.encode(bytes));
    let all: Vec<Json> =
        buffers.iter().map(|b| json!({ "byteLength": b.len(), "uri": uri(b) })).collect();
    let views: Vec<Json> =
        (0..).zip(buffers).map(|(at, b)| json!({ "buffer": at, "byteLength": b.len() })).collect();
    json!({
        "asset": { "version": "2.0" }, "buffers": all, "bufferViews": views,
        "accessors": accessors, "meshes": [{ "primitives": [primitive] }],
        "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }]
    })
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn float_accessor(view: usize, count: usize, shape: &str) -> Json {
    json!({ "bufferView": view, "componentType": 5126, "count": count, "type": shape })
}

/// Five points along a zigzag, as any mode of triangles.
fn zigzag(mode: u32) -> Json {
    let points = floats(&[0., 0., 0., 0., 1., 0., 1., 0., 0., 1., 1., 0., 2., 0., 0.]);
    let accessors = json!([float_accessor(0, 5, "VEC3")]);
    let primitive = json!({ "attributes": { "POSITION": 0 }, "mode": mode });
    document(&[points], accessors, primitive)
}

fn faces(mesh: &TriMesh) -> Vec<[u32; 3]> {
    mesh.faces.iter().map(|face| face.map(|v| v.0)).collect()
}

#[test]
fn strips_fans_and_lists_are_triangles_the_same_way_round() {
    let (strip, _) = read(&zigzag(5)).unwrap();
    assert_eq!(faces(&strip), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    let (fan, _) = read(&zigzag(6)).unwrap();
    assert_eq!(faces(&fan), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
    let (list, warnings) = read(&zigzag(4)).unwrap();
    assert_eq!(faces(&list), [[0, 1, 2]]);
    assert!(warnings[0].contains("one or two corners"), "{warnings:?}");
    let (points, warnings) = read(&zigzag(0)).unwrap();
    assert_eq!((points.positions.len(), points.faces.len()), (5, 0));
    assert!(warnings[0].contains("points and lines are left out"), "{warnings:?}");
}

#[test]
fn nodes_move_turn_and_mirror_what_is_in_them() {
    let mut file = zigzag(5);
    // A quarter turn around z takes x to y; the child's matrix mirrors x, column by column.
    let half = 0.5_f64.sqrt();
    file["nodes"] = json!([
        { "name": "top", "translation": [10, 0, 0], "rotation": [0, 0, half, half],
          "scale": [2, 2, 2], "children": [1] },
        { "name": "low", "mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1] }
    ]);
    let (mesh, _) = read(&file).unwrap();
    let expected = DVec3::new(10.0, -2.0, 10.0);
    assert!(mesh.positions[2].distance(expected) < 1e-12, "{}", mesh.positions[2]);
    assert_eq!(faces(&mesh)[0], [0, 2, 1]);
    let Some(Layer { values: LayerValues::Label(names), .. }) = mesh.layer(Layer::OBJECT) else {
        panic!("objects")
    };
    assert_eq!(names, &["low"]);
}

#[test]
fn circles_of_nodes_and_nodes_that_are_not_there_are_refused() {
    let message = |nodes: Json| {
        let mut file = zigzag(5);
        file["nodes"] = nodes;
        read(&file).unwrap_err()
    };
    assert!(message(json!([{ "children": [1] }, { "children": [0] }])).contains("node 0 is in"));
    assert!(message(json!([{ "children": [1, 1] }, {}])).contains("node 1 is in the scene twice"));
    assert!(message(json!([{ "children": [7] }])).contains("node 7 is not there"));
    assert!(message(json!([{ "mesh": 3 }])).contains("mesh 3 is not there"));
    assert!(message(json!([{ "mesh": 1.5 }])).contains("expected a whole number"));
}

#[test]
fn quantized_numbers_are_parts_of_one() {
    let positions = [[0_i8, 0, 0, 0], [127, 0, 0, 0], [0, -128, 64, 0]];
    let positions = positions.iter().flatten().map(|&n| n as u8).collect();
    let uvs = [[0_u16, 0], [65_535, 0], [0, 65_535]];
    let uvs = uvs.iter().flatten().flat_map(|n| n.to_le_bytes()).collect();
    let accessors = json!([
        { "bufferView": 0, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3" },
        { "bufferView": 1, "componentType": 5123, "normalized": true, "count": 3, "type": "VEC2" }
    ]);
    let primitive = json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 } });
    let mut file = document(&[positions, uvs], accessors, primitive);
    file["bufferViews"][0]["byteStride"] = 4.into();
    file["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let (mesh, warnings) = read(&file).unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(mesh.positions[1], DVec3::X);
    assert_eq!(mesh.positions[2], DVec3::new(0.0, -1.0, 64.0 / 127.0));
    let Some(Layer { values: LayerValues::Vec2(uvs), domain, .. }) = mesh.layer(Layer::TEXCOORD)
    else {
        panic!("texture coordinates")
    };
    assert_eq!((*domain, &uvs[..]), (Domain::Corner, &[DVec2::Y, DVec2::ONE, DVec2::ZERO][..]));
}

#[test]
fn sparse_values_take_the_place_of_others_or_of_zeros() {
    let points = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let (places, values) = (vec![2_u8], floats(&[0., 3., 0.]));
    let sparse = json!({
        "count": 1, "indices": { "bufferView": 1, "componentType": 5121 },
        "values": { "bufferView": 2 }
    });
    let mut accessor = float_accessor(0, 3, "VEC3");
    accessor["sparse"] = sparse;
    let primitive = json!({ "attributes": { "POSITION": 0 } });
    let mut file = document(&[points, places, values], json!([accessor]), primitive);
    assert_eq!(read(&file).unwrap().0.area(), 1.5);
    file["accessors"][0]["bufferView"] = Json::Null;
    let (mesh, _) = read(&file).unwrap();
    assert_eq!(mesh.positions, [DVec3::ZERO, DVec3::ZERO, DVec3::new(0.0, 3.0, 0.0)]);
    file["accessors"][0]["sparse"]["count"] = 2.into();
    assert!(read(&file).unwrap_err().contains("fewer values"));
    file["accessors"][0]["sparse"] = Json::Null;
    file["accessors"][0]["count"] = json!(1_000_000_000_000_u64);
    assert!(read(&file).unwrap_err().contains("more than 33554432 faces"));
    file["accessors"][0]["count"] = json!(1_000_000);
    assert!(read(&file).unwrap_err().contains("promises 1000000 elements and has no bytes"));
}

#[test]
fn vertices_on_seams_are_joined_and_their_corners_keep_their_values() {
    // Two triangles of a square, each with vertices, texture coordinates and a color of its own.
    let points = floats(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 0., 0., 1., 1., 0., 0., 1., 0.]);
    let uvs = floats(&[0., 1., 0.5, 1., 0.5, 0., 0.5, 1., 1., 0., 0.5, 0.]);
    let colors = floats(&[[1.0, 0.0, 0.0]; 6].concat());
    let accessors = json!([
        float_accessor(0, 6, "VEC3"),
        float_accessor(1, 6, "VEC2"),
        float_accessor(2, 6, "VEC3")
    ]);
    let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2 });
    let file = document(&[points, uvs, colors], accessors, json!({ "attributes": attributes }));
    let bytes = file.to_string();
    let (mesh, _) = read_bytes(bytes.as_bytes(), Vertices::Welded).unwrap();
    assert_eq!(faces(&mesh), [[0, 1, 2], [0, 2, 3]]);
    let texcoord = mesh.layer(Layer::TEXCOORD).unwrap();
    let LayerValues::Vec2(values) = &texcoord.values else { panic!("pairs") };
    let uv = |corner: usize| values[texcoord.index[corner] as usize];
    assert_eq!([uv(0), uv(3), uv(4)], [DVec2::ZERO, DVec2::new(0.5, 0.0), DVec2::ONE]);
    let color = mesh.layer(Layer::COLOR).unwrap();
    assert_eq!((color.domain, &color.index[..]), (Domain::Vertex, &[0; 4][..]));
    assert_eq!(read(&file).unwrap().0.positions.len(), 6);
}

#[test]
fn pictures_may_be_moved_and_turned_on_the_surface() {
    let points = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let uvs = floats(&[0., 0., 1., 0., 0., 1.]);
    let accessors = json!([float_accessor(0, 3, "VEC3"), float_accessor(1, 3, "VEC2")]);
    let attributes = json!({ "POSITION": 0, "TEXCOORD_3": 1 });
    let primitive = json!({ "attributes": attributes, "material": 0 });
    let mut file = document(&[points, uvs], accessors, primitive);
    let transform = json!({
        "offset": [0.25, 0.5], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 1],
        "texCoord": 3
    });
    let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    file["materials"] = json!([{
        "name": "skin",
        "pbrMetallicRoughness": { "baseColorTexture": info, "baseColorFactor": [0.25, 1, 0, 0.5],
                                  "metallicFactor": 0 }
    }]);
    file["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    file["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33071 }]);
    file["images"] = json!([{ "uri": "a%20b.png" }]);
    let (mesh, _) = read(&file).unwrap();
    let Some(LayerValues::Vec2(uvs)) = mesh.layer(Layer::TEXCOORD).map(|layer| &layer.values)
    else {
        panic!("texture coordinates")
    };
    // A quarter turn counter-clockwise takes what points right up, and the second coordinate of
    // the file points down: (u, v) becomes (v, -2 u), then the offset.
    let expected = [[0.25, 0.5], [0.25, 2.5], [1.25, 0.5]];
    let is_near = |(uv, expected): (&DVec2, [f64; 2])| uv.distance(DVec2::from(expected)) < 1e-12;
    assert!(uvs.iter().zip(expected).all(is_near), "{uvs:?}");
    let material = &mesh.materials[0];
    let color = material.diffuse().unwrap();
    // 0.25 is 137 of 255 as sRGB has it.
    assert_eq!(((color.x * 255.0).round(), color.y, color.z), (137.0, 1.0, 0.0));
    assert!(material.statements.contains(&("d".to_owned(), "0.5".to_owned())));
    let texture = &material.textures[0];
    assert_eq!((texture.name.as_str(), texture.options.as_str()), ("a b.png", "-clamp on "));
}

#[test]
fn what_is_wrong_is_said() {
    let of = |change: &dyn Fn(&mut Json)| {
        let mut file = zigzag(5);
        change(&mut file);
        read(&file).unwrap_err()
    };
    let asks = |name: &str| json!([name]);
    let draco = of(&|file| file["extensionsRequired"] = asks("KHR_draco_mesh_compression"));
    assert!(draco.contains("KHR_draco_mesh_compression") && draco.contains("unpack"), "{draco}");
    let old = of(&|file| file["asset"]["version"] = "1.0".into());
    assert!(old.contains("has 1.0; save it as glTF 2.0"), "{old}");
    let many = of(&|file| file["accessors"][0]["count"] = 6.into());
    assert!(many.contains("mesh 0, primitive 0: accessor 0 promises 6 elements"), "{many}");
    let odd = of(&|file| file["accessors"][0]["componentType"] = 5124.into());
    assert!(odd.contains("component type 5124"), "{odd}");
    let few = of(&|file| file["accessors"][0]["type"] = "VEC2".into());
    assert!(few.contains("expected 3 numbers"), "{few}");
    let beside = of(&|file| file["buffers"][0]["uri"] = "x.bin".into());
    assert!(beside.contains("buffer 0 is the file x.bin"), "{beside}");
    let beyond = of(&|file| file["bufferViews"][0]["byteLength"] = 61.into());
    assert!(beyond.contains("asks for 61 bytes from byte 0 of buffer 0, which has 60"), "{beyond}");
    let text = of(&|file| file["nodes"] = "x".into());
    assert!(text.contains("line 1 column"), "{text}");
    let message = |bytes: &[u8]| read_bytes(bytes, Vertices::Welded).unwrap_err();
    assert!(message(b"glTF\x01\0\0\0\x0c\0\0\0").contains("version 1"));
    assert!(message(b"glTF\x02\0\0\0\x0c\0\0\0\xff\xff\0\0JSON{}").contains("cut off"));
    let (mesh, warnings) = read(&{
        let mut file = zigzag(5);
        file["extensionsRequired"] = asks("ACME_waves");
        file
    })
    .unwrap();
    assert!(mesh.faces.len() == 3 && warnings[0].contains("ACME_waves"), "{warnings:?}");
}

#[test]
fn indices_out_of_range_leave_their_triangles_out() {
    let points = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let accessors = json!([
        float_accessor(0, 3, "VEC3"),
        { "bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR" }
    ]);
    let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1 });
    let file = document(&[points, vec![0, 1, 2, 0, 1, 9]], accessors, primitive);
    let (mesh, warnings) = read(&file).unwrap();
    assert_eq!(faces(&mesh), [[0, 1, 2]]);
    assert!(warnings[0].contains("found vertex 9, expected 0 to 2"), "{warnings:?}");
}

proptest! {
    #[test]
    fn any_bytes_give_a_mesh_or_an_error(
        is_binary in any::<bool>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = zigzag(5).to_string().into_bytes();
        if is_binary {
            bytes.clear();
            write_glb(&mve_mesh::fixtures::tetrahedron(), &mut bytes, Control::none()).unwrap();
        }
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = read_bytes(&bytes, Vertices::Welded);
    }
}
