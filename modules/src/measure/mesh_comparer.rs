//! Measures how a simplified mesh differs from its original.

use crate::metric::{METRICS, MakeMetric, MeshRole, MetricError};
use crate::prelude::*;

const ORIGINAL_IN: In<TriMesh> = In::new("original", "The mesh to measure against.");
const SIMPLIFIED_IN: In<TriMesh> = In::new("simplified", "The mesh to measure.");
const METRIC: ChoiceParam<MakeMetric> =
    ChoiceParam::new("metric", "What to measure.", &METRICS, "Hausdorff");
const MEASURES_OUT: Out<Measures> =
    Out::new("measures", "All that the metric measured.").giving(METRIC.quantities());
const VALUE_OUT: Out<f64> =
    Out::new("value", "The first of the measures: the metric in one number.")
        .giving(METRIC.first_quantity());
const ORIGINAL_FIELD_OUT: Out<Field> = Out::new(
    "original_field",
    "The difference at each vertex or face of the original; empty if the metric has none.",
);
const SIMPLIFIED_FIELD_OUT: Out<Field> = Out::new(
    "simplified_field",
    "The difference at each vertex or face of the simplified mesh; empty if the metric has none.",
);

const ORIGINAL_IMAGES_OUT: Out<Images> =
    Out::new("original_images", "Pictures of the original; none if the metric takes none.");
const SIMPLIFIED_IMAGES_OUT: Out<Images> = Out::new(
    "simplified_images",
    "Pictures of the simplified mesh from the same cameras; none if the metric takes none.",
);
const DIFFERENCE_IMAGES_OUT: Out<Images> = Out::new(
    "difference_images",
    "How the pictures of the two differ, camera by camera; none if the metric takes none.",
);

pub static MODULE: Module = Module {
    id: "MeshComparer",
    summary: "Measures how a simplified mesh differs from its original.",
    inputs: &[ORIGINAL_IN.spec(), SIMPLIFIED_IN.spec()],
    outputs: &[
        MEASURES_OUT.spec(),
        VALUE_OUT.spec(),
        ORIGINAL_FIELD_OUT.spec(),
        SIMPLIFIED_FIELD_OUT.spec(),
        ORIGINAL_IMAGES_OUT.spec(),
        SIMPLIFIED_IMAGES_OUT.spec(),
        DIFFERENCE_IMAGES_OUT.spec(),
    ],
    params: &[METRIC.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (original, simplified) = (io.get(ORIGINAL_IN)?, io.get(SIMPLIFIED_IN)?);
    let chosen = io.choice(METRIC)?;
    let metric = (chosen.entry.build.make)(&chosen.params)?;
    io.reserve(metric.bytes(&original, &simplified))?;
    let found = metric.compare(&original, &simplified, io.control());
    let mut found = found.map_err(of_port)?;
    found.warnings.iter().for_each(|warning| io.warn(warning));
    let none = || Field {
        name: String::new(),
        unit: String::new(),
        domain: Domain::Vertex,
        values: Vec::new(),
    };
    io.put(VALUE_OUT, found.scalars.first().map_or(f64::NAN, |first| first.value));
    io.put(MEASURES_OUT, Measures(found.scalars));
    io.put(ORIGINAL_FIELD_OUT, found.original_fields.drain(..).next().unwrap_or_else(none));
    io.put(SIMPLIFIED_FIELD_OUT, found.simplified_fields.drain(..).next().unwrap_or_else(none));
    io.put(ORIGINAL_IMAGES_OUT, found.original_images);
    io.put(SIMPLIFIED_IMAGES_OUT, found.simplified_images);
    io.put(DIFFERENCE_IMAGES_OUT, found.difference_images);
    Ok(())
}

/// The error with the port that the mesh came in at.
fn of_port(error: MetricError) -> ModuleError {
    match error {
        MetricError::Input { mesh: MeshRole::Original, message } => {
            ModuleError::input(&ORIGINAL_IN, message)
        }
        MetricError::Input { mesh: MeshRole::Simplified, message } => {
            ModuleError::input(&SIMPLIFIED_IN, message)
        }
        MetricError::Param { name, message } => {
            ModuleError::Param { name: format!("{}.{name}", METRIC.spec().name), message }
        }
        MetricError::Failed(message) => ModuleError::Failed(message),
        MetricError::Cancelled(cancelled) => cancelled.into(),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::cube;

    use crate::prelude::*;

    #[test]
    fn a_moved_cube_is_as_far_as_it_was_moved() {
        let outputs = Trial::of(&super::MODULE)
            .input("original", cube(DVec3::ZERO))
            .input("simplified", cube(DVec3::new(0.25, 0.0, 0.0)))
            .run()
            .unwrap();
        let value = *outputs["value"].get::<f64>().unwrap();
        assert!((value - 0.25).abs() < 1e-12, "{value}");
        assert_eq!(outputs["measures"].get::<Measures>().unwrap().0[0].value, value);
        assert_eq!(outputs["simplified_field"].get::<Field>().unwrap().values.len(), 8);
    }

    #[test]
    fn a_mesh_that_cannot_be_measured_is_named_by_its_port() {
        let message = |original, simplified| {
            let trial = Trial::of(&super::MODULE).input("original", original);
            trial.input("simplified", simplified).run().unwrap_err().to_string()
        };
        let (full, empty) = (cube(DVec3::ZERO), TriMesh::default());
        let of_simplified = message(full.clone(), empty.clone());
        assert!(
            of_simplified.starts_with("input \"simplified\": the simplified mesh has no faces")
        );
        let of_original = message(empty, full);
        assert!(of_original.starts_with("input \"original\": the original mesh has no faces"));
    }
}
