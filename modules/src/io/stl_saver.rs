//! Saves the triangles of a mesh as an STL file.

use crate::formats::save_atomic;
use crate::formats::stl::{StlEncoding, write_stl};
use crate::prelude::*;

impl Enumeration for StlEncoding {
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("Binary", "Small: 50 bytes a triangle."), ("Ascii", "Text that a person can read.")];
    const VALUES: &'static [Self] = &[Self::Binary, Self::Ascii];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh with finite coordinates.");
const PATH: Param<PathBuf> = Param::output_file("path", "The file.", &["stl"]);
const ENCODING: Param<StlEncoding> =
    Param::one_of("encoding", "How numbers stand in the file.", "Binary");

pub static MODULE: Module = Module {
    id: "StlSaver",
    summary: "Saves the triangles of a mesh as an STL file, for printing; nothing else has a place.",
    inputs: &[MESH_IN.spec()],
    outputs: &[],
    params: &[PATH.spec(), ENCODING.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, path, encoding) = (io.get(MESH_IN)?, io.param(PATH)?, io.param(ENCODING)?);
    // A float has 24 bits: it tells points apart that are 2⁻²⁴ of their coordinates away.
    let farthest = mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let rounding = farthest * 2f64.powi(-24);
    if rounding > 1e-5 * mesh.diagonal() {
        io.warn(format!(
            "STL has floats, which round positions by up to {rounding:.3e}, {:.1e} of the mesh's \
             diagonal; move the mesh to the origin, or save it as PLY with Double",
            rounding / mesh.diagonal()
        ));
    }
    Ok(save_atomic(&path, |out| write_stl(&mesh, encoding, out, io.control()))?)
}
