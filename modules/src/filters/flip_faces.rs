//! Reverses the orientation of every face.
//!
//! Positions stay as they are; the signed volume of a closed mesh changes sign. Normals point the
//! other way, so that shading goes with the faces.

use crate::geometry::edit::transform::flipped;
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const MESH_OUT: Out<TriMesh> =
    Out::new("mesh", "The mesh with each face (a, b, c) as (a, c, b), and with opposite normals.");

pub static MODULE: Module = Module {
    id: "FlipFaces",
    summary: "Turns every face over, so that what was inside is outside.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    io.put(MESH_OUT, flipped(mesh, io.control())?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::run_on;

    use crate::mesh::fixtures::tetrahedron;
    use crate::prelude::*;

    #[test]
    fn volume_changes_sign() {
        let flipped: TriMesh = run_on(&super::MODULE, tetrahedron());
        assert_eq!(flipped.signed_volume(), -tetrahedron().signed_volume());
    }
}
