//! Saves a mesh as a binary glTF file.

use mve_formats::gltf;

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh with finite coordinates.");
const PATH: Param<PathBuf> =
    Param::output_file("path", "The file, with all textures in it.", &["glb"]);

pub static MODULE: Module = Module {
    id: "GltfSaver",
    summary: "Saves a mesh as a .glb file with its materials and textures, for viewers in browsers; \
              vertices with several normals, texture coordinates or colors are split.",
    inputs: &[MESH_IN.spec()],
    outputs: &[],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, path) = (io.get(MESH_IN)?, io.param(PATH)?);
    let warnings = gltf::save(&mesh, &path, io.control())?;
    warnings.iter().for_each(|warning| io.warn(warning));
    Ok(())
}
