//! Loads an OFF file.

use mve_formats::load_with;
use mve_formats::off::read_off;

use crate::prelude::*;

/// A red square; `tests/contracts.rs` loads it, and damaged copies.
const EXAMPLE: &[u8] = b"OFF\n# a square\n4 1 4\n0 0 0\n2 0 0\n2 3 0\n0 3 0\n4 0 1 2 3 255 0 0\n";

const PATH: Param<PathBuf> =
    Param::input_file("path", "The file, packed by gzip or not.", &["off"]).example(EXAMPLE);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "Polygons as triangles, vertices in the file's order, with normals, colors and texture coordinates.",
);

pub static MODULE: Module = Module {
    id: "OffLoader",
    summary: "Loads a mesh from an OFF file, with normals and colors.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let (mesh, warnings) = load_with(&path, io.control(), read_off)?;
    for warning in warnings {
        io.warn(format!("{}: {warning}", path.display()));
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}
