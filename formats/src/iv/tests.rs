//! Tests of Open Inventor files: texts by hand, and what is written.

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh};
use mve_mesh::fixtures::{cube, tetrahedron};
use proptest::prelude::*;

use super::*;
use crate::ReadError;

fn read_all(text: &str) -> Result<(TriMesh, Vec<String>), String> {
    match read_iv(text.as_bytes(), Control::none()) {
        Ok((mesh, warnings)) => {
            assert_eq!(mesh.check(), Ok(()));
            Ok((mesh, warnings.iter().map(ToString::to_string).collect()))
        }
        Err(ReadError::Wrong(message)) => Err(message),
        Err(ReadError::Cancelled(_)) => Err("cancelled".to_owned()),
    }
}

/// A file with this in it, read without a warning.
fn read(body: &str) -> TriMesh {
    let (mesh, warnings) = read_all(&format!("#Inventor V2.1 ascii\n{body}")).unwrap();
    assert_eq!(warnings, Vec::<String>::new(), "{body}");
    mesh
}

fn faces(mesh: &TriMesh) -> Vec<[u32; 3]> {
    mesh.faces.iter().map(|face| face.map(|v| v.0)).collect()
}

/// The value of each element of a layer.
fn vectors(mesh: &TriMesh, name: &str) -> (Domain, Vec<DVec3>) {
    let layer = mesh.layer(name).unwrap_or_else(|| panic!("no {name}"));
    let value = |&at: &u32| match &layer.values {
        _ if at == NO_VALUE => DVec3::NAN,
        LayerValues::Vec2(values) => values[at as usize].extend(0.0),
        LayerValues::Vec3(values) => values[at as usize],
        other => panic!("{other:?}"),
    };
    (layer.domain, layer.index.iter().map(value).collect())
}

const SQUARE: &str = "Coordinate3 { point [ 0 0 0, 2 0 0, 2 3 0, 0 3 0 ] }";
const FACES: &str = "IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1, 0 3 2 ] }";

#[test]
fn polygons_strips_and_counted_corners_are_triangles() {
    assert_eq!(faces(&read(&format!("{SQUARE}{FACES}"))), [[0, 1, 2], [0, 2, 3], [0, 3, 2]]);
    let strip = "IndexedTriangleStripSet { coordIndex [ 0 1 3 2 -1, 1 2 0, -1 ] }";
    assert_eq!(faces(&read(&format!("{SQUARE}{strip}"))), [[0, 1, 3], [3, 1, 2], [1, 2, 0]]);
    let counted = "FaceSet { startIndex 1 numVertices 3 }";
    assert_eq!(faces(&read(&format!("{SQUARE}{counted}"))), [[1, 2, 3]]);
    let all = "TriangleStripSet { numVertices -1 }";
    assert_eq!(faces(&read(&format!("{SQUARE}{all}"))), [[0, 1, 2], [2, 1, 3]]);
    let inside = "IndexedFaceSet { vertexProperty VertexProperty { vertex [ 0 0 0, 1 0 0, 0 1 0 ]
        orderedRGBA [ 0xff0000ff, 0x003300ff ] materialBinding PER_VERTEX_INDEXED }
        coordIndex [ 0 1 2 -1 ] materialIndex [ 0 1 0 -1 ] }";
    let mesh = read(&format!("{SQUARE}{inside}"));
    let (domain, colors) = vectors(&mesh, Layer::COLOR);
    assert_eq!(domain, Domain::Vertex);
    assert_eq!(colors, [DVec3::X, DVec3::new(0.0, 0.2, 0.0), DVec3::X]);
}

/// Where the first point ends, which is (1, 2, 3) in the file.
fn moved(transforms: &str) -> DVec3 {
    let shape = "Coordinate3 { point [ 1 2 3, 1 0 0, 0 1 0 ] } FaceSet {}";
    read(&format!("{transforms}{shape}")).positions[0]
}

