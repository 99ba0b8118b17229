//! Tests of reading PLY files: bytes by hand, and what is written.

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Domain, Field, Layer, LayerValues, NO_VALUE, TriMesh};
use mve_mesh::fixtures::tetrahedron;
use proptest::prelude::*;

use super::*;
use crate::ReadError;

fn read_all(bytes: &[u8]) -> Result<(TriMesh, Vec<String>), String> {
    match read_ply(bytes, Control::none()) {
        Ok((mesh, warnings)) => Ok((mesh, warnings.iter().map(ToString::to_string).collect())),
        Err(ReadError::Wrong(message)) => Err(message),
        Err(ReadError::Cancelled(_)) => Err("cancelled".to_owned()),
    }
}

fn read(bytes: &[u8]) -> TriMesh {
    read_all(bytes).unwrap().0
}

#[test]
fn texture_coordinates_pictures_and_numbers_are_written_and_come_back() {
    let text = format!(
        "{HEAD}comment TextureFile b.png\ncomment TextureFile c.png\nelement face 3\nproperty list \
         uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n\
         property float area\nend_header\n{SQUARE}3 0 1 2 6 0 0 1 0 1 0.125 1 7\n3 2 1 0 0 -1 8\n\
         3 0 2 3 6 0 0 1 0.125 0 1 0 9\n"
    );
    let mesh = read(text.as_bytes());
    for encoding in [Encoding::Binary, Encoding::Ascii] {
        let options = PlyOptions { encoding, precision: Precision::Float };
        let mut bytes = Vec::new();
        write_ply(&mesh, None, options, &mut bytes, Control::none()).unwrap();
        assert_eq!(read(&bytes), mesh);
    }
}

/// The value of each element of a layer over vertices or corners.
fn vectors(mesh: &TriMesh, name: &str) -> Vec<DVec3> {
    let layer = mesh.layer(name).unwrap();
    let value = |&at: &u32| match &layer.values {
        _ if at == NO_VALUE => DVec3::NAN,
        LayerValues::Number(values) => DVec3::new(values[at as usize], 0.0, 0.0),
        LayerValues::Vec2(values) => values[at as usize].extend(0.0),
        LayerValues::Vec3(values) => values[at as usize],
        LayerValues::Label(_) => DVec3::NAN,
    };
    layer.index.iter().map(value).collect()
}

#[test]
fn what_is_written_comes_back() {
    let mut mesh = tetrahedron();
    mesh.positions[1] = DVec3::new(0.1, -2e-7, 3e8);
    let colors = vec![DVec3::X, DVec3::new(0.0, 0.2, 1.0)];
    for (name, values) in
        [(Layer::NORMAL, vec![DVec3::Z, DVec3::new(0.6, 0.8, 0.0)]), (Layer::COLOR, colors)]
    {
        let (name, domain) = (name.to_owned(), Domain::Vertex);
        let values = LayerValues::Vec3(values);
        mesh.set_layer(Layer { name, domain, values, index: vec![0, 1, 1, 0] });
    }
    let (name, unit, domain) = ("x".to_owned(), String::new(), Domain::Face);
    let field = Field { name, unit, domain, values: vec![1.5, -2.0, 1e300, 0.0] };
    for encoding in [Encoding::Binary, Encoding::Ascii] {
        let options = PlyOptions { encoding, precision: Precision::Double };
        let mut bytes = Vec::new();
        write_ply(&mesh, Some(&field), options, &mut bytes, Control::none()).unwrap();
        let back = read(&bytes);
        assert_eq!((&back.positions, &back.faces), (&mesh.positions, &mesh.faces));
        for name in [Layer::NORMAL, Layer::COLOR] {
            assert_eq!(vectors(&back, name), vectors(&mesh, name), "{name}");
        }
        assert_eq!(back.layer("quality").unwrap().domain, Domain::Face);
        let values: Vec<f64> = vectors(&back, "quality").iter().map(|value| value.x).collect();
        assert_eq!(values, field.values);
    }
}

