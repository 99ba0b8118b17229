//! Saves a mesh as an Open Inventor file.

use mve_formats::iv;

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh with finite coordinates.");
const PATH: Param<PathBuf> = Param::output_file(
    "path",
    "The file; textures go into a folder of its stem and -iv-textures.",
    &["iv"],
)
.also_writes(&["-iv-textures/"]);

pub static MODULE: Module = Module {
    id: "IvSaver",
    summary: "Saves a mesh as an Open Inventor 2.1 file: text, all digits, with normals, texture \
              coordinates, colors, materials and textures; no vertex is split.",
    inputs: &[MESH_IN.spec()],
    outputs: &[],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, path) = (io.get(MESH_IN)?, io.param(PATH)?);
    let warnings = iv::save(&mesh, &path, io.control())?;
    warnings.iter().for_each(|warning| io.warn(warning));
    Ok(())
}
