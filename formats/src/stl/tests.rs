//! Tests of STL files: known bytes by hand, both kinds, odd heads.

use mve_core::Control;
use mve_mesh::data::TriMesh;
use mve_mesh::fixtures::{mesh_of, tetrahedron};
use proptest::prelude::*;

use super::*;
use crate::ReadError;

fn written(mesh: &TriMesh, encoding: StlEncoding) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_stl(mesh, encoding, &mut bytes, Control::none()).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> Result<TriMesh, String> {
    read_stl(bytes, Control::none()).map(|(mesh, _)| mesh).map_err(|error| match error {
        ReadError::Wrong(message) => message,
        ReadError::Cancelled(_) => "cancelled".to_owned(),
    })
}

#[test]
fn both_kinds_come_back_with_their_vertices_joined() {
    let mesh = tetrahedron();
    for encoding in [StlEncoding::Binary, StlEncoding::Ascii] {
        let back = read(&written(&mesh, encoding)).unwrap();
        assert_eq!((back.positions.len(), back.faces.len()), (4, 4));
        assert_eq!((back.area(), back.signed_volume()), (mesh.area(), mesh.signed_volume()));
    }
}

#[test]
fn text_by_hand() {
    let mesh = mesh_of(&[[0.0; 3], [2.0, 0.0, 0.0], [0.0, 0.5, 0.0]], &[[0, 1, 2]]);
    let expected = "solid mesh\nfacet normal 0 0 1\n  outer loop\n    vertex 0 0 0\n    vertex 2 0 0\n    \
                    vertex 0 0.5 0\n  endloop\nendfacet\nendsolid mesh\n";
    assert_eq!(String::from_utf8(written(&mesh, StlEncoding::Ascii)).unwrap(), expected);
}

/// What is read from a file piece by piece is what is read from memory, errors included.
#[test]
fn a_file_is_read_as_its_bytes_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.stl");
    // More triangles than are joined at once.
    let binary = written(&mve_mesh::fixtures::torus(2.0, 0.5, 60), StlEncoding::Binary);
    let text = written(&tetrahedron(), StlEncoding::Ascii);
    let with_more = [&binary[..], b"colors"].concat();
    for bytes in [&binary[..], &with_more, &text, &binary[..binary.len() - 1], b"solid", b""] {
        std::fs::write(&path, bytes).unwrap();
        let from_file = load(&path, Control::none());
        match read_stl(bytes, Control::none()) {
            Ok((mesh, warnings)) => {
                let (other, others) = from_file.unwrap();
                assert_eq!((other.positions, other.faces), (mesh.positions, mesh.faces));
                assert_eq!(format!("{others:?}"), format!("{warnings:?}"));
            }
            Err(error) => {
                let found = from_file.unwrap_err().to_string();
                assert!(found.ends_with(&error.to_string()), "{found}");
            }
        }
    }
}

#[test]
fn a_binary_file_may_begin_with_solid() {
    let mut bytes = written(&tetrahedron(), StlEncoding::Binary);
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(read(&bytes).unwrap().faces.len(), 4);
}

#[test]
fn names_with_words_of_the_format_capitals_and_several_solids_are_read() {
    let solid = "SOLID facet vertex 1 2\n FACET NORMAL 0 0 0\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\n\
                 VERTEX -0 1 0\nENDLOOP\nENDFACET\nENDSOLID facet\n";
    let mesh = read(solid.repeat(2).as_bytes()).unwrap();
    assert_eq!((mesh.positions.len(), mesh.faces.len(), mesh.area()), (3, 2, 1.0));
}

#[test]
fn what_is_wrong_is_said() {
    let whole = written(&tetrahedron(), StlEncoding::Binary);
    let message = read(&whole[..200]).unwrap_err();
    assert!(message.contains("promises 4 triangles, but there is room for 2"), "{message}");
    let message = read(b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n").unwrap_err();
    assert!(message.contains("line 4: found `x`, expected z"), "{message}");
    let message = read(b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n").unwrap_err();
    assert!(message.contains("ends within a facet"), "{message}");
    assert!(read(b"").unwrap_err().contains("too few"));
    let mut huge = whole.clone();
    huge[80..84].fill(0xff);
    assert!(read(&huge).unwrap_err().contains("promises 4294967295 triangles"));
}

proptest! {
    #[test]
    fn any_bytes_give_a_mesh_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        for start in [&b""[..], b"solid ", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 "] {
            let bytes = [start, &bytes].concat();
            if let Ok(mesh) = read(&bytes) {
                prop_assert_eq!(mesh.check(), Ok(()));
            }
        }
    }
}
