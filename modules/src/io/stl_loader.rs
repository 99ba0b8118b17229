//! Loads an STL file.

use mve_formats::stl;

use crate::prelude::*;

/// Two triangles with a common side; `tests/contracts.rs` loads it, and damaged copies.
const EXAMPLE: &[u8] = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n\
    vertex 2 0 0\nvertex 0 3 0\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\n\
    vertex 2 0 0\nvertex 0 3 0\nvertex 0 0 4\nendloop\nendfacet\nendsolid a\n";

const PATH: Param<PathBuf> =
    Param::input_file("path", "The file, packed by gzip or not.", &["stl"]).example(EXAMPLE);
const MESH_OUT: Out<TriMesh> =
    Out::new("mesh", "The triangles; points of the same coordinates are one vertex.");

pub static MODULE: Module = Module {
    id: "StlLoader",
    summary: "Loads a mesh from an STL file, text or binary, and joins its triangles.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let (mesh, warnings) = stl::load(&path, io.control())?;
    for warning in warnings {
        io.warn(format!("{}: {warning}", path.display()));
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}
