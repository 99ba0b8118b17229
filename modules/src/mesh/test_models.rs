//! Real models for tests: read where they are, reported on one line where they are not.

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
    let folder = folder();
    match std::fs::read_to_string(folder.join(name)) {
        Ok(text) => Some(read(&text)),
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
