//! Saves a mesh as a Wavefront OBJ file with its materials.

use crate::formats::obj;
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const PATH: Param<PathBuf> = Param::output_file(
    "path",
    "The file. An MTL file of the same name is written beside it if the mesh has materials.",
    &["obj"],
)
.also_writes(&["mtl"]);

pub static MODULE: Module = Module {
    id: "ObjSaver",
    summary: "Saves a mesh as an OBJ file, with an MTL file if it has materials.",
    inputs: &[MESH_IN.spec()],
    outputs: &[],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, path) = (io.get(MESH_IN)?, io.param(PATH)?);
    Ok(obj::save(&mesh, &path, io.control())?)
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use crate::mesh::fixtures::tetrahedron;
    use mve_core::Control;

    #[test]
    fn what_is_saved_loads_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let name = path.to_str().unwrap();
        Trial::of(&super::MODULE).input("mesh", tetrahedron()).set("path", name).run().unwrap();
        let (mesh, _) = crate::formats::obj::load(&path, Control::none()).unwrap();
        assert_eq!(mesh, tetrahedron());
    }
}
