//! Real models for tests: read where they are, reported on one line where they are not.

use std::io::Read;
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::data::{TriMesh, VertexId};

/// The folder of models: `MVE_MODELS`, or `../shared/models` beside the workspace. References are
/// in `../refs` of it.
pub fn folder() -> PathBuf {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/models");
    std::env::var_os("MVE_MODELS").map_or(beside, PathBuf::from)
}

/// The model of this file name from the folder `MVE_MODELS` or `../shared/models` beside the
/// workspace; `None`, after a line saying so, when it is not there.
pub fn model(name: &str) -> Option<TriMesh> {
    Some(read(&text_in(&folder(), name)?))
}

/// The text of a file of reference values, from the folder `refs` beside that of the models; a
/// name that ends in `.gz` is unpacked. `None`, after a line saying so, when it is not there.
pub fn reference(name: &str) -> Option<String> {
    text_in(&folder().join("../refs"), name)
}

/// A mesh among the reference values.
pub fn reference_mesh(name: &str) -> Option<TriMesh> {
    Some(read(&reference(name)?))
}

fn text_in(folder: &Path, name: &str) -> Option<String> {
    let unpacked = |bytes: Vec<u8>| {
        let mut text = String::new();
        if name.ends_with(".gz") {
            flate2::read::GzDecoder::new(bytes.as_slice()).read_to_string(&mut text)?;
            return Ok(text);
        }
        String::from_utf8(bytes).map_err(std::io::Error::other)
    };
    match std::fs::read(folder.join(name)).and_then(unpacked) {
        Ok(text) => Some(text),
        Err(error) => {
            eprintln!("skipped: {} in {}: {error}", name, folder.display());
            None
        }
    }
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