#[test]
fn the_highest_byte_may_come_first_and_any_type_for_any_property() {
    let mut bytes = b"ply\r\nformat binary_big_endian 1.0\r\nelement color 1\r\n\
        property list ushort double x\r\nelement vertex 4\r\nproperty double x\r\n\
        property short y\r\nproperty uint8 z\r\nproperty ushort red\r\n\
        property ushort green\r\nproperty ushort blue\r\nproperty list uchar char junk\r\n\
        element face 2\r\nproperty list int uint16 vertex_index\r\nend_header\r\n"
        .to_vec();
    bytes.extend([0, 1]);
    bytes.extend(7f64.to_be_bytes());
    for (x, y, z) in [(0.0, 0, 0), (2.5, 0, 0), (2.5, -300, 0), (0.0, -300, 200)] {
        bytes.extend(f64::to_be_bytes(x));
        bytes.extend(i16::to_be_bytes(y));
        bytes.push(z);
        bytes.extend([0xff, 0xff, 0, 0, 0x33, 0x33]);
        bytes.extend([1, 9]);
    }
    for corners in [&[0_u16, 1, 2, 3][..], &[2, 1, 0]] {
        bytes.extend((corners.len() as i32).to_be_bytes());
        corners.iter().for_each(|corner| bytes.extend(corner.to_be_bytes()));
    }
    let mesh = read(&bytes);
    assert_eq!(mesh.positions[3], DVec3::new(0.0, -300.0, 200.0));
    assert_eq!(
        mesh.faces.iter().map(|face| face.map(|v| v.0)).collect::<Vec<_>>(),
        [[0, 1, 2], [0, 2, 3], [2, 1, 0]]
    );
    assert_eq!(vectors(&mesh, Layer::COLOR), [DVec3::new(1.0, 0.0, 0.2); 4]);
}

const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
                    property float z\n";
const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

#[test]
fn corners_have_texture_coordinates_and_faces_pictures_and_numbers() {
    let text = format!(
        "{HEAD}comment TextureFile a b.png\nelement face 3\nproperty list uchar int vertex_indices\n\
         property list uchar float texcoord\nproperty int texnumber\nproperty float area\n\
         end_header\n{SQUARE}4 0 1 2 3 8 0 0 1 0 1 1 0 1 0 7\n3 2 1 0 6 1 1 1 0 0 0 5 8\n\
         3 0 1 2 0 0 9\n"
    );
    let (mesh, warnings) = read_all(text.as_bytes()).unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    let uv = |x, y| DVec2::new(x, y).extend(0.0);
    let texcoords = vectors(&mesh, Layer::TEXCOORD);
    let expected = [uv(0., 0.), uv(1., 0.), uv(1., 1.), uv(0., 0.), uv(1., 1.), uv(0., 1.)];
    assert_eq!(texcoords[..6], expected);
    assert_eq!(texcoords[6..9], [uv(1., 1.), uv(1., 0.), uv(0., 0.)]);
    assert!(texcoords[9].is_nan());
    assert_eq!(mesh.materials[0].textures[0].name, "a b.png");
    assert_eq!(mesh.layer(Layer::MATERIAL).unwrap().index, [0, 0, NO_VALUE, 0]);
    let areas: Vec<f64> = vectors(&mesh, "area").iter().map(|area| area.x).collect();
    assert_eq!(areas, [7.0, 7.0, 8.0, 9.0]);
}

#[test]
fn strips_are_taken_apart_each_triangle_the_right_way_round() {
    let text = format!(
        "{HEAD}element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
         {SQUARE}8 0 1 3 2 -1 0 1 2\n"
    );
    let mesh = read(text.as_bytes());
    let faces: Vec<_> = mesh.faces.iter().map(|face| face.map(|v| v.0)).collect();
    assert_eq!(faces, [[0, 1, 3], [3, 1, 2], [0, 1, 2]]);
    assert!(mesh.faces.iter().all(|face| {
        let [a, b, c] = face.map(|v| mesh.positions[v.idx()]);
        (b - a).cross(c - a).z > 0.0
    }));
}

