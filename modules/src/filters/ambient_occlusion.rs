//! Measures how open each vertex is to the sky, for shading and to find hollows.
//!
//! Unlike MeshLab's, which draws pictures, it needs no GPU, and gives the same numbers on any
//! machine with any number of threads.

use mve_mesh::weld::finite_diagonal;

use crate::geometry::visibility::openness::{OpennessOptions, openness};
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh; both sides of its faces hide.");
const RAYS: Param<i64> = Param::integer(
    "rays",
    "Rays from each vertex, about; at least 4. Values are exact to about one over their number, \
     and take time by it.",
    128,
)
.between((1, 65_536))
.mostly((16, 1024))
.unit("rays");
const DISTANCE: Param<Option<f64>> = Param::maybe_number(
    "distance",
    "What is farther away hides nothing, as a share of the diagonal. Off: all hides.",
    None,
)
.within((0.0, 1e6))
.usually((0.0, 1.0));
const FIELD_OUT: Out<Field> = Out::new(
    "field",
    "The share of the sky above each vertex that is open, by the cosine to its normal: 1 on a \
     plane, 0 in a closed space.",
);

pub static MODULE: Module = Module {
    id: "AmbientOcclusion",
    summary: "Measures how much of the sky above each vertex the mesh itself hides.",
    inputs: &[MESH_IN.spec()],
    outputs: &[FIELD_OUT.spec()],
    params: &[RAYS.spec(), DISTANCE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let share = io.param(DISTANCE)?;
    let options = OpennessOptions {
        n_rays: io.param(RAYS)? as u32,
        distance: share.map_or(f64::INFINITY, |share| share * finite_diagonal(&mesh)),
    };
    let values = openness(&mesh, &options, io.control())?;
    let n_undefined = values.iter().filter(|value| value.is_nan()).count();
    if n_undefined > 0 {
        io.warn(format!("{n_undefined} of {} vertices have no normal", values.len()));
    }
    let (name, unit) = ("ambient occlusion".to_owned(), String::new());
    io.put(FIELD_OUT, Field { name, unit, domain: Domain::Vertex, values });
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::cube;

    use crate::prelude::*;

    #[test]
    fn a_cube_before_a_wall_and_too_far_from_it() {
        let mut mesh = cube(DVec3::ZERO);
        let wall = cube(DVec3::new(1.5, 0.0, 0.0));
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(wall.positions);
        let moved = |v: mve_mesh::data::VertexId| mve_mesh::data::VertexId(v.0 + first);
        mesh.faces.extend(wall.faces.iter().map(|face| face.map(moved)));
        let values = |trial: Trial| {
            let outputs = trial.run().unwrap();
            outputs["field"].get::<Field>().unwrap().values.clone()
        };
        let trial = || Trial::of(&super::MODULE).input("mesh", mesh.clone());
        let found = values(trial());
        // Vertex 0 looks away from the wall, a little of which vertex 1 sees.
        assert_eq!(found[0], 1.0);
        assert!((0.8..1.0).contains(&found[1]), "{}", found[1]);
        assert!(values(trial().set("distance", 0.1)).iter().all(|share| *share == 1.0));
        assert_eq!(values(trial().set("rays", 1)).len(), 16);
    }
}
