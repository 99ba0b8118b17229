//! Saves a mesh as a file of any format that mve writes, by the ending of its name.

use mve_formats::mesh_file::{self, Reader};

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh with finite coordinates.");
const PATH: Param<PathBuf> = Param::output_file(
    "path",
    "The file; its ending says the format. Textures go into a folder of its stem and -textures, \
     with PLY -ply-textures and with Open Inventor -iv-textures, materials of OBJ into an MTL file.",
    &mesh_file::WRITTEN,
)
.also_writes_with(&[
    ("obj", &["mtl", "-textures/"]),
    ("ply", &["-ply-textures/"]),
    ("iv", &["-iv-textures/"]),
]);

pub static MODULE: Module = Module {
    id: "MeshSaver",
    summary: "Saves a mesh as an OBJ, PLY, STL, OFF, glTF or Open Inventor file, by the ending of its \
              name, as the saver of the format does.",
    inputs: &[MESH_IN.spec()],
    outputs: &[],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, path) = (io.get(MESH_IN)?, io.param(PATH)?);
    let warnings = mesh_file::save(mesh, &path, Reader::Anybody, io.control())?;
    warnings.iter().for_each(|warning| io.warn(warning));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::Control;
    use mve_core::testing::Trial;
    use mve_formats::obj::FileScope;
    use mve_mesh::fixtures::tetrahedron;

    use super::*;

    #[test]
    fn every_ending_gives_a_file_that_loads() {
        let folder = tempfile::tempdir().unwrap();
        for ending in mesh_file::WRITTEN {
            let path = folder.path().join("a").with_extension(ending.to_uppercase());
            let trial = Trial::of(&MODULE).input("mesh", tetrahedron());
            trial.set("path", path.to_str().unwrap()).run().unwrap();
            let loaded = mesh_file::load(&path, FileScope::Folder, Control::none()).unwrap();
            let (mesh, warnings) = loaded;
            assert_eq!((mesh.positions.len(), mesh.area()), (4, tetrahedron().area()), "{ending}");
            assert_eq!(warnings, [], "{ending}");
        }
    }
}
