//! Tests of PLY files: exact bytes by hand.
//!
//! That others read them was tried with pymeshlab 2025.7, trimesh 5.2.0 and vtk 9.7.2.

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::{Domain, Field, Layer, LayerValues, NO_VALUE, TriMesh};
use mve_mesh::fixtures::mesh_of;

use super::*;

fn triangle(color: Domain) -> TriMesh {
    let mut mesh =
        mesh_of(&[[0.0; 3], [1.0, 0.0, -2.5], [0.0, 0.1, 1e-20]], &[[0, 1, 2], [2, 1, 0]]);
    let index = if color == Domain::Face { vec![0, NO_VALUE] } else { vec![1, NO_VALUE, 0] };
    let values = LayerValues::Vec3(vec![DVec3::new(0.0, 0.5, 1.0), DVec3::new(7.0, -1.0, 0.2)]);
    mesh.set_layer(Layer { name: Layer::COLOR.to_owned(), domain: color, values, index });
    mesh
}

fn field(domain: Domain, values: &[f64]) -> Field {
    let (name, unit) = ("x".to_owned(), String::new());
    Field { name, unit, domain, values: values.to_vec() }
}

fn written(
    mesh: &TriMesh,
    field: Option<&Field>,
    encoding: Encoding,
    precision: Precision,
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let options = PlyOptions { encoding, precision };
    let result = write_ply(mesh, field, options, &mut bytes, Control::none());
    result.map(|()| bytes).map_err(|error| error.to_string())
}

#[test]
fn text_by_hand() {
    let field = field(Domain::Vertex, &[1.0, f64::NAN, 0.25]);
    let mut mesh = triangle(Domain::Vertex);
    let (values, index) = (LayerValues::Vec3(vec![DVec3::Z]), vec![0, 0, NO_VALUE]);
    let (name, domain) = (Layer::NORMAL.to_owned(), Domain::Vertex);
    mesh.set_layer(Layer { name, domain, values, index });
    let bytes = written(&mesh, Some(&field), Encoding::Ascii, Precision::Float).unwrap();
    let expected = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n\
        element face 2\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 0 0 1 255 0 51 1\n1 0 -2.5 0 0 1 255 255 255 nan\n0 0.1 1e-20 0 0 0 0 128 255 0.25\n\
        3 0 1 2\n3 2 1 0\n";
    assert_eq!(String::from_utf8(bytes).unwrap(), expected);
}

#[test]
fn binary_by_hand() {
    let field = field(Domain::Face, &[2.0, 3.0]);
    let mesh = triangle(Domain::Face);
    for (precision, real, size) in
        [(Precision::Float, "float", 4), (Precision::Double, "double", 8)]
    {
        let bytes = written(&mesh, Some(&field), Encoding::Binary, precision).unwrap();
        let end = b"end_header\n";
        let start = bytes.windows(end.len()).position(|w| w == end).unwrap() + end.len();
        let header = String::from_utf8(bytes[..start].to_vec()).unwrap();
        assert!(header.contains("format binary_little_endian 1.0\n"), "{header}");
        assert!(header.contains(&format!("property {real} quality\nend_header\n")), "{header}");
        let (vertices, faces) = bytes[start..].split_at(9 * size);
        let number = |bytes: &[u8]| match size {
            4 => f64::from(f32::from_le_bytes(bytes.try_into().unwrap())),
            _ => f64::from_le_bytes(bytes.try_into().unwrap()),
        };
        assert_eq!(number(&vertices[5 * size..6 * size]), -2.5);
        assert_eq!(faces.len(), 2 * (13 + 3 + size));
        assert_eq!(faces[..16], [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0, 128, 255]);
        assert_eq!(number(&faces[16..16 + size]), 2.0);
    }
}

#[test]
fn what_cannot_be_written_is_named() {
    let mut mesh = triangle(Domain::Vertex);
    let refused = |mesh: &TriMesh, field: Option<&Field>| {
        written(mesh, field, Encoding::Binary, Precision::Float).unwrap_err()
    };
    let other = field(Domain::Vertex, &[0.0; 5]);
    assert!(refused(&mesh, Some(&other)).contains("5 values"));
    let corners = field(Domain::Corner, &[0.0; 6]);
    assert!(refused(&mesh, Some(&corners)).contains("corners"));
    mesh.positions[1].y = 1e50;
    assert!(refused(&mesh, None).contains("vertex 1 has the coordinate 1e50, too large"));
    assert!(written(&mesh, None, Encoding::Binary, Precision::Double).is_ok());
    mesh.positions[1].y = f64::NAN;
    assert!(refused(&mesh, None).contains("vertex 1 has the coordinate NaN"));
}
