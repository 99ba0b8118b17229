//! Distances between the two surfaces: Hausdorff, mean and RMS, both ways.
//!
//! See [`crate::geometry::distance::hausdorff`] for how they are measured and what is guaranteed.

use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::geometry::distance::hausdorff::{
    Directed, Hausdorff, HausdorffError, HausdorffOptions, hausdorff,
};
use crate::prelude::*;

const MAX: Quantity =
    Quantity::new("max", "Hausdorff distance: the larger maximum of both directions.")
        .titled("Hausdorff distance")
        .in_unit(Unit::LENGTH)
        .lower();
const RMS: Quantity =
    Quantity::new("rms", "The larger root mean square distance of both directions.")
        .titled("RMS distance")
        .in_unit(Unit::LENGTH)
        .lower();
const MAX_RELATIVE: Quantity =
    Quantity::new("max_relative", "max over the diagonal of the original.")
        .titled("Hausdorff distance / diagonal")
        .lower()
        .chief();
const RMS_RELATIVE: Quantity =
    Quantity::new("rms_relative", "rms over the diagonal of the original.")
        .titled("RMS distance / diagonal")
        .lower()
        .chief();
const MEAN: Quantity = Quantity::new("mean", "The larger mean distance of both directions.")
    .titled("Mean distance")
    .in_unit(Unit::LENGTH)
    .lower();
const MEAN_RELATIVE: Quantity =
    Quantity::new("mean_relative", "mean over the diagonal of the original.")
        .titled("Mean distance / diagonal")
        .lower();
const MAX_UPPER_BOUND: Quantity =
    Quantity::new("max_upper_bound", "No point of either surface is farther than this.")
        .titled("Upper bound of the Hausdorff distance")
        .in_unit(Unit::LENGTH)
        .lower();
const ORIGINAL_MAX: Quantity =
    Quantity::new("original_max", "Largest distance of the original from the simplified.")
        .titled("Maximum from the original")
        .in_unit(Unit::LENGTH)
        .lower();
const ORIGINAL_MEAN: Quantity =
    Quantity::new("original_mean", "Mean of that distance over the area of the original.")
        .titled("Mean from the original")
        .in_unit(Unit::LENGTH)
        .lower();
const ORIGINAL_RMS: Quantity =
    Quantity::new("original_rms", "Root mean square over the area of the original.")
        .titled("RMS from the original")
        .in_unit(Unit::LENGTH)
        .lower();
const ORIGINAL_SAMPLES: Quantity =
    Quantity::new("original_samples", "Area samples on the original.");
const SIMPLIFIED_MAX: Quantity =
    Quantity::new("simplified_max", "Largest distance of the simplified from the original.")
        .titled("Maximum from the simplified")
        .in_unit(Unit::LENGTH)
        .lower();
const SIMPLIFIED_MEAN: Quantity =
    Quantity::new("simplified_mean", "Mean of that distance over the simplified's area.")
        .titled("Mean from the simplified")
        .in_unit(Unit::LENGTH)
        .lower();
const SIMPLIFIED_RMS: Quantity =
    Quantity::new("simplified_rms", "Root mean square over the simplified's area.")
        .titled("RMS from the simplified")
        .in_unit(Unit::LENGTH)
        .lower();
const SIMPLIFIED_SAMPLES: Quantity =
    Quantity::new("simplified_samples", "Area samples on the simplified mesh.");
const DIAGONAL: Quantity = Quantity::new("diagonal", "Diagonal of the box of the original.")
    .titled("Diagonal of the original")
    .in_unit(Unit::LENGTH);

/// In the order in which they are to be read.
const QUANTITIES: &[Quantity] = &[
    MAX,
    RMS,
    RMS_RELATIVE,
    MAX_RELATIVE,
    MEAN,
    MEAN_RELATIVE,
    MAX_UPPER_BOUND,
    ORIGINAL_MAX,
    ORIGINAL_MEAN,
    ORIGINAL_RMS,
    ORIGINAL_SAMPLES,
    SIMPLIFIED_MAX,
    SIMPLIFIED_MEAN,
    SIMPLIFIED_RMS,
    SIMPLIFIED_SAMPLES,
    DIAGONAL,
];

