//! Puts two meshes together as one.

use crate::geometry::edit::merge::merge;
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh; its elements come first.");
const OTHER_IN: In<TriMesh> = In::new("other", "Another one, where it lies.");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "Both meshes, nothing joined: Weld does that. Layers of one name and kind are one; what only \
     one mesh has has no value in the other. Other materials and layers of a name that is taken \
     get a new name.",
);

pub static MODULE: Module = Module {
    id: "Merge",
    summary: "Puts two meshes together as one, with the layers and materials of both.",
    inputs: &[MESH_IN.spec(), OTHER_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, other) = (io.take(MESH_IN)?, io.get(OTHER_IN)?);
    io.progress(0.0)?;
    let merged =
        merge(mesh, &other).map_err(|error| ModuleError::input(&OTHER_IN, error.to_string()))?;
    if !merged.renamed.is_empty() {
        io.warn(format!("renamed in the second mesh: {}", merged.renamed.join(", ")));
    }
    io.put(MESH_OUT, merged.mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;

    use crate::mesh::fixtures::{cube, tetrahedron};
    use crate::prelude::*;

    #[test]
    fn volumes_add_up() {
        let trial = Trial::of(&super::MODULE).input("mesh", tetrahedron());
        let outputs = trial.input("other", cube(DVec3::ONE)).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert!((mesh.signed_volume() - 7.0 / 6.0).abs() < 1e-14);
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (12, 16));
    }
}
