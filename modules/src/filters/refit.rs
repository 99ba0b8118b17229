//! Fits a simplified mesh to its original.

use crate::geometry::distance::hausdorff::MeshRole;
use crate::geometry::simplify::refit::{RefitError, RefitOptions, needs, refit};
use crate::prelude::*;

use mve_core::Quantities;
use mve_mesh::data::Measure;

const MESH_IN: In<TriMesh> = In::new("mesh", "The mesh whose vertices move, of any origin.");
const ORIGINAL: In<TriMesh> = In::new("original", "The surface that it should lie on.");
const STEPS: Param<i64> = Param::integer(
    "steps",
    "How often nearest points are found and vertices moved; the first step does most.",
    RefitOptions::DEFAULT.n_steps as i64,
)
.between((0, 1000))
.mostly((1, 20));
const SAMPLES: Param<f64> = Param::number(
    "samples",
    "Points of the original in each step for each face of the mesh, at most four million in all; \
     more are slower and better.",
    RefitOptions::DEFAULT.samples_per_face,
)
.within((1.0, 1000.0))
.usually((3.0, 30.0));
const MESH_OUT: Out<TriMesh> = Out::new(
    "mesh",
    "The mesh with its vertices moved and attributes interpolated there; borders and seams stay.",
);
const RMS_BEFORE: Quantity = Quantity::new(
    "rms_before",
    "Root of the mean square of the distances of both surfaces, before.",
)
.titled("RMS before")
.in_unit(Unit::Model("model units"));
const RMS_AFTER: Quantity =
    Quantity::new("rms_after", "Root of the mean square of the distances of both surfaces, after.")
        .titled("RMS after")
        .in_unit(Unit::Model("model units"))
        .lower();
const MAX_BEFORE: Quantity = Quantity::new("max_before", "The largest of the distances, before.")
    .titled("maximum before")
    .in_unit(Unit::Model("model units"));
const MAX_AFTER: Quantity = Quantity::new("max_after", "The largest of the distances, after.")
    .titled("maximum after")
    .in_unit(Unit::Model("model units"))
    .lower();
const STATISTICS_OUT: Out<Measures> =
    Out::new("statistics", "Distances at the samples, which are fewer than MeshComparer takes.")
        .giving(Quantities::Row(&[RMS_BEFORE, RMS_AFTER, MAX_BEFORE, MAX_AFTER]));

pub static MODULE: Module = Module {
    id: "Refit",
    summary: "Moves the vertices of a simplified mesh so that it lies closer to its original.",
    inputs: &[MESH_IN.spec(), ORIGINAL.spec()],
    outputs: &[MESH_OUT.spec(), STATISTICS_OUT.spec()],
    params: &[STEPS.spec(), SAMPLES.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (mesh, original) = (io.get(MESH_IN)?, io.get(ORIGINAL)?);
    let options = RefitOptions {
        n_steps: io.param(STEPS)? as usize,
        samples_per_face: io.param(SAMPLES)?,
        ..RefitOptions::DEFAULT
    };
    io.reserve(needs(&mesh, &original))?;
    let fitted = refit(&mesh, &original, options, io.control()).map_err(|error| match error {
        RefitError::Cancelled(cancelled) => cancelled.into(),
        RefitError::NoSurface(MeshRole::Original) => {
            ModuleError::input(&ORIGINAL, error.to_string())
        }
        RefitError::NoSurface(MeshRole::Simplified) => {
            ModuleError::input(&MESH_IN, error.to_string())
        }
    })?;
    let (before, after) = (fitted.before, fitted.after.unwrap_or(fitted.before));
    io.put(MESH_OUT, fitted.mesh);
    io.put(
        STATISTICS_OUT,
        Measures(vec![
            Measure::of(&RMS_BEFORE, before.rms()),
            Measure::of(&RMS_AFTER, after.rms()),
            Measure::of(&MAX_BEFORE, before.max()),
            Measure::of(&MAX_AFTER, after.max()),
        ]),
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{mesh_of, torus};

    use crate::prelude::*;

    #[test]
    fn a_coarse_torus_comes_closer_to_a_fine_one() {
        let trial = Trial::of(&super::MODULE)
            .input("mesh", torus(2.0, 0.5, 12))
            .input("original", torus(2.0, 0.5, 96));
        let outputs = trial.run().unwrap();
        let found = outputs["statistics"].get::<Measures>().unwrap();
        let value = |name: &str| found.0.iter().find(|m| m.name == name).unwrap().value;
        // Inscribed, all of the surface lies within the torus; fitted, on both sides of it.
        assert!(value("rms_after") < 0.5 * value("rms_before"), "{found:?}");
        assert!(value("max_after") <= value("max_before"), "{found:?}");
    }

    #[test]
    fn an_original_without_faces_is_named() {
        let empty = mesh_of(&[], &[]);
        let trial = Trial::of(&super::MODULE).input("mesh", torus(2.0, 0.5, 6));
        let error = trial.input("original", empty).run().unwrap_err().to_string();
        assert!(error.contains("\"original\"") && error.contains("no face"), "{error}");
    }
}
