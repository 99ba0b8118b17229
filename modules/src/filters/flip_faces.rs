//! Reverses the orientation of faces.
//!
//! Positions stay as they are; the signed volume of a closed mesh changes sign. Normals point the
//! other way, so that shading goes with the faces.

use crate::geometry::edit::transform::{flipped, flipped_part};
use crate::geometry::select::chosen::{CornerRule, chosen_faces};
use crate::prelude::*;

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const SELECTION_IN: MaybeIn<Field> = MaybeIn::new(
    "selection",
    "The faces that are turned over, or vertices between which faces are; all without a link. \
     Normals are computed anew then.",
);
const MESH_OUT: Out<TriMesh> =
    Out::new("mesh", "The mesh with each face (a, b, c) as (a, c, b), and with opposite normals.");

pub static MODULE: Module = Module {
    id: "FlipFaces",
    summary: "Turns every face over, so that what was inside is outside.",
    inputs: &[MESH_IN.spec(), SELECTION_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    let flipped = match io.maybe(SELECTION_IN) {
        None => flipped(mesh, io.control())?,
        Some(selection) => {
            let chosen = chosen_faces(&selection, &mesh, CornerRule::All)
                .map_err(|why| ModuleError::maybe_input(&SELECTION_IN, why))?;
            flipped_part(mesh, &chosen, io.control())?
        }
    };
    io.put(MESH_OUT, flipped);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::{Trial, run_on};
    use mve_mesh::fixtures::tetrahedron;

    use crate::prelude::*;

    #[test]
    fn volume_changes_sign() {
        let flipped: TriMesh = run_on(&super::MODULE, tetrahedron());
        assert_eq!(flipped.signed_volume(), -tetrahedron().signed_volume());
    }

    #[test]
    fn only_selected_faces_turn() {
        let (name, unit) = ("s".to_owned(), String::new());
        let selection = Field { name, unit, domain: Domain::Face, values: vec![0., 1., 0., 0.] };
        let trial = Trial::of(&super::MODULE).input("mesh", tetrahedron());
        let outputs = trial.input("selection", selection).run().unwrap();
        let faces = outputs["mesh"].get::<TriMesh>().unwrap().faces.clone();
        assert_eq!(faces[1].map(|v| v.0), [0, 3, 1]);
        assert_eq!((faces[0], &faces[2..]), (tetrahedron().faces[0], &tetrahedron().faces[2..]));
    }
}
