//! Puts meshes together as one.

use crate::geometry::edit::merge::merge;
use crate::prelude::*;

const MESH_IN: ManyIn<TriMesh> = ManyIn::new(
    "mesh",
    "Any triangle meshes, each where it lies; their elements come in the order of the links.",
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "All meshes, nothing joined: Weld does that. Layers of one name and kind are one; what only \
     some meshes have has no value in the others. Other materials and layers of a name that is \
     taken get a new name.",
);

pub static MODULE: Module = Module {
    id: "Merge",
    summary: "Puts any number of meshes together as one, with their layers and materials.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mut meshes: Vec<TriMesh> = io.take_all(MESH_IN)?;
    io.progress(0.0)?;
    let (mut made, n) = (0, meshes.len());
    // Two and two, so that no mesh is copied more often than the number of meshes has digits.
    while meshes.len() > 1 {
        let mut pairs = meshes.into_iter();
        let mut next = Vec::new();
        while let Some(first) = pairs.next() {
            io.progress(f64::from(made) / n as f64)?;
            let Some(second) = pairs.next() else {
                next.push(first);
                break;
            };
            let merged = merge(first, &second)
                .map_err(|error| ModuleError::inputs(&MESH_IN, error.to_string()))?;
            if !merged.renamed.is_empty() {
                io.warn(format!("renamed in a later mesh: {}", merged.renamed.join(", ")));
            }
            made += 1;
            next.push(merged.mesh);
        }
        meshes = next;
    }
    let merged = meshes.pop().unwrap_or_default();
    io.put(MESH_OUT, merged);
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{cube, tetrahedron};

    use crate::prelude::*;

    #[test]
    fn volumes_add_up() {
        let trial = Trial::of(&super::MODULE).input("mesh", tetrahedron());
        let outputs = trial.input("mesh", cube(DVec3::ONE)).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert!((mesh.signed_volume() - 7.0 / 6.0).abs() < 1e-14);
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (12, 16));
    }

    #[test]
    fn many_keep_their_order() {
        let moved = |x: f64| {
            let mut mesh = tetrahedron();
            mesh.positions.iter_mut().for_each(|p| p.x += x);
            mesh
        };
        let trial = |trial: Trial, i: i32| trial.input("mesh", moved(f64::from(i)));
        let outputs = (0..5).fold(Trial::of(&super::MODULE), trial).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        let first = tetrahedron().positions[0].x;
        let firsts: Vec<f64> = mesh.positions.iter().step_by(4).map(|p| p.x - first).collect();
        assert_eq!(firsts, [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(mesh.faces.len(), 20);
    }
}
