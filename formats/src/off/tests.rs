//! Tests of OFF files: texts by hand.

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::{Domain, Layer, LayerValues, TriMesh};
use mve_mesh::fixtures::tetrahedron;
use proptest::prelude::*;

use super::*;
use crate::ReadError;

fn read(text: &str) -> Result<TriMesh, String> {
    read_off(text.as_bytes(), Control::none()).map(|(mesh, _)| mesh).map_err(|error| match error {
        ReadError::Wrong(message) => message,
        ReadError::Cancelled(_) => "cancelled".to_owned(),
    })
}

fn colors(mesh: &TriMesh) -> (Domain, Vec<DVec3>) {
    match mesh.layer(Layer::COLOR) {
        Some(Layer { domain, values: LayerValues::Vec3(values), index, .. }) => {
            (*domain, index.iter().map(|&at| values[at as usize]).collect())
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_square_with_comments_and_counts_behind_the_keyword() {
    for start in
        ["OFF\n# a square\n4 1 4\n", "OFF 4 1 4\n", "4 1\n", "\u{20}OFF # x\n\n4 1 0 # y\n"]
    {
        let mesh =
            read(&format!("{start}0 0 0\n2 0 0 # corner\n2 3 0\n0 3 0\n4 0 1 2 3\n")).unwrap();
        assert_eq!((mesh.positions.len(), mesh.faces.len(), mesh.area()), (4, 2, 6.0), "{start}");
    }
}

#[test]
fn vertices_have_what_the_keyword_says() {
    let text = "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255 0.25 0.5\n1 0 0 0 0 1 0 51 0 255 1 0\n0 1 0 0 0 1 \
                0 0 255 255 0 1\n3 0 1 2\n";
    let mesh = read(text).unwrap();
    let expected = [DVec3::X, DVec3::new(0.0, 0.2, 0.0), DVec3::Z];
    assert_eq!(colors(&mesh), (Domain::Vertex, expected.to_vec()));
    let Some(LayerValues::Vec2(texcoords)) = mesh.layer(Layer::TEXCOORD).map(|l| &l.values) else {
        panic!()
    };
    assert_eq!(texcoords[0].to_array(), [0.25, 0.5]);
    let Some(LayerValues::Vec3(normals)) = mesh.layer(Layer::NORMAL).map(|l| &l.values) else {
        panic!()
    };
    assert_eq!(normals[2], DVec3::Z);
    assert_eq!(read(&text.replace("STCNOFF", "NCSTOFF")), read(text));
    let mesh =
        read("COFF\n3 1 0\n0 0 0 0.5 0 0 1\n1 0 0 0 0 0 1\n0 1 0 0 0 1 1\n3 0 1 2\n").unwrap();
    assert_eq!(colors(&mesh).1[0], DVec3::new(0.5, 0.0, 0.0));
}

#[test]
fn faces_have_colors_behind_their_corners() {
    let text = "OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 1\n3 0 1 2 7\n";
    let mesh = read(text).unwrap();
    assert_eq!(colors(&mesh), (Domain::Face, vec![DVec3::X, DVec3::ONE, DVec3::ONE]));
}

#[test]
fn what_is_written_comes_back() {
    let mut mesh = tetrahedron();
    mesh.positions[1].x = 0.1 + 0.2;
    let values = LayerValues::Vec3(vec![DVec3::X, DVec3::new(0.0, 0.4, 1.0)]);
    for (domain, index) in [(Domain::Vertex, vec![0, 1, 1, 0]), (Domain::Face, vec![1, 0, 0, 1])] {
        let name = Layer::COLOR.to_owned();
        mesh.set_layer(Layer { name, domain, values: values.clone(), index });
        let mut bytes = Vec::new();
        write_off(&mesh, &mut bytes, Control::none()).unwrap();
        let back = read(str::from_utf8(&bytes).unwrap()).unwrap();
        assert_eq!((&back.positions, &back.faces), (&mesh.positions, &mesh.faces));
        assert_eq!(colors(&back), colors(&mesh));
    }
}

#[test]
fn what_is_wrong_is_said() {
    let message = |text: &str| read(text).unwrap_err();
    assert!(message("").contains("empty"));
    assert!(message("solid\n").contains("line 1: found `solid`, expected `OFF`"));
    assert!(message("OFF BINARY\n").contains("BINARY"));
    assert!(message("4nOFF\n").contains("three dimensions"), "{}", message("4nOFF\n"));
    let many = message("OFF\n1000000000000 1 0\n0 0 0\n");
    assert!(many.contains("1000000000000 vertices"), "{many}");
    let bad = message("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 zero\n3 0 1 2\n");
    assert!(bad.contains("line 5: found `zero`, expected z"), "{bad}");
    let bad = message("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
    assert!(bad.contains("line 6: found vertex 3, expected 0 to 2"), "{bad}");
}

proptest! {
    #[test]
    fn any_words_give_a_mesh_or_an_error(words in "(ST)?C?N?4?OFF( [0-9]{1,2}){0,3}\n([0-9. -]{0,40}\n){0,9}") {
        if let Ok(mesh) = read(&words) {
            prop_assert_eq!(mesh.check(), Ok(()));
        }
    }
}
