//! Moves every vertex along z. Say what the module does, and what a caller cannot see.
//!
//! Name the source of an algorithm here: authors, title, venue, year, and every deviation.

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const HEIGHT: Param<f64> = Param::number("height", "How far, in model units.", 1.0);
const MESH_OUT: Out<TriMesh> = Out::new("mesh", "The mesh, moved.");

pub static MODULE: Module = Module {
    id: "Template",
    summary: "Moves every vertex along z.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[HEIGHT.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mut mesh, height) = (io.take(MESH_IN)?, io.param(HEIGHT)?);
    for position in &mut mesh.positions {
        position.z += height;
    }
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::run_on;
    use mve_mesh::fixtures::tetrahedron;

    use super::*;

    #[test]
    fn every_vertex_moves() {
        let moved: TriMesh = run_on(&MODULE, tetrahedron());
        for (new, old) in moved.positions.iter().zip(&tetrahedron().positions) {
            assert_eq!((new.x, new.y, new.z), (old.x, old.y, old.z + 1.0));
        }
    }
}