const DEFAULT: HausdorffOptions = HausdorffOptions::DEFAULT;

const SAMPLES: Param<Option<i64>> = Param::maybe_integer(
    "samples",
    "Area samples on each mesh, for mean and RMS. Off: ten a face of the larger mesh, from \
     100,000 to 2,000,000.",
    None,
)
.between((1, 1_000_000_000))
.mostly((10_000, 10_000_000));
const SEED: Param<Seed> =
    Param::seed("seed", "Chooses among sets of samples.", DEFAULT.seed as u32);
const TOLERANCE: Param<Option<f64>> = Param::maybe_number(
    "tolerance",
    "The maximum is searched until it is known within this part of itself; max_upper_bound says \
     how well it is known. Off: the maximum is the largest of the samples.",
    DEFAULT.max_tolerance,
)
.within((1e-9, 1.0))
.usually((1e-6, 1e-2));
const EDGE_SAMPLES: Param<i64> = Param::integer(
    "edge_samples",
    "Samples along the edges of each mesh, for the maximum where it is not searched.",
    DEFAULT.n_edge_samples as i64,
)
.between((0, 1_000_000_000))
.mostly((0, 10_000_000));

const MAX_PARTS: Param<i64> = Param::integer(
    "max_parts",
    "Parts of faces that the search for the maximum may look at on each mesh, beyond all faces and \
     their quarters. Where that is not enough, max_upper_bound says how well it is known; more \
     take more time and memory.",
    DEFAULT.max_parts as i64,
)
.between((0, 1_000_000_000))
.mostly((100_000, 10_000_000));

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "Hausdorff",
    summary: "Distances between the two surfaces in both directions: maximum, mean and RMS.",
    params: &[SAMPLES.spec(), SEED.spec(), TOLERANCE.spec(), EDGE_SAMPLES.spec(), MAX_PARTS.spec()],
    build: MakeMetric { quantities: QUANTITIES, make },
};

fn make(settings: &Settings) -> Result<Box<dyn Metric>, ModuleError> {
    let options = HausdorffOptions {
        n_samples: settings.get(&SAMPLES)?.map(|n| n as usize),
        seed: settings.get(&SEED)?.0,
        max_tolerance: settings.get(&TOLERANCE)?,
        n_edge_samples: settings.get(&EDGE_SAMPLES)? as usize,
        max_parts: settings.get(&MAX_PARTS)? as usize,
    };
    Ok(Box::new(HausdorffMetric { options }))
}

/// The metric with its options.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HausdorffMetric {
    /// How finely to measure.
    pub options: HausdorffOptions,
}

impl Metric for HausdorffMetric {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let found = hausdorff(original, simplified, &self.options, control).map_err(of_metric)?;
        Ok(Comparison {
            scalars: scalars(&found),
            warnings: warnings(&found),
            original_fields: vec![found.original_distance],
            simplified_fields: vec![found.simplified_distance],
            ..Comparison::default()
        })
    }
}

fn of_metric(error: HausdorffError) -> MetricError {
    let message = error.to_string();
    match error {
        HausdorffError::NoFaces(mesh) | HausdorffError::NothingFinite(mesh, _) => {
            MetricError::Input { mesh, message }
        }
        HausdorffError::Cancelled(cancelled) => MetricError::Cancelled(cancelled),
    }
}

