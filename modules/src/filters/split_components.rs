//! Takes parts of a surface that hang together: the largest, one of them, or all large ones.

use mve_core::Condition;

use crate::geometry::edit::parts::{Connection, Largeness, parts};
use crate::geometry::edit::rebuild::{Isolated, with_faces};
use crate::prelude::*;

impl Enumeration for Connection {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Edge", "An edge that they share, whatever its number of faces."),
        ("Vertex", "A vertex that they share."),
    ];
    const VALUES: &'static [Self] = &[Self::Edge, Self::Vertex];
}

impl Enumeration for Largeness {
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("Faces", "The number of its faces."), ("Area", "Its area.")];
    const VALUES: &'static [Self] = &[Self::Faces, Self::Area];
}

#[derive(Clone, Copy)]
enum Takes {
    Largest,
    Nth,
    Faces,
    Share,
}

impl Enumeration for Takes {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Largest", "As many of the largest as are asked for."),
        ("Nth", "One alone, by its place among all, the largest first."),
        ("Faces", "All that have at least so many faces."),
        ("Share", "All that are at least so large, as a part of all of the mesh."),
    ];
    const VALUES: &'static [Self] = &[Self::Largest, Self::Nth, Self::Faces, Self::Share];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const CONNECTION: Param<Connection> =
    Param::one_of("connection", "What makes faces one component.", "Edge");
const LARGENESS: Param<Largeness> =
    Param::one_of("largeness", "What makes a component large.", "Faces");
const TAKE: Param<Takes> = Param::one_of("take", "Which components are taken.", "Largest");
const COUNT: Param<i64> = Param::integer("count", "How many of the largest.", 1)
    .between((1, 4_294_967_295))
    .mostly((1, 10))
    .only_where(Condition::Is { param: "take", value: "Largest" });
const PLACE: Param<i64> =
    Param::integer("place", "The place of the component; 1 is the largest.", 1)
        .between((1, 4_294_967_295))
        .mostly((1, 10))
        .only_where(Condition::Is { param: "take", value: "Nth" });
const FACES: Param<i64> = Param::integer("faces", "The fewest faces of a component.", 100)
    .between((0, 4_294_967_295))
    .mostly((1, 1000))
    .unit("faces")
    .only_where(Condition::Is { param: "take", value: "Faces" });
const SHARE: Param<f64> =
    Param::number("share", "The least part of all faces, or of the area of all.", 0.01)
        .within((0.0, 1.0))
        .only_where(Condition::Is { param: "take", value: "Share" });
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The components that are taken, in the order of the input and with its layers; vertices \
     without a face are left out.",
);
const REST_OUT: Out<TriMesh> = Out::new("rest", "All other components.");
const COMPONENTS_OUT: Out<f64> =
    Out::number(Quantity::new("components", "Components of the input."));
const TAKEN_OUT: Out<f64> = Out::number(Quantity::new("taken", "Components that are taken."));

pub static MODULE: Module = Module {
    id: "SplitComponents",
    summary: "Takes the largest components of a mesh, one of them, or those above a size.",
    inputs: &[MESH_IN.spec()],
    outputs: &[MESH_OUT.spec(), REST_OUT.spec(), COMPONENTS_OUT.spec(), TAKEN_OUT.spec()],
    params: &[
        CONNECTION.spec(),
        LARGENESS.spec(),
        TAKE.spec(),
        COUNT.spec(),
        PLACE.spec(),
        FACES.spec(),
        SHARE.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.get(MESH_IN)?;
    let control = io.control();
    let part = control.part(0.0, 0.5);
    let found = parts(&mesh, io.param(CONNECTION)?, io.param(LARGENESS)?, part)?;
    let n_components = found.sizes.len();
    let ranks = 0..n_components;
    let is_taken: Vec<bool> = match io.param(TAKE)? {
        Takes::Largest => {
            let count = io.param(COUNT)? as usize;
            ranks.map(|rank| rank < count).collect()
        }
        Takes::Nth => {
            let place = io.param(PLACE)? as usize;
            if place > n_components && n_components > 0 {
                let message = format!("there are {n_components} components, none at place {place}");
                return Err(ModuleError::param(&PLACE, message));
            }
            ranks.map(|rank| rank + 1 == place).collect()
        }
        Takes::Faces => {
            let mut n_faces = vec![0; n_components];
            found.of_faces.iter().for_each(|&rank| n_faces[rank as usize] += 1);
            let least = io.param(FACES)?;
            n_faces.iter().map(|n| *n >= least).collect()
        }
        Takes::Share => {
            let total: f64 = found.sizes.iter().sum();
            let least = io.param(SHARE)? * total;
            found.sizes.iter().map(|size| *size >= least).collect()
        }
    };
    let n_taken = is_taken.iter().filter(|is| **is).count();
    if n_taken == 0 && n_components > 0 {
        io.warn(format!("none of {n_components} components is taken"));
    }
    let is_of = |face: usize| is_taken[found.of_faces[face] as usize];
    let taken = with_faces(&mesh, is_of, Isolated::Removed, control.part(0.5, 0.75))?;
    let rest = with_faces(&mesh, |f| !is_of(f), Isolated::Removed, control.part(0.75, 1.0))?;
    io.put(MESH_OUT, taken);
    io.put(REST_OUT, rest);
    io.put(COMPONENTS_OUT, n_components as f64);
    io.put(TAKEN_OUT, n_taken as f64);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::mesh_of;

    use crate::prelude::*;

    /// A square of two small faces, and a large triangle.
    fn trial() -> Trial {
        let points = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [5.0, 0.0, 0.0],
            [9.0, 0.0, 0.0],
            [5.0, 4.0, 0.0],
        ];
        let mesh = mesh_of(&points, &[[4, 5, 6], [0, 1, 2], [0, 2, 3]]);
        Trial::of(&super::MODULE).input("mesh", mesh)
    }

    fn areas(trial: Trial) -> [f64; 2] {
        let outputs = trial.run().unwrap();
        ["mesh", "rest"].map(|name| outputs[name].get::<TriMesh>().unwrap().area())
    }

    #[test]
    fn components_are_taken_by_what_is_asked_for() {
        assert_eq!(areas(trial()), [1.0, 8.0]);
        assert_eq!(areas(trial().set("largeness", "Area")), [8.0, 1.0]);
        assert_eq!(areas(trial().set("count", 5)), [9.0, 0.0]);
        assert_eq!(areas(trial().set("take", "Nth").set("place", 2)), [8.0, 1.0]);
        assert_eq!(areas(trial().set("take", "Faces").set("faces", 2)), [1.0, 8.0]);
        let share = || trial().set("take", "Share").set("largeness", "Area");
        assert_eq!(areas(share().set("share", 0.2)), [8.0, 1.0]);
        assert_eq!(areas(share().set("share", 0.1)), [9.0, 0.0]);
    }

    #[test]
    fn a_place_that_is_not_there_and_an_empty_result_are_said() {
        let message = trial().set("take", "Nth").set("place", 3).run().unwrap_err().to_string();
        assert!(message.contains("there are 2 components"), "{message}");
        let lines = trial().set("take", "Faces").log().unwrap();
        assert!(lines[0].contains("none of 2 components"), "{lines:?}");
    }
}
