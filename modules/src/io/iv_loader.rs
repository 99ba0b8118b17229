//! Loads an Open Inventor file as one mesh.

use mve_formats::iv;
use mve_formats::obj::FileScope;

use crate::prelude::*;

/// A square that is used twice, once moved; `tests/contracts.rs` loads it, and damaged copies.
const EXAMPLE: &[u8] = b"#Inventor V2.1 ascii\nSeparator {\n  Material { diffuseColor 1 0 0 }\n  \
    DEF square Separator {\n    Coordinate3 { point [ 0 0 0, 2 0 0, 2 3 0, 0 3 0 ] }\n    \
    IndexedFaceSet { coordIndex [ 0, 1, 2, 3, -1 ] }\n  }\n  \
    Translation { translation 0 0 5 }\n  USE square\n}\n";

const PATH: Param<PathBuf> =
    Param::input_file("path", "The file, text, packed by gzip or not.", &["iv", "wrl"])
        .example(EXAMPLE)
        .also_reads(iv::companions);
const ALLOW_OUTSIDE: Param<bool> = Param::flag(
    "allow_outside",
    "Also read textures that lie outside of the folder of the file. A file of a stranger can name \
     any file of this machine.",
    false,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "Polygons and triangle strips where transforms put them, as one mesh of triangles, with \
     materials, colors, normals, texture coordinates and textures; a node that is used again is \
     there again.",
);

pub static MODULE: Module = Module {
    id: "IvLoader",
    summary: "Loads a mesh from an Open Inventor file (text of version 2.0 or 2.1, or VRML 1.0).",
    inputs: &[],
    outputs: &[MESH_OUT.spec()],
    params: &[PATH.spec(), ALLOW_OUTSIDE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let scope = if io.param(ALLOW_OUTSIDE)? { FileScope::Anywhere } else { FileScope::Folder };
    let (mesh, warnings) = iv::load(&path, scope, io.control())?;
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
    fn a_picture_beside_the_file_is_read_and_counts() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.iv");
        let text = str::from_utf8(EXAMPLE).unwrap();
        let text = text.replace("DEF square", "Texture2 { filename \"b.png\" } DEF square");
        std::fs::write(&path, text).unwrap();
        let mut png = Vec::new();
        image::RgbImage::new(2, 2)
            .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
            .unwrap();
        std::fs::write(folder.path().join("b.png"), png).unwrap();
        let outputs = Trial::of(&MODULE).set("path", path.to_str().unwrap()).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!((mesh.positions.len(), mesh.faces.len(), mesh.area()), (8, 4, 12.0));
        assert!(mesh.materials[0].textures[0].image.is_some());
        assert_eq!(iv::companions(&path), [folder.path().join("b.png")]);
    }
}