#[test]
fn several_elements_of_faces_keep_their_values_apart() {
    let faces = "element face 1\nproperty list uchar int vertex_indices\n";
    let text = format!(
        "{HEAD}element tristrips 1\nproperty list int int vertex_indices\n{faces}property float a\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         {faces}property float b\nproperty list uchar float texcoord\n{faces}end_header\n{SQUARE}\
         3 0 1 2\n3 0 1 2 5 255 0 0\n3 0 2 3 6 6 1 1 0 0 0.5 0.5\n3 0 1 3\n"
    );
    let mesh = read(text.as_bytes());
    assert_eq!((mesh.faces.len(), mesh.check()), (4, Ok(())));
    let numbers = |name: &str| -> Vec<String> {
        vectors(&mesh, name).iter().map(|value| value.x.to_string()).collect()
    };
    assert_eq!(numbers("a"), ["NaN", "5", "NaN", "NaN"]);
    assert_eq!(numbers("b"), ["NaN", "NaN", "6", "NaN"]);
    assert_eq!(vectors(&mesh, Layer::COLOR)[..3], [DVec3::ONE, DVec3::X, DVec3::ONE]);
    let texcoords = vectors(&mesh, Layer::TEXCOORD);
    assert!(texcoords[5].is_nan() && texcoords[6].x == 1.0 && texcoords[9].is_nan());
}

#[test]
fn bad_faces_are_left_out_and_said() {
    let faces = "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    let text = format!("{HEAD}{faces}{SQUARE}3 0 1 4\n2 0 1\n3 0 1 2\n3 -1 0 1\n");
    let (mesh, warnings) = read_all(text.as_bytes()).unwrap();
    assert_eq!(mesh.faces.len(), 1);
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(warning.contains("found vertex 4, expected 0 to 3"), "{warning}");
    assert!(warning.contains("2 more"), "{warning}");
    let spoiled =
        format!("{HEAD}{faces}{}{}", SQUARE.replace("1 1 0", "1 nan 0"), "3 0 1 2\n".repeat(4));
    let message = read_all(spoiled.as_bytes()).unwrap_err();
    assert!(message.contains("vertex 2 of face 0 is at 1 NaN 0"), "{message}");
}

#[test]
fn what_is_wrong_is_said() {
    let message = |text: &str| read_all(text.as_bytes()).unwrap_err();
    assert!(message("solid").contains("no PLY file"));
    assert!(message("ply\nformat ascii 1.0\n").contains("no line `end_header`"));
    assert!(message("ply\nend_header\n").contains("no line `format`"));
    let bad = message("ply\nformat ascii 1.0\nelement vertex x\n");
    assert!(bad.contains("line 3: found `element vertex x`"), "{bad}");
    let huge = "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty float x\n\
                property float y\nproperty float z\nend_header\n0123456789";
    let bad = message(huge);
    assert!(bad.contains("promises 1000000000000 rows of \"vertex\""), "{bad}");
    let list = "ply\nformat binary_little_endian 1.0\nelement x 1\nproperty list uint uchar y\n\
                end_header\n\u{7f}\u{7f}\u{7f}\u{7f}";
    assert!(message(list).contains("the list \"y\" has 2139062143 items"), "{}", message(list));
    let no_rows = "ply\nformat ascii 1.0\nelement x 1000000000000\nelement vertex 0\nproperty float x\n\
                   property float y\nproperty float z\nend_header\n";
    assert_eq!(read(no_rows.as_bytes()), TriMesh::default());
    let bad = message(&format!("{HEAD}end_header\n0 0 0 1 0 0 1 x 0 0 0 0"));
    assert!(bad.contains("\"vertex\", row 3 of 4: line 8: found `x`"), "{bad}");
}

proptest! {
    #[test]
    fn any_bytes_give_a_mesh_or_an_error(
        which in 0_usize..3,
        cut in 0_usize..400,
        changes in prop::collection::vec((0_usize..400, any::<u8>()), 0..8),
    ) {
        let mut bytes = Vec::new();
        let encoding = if which == 0 { Encoding::Ascii } else { Encoding::Binary };
        let options = PlyOptions { encoding, precision: Precision::Float };
        write_ply(&tetrahedron(), None, options, &mut bytes, Control::none()).unwrap();
        for (at, byte) in changes {
            let at = at % bytes.len();
            bytes[at] = byte;
        }
        if which == 2 {
            bytes.truncate(cut);
        }
        if let Ok((mesh, _)) = read_all(&bytes) {
            prop_assert_eq!(mesh.check(), Ok(()));
        }
    }
}
