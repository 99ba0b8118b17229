//! Deletes faces by the values of a field.

use crate::geometry::edit::rebuild::{Isolated, with_faces};
use crate::prelude::*;

#[derive(Clone, Copy)]
enum Corners {
    All,
    Any,
    Mean,
}

impl Enumeration for Corners {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("All", "All of its corners are in the range."),
        ("Any", "One of its corners is."),
        ("Mean", "The mean of its corners is."),
    ];
    const VALUES: &'static [Self] = &[Self::All, Self::Any, Self::Mean];
}

#[derive(Clone, Copy, PartialEq)]
enum Which {
    InRange,
    OutOfRange,
}

impl Enumeration for Which {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("InRange", "Faces in the range."),
        ("OutOfRange", "All others, those whose value is not a number among them."),
    ];
    const VALUES: &'static [Self] = &[Self::InRange, Self::OutOfRange];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const FIELD_IN: In<Field> = In::new("field", "One number for each vertex, corner or face of it.");
const LOW: Param<Option<f64>> =
    Param::maybe_number("low", "Lower end of the range, which belongs to it. Off: none.", None);
const HIGH: Param<Option<f64>> =
    Param::maybe_number("high", "Upper end of the range, which belongs to it. Off: none.", None);
const CORNERS: Param<Corners> = Param::one_of(
    "corners",
    "When a face is in the range, where the field is over vertices or corners.",
    "All",
);
const DELETE: Param<Which> = Param::one_of("delete", "What is deleted.", "InRange");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The faces that are left, in their order and with their layers; vertices that lose all of \
     their faces go.",
);
const DELETED_OUT: Out<f64> = Out::number(Quantity::new("deleted", "Faces that were deleted."));

pub static MODULE: Module = Module {
    id: "DeleteFaces",
    summary: "Deletes the faces on which a field is in a range, or all others.",
    inputs: &[MESH_IN.spec(), FIELD_IN.spec()],
    outputs: &[MESH_OUT.spec(), DELETED_OUT.spec()],
    params: &[LOW.spec(), HIGH.spec(), CORNERS.spec(), DELETE.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, field) = (io.get(MESH_IN)?, io.get(FIELD_IN)?);
    field.check_fits(&mesh).map_err(|message| ModuleError::input(&FIELD_IN, message))?;
    let low = io.param(LOW)?.unwrap_or(f64::NEG_INFINITY);
    let high = io.param(HIGH)?.unwrap_or(f64::INFINITY);
    if low > high {
        let message = format!("the range from {low} to {high} holds nothing");
        return Err(ModuleError::param(&LOW, message));
    }
    let is_in = |value: f64| low <= value && value <= high;
    let corners = io.param(CORNERS)?;
    let of_corners = |values: [f64; 3]| match corners {
        Corners::All => values.iter().all(|value| is_in(*value)),
        Corners::Any => values.iter().any(|value| is_in(*value)),
        Corners::Mean => is_in(values.iter().sum::<f64>() / 3.0),
    };
    let is_face_in = |face: usize| match field.domain {
        Domain::Face => is_in(field.values[face]),
        Domain::Corner => of_corners([0, 1, 2].map(|k| field.values[3 * face + k])),
        Domain::Vertex => of_corners(mesh.faces[face].map(|v| field.values[v.idx()])),
    };
    let deletes_in = io.param(DELETE)? == Which::InRange;
    let is_kept = |face: usize| is_face_in(face) != deletes_in;
    let found = with_faces(&mesh, is_kept, Isolated::Kept, io.control())?;
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

    use crate::mesh::fixtures::tetrahedron;
    use crate::prelude::*;

    fn trial(domain: Domain, values: &[f64]) -> Trial {
        let (name, unit) = ("height".to_owned(), String::new());
        let field = Field { name, unit, domain, values: values.to_vec() };
        Trial::of(&super::MODULE).input("mesh", tetrahedron()).input("field", field)
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
    fn values_of_faces_decide() {
        let values = [0.0, 1.0, f64::NAN, 3.0];
        let run = |which: &str| {
            left(trial(Domain::Face, &values).set("low", 1.0).set("high", 2.0).set("delete", which))
        };
        assert_eq!(run("InRange"), [[0, 2, 1], [0, 3, 2], [1, 2, 3]]);
        // Vertex 2 has no face then, and the last one takes its number.
        assert_eq!(run("OutOfRange"), [[0, 1, 2]]);
    }

    #[test]
    fn corners_decide_as_they_are_told_to() {
        // Face sums: 0 2 1 → 5, 0 1 3 → 1, 0 3 2 → 4, 1 2 3 → 5.
        let run = |corners: &str| {
            let trial = trial(Domain::Vertex, &[0.0, 1.0, 4.0, 0.0]).set("low", 1.0);
            left(trial.set("corners", corners)).len()
        };
        assert_eq!((run("All"), run("Any"), run("Mean")), (4, 0, 1));
    }

    #[test]
    fn what_does_not_fit_is_said() {
        let message = trial(Domain::Face, &[0.0]).run().unwrap_err().to_string();
        assert!(message.contains("1 values"), "{message}");
        let turned = trial(Domain::Face, &[0.0; 4]).set("low", 2.0).set("high", 1.0);
        assert!(turned.run().unwrap_err().to_string().contains("holds nothing"));
        assert!(trial(Domain::Face, &[0.0; 4]).log().unwrap()[0].contains("nothing is left"));
    }
}
