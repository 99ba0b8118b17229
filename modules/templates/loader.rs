//! Loads a mesh from a text with a triangle a line, as nine numbers: three coordinates a corner.
//!
//! This is what other programs call RAW triangles. Say where the format is described, and what of
//! it is left out.

use glam::DVec3;
use mve_core::Control;
use mve_formats::{ReadError, load};
use mve_mesh::data::VertexId;

use crate::prelude::*;

/// Bytes of the largest file that is read.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Lines that are read between two looks at the control.
const LINES_AT_ONCE: usize = 1 << 12;

/// Two triangles; `tests/contracts.rs` loads them, and damaged copies.
const EXAMPLE: &[u8] = b"0 0 0 2 0 0 0 3 0\n0 0 0 0 3 0 0 0 4\n";

const PATH: Param<PathBuf> = Param::input_file("path", "The file.", &["template"]).example(EXAMPLE);
const MESH_OUT: Out<TriMesh> = Out::new("mesh", "All triangles, each with vertices of its own.");

pub static MODULE: Module = Module {
    id: "Template",
    summary: "Loads a mesh from a text with a triangle a line, as nine numbers.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let mesh = load(&path, MAX_FILE_BYTES, io.control(), read)?;
    io.put(MESH_OUT, mesh);
    Ok(())
}

/// Reads the bytes of a file. Any bytes give a mesh or an error, in memory that grows with their
/// number alone.
fn read(bytes: &[u8], control: Control) -> Result<TriMesh, ReadError> {
    let wrong = |line: usize, what: &str| ReadError::Wrong(format!("line {line} is {what}"));
    let mut mesh = TriMesh::default();
    let mut n_done = 0;
    for (place, line) in bytes.split_inclusive(|byte| *byte == b'\n').enumerate() {
        if place % LINES_AT_ONCE == 0 {
            control.at(n_done as f64 / bytes.len() as f64)?;
        }
        n_done += line.len();
        let text = str::from_utf8(line).map_err(|_| wrong(place + 1, "no text"))?;
        let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
        let numbers = numbers.ok().filter(|numbers| numbers.len() == 9);
        let numbers = numbers.ok_or_else(|| wrong(place + 1, "not nine numbers"))?;
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(numbers.chunks_exact(3).map(DVec3::from_slice));
        mesh.faces.push([0, 1, 2].map(|corner| VertexId(first + corner)));
    }
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use mve_core::testing::Trial;

    use super::*;

    #[test]
    fn loads_a_file_and_names_it_where_it_is_wrong() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.template");
        let load = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            Trial::of(&MODULE).set("path", path.to_str().unwrap()).run()
        };
        let outputs = load(EXAMPLE).unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!((mesh.faces.len(), mesh.area()), (2, 3.0 + 6.0));
        let message = load(b"0 0 0 1 0 0 0 1 0\n0 0 x\n").unwrap_err().to_string();
        assert!(message.contains("a.template: line 2 is not nine numbers"), "{message}");
        assert!(load(b"\xff\n").unwrap_err().to_string().contains("line 1 is no text"));
    }

    #[test]
    fn the_reader_hears_a_cancel() {
        let control = Control::new(&|_| ControlFlow::Break(()));
        assert!(matches!(read(EXAMPLE, control), Err(ReadError::Cancelled(_))));
    }
}