fn scalars(found: &Hausdorff) -> Vec<Measure> {
    // Nothing is no part of anything, also where all lies in one place.
    let relative = |value: f64| match value {
        0.0 => 0.0,
        _ if found.diagonal > 0.0 => value / found.diagonal,
        _ => f64::NAN,
    };
    let mut scalars = Vec::with_capacity(QUANTITIES.len());
    let mut put = |quantity: Quantity, value| scalars.push(Measure::of(&quantity, value));
    let both = found;
    put(MAX, both.max());
    put(RMS, both.rms());
    put(RMS_RELATIVE, relative(both.rms()));
    put(MAX_RELATIVE, relative(both.max()));
    put(MEAN, both.mean());
    put(MEAN_RELATIVE, relative(both.mean()));
    if let Some(bound) = both.max_upper_bound() {
        put(MAX_UPPER_BOUND, bound);
    }
    let Directed { max, mean, rms, n_samples, .. } = found.from_original;
    put(ORIGINAL_MAX, max);
    put(ORIGINAL_MEAN, mean);
    put(ORIGINAL_RMS, rms);
    put(ORIGINAL_SAMPLES, n_samples as f64);
    let Directed { max, mean, rms, n_samples, .. } = found.from_simplified;
    put(SIMPLIFIED_MAX, max);
    put(SIMPLIFIED_MEAN, mean);
    put(SIMPLIFIED_RMS, rms);
    put(SIMPLIFIED_SAMPLES, n_samples as f64);
    put(DIAGONAL, found.diagonal);
    scalars
}

fn warnings(found: &Hausdorff) -> Vec<String> {
    let sides = [
        (MeshRole::Original, found.n_left_out_original, found.from_original.n_samples),
        (MeshRole::Simplified, found.n_left_out_simplified, found.from_simplified.n_samples),
    ];
    let mut warnings = Vec::new();
    for (side, n_left_out, n_samples) in sides {
        if n_left_out > 0 {
            warnings.push(format!(
                "{n_left_out} faces of the {side} mesh have coordinates that are not finite and \
                 were left out"
            ));
        }
        if n_samples == 0 {
            warnings.push(format!(
                "the {side} mesh has no area; its mean and RMS are over its vertices"
            ));
        }
    }
    warnings
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::fixtures::{mesh_of, tetrahedron, torus};
    use serde_json::json;

    use super::*;
    use crate::registry;

    #[test]
    fn two_squares_at_a_quarter_of_their_diagonal() {
        let square = |z: f64| {
            mesh_of(
                &[[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]],
                &[[0, 1, 2], [0, 2, 3]],
            )
        };
        let found = HausdorffMetric::default()
            .compare(&square(0.0), &square(2f64.sqrt() / 4.0), Control::none())
            .unwrap();
        for name in ["max_relative", "mean_relative", "rms_relative"] {
            assert!((found.scalar(name).unwrap() - 0.25).abs() < 1e-12, "{name}");
        }
        assert_eq!(found.original_fields[0].values.len(), 4);
        assert_eq!(found.warnings, [""; 0]);
    }

    #[test]
    fn an_empty_mesh_is_named() {
        let error = HausdorffMetric::default()
            .compare(&tetrahedron(), &TriMesh::default(), Control::none())
            .unwrap_err();
        assert!(error.to_string().contains("simplified mesh has no faces"), "{error}");
    }

    #[test]
    fn more_parts_bound_the_maximum_better() {
        let (fine, coarse) = (torus(2.0, 0.5, 20), torus(2.02, 0.45, 13));
        let gap = |max_parts: f64| {
            let trial = Trial::of(registry().find("MeshComparer").unwrap().module);
            let params = json!({ "Hausdorff": { "max_parts": max_parts, "tolerance": 1e-6 } });
            let trial = trial.set("metric", params).input("original", fine.clone());
            let outputs = trial.input("simplified", coarse.clone()).run().unwrap();
            let measures = outputs["measures"].get::<Measures>().unwrap();
            let of = |name| measures.0.iter().find(|measure| measure.name == name).unwrap().value;
            of("max_upper_bound") - of("max")
        };
        let [none, many] = [gap(0.0), gap(1e6)];
        assert!(none > 10.0 * many && many >= 0.0, "{none} {many}");
    }
}
