//! Real models for tests: read where they are, reported on one line where they are not.

use std::io::Read;
use std::path::Path;

use glam::DVec3;

use mve_mesh::data::{TriMesh, VertexId};
use mve_mesh::testing;

/// The model of this file name; `None`, after a line saying so, when it is not there.
pub fn model(name: &str) -> Option<TriMesh> {
    Some(read(&text_in(&testing::model(name)?)))
}

/// The text of a file of reference values; a name that ends in `.gz` is unpacked. `None`, after a
/// line saying so, when it is not there.
pub fn reference(name: &str) -> Option<String> {
    Some(text_in(&testing::reference(name)?))
}

/// A mesh among the reference values.
pub fn reference_mesh(name: &str) -> Option<TriMesh> {
    Some(read(&reference(name)?))
}

fn text_in(path: &Path) -> String {
    let bytes = std::fs::read(path).unwrap();
    if path.extension().is_none_or(|extension| extension != "gz") {
        return String::from_utf8(bytes).unwrap();
    }
    let mut text = String::new();
    flate2::read::GzDecoder::new(bytes.as_slice()).read_to_string(&mut text).unwrap();
    text
}

/// All vertices, and faces cut in fans; nothing else of the format.
fn read(text: &str) -> TriMesh {
    let mut mesh = TriMesh::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> = words.take(3).map(|w| w.parse().unwrap()).collect();
                mesh.positions.push(DVec3::from_slice(&numbers));
            }
            Some("f") => {
                let first = |w: &str| w.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                let ids: Vec<VertexId> = words.map(|w| VertexId(first(w))).collect();
                mesh.faces.extend((2..ids.len()).map(|k| [ids[0], ids[k - 1], ids[k]]));
            }
            _ => {}
        }
    }
    mesh
}