#[test]
fn transforms_move_what_comes_behind_them() {
    let is_near = |found: DVec3, expected: [f64; 3]| {
        assert!(found.distance(expected.into()) < 1e-9, "{found} is not {expected:?}");
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    is_near(
        moved("Translation { translation 10 0 0 } Scale { scaleFactor 2 3 4 }"),
        [12., 6., 12.],
    );
    // A quarter turn around z takes x to y.
    is_near(moved(&format!("Rotation {{ rotation 0 0 2 {quarter} }}")), [-2., 1., 3.]);
    is_near(moved(&format!("RotationXYZ {{ axis Y angle {quarter} }}")), [3., 2., -1.]);
    // Points are rows, and the last row moves them.
    let matrix = "MatrixTransform { matrix 0 1 0 0  -1 0 0 0  0 0 1 0  5 0 0 1 }";
    is_near(moved(matrix), [3., 1., 3.]);
    // About the center: moved there, scaled along turned axes, turned, and moved back.
    let all = format!(
        "Transform {{ translation 100 0 0 rotation 0 0 1 {quarter} scaleFactor 2 1 1 \
         scaleOrientation 0 0 1 {quarter} center 1 1 0 }}"
    );
    // (0, 1, 3) from the center; scaled along the turned x, which is y: (0, 2, 3);
    // turned: (-2, 0, 3).
    is_near(moved(&all), [99., 1., 3.]);
    is_near(moved("Separator { Translation { translation 9 9 9 } }"), [1., 2., 3.]);
    is_near(moved("Group { Translation { translation 9 9 9 } }"), [10., 11., 12.]);
    let kept = "TransformSeparator { Translation { translation 9 9 9 } }";
    is_near(moved(kept), [1., 2., 3.]);
    let mirrored = read(&format!("Scale {{ scaleFactor -1 1 1 }} {SQUARE} {FACES}"));
    assert_eq!(faces(&mirrored)[0], [3, 2, 1]);
    let clockwise = read(&format!("ShapeHints {{ vertexOrdering CLOCKWISE }} {SQUARE} {FACES}"));
    assert_eq!(faces(&clockwise)[2], [2, 3, 0]);
}

#[test]
fn nodes_are_used_again_and_switches_choose() {
    let twice = format!(
        "DEF a Separator {{ {SQUARE} {FACES} }} Translation {{ translation 0 0 1 }} USE a
         Switch {{ USE a }} Switch {{ whichChild 1 Info {{}} USE a }} LOD {{ range [ 5 ] USE a USE a }}"
    );
    let mesh = read(&twice);
    // The three that are moved share their points.
    assert_eq!((mesh.positions.len(), mesh.faces.len()), (8, 12));
    let message = read_all("#Inventor V2.0 ascii\nDEF a Separator { USE a }").unwrap_err();
    assert!(message.contains("line 2: USE `a`, but no DEF before it"), "{message}");
    let mut bomb = format!("#Inventor V2.1 ascii\nDEF a0 Separator {{ {SQUARE} {FACES} }}\n");
    for at in 1..64 {
        let before = at - 1;
        bomb.push_str(&format!("DEF a{at} Separator {{ USE a{before} USE a{before} }}\n"));
    }
    let message = read_all(&bomb).unwrap_err();
    assert!(message.contains("used again"), "{message}");
    let deep = "Separator {".repeat(300);
    let message = read_all(&format!("#Inventor V2.1 ascii\n{deep}")).unwrap_err();
    assert!(message.contains("250 nodes in each other"), "{message}");
}

#[test]
fn bindings_say_which_value_a_corner_has() {
    let colors = "Material { diffuseColor [ 1 0 0, 0 1 0, 0 0 1, 1 1 1 ] }";
    let of = |binding: &str, index: &str| {
        let set = FACES.replace(" }", &format!(" {index} }}"));
        vectors(
            &read(&format!("{SQUARE}{colors} MaterialBinding {{ value {binding} }} {set}")),
            Layer::COLOR,
        )
    };
    let (x, y, z, white) = (DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE);
    assert_eq!(of("PER_FACE", ""), (Domain::Face, vec![x, x, y]));
    assert_eq!(of("PER_FACE_INDEXED", "materialIndex [ 2, 3 ]"), (Domain::Face, vec![z, z, white]));
    assert_eq!(of("PER_VERTEX_INDEXED", ""), (Domain::Vertex, vec![x, y, z, white]));
    let (domain, corners) = of("PER_VERTEX_INDEXED", "materialIndex [ 0 1 2 3 -1 1 1 1 ]");
    assert_eq!((domain, &corners[6..]), (Domain::Corner, &[y; 3][..]));
    // One list for all corners, in their order; there is none behind the fourth.
    let (_, corners) = of("PER_VERTEX", "");
    assert_eq!(corners[..6], [x, y, z, x, z, white]);
    assert!(corners[6].is_nan());
    let normals = "Normal { vector [ 0 0 1, 0 0 -1 ] } NormalBinding { value PER_FACE }";
    let (_, normals) = vectors(&read(&format!("{SQUARE}{normals}{FACES}")), Layer::NORMAL);
    assert_eq!((normals[0], normals[6]), (DVec3::Z, DVec3::NEG_Z));
    let uvs = "TextureCoordinate2 { point [ 0 0, 1 0, 1 1 ] }";
    let set = FACES.replace(" }", " textureCoordIndex [ 0 1 2 2 -1 1 1 1 -1 ] }");
    let (_, uvs) = vectors(&read(&format!("{SQUARE}{uvs}{set}")), Layer::TEXCOORD);
    assert_eq!(uvs[5], DVec3::new(1.0, 1.0, 0.0));
}

#[test]
fn materials_and_pictures_hold_for_what_comes_behind_them() {
    let image = "Texture2 { image 2 1 3 0xff0000 0x0000ff wrapS CLAMP wrapT CLAMP }";
    let body = format!(
        "Separator {{ DEF skin Material {{ diffuseColor 0.5 0.25 1 transparency 0.25
         shininess 0.5 }} {SQUARE} {FACES} Separator {{ {image} {FACES} }} {FACES} }} {SQUARE} {FACES}"
    );
    let mesh = read(&body);
    let material = mesh.layer(Layer::MATERIAL).unwrap();
    assert_eq!(material.index[..3], [0; 3]);
    assert_eq!(material.index[3..6], [1; 3]);
    assert_eq!(material.index[6..9], [0; 3]);
    assert_eq!(material.index[9..], [NO_VALUE; 3]);
    let skin = &mesh.materials[0];
    assert_eq!((skin.name.as_str(), skin.diffuse()), ("skin", Some(DVec3::new(0.5, 0.25, 1.0))));
    assert_eq!(
        skin.statements[1..],
        [("d", "0.75"), ("Ns", "64")].map(|(a, b)| (a.into(), b.into()))
    );
    let texture = &mesh.materials[1].textures[0];
    let pixels = texture.image.as_ref().unwrap().pixels().unwrap();
    assert_eq!(
        (pixels.bytes.as_slice(), texture.options.as_str()),
        (&[255, 0, 0, 0, 0, 255][..], "-clamp on ")
    );
}

