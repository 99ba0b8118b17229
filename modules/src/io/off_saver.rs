//! Saves a mesh as an OFF file.

use crate::formats::off::write_off;
use crate::formats::save_atomic;
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
    for name in [Layer::NORMAL, Layer::TEXCOORD, Layer::MATERIAL] {
        if mesh.layer(name).is_some() {
            io.warn(format!("the layer \"{name}\" has no place in the file and is left out"));
        }
    }
    Ok(save_atomic(&path, |out| write_off(&mesh, out, io.control()))?)
}
