//! Smooths a surface.
//!
//! Faces and their order stay; only vertices move.

use mve_core::{Condition, brief};

use crate::geometry::relax::smooth::{SmoothMethod, SmoothOptions, smooth};
use crate::geometry::relax::weights::{Borders, EdgeWeight};
use crate::geometry::select::chosen::chosen_vertices;
use crate::prelude::*;

#[derive(Clone, Copy)]
enum Method {
    Laplace,
    Taubin,
    Implicit,
}

impl Enumeration for Method {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        (
            "Laplace",
            "Each vertex goes a share of the way to the mean of its neighbors: it shrinks.",
        ),
        (
            "Taubin",
            "A step forth and one back (Taubin 1995, λ|μ): bumps go, and the mesh hardly shrinks.",
        ),
        (
            "Implicit",
            "A long step of the diffusion at once, by a system of equations (Desbrun et al. 1999): \
             steady, however long.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Laplace, Self::Taubin, Self::Implicit];
}

impl Enumeration for EdgeWeight {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Uniform", "Each neighbor the same: triangles become even, and textures slide."),
        (
            "Cotangent",
            "By the angles across the edge: vertices move along normals and hardly slide. Weights \
             below 0 count as 0.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Uniform, Self::Cotangent];
}

impl Enumeration for Borders {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Fixed", "They stay where they are."),
        ("Curve", "They are smoothed along the border, as lines."),
        ("Free", "They are drawn to all of their neighbors, and the border shrinks."),
    ];
    const VALUES: &'static [Self] = &[Self::Fixed, Self::Curve, Self::Free];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const SELECTION_IN: MaybeIn<Field> = MaybeIn::new(
    "selection",
    "The vertices that move, or faces whose vertices do; all without a link. The others hold them.",
);
const METHOD: Param<Method> = Param::one_of("method", "How vertices move.", "Taubin");
const STEPS: Param<i64> =
    Param::integer("steps", "How many steps; 0 leaves the mesh as it is.", 10)
        .between((0, 100_000))
        .mostly((1, 100));
const LAMBDA: Param<f64> = Param::number(
    "lambda",
    "The share of the way to the mean of the neighbors, of Laplace and of the step forth of Taubin.",
    0.5,
)
.within((0.0, 1.0));
const MU: Param<f64> = Param::number(
    "mu",
    "The step back of Taubin; a little longer than the step forth, it keeps what is large. At 0.5 \
     and −0.53, waves of more than about 13 edges grow a little.",
    -0.53,
)
.within((-2.0, 0.0))
.usually((-1.0, 0.0))
.only_where(Condition::Is { param: "method", value: "Taubin" });
const STRENGTH: Param<f64> = Param::number(
    "strength",
    "Length of an implicit step: about that of as many steps of Laplace with a lambda of 1.",
    10.0,
)
.within((0.0, 1e6))
.usually((0.0, 100.0))
.only_where(Condition::Is { param: "method", value: "Implicit" });
const WEIGHT: Param<EdgeWeight> =
    Param::one_of("weight", "How much each neighbor counts.", "Uniform");
const BORDERS: Param<Borders> = Param::one_of(
    "borders",
    "What happens to vertices on edges of one face, or of more than two.",
    "Fixed",
);
const KEEP_VOLUME: Param<bool> = Param::flag(
    "keep_volume",
    "Whether a closed mesh is scaled back to its volume after each step, as a whole, around its \
     center of gravity.",
    false,
);
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with moved vertices, all else in its order. Normals are computed anew; which corners \
     share one stays.",
);

