//! Saves a mesh as a PLY file, with colors and a field, to look at it in other programs.

use mve_formats::ply::{self, Encoding, PlyOptions, Precision};

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh with finite coordinates.");
const FIELD_IN: MaybeIn<Field> = MaybeIn::new(
    "field",
    "One number for each vertex or face of the mesh, written as the property \"quality\".",
);
const PATH: Param<PathBuf> = Param::output_file(
    "path",
    "The file; textures go into a folder of its stem and -ply-textures.",
    &["ply"],
)
.also_writes(&["-ply-textures/"]);
const ENCODING: Param<Encoding> =
    Param::one_of("encoding", "How numbers stand in the file.", "Binary");
const PRECISION: Param<Precision> =
    Param::one_of("precision", "How exact positions, normals and the field are.", "Float");

pub static MODULE: Module = Module {
    id: "PlySaver",
    summary: "Saves a mesh as a PLY file, with its colors, normals and a field; vertices with several \
              normals are split.",
    inputs: &[MESH_IN.spec(), FIELD_IN.spec()],
    outputs: &[],
    params: &[PATH.spec(), ENCODING.spec(), PRECISION.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, field, path) = (io.get(MESH_IN)?, io.maybe(FIELD_IN), io.param(PATH)?);
    let options = PlyOptions { encoding: io.param(ENCODING)?, precision: io.param(PRECISION)? };
    let warnings = ply::save(mesh, field, options, &path, io.control())?;
    warnings.iter().for_each(|warning| io.warn(warning));
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{cube, tetrahedron};

    use crate::geometry::surface::normals::{NormalWeight, corner_normal_layer};
    use crate::prelude::*;

    #[test]
    fn vertices_with_several_normals_are_split() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        let mut mesh = cube(glam::DVec3::ZERO);
        let control = mve_core::Control::none();
        mesh.set_layer(corner_normal_layer(&mesh, NormalWeight::Angle, 0.5, control).unwrap());
        let values = (0..8).map(f64::from).collect();
        let (name, unit, domain) = ("x".to_owned(), String::new(), Domain::Vertex);
        let field = Field { name, unit, domain, values };
        let trial = Trial::of(&super::MODULE).input("mesh", mesh).input("field", field);
        let trial = trial.set("encoding", "Ascii").set("path", path.to_str().unwrap());
        trial.run().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("element vertex 24\n"), "{text}");
        // The last vertex is the corner (1, 1, 1), with its number as the field.
        let vertices: Vec<&str> = text.lines().filter(|line| line.starts_with("1 1 1 ")).collect();
        assert_eq!(vertices.len(), 3);
        for normal in ["1 0 0", "0 1 0", "0 0 1"] {
            assert!(vertices.contains(&format!("1 1 1 {normal} 7").as_str()), "{vertices:?}");
        }
    }

    #[test]
    fn a_file_is_written_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        let save = |mesh| {
            let trial = Trial::of(&super::MODULE).input("mesh", mesh);
            trial.set("path", path.to_str().unwrap()).run()
        };
        save(tetrahedron()).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert!(bytes.starts_with(b"ply\nformat binary_little_endian 1.0\nelement vertex 4\n"));
        let mut broken = tetrahedron();
        broken.positions[3].z = f64::INFINITY;
        let message = save(broken).unwrap_err().to_string();
        assert!(message.contains("a.ply") && message.contains("vertex 3"), "{message}");
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
    }
}