#[test]
fn what_is_not_known_is_stepped_over_and_named() {
    let body = format!(
        "#Inventor V2.0 ascii\n\nSeparator {{ renderCaching OFF # a comment {{
         SoFancy {{ fields [ SFFloat a, MFString b ] a 3 b [ \"}}\", \"x\\\"}}\" ] child Cube {{ }} }}
         {SQUARE} Complexity {{ value 0.5 }} ShapeHints {{ faceType (CONVEX | X) crease 0.5 ~ }}
         IndexedFaceSet {{ odd [ 1 2 3 ] other 1 2 3 word PLAIN node Cube {{ width 3 }} \
         joined 1 = Engine.out coordIndex [ 0 1 2 -1 ] }} }}"
    );
    let (mesh, warnings) = read_all(&body).unwrap();
    assert_eq!(mesh.faces.len(), 1);
    assert!(warnings.len() == 1 && warnings[0].contains("left out: `SoFancy`"), "{warnings:?}");
}

#[test]
fn what_is_wrong_is_said() {
    let message = |text: &str| read_all(text).unwrap_err();
    assert!(message("#Inventor V2.1 binary\n\0\0").contains("binary Open Inventor"));
    assert!(message("#VRML V2.0 utf8\n").contains("VRML 2.0"));
    assert!(message("solid x\n").contains("line 1: found `solid x`"));
    let of = |body: &str| message(&format!("#Inventor V2.1 ascii\n{body}"));
    let bad = of("Separator {\n  Coordinate3 { point [ 0 0 0,\n1 x 0 ] }");
    assert!(bad.contains("line 4: found `x`, expected a number"), "{bad}");
    let open = of("Separator {\n  Cube { width 1\n");
    assert!(open.contains("the file ends before the `}` of what line 3 opens"), "{open}");
    assert!(of("Separator { ").contains("the file ends in line 2, before a node"));
    let beyond = of(&format!("{SQUARE} IndexedFaceSet {{ coordIndex [ 0 1 4 ] }}"));
    assert!(beyond.contains("face 0 of a shape: found point 4, expected 0 to 3"), "{beyond}");
    assert!(of("IndexedFaceSet { coordIndex [ 0 1 2 ] }").contains("no points before it"));
    assert!(of("Texture2 { image 100000 100000 3 0 }").contains("too few follow"));
    let nowhere = of(&format!("{} {FACES}", SQUARE.replace("2 3 0", "2 nan 0")));
    assert!(nowhere.contains("vertex 2 of face 0 is at 2 NaN 0"), "{nowhere}");
}

#[test]
fn what_is_written_comes_back() {
    let mut mesh = cube(DVec3::new(0.1, -2e-7, 3e8));
    let mut put = |name: &str, domain, values, index: Vec<u32>| {
        mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
    };
    let normals = LayerValues::Vec3(vec![DVec3::X, DVec3::Y, DVec3::Z]);
    let corners = |n: u32| (0..36).map(|corner| corner * corner % n).collect();
    put(Layer::NORMAL, Domain::Corner, normals, corners(3));
    let uvs = LayerValues::Vec2(vec![DVec2::ZERO, DVec2::new(0.1, 0.7)]);
    put(Layer::TEXCOORD, Domain::Corner, uvs, corners(2));
    let labels = LayerValues::Label(vec!["skin".to_owned(), "hair".to_owned()]);
    let of_faces = (0..12).map(|face| [0, 1, NO_VALUE][face / 4]).collect();
    put(Layer::MATERIAL, Domain::Face, labels, of_faces);
    let (skin, hair) = (b"newmtl skin\nKd 1 0.5 0\nNs 64\n", b"newmtl hair\nd 0.25\n");
    for text in [skin.as_slice(), hair] {
        mesh.materials.extend(crate::obj::parse_mtl(text).0);
    }
    let written = |mesh: &TriMesh| {
        let mut bytes = Vec::new();
        write_iv(mesh, &mesh.materials, &mut bytes, Control::none()).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    let sorted = |mut mesh: TriMesh| {
        mesh.layers.sort_by(|a, b| a.name.cmp(&b.name));
        mesh
    };
    assert_eq!(sorted(read_all(&written(&mesh)).unwrap().0), sorted(mesh));
    let mut mesh = tetrahedron();
    let colors = LayerValues::Vec3(vec![DVec3::X, DVec3::new(0.0, 0.4, 1.0)]);
    for (domain, index) in [(Domain::Vertex, vec![0, 1, 1, 0]), (Domain::Face, vec![1, 0, 0, 1])] {
        let name = Layer::COLOR.to_owned();
        mesh.set_layer(Layer { name, domain, values: colors.clone(), index });
        assert_eq!(read_all(&written(&mesh)).unwrap().0, mesh);
    }
}

proptest! {
    #[test]
    fn any_words_give_a_mesh_or_an_error(
        words in prop::collection::vec(prop::sample::select(vec![
            "Separator", "Group", "{", "}", "[", "]", "DEF", "USE", "a", "Coordinate3", "point",
            "0 0 0", "1 0 0, 0 1 0", "IndexedFaceSet", "coordIndex", "0 1 2 -1", "-1", "7",
            "FaceSet", "numVertices", "TriangleStripSet", "Material", "diffuseColor",
            "MaterialBinding", "value", "PER_FACE", "Texture2", "image", "filename", "\"x\"",
            "vertexProperty", "VertexProperty", "vertex", "Scale", "scaleFactor", "1e400", "nan",
            "Switch", "whichChild", "startIndex", "0xff", "~", "=", "#", "\n", "\"", "(", "|",
        ]), 0..60),
    ) {
        let _ = read_all(&format!("#Inventor V2.1 ascii\n{}", words.join(" ")));
    }

    #[test]
    fn any_bytes_give_a_mesh_or_an_error(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = Vec::new();
        write_iv(&tetrahedron(), &[], &mut bytes, Control::none()).unwrap();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok((mesh, _)) = read_iv(&bytes, Control::none()) {
            prop_assert_eq!(mesh.check(), Ok(()));
        }
    }
}
