//! Deletes the faces of a selection.

use crate::geometry::edit::rebuild::{Isolated, with_faces};
use crate::geometry::select::chosen::{CornerRule, chosen_faces};
use crate::prelude::*;

#[derive(Clone, Copy)]
enum Corners {
    All,
    Any,
    Most,
}

impl Enumeration for Corners {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("All", "All of its corners are."),
        ("Any", "One of its corners is."),
        ("Most", "Two of its corners are."),
    ];
    const VALUES: &'static [Self] = &[Self::All, Self::Any, Self::Most];
}

#[derive(Clone, Copy, PartialEq)]
enum Which {
    Selected,
    Others,
}

impl Enumeration for Which {
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("Selected", "Faces of the selection."), ("Others", "All others.")];
    const VALUES: &'static [Self] = &[Self::Selected, Self::Others];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const SELECTION_IN: In<Field> = In::new(
    "selection",
    "Its faces, or the vertices or corners that decide of them: 1 for those that are chosen, 0 for \
     others, as Select gives it.",
);
const CORNERS: Param<Corners> = Param::one_of(
    "corners",
    "When a face is chosen, where the selection is over vertices or corners.",
    "All",
);
const DELETE: Param<Which> = Param::one_of("delete", "What is deleted.", "Selected");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The faces that are left, in their order and with their layers; vertices that lose all of \
     their faces go.",
);
const DELETED_OUT: Out<f64> = Out::number(Quantity::new("deleted", "Faces that were deleted."));

pub static MODULE: Module = Module {
    id: "DeleteFaces",
    summary: "Deletes the faces of a selection, or all others.",
    inputs: &[MESH_IN.spec(), SELECTION_IN.spec()],
    outputs: &[MESH_OUT.spec(), DELETED_OUT.spec()],
    params: &[CORNERS.spec(), DELETE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, selection) = (io.get(MESH_IN)?, io.get(SELECTION_IN)?);
    let rule = match io.param(CORNERS)? {
        Corners::All => CornerRule::All,
        Corners::Any => CornerRule::Any,
        Corners::Most => CornerRule::Most,
    };
    let is = chosen_faces(&selection, &mesh, rule)
        .map_err(|message| ModuleError::input(&SELECTION_IN, message))?;
    let deletes = io.param(DELETE)? == Which::Selected;
    let found = with_faces(&mesh, |face| is[face] != deletes, Isolated::Kept, io.control())?;
    if found.faces.is_empty() && !mesh.faces.is_empty() {
        io.warn("nothing is left: all faces were deleted");
    }
    io.put(DELETED_OUT, (mesh.faces.len() - found.faces.len()) as f64);
    io.put(MESH_OUT, found);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::tetrahedron;

    use crate::prelude::*;

    fn trial(domain: Domain, values: &[f64]) -> Trial {
        let (name, unit) = ("selection".to_owned(), String::new());
        let selection = Field { name, unit, domain, values: values.to_vec() };
        Trial::of(&super::MODULE).input("mesh", tetrahedron()).input("selection", selection)
    }

    fn left(trial: Trial) -> Vec<[u32; 3]> {
        let outputs = trial.run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!(
            outputs["deleted"].get::<f64>().as_deref(),
            Some(&(4.0 - mesh.faces.len() as f64))
        );
        mesh.faces.iter().map(|face| face.map(|v| v.0)).collect()
    }

    #[test]
    fn chosen_faces_go_or_stay() {
        let run = |which: &str| {
            left(trial(Domain::Face, &[0.0, 1.0, f64::NAN, 0.0]).set("delete", which))
        };
        assert_eq!(run("Selected"), [[0, 2, 1], [0, 3, 2], [1, 2, 3]]);
        // Vertex 2 has no face then, and the last one takes its number.
        assert_eq!(run("Others"), [[0, 1, 2]]);
    }

    #[test]
    fn corners_decide_as_they_are_told_to() {
        let run = |corners: &str| {
            left(trial(Domain::Vertex, &[0.0, 1.0, 1.0, 0.0]).set("corners", corners)).len()
        };
        // The edge from 1 to 2 has two faces; the others have one of the two.
        assert_eq!((run("All"), run("Any"), run("Most")), (4, 0, 2));
    }

    #[test]
    fn what_does_not_fit_is_said() {
        let message = trial(Domain::Face, &[0.0]).run().unwrap_err().to_string();
        assert!(message.contains("1 values"), "{message}");
        assert!(trial(Domain::Face, &[1.0; 4]).log().unwrap()[0].contains("nothing is left"));
    }
}
