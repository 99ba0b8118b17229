//! Loads a glTF file, text or binary, as one mesh.

use mve_formats::gltf::{self, Vertices};
use mve_formats::obj::FileScope;

use crate::prelude::*;

/// A triangle and its mirror image, with indices in the file; `tests/contracts.rs` loads it, and
/// damaged copies.
const EXAMPLE: &[u8] = br#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"a","mesh":0,"children":[1]},{"name":"b","mesh":0,"scale":[-1,1,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":1},"indices":0}]}],
"buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA="}],
"bufferViews":[{"buffer":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}]}"#;

const PATH: Param<PathBuf> = Param::input_file(
    "path",
    "The file. Buffers and pictures are in it or in files beside it.",
    &["gltf", "glb"],
)
.example(EXAMPLE)
.also_reads(gltf::companions);
const WELD: Param<bool> = Param::flag(
    "weld",
    "Join the vertices of a node that lie at one place. A vertex of glTF has one normal and one \
     texture coordinate, so files repeat vertices along seams, and without this the surface is \
     open there.",
    true,
);
const ALLOW_OUTSIDE: Param<bool> = Param::flag(
    "allow_outside",
    "Also read buffers and textures that lie outside of the folder of the file. A file of a stranger \
     can name any file of this machine.",
    false,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The meshes of all nodes of the scene where they stand, as one mesh: triangles, strips and \
     fans, with normals, colors, texture coordinates, materials and their pictures. Each node with \
     a name is an object.",
);

pub static MODULE: Module = Module {
    id: "GltfLoader",
    summary: "Loads a mesh from a glTF 2.0 file (.gltf or .glb) with its materials and textures.",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[PATH.spec(), WELD.spec(), ALLOW_OUTSIDE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let scope = if io.param(ALLOW_OUTSIDE)? { FileScope::Anywhere } else { FileScope::Folder };
    let vertices = if io.param(WELD)? { Vertices::Welded } else { Vertices::AsInFile };
    let (mesh, warnings) = gltf::load(&path, scope, vertices, io.control())?;
    for warning in warnings {
        io.warn(format!("{}: {warning}", path.display()));
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use super::*;

    #[test]
    fn files_beside_are_read_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gltf");
        let text = str::from_utf8(EXAMPLE).unwrap();
        let start = text.find("data:").unwrap();
        let end = start + text[start..].find('"').unwrap();
        std::fs::write(&path, text.replace(&text[start..end], "a%20b.bin")).unwrap();
        let load = || Trial::of(&MODULE).set("path", path.to_str().unwrap()).run();
        let message = load().unwrap_err().to_string();
        assert!(message.contains("buffer 0 is in a b.bin"), "{message}");
        let numbers = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let mut bytes = [0_u16, 1, 2, 0].map(u16::to_le_bytes).concat();
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        std::fs::write(folder.path().join("a b.bin"), bytes).unwrap();
        let mesh = load().unwrap()["mesh"].get::<TriMesh>().unwrap();
        assert_eq!((mesh.positions.len(), mesh.faces.len(), mesh.area()), (6, 2, 1.0));
        assert_eq!(gltf::companions(&path), [folder.path().join("a b.bin")]);
    }
}
