//! Loads a mesh file of any format that mve reads, by how the file begins.

use std::path::Path;

use mve_formats::mesh_file;
use mve_formats::obj::FileScope;

use crate::prelude::*;

const PATH: Param<PathBuf> = Param::input_file(
    "path",
    "The file: OBJ, PLY, STL, OFF, glTF or Open Inventor, packed by gzip or not. What it is is seen \
     from how it begins, not from its name.",
    &["obj", "ply", "stl", "off", "gltf", "glb", "iv", "wrl", "gz"],
)
.also_reads(mesh_file::companions);
const ALLOW_OUTSIDE: Param<bool> = Param::flag(
    "allow_outside",
    "Also read material files, buffers and textures that lie outside of the folder of the file. A file of a \
     stranger can name any file of this machine.",
    false,
);
const MESH_OUT: Out<TriMesh> =
    Out::new("mesh", "What the loader of the format gives, such as ObjLoader.");

pub static MODULE: Module = Module {
    id: "MeshLoader",
    summary: "Loads a mesh from an OBJ, PLY, STL, OFF, glTF or Open Inventor file, whatever its name.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[PATH.spec(), ALLOW_OUTSIDE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let scope = if io.param(ALLOW_OUTSIDE)? { FileScope::Anywhere } else { FileScope::Folder };
    let (mesh, warnings) = mesh_file::load(Path::new(&path), scope, io.control())?;
    for warning in warnings {
        io.warn(format!("{}: {warning}", path.display()));
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};
    use mve_core::Control;
    use mve_core::testing::Trial;
    use mve_formats::{gltf, iv, obj, off, ply, stl};
    use mve_mesh::fixtures::tetrahedron;

    use super::*;

    #[test]
    fn the_beginning_says_what_a_file_is() {
        let (mesh, control) = (tetrahedron(), Control::none());
        let mut files: Vec<Vec<u8>> = vec![Vec::new(); 8];
        obj::write_obj(&mesh, &mut files[0], None).unwrap();
        for (at, encoding) in [(1, ply::Encoding::Binary), (2, ply::Encoding::Ascii)] {
            let options = ply::PlyOptions { encoding, precision: ply::Precision::Double };
            ply::write_ply(&mesh, None, options, &mut files[at], control).unwrap();
        }
        stl::write_stl(&mesh, stl::StlEncoding::Binary, &mut files[3], control).unwrap();
        stl::write_stl(&mesh, stl::StlEncoding::Ascii, &mut files[4], control).unwrap();
        off::write_off(&mesh, &mut files[5], control).unwrap();
        gltf::write_glb(&mesh, &mut files[6], control).unwrap();
        iv::write_iv(&mesh, &[], &mut files[7], control).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("misnamed.obj");
        let commented = [b"# a comment\n\n".as_slice(), &files[5]].concat();
        for bytes in files.into_iter().chain([commented]) {
            let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
            packed.write_all(&bytes).unwrap();
            for bytes in [bytes, packed.finish().unwrap()] {
                std::fs::write(&path, bytes).unwrap();
                let outputs = Trial::of(&MODULE).set("path", path.to_str().unwrap()).run().unwrap();
                let loaded = outputs["mesh"].get::<TriMesh>().unwrap();
                assert_eq!((loaded.faces.len(), loaded.area()), (4, mesh.area()));
            }
        }
    }
}
