//! Joins vertices that lie on each other.

use mve_mesh::weld::weld;

use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const TOLERANCE: Param<f64> = Param::number(
    "tolerance",
    "Vertices at most so far apart become one, as a part of the diagonal of the bounding box. 0: \
     those at one place.",
    0.0,
)
.within((0.0, 0.1))
.usually((0.0, 1e-4));
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with each place once: vertices and faces keep their order, vertices the layers of the \
     first at their place, corners their own. Faces whose corners became one are left out.",
);
const JOINED_OUT: Out<f64> = Out::new("joined", "Vertices that became another one.");

pub static MODULE: Module = Module {
    id: "Weld",
    summary: "Joins vertices that lie on each other, so that faces share them.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), JOINED_OUT.spec()],
    params: &[TOLERANCE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let welded = weld(&mesh, io.param(TOLERANCE)?, io.control())?;
    if welded.n_left_out > 0 {
        io.warn(format!("{} faces are left out, as their corners became one", welded.n_left_out));
    }
    io.put(MESH_OUT, welded.mesh);
    io.put(JOINED_OUT, welded.n_joined as f64);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::mesh_of;

    use crate::prelude::*;

    #[test]
    fn two_triangles_become_a_square() {
        let points = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0; 3],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        let mesh = mesh_of(&points, &[[0, 1, 2], [3, 4, 5]]);
        let outputs = Trial::of(&super::MODULE).input("mesh", mesh).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!((mesh.positions.len(), mesh.area()), (4, 1.0));
        assert_eq!(outputs["joined"].get::<f64>().as_deref(), Some(&2.0));
    }
}
