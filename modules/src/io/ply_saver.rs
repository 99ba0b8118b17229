//! Saves a mesh as a PLY file, with colors and a field, to look at it in other programs.

use crate::formats::ply::{Encoding, PlyOptions, Precision, write_ply};
use crate::formats::save_atomic;
use crate::prelude::*;

impl Enumeration for Encoding {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Binary", "Small and exact: binary, the lowest byte first."),
        ("Ascii", "Text that a person can read."),
    ];
    const VALUES: &'static [Self] = &[Self::Binary, Self::Ascii];
}

impl Enumeration for Precision {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Float", "32 bits, 7 digits: what viewers expect."),
        ("Double", "64 bits: nothing is lost, but not every viewer reads it."),
    ];
    const VALUES: &'static [Self] = &[Self::Float, Self::Double];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh with finite coordinates.");
const FIELD_IN: MaybeIn<Field> = MaybeIn::new(
    "field",
    "One number for each vertex or face of the mesh, written as the property \"quality\".",
);
const PATH: Param<PathBuf> = Param::output_file("path", "The file.", &["ply"]);
const ENCODING: Param<Encoding> =
    Param::one_of("encoding", "How numbers stand in the file.", "Binary");
const PRECISION: Param<Precision> =
    Param::one_of("precision", "How exact positions, normals and the field are.", "Float");

pub static MODULE: Module = Module {
    id: "PlySaver",
    summary: "Saves a mesh as a PLY file, with its colors, normals and a field.",
    inputs: &[MESH_IN.spec(), FIELD_IN.spec()],
    outputs: &[],
    params: &[PATH.spec(), ENCODING.spec(), PRECISION.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, field, path) = (io.get(MESH_IN)?, io.maybe(FIELD_IN), io.param(PATH)?);
    let options = PlyOptions { encoding: io.param(ENCODING)?, precision: io.param(PRECISION)? };
    let is_over_corners = |name| mesh.layer(name).is_some_and(|l| l.domain == Domain::Corner);
    for name in [Layer::NORMAL, Layer::COLOR, Layer::TEXCOORD] {
        if is_over_corners(name) {
            io.warn(format!("layer \"{name}\" is over corners and is left out of the file"));
        }
    }
    // A float has 24 bits: it tells points apart that are 2⁻²⁴ of their coordinates away.
    let farthest = mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let rounding = farthest * 2f64.powi(-24);
    if options.precision == Precision::Float && rounding > 1e-5 * mesh.diagonal() {
        io.warn(format!(
            "floats round positions by up to {rounding:.3e}, which is {:.1e} of the mesh's \
             diagonal; set precision to Double, or move the mesh to the origin",
            rounding / mesh.diagonal()
        ));
    }
    let write = |out: &mut dyn std::io::Write| {
        write_ply(&mesh, field.as_deref(), options, out, io.control())
    };
    Ok(save_atomic(&path, write)?)
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;

    use crate::mesh::fixtures::tetrahedron;

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