pub static MODULE: Module = Module {
    id: "Smooth",
    summary: "Smooths a surface: by Laplace, without shrinking (Taubin), or in long implicit steps.",
    inputs: &[MESH_IN.spec(), SELECTION_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[
        METHOD.spec(),
        STEPS.spec(),
        LAMBDA.spec(),
        MU.spec(),
        STRENGTH.spec(),
        WEIGHT.spec(),
        BORDERS.spec(),
        KEEP_VOLUME.spec(),
    ],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    let chosen = io.maybe(SELECTION_IN).map(|selection| chosen_vertices(&selection, &mesh));
    let chosen = chosen.transpose().map_err(|why| ModuleError::maybe_input(&SELECTION_IN, why))?;
    let lambda = io.param(LAMBDA)?;
    let options = SmoothOptions {
        method: match io.param(METHOD)? {
            Method::Laplace => SmoothMethod::Laplace { lambda },
            Method::Taubin => SmoothMethod::Taubin { lambda, mu: io.param(MU)? },
            Method::Implicit => SmoothMethod::Implicit { lambda: io.param(STRENGTH)? },
        },
        steps: io.param(STEPS)? as u32,
        weight: io.param(WEIGHT)?,
        borders: io.param(BORDERS)?,
        keeps_volume: io.param(KEEP_VOLUME)?,
    };
    let diagonal = mesh.diagonal();
    let found = smooth(mesh, &options, chosen.as_deref(), io.control())?;
    if !found.has_volume {
        io.warn(match chosen {
            None => "the mesh bounds no volume that could be kept: it is open, turned or flat",
            Some(_) => "the volume was not kept: that would move what is not selected",
        });
    }
    if !found.is_solved {
        io.warn("an implicit step was not solved to its end: a smaller strength helps");
    }
    warn_of_size(io, diagonal, found.mesh.diagonal());
    io.put(MESH_OUT, found.mesh);
    Ok(())
}

/// Says where a mesh grew beyond all bounds, or went to a point.
fn warn_of_size(io: &Io, before: f64, after: f64) {
    let times = after / before;
    if before > 0.0 && before.is_finite() && !(1e-2..10.0).contains(&times) {
        let what = if times < 1.0 { "shrank" } else { "grew" };
        io.warn(format!(
            "the mesh {what}: its diagonal is {} times that of before; fewer steps, or shorter \
             ones, keep its size",
            brief(times)
        ));
    }
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{mesh_of, tetrahedron};

    use crate::prelude::*;

    #[test]
    fn methods_and_lengths_are_heard() {
        let volume = |trial: Trial| {
            let outputs = trial.set("steps", 1).run().unwrap();
            outputs["mesh"].get::<TriMesh>().unwrap().signed_volume() * 6.0
        };
        let trial = || Trial::of(&super::MODULE).input("mesh", tetrahedron());
        // The mean of the others lies across the center, a third as far: each step scales.
        let factor = |share: f64| (1.0 - share * 4.0 / 3.0).powi(3);
        let is_near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        assert!(is_near(
            volume(trial().set("method", "Laplace").set("lambda", 0.25)),
            factor(0.25)
        ));
        let both = factor(0.25) * factor(-0.3);
        assert!(is_near(volume(trial().set("lambda", 0.25).set("mu", -0.3)), both));
        let implicit = trial().set("method", "Implicit").set("strength", 3.0);
        assert!(is_near(volume(implicit), 5.0_f64.powi(-3)));
        let kept = trial().set("method", "Laplace").set("lambda", 0.25).set("keep_volume", true);
        assert!(is_near(volume(kept), 1.0));
    }

    #[test]
    fn only_what_is_selected_moves() {
        let (name, unit) = ("s".to_owned(), String::new());
        let values = vec![0.0, 0.0, 0.0, 1.0];
        let selection = Field { name, unit, domain: Domain::Vertex, values };
        let trial = Trial::of(&super::MODULE).input("mesh", tetrahedron());
        let trial = trial.input("selection", selection).set("method", "Laplace").set("steps", 1);
        let outputs = trial.set("lambda", 0.5).run().unwrap();
        let mesh = outputs["mesh"].get::<TriMesh>().unwrap();
        assert_eq!(mesh.positions[..3], tetrahedron().positions[..3]);
        // Half way from (0, 0, 1) to the mean of the others.
        let expected = glam::DVec3::new(1.0 / 6.0, 1.0 / 6.0, 0.5);
        assert!(mesh.positions[3].distance(expected) < 1e-15);
    }

    #[test]
    fn a_volume_that_is_not_there_is_said() {
        let mesh = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
        let trial = Trial::of(&super::MODULE).input("mesh", mesh).set("keep_volume", true);
        assert!(trial.log().unwrap()[0].contains("no volume"));
    }
}
