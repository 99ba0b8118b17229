//! Loads a Wavefront OBJ file with its materials and textures.

use mve_formats::obj::{self, FileScope};

use crate::prelude::*;

const PATH: Param<PathBuf> =
    Param::input_file("path", "The file.", &["obj"]).also_reads(obj::companions);
const ALLOW_OUTSIDE: Param<bool> = Param::flag(
    "allow_outside",
    "Also read material files and textures that lie outside of the folder of the file. A file of a \
     stranger can name any file of this machine.",
    false,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "All of the file as one mesh, vertices in its order; polygons are cut into triangles, texture \
     coordinates and normals belong to corners, objects, groups, materials and smoothing groups to \
     faces.",
);

pub static MODULE: Module = Module {
    id: "ObjLoader",
    summary: "Loads a mesh from an OBJ file, with the MTL files that it names and their textures.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[PATH.spec(), ALLOW_OUTSIDE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let scope = if io.param(ALLOW_OUTSIDE)? { FileScope::Anywhere } else { FileScope::Folder };
    let loaded = obj::load_within(&path, scope, io.control());
    let (mesh, warnings) = loaded.map_err(|error| error.about(&path))?;
    for warning in warnings {
        io.warn(format!("{}: {warning}", path.display()));
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use mve_mesh::data::TriMesh;

    #[test]
    fn loads_a_file_and_names_it_where_it_is_wrong() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let load = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Trial::of(&super::MODULE).set("path", path.to_str().unwrap()).run()
        };
        let outputs = load("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        assert_eq!(outputs["mesh"].get::<TriMesh>().unwrap().area(), 0.5);
        let message = load("v 0 0 0\nf 1 2 3\n").unwrap_err().to_string();
        assert!(message.contains("a.obj: line 2:"), "{message}");
    }
}
