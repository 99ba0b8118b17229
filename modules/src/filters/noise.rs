//! Moves vertices at random, to try how a method stands noise.

use mve_mesh::weld::finite_diagonal;

use crate::geometry::relax::noise::{NoiseDirection, NoiseOptions, Spread, add_noise, mean_edge};
use crate::geometry::select::chosen::chosen_vertices;
use crate::prelude::*;

impl Enumeration for NoiseDirection {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Normal", "Along the normal, out or in; a vertex without a normal stays."),
        ("All", "In all directions alike; vertices at one place stay together."),
    ];
    const VALUES: &'static [Self] = &[Self::Normal, Self::All];
}

impl Enumeration for Spread {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Uniform", "All distances up to the amplitude alike, or all points of a ball."),
        ("Gaussian", "By the normal distribution; the amplitude is its standard deviation."),
    ];
    const VALUES: &'static [Self] = &[Self::Uniform, Self::Gaussian];
}

#[derive(Clone, Copy)]
enum NoiseScale {
    Edge,
    Diagonal,
}

impl Enumeration for NoiseScale {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Edge", "The mean length of the edges."),
        ("Diagonal", "The diagonal of the bounding box."),
    ];
    const VALUES: &'static [Self] = &[Self::Edge, Self::Diagonal];
}

const MESH_IN: In<TriMesh> = In::new("mesh", "Any triangle mesh.");
const SELECTION_IN: MaybeIn<Field> = MaybeIn::new(
    "selection",
    "The vertices that move, or faces whose vertices do; all without a link.",
);
const SEED: Param<Seed> = Param::seed("seed", "What the random numbers start from.", 0);
const AMPLITUDE: Param<f64> =
    Param::number("amplitude", "How far vertices move, as a part of the scale.", 0.1)
        .within((0.0, 1e6))
        .usually((0.0, 1.0));
const SCALE: Param<NoiseScale> = Param::one_of("scale", "What the amplitude is a part of.", "Edge");
const DIRECTION: Param<NoiseDirection> =
    Param::one_of("direction", "Where vertices move.", "Normal");
const SPREAD: Param<Spread> = Param::one_of("spread", "How distances are spread.", "Uniform");
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with moved vertices, all else in its order, and normals computed anew. How a vertex \
     moves depends on its place and the seed alone, not on its number.",
);

pub static MODULE: Module = Module {
    id: "Noise",
    summary: "Moves vertices at random, along their normals or in all directions.",
    inputs: &[MESH_IN.spec(), SELECTION_IN.spec()],
    outputs: &[MESH_OUT.spec()],
    params: &[SEED.spec(), AMPLITUDE.spec(), SCALE.spec(), DIRECTION.spec(), SPREAD.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let mesh = io.take(MESH_IN)?;
    let chosen = io.maybe(SELECTION_IN).map(|selection| chosen_vertices(&selection, &mesh));
    let chosen = chosen.transpose().map_err(|why| ModuleError::maybe_input(&SELECTION_IN, why))?;
    let control = io.control();
    let scale = match io.param(SCALE)? {
        NoiseScale::Edge => mean_edge(&mesh, control.part(0.0, 0.4))?,
        NoiseScale::Diagonal => finite_diagonal(&mesh),
    };
    let options = NoiseOptions {
        seed: io.param(SEED)?.0,
        amplitude: io.param(AMPLITUDE)? * scale,
        direction: io.param(DIRECTION)?,
        spread: io.param(SPREAD)?,
    };
    let mesh = add_noise(mesh, &options, chosen.as_deref(), control.part(0.4, 1.0))?;
    io.put(MESH_OUT, mesh);
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::mesh_of;

    use crate::prelude::*;

    /// A triangle with sides of 3, 4 and 5, so that the mean edge is 4 and the diagonal 5.
    #[test]
    fn the_amplitude_is_a_part_of_the_scale() {
        let mesh = mesh_of(&[[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[[0, 1, 2]]);
        let heights = |trial: Trial| -> Vec<f64> {
            let outputs = trial.run().unwrap();
            outputs["mesh"].get::<TriMesh>().unwrap().positions.iter().map(|p| p.z).collect()
        };
        let trial = || Trial::of(&super::MODULE).input("mesh", mesh.clone());
        let by_edge = heights(trial());
        assert!(by_edge.iter().all(|z| z.abs() <= 0.4) && by_edge.iter().any(|z| z.abs() > 0.01));
        let by_diagonal = heights(trial().set("scale", "Diagonal"));
        for (one, two) in by_edge.iter().zip(&by_diagonal) {
            assert!((two - 1.25 * one).abs() < 1e-15);
        }
        assert_ne!(heights(trial().set("seed", 1)), by_edge);
        assert_eq!(heights(trial().set("amplitude", 0.0)), [0.0; 3]);
        let (name, unit) = ("s".to_owned(), String::new());
        let values = vec![0.0, 1.0, 0.0];
        let selection = Field { name, unit, domain: Domain::Vertex, values };
        let expected = [0.0, by_edge[1], 0.0];
        assert_eq!(heights(trial().input("selection", selection)), expected);
    }
}
