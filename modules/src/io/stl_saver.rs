//! Saves the triangles of a mesh as an STL file.

use mve_formats::stl::{self, StlEncoding};

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh with finite coordinates.");
const PATH: Param<PathBuf> = Param::output_file("path", "The file.", &["stl"]);
const ENCODING: Param<StlEncoding> =
    Param::one_of("encoding", "How numbers stand in the file.", "Binary");

pub static MODULE: Module = Module {
    id: "StlSaver",
    summary: "Saves the triangles of a mesh as an STL file, for printing; nothing else has a place.",
    inputs: &[MESH_IN.spec()],
    outputs: &[],
    params: &[PATH.spec(), ENCODING.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, path, encoding) = (io.get(MESH_IN)?, io.param(PATH)?, io.param(ENCODING)?);
    let warnings = stl::save(&mesh, encoding, &path, io.control())?;
    warnings.iter().for_each(|warning| io.warn(warning));
    Ok(())
}
