//! Saves a mesh as an OFF file.

use mve_formats::off;

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh with finite coordinates.");
const PATH: Param<PathBuf> = Param::output_file("path", "The file.", &["off"]);

pub static MODULE: Module = Module {
    id: "OffSaver",
    summary: "Saves a mesh as an OFF file: text, all digits, with colors of vertices or faces.",
    inputs: &[MESH_IN.spec()],
    outputs: &[],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, path) = (io.get(MESH_IN)?, io.param(PATH)?);
    let warnings = off::save(&mesh, &path, io.control())?;
    warnings.iter().for_each(|warning| io.warn(warning));
    Ok(())
}
