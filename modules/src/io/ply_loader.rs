//! Loads a PLY file with all that it says of vertices and faces.

use mve_formats::obj::FileScope;
use mve_formats::ply;
use mve_mesh::data::LayerValues;

use crate::prelude::*;

/// A square of two colors; `tests/contracts.rs` loads it, and damaged copies.
const EXAMPLE: &[u8] = b"ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\n\
    property float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 255 0 0 0.5\n2 0 0 255 0 0 1\n2 3 0 0 0 255 1.5\n0 3 0 0 0 255 2\n4 0 1 2 3\n";

const PATH: Param<PathBuf> =
    Param::input_file("path", "The file, packed by gzip or not.", &["ply"])
        .example(EXAMPLE)
        .also_reads(ply::companions);
const FIELD: Param<String> = Param::text(
    "field",
    "The property of vertices or faces that goes to the port `field`.",
    "quality",
);
const ALLOW_OUTSIDE: Param<bool> = Param::flag(
    "allow_outside",
    "Also read textures that lie outside of the folder of the file. A file of a stranger can name \
     any file of this machine.",
    false,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "Polygons and triangle strips as triangles, vertices in the file's order, with normals, colors, \
     texture coordinates and textures; other properties that are one number are layers of their \
     names.",
);
const FIELD_OUT: Out<Field> =
    Out::new("field", "The property that `field` names; no value where the file has none.");

pub static MODULE: Module = Module {
    id: "PlyLoader",
    summary: "Loads a mesh from a PLY file, text or binary, with any properties.",
    inputs: &[],
    outputs: &[MESH_OUT.spec(), FIELD_OUT.spec()],
    params: &[PATH.spec(), FIELD.spec(), ALLOW_OUTSIDE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let scope = if io.param(ALLOW_OUTSIDE)? { FileScope::Anywhere } else { FileScope::Folder };
    let (mesh, warnings) = ply::load(&path, scope, io.control())?;
    for warning in warnings {
        io.warn(format!("{}: {warning}", path.display()));
    }
    let name = io.param(FIELD)?;
    let layer = mesh.layer(&name).filter(|layer| matches!(layer.values, LayerValues::Number(_)));
    let field = match layer {
        Some(Layer { domain, values: LayerValues::Number(values), index, .. }) => {
            let value = |at: &u32| values.get(*at as usize).copied().unwrap_or(f64::NAN);
            let values = index.iter().map(value).collect();
            Field { name, unit: String::new(), domain: *domain, values }
        }
        _ => Field { name, unit: String::new(), domain: Domain::Vertex, values: Vec::new() },
    };
    io.put(MESH_OUT, mesh);
    io.put(FIELD_OUT, field);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use super::*;

    #[test]
    fn a_property_is_a_field_and_a_picture_beside_the_file_a_material() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        let text = str::from_utf8(EXAMPLE).unwrap().replace("a square", "TextureFile b.png");
        std::fs::write(&path, text).unwrap();
        let mut png = Vec::new();
        image::RgbImage::new(2, 2)
            .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
            .unwrap();
        std::fs::write(folder.path().join("b.png"), png).unwrap();
        let outputs = Trial::of(&MODULE).set("path", path.to_str().unwrap()).run().unwrap();
        let field = outputs["field"].get::<Field>().unwrap();
        assert_eq!((field.domain, &field.values[..]), (Domain::Vertex, &[0.5, 1.0, 1.5, 2.0][..]));
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!((mesh.faces.len(), mesh.area()), (2, 6.0));
        let texture = &mesh.materials[0].textures[0];
        assert!(texture.name == "b.png" && texture.image.is_some(), "{texture:?}");
        assert_eq!(mesh.layer(Layer::MATERIAL).unwrap().index, [0, 0]);
        assert_eq!(ply::companions(&path), [folder.path().join("b.png")]);
    }
}
