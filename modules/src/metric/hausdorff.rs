//! Distances between the two surfaces: Hausdorff, mean and RMS, both ways.
//!
//! See [`crate::geometry::distance::hausdorff`] for how they are measured and what is guaranteed.

use mve_core::{Control, Entry};

use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::data::Measure;
use crate::geometry::distance::hausdorff::{
    Directed, Hausdorff, HausdorffError, HausdorffOptions, hausdorff,
};
use crate::prelude::*;

/// Unit of lengths.
const LENGTH: &str = "model units";
/// Unit of lengths over the diagonal of the original's box, and of counts.
const NONE: &str = "";

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
    "The maximum is searched until it is known within this part of the diagonal of the original. \
     Off: the maximum is the largest of the samples.",
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

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "Hausdorff",
    summary: "Distances between the two surfaces in both directions: maximum, mean and RMS.",
    params: &[SAMPLES.spec(), SEED.spec(), TOLERANCE.spec(), EDGE_SAMPLES.spec()],
    build,
};

fn build(settings: &Settings) -> Result<Box<dyn Metric>, ModuleError> {
    let options = HausdorffOptions {
        n_samples: settings.get(&SAMPLES)?.map(|n| n as usize),
        seed: settings.get(&SEED)?.0,
        max_tolerance: settings.get(&TOLERANCE)?,
        n_edge_samples: settings.get(&EDGE_SAMPLES)? as usize,
        ..DEFAULT
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
    let relative =
        |value: f64| if found.diagonal > 0.0 { value / found.diagonal } else { f64::NAN };
    let mut scalars = Vec::with_capacity(18);
    let mut put = |name, value, unit, doc| scalars.push(Measure::new(name, value, unit, doc));
    let both = found;
    put("max", both.max(), LENGTH, "Hausdorff distance: the larger maximum of both directions.");
    put("rms", both.rms(), LENGTH, "The larger root mean square distance of both directions.");
    put("max_relative", relative(both.max()), NONE, "max over the diagonal of the original.");
    put("rms_relative", relative(both.rms()), NONE, "rms over the diagonal of the original.");
    put("mean", both.mean(), LENGTH, "The larger mean distance of both directions.");
    put("mean_relative", relative(both.mean()), NONE, "mean over the diagonal of the original.");
    if let Some(bound) = both.max_upper_bound() {
        put("max_upper_bound", bound, LENGTH, "No point of either surface is farther than this.");
    }
    let Directed { max, mean, rms, n_samples, .. } = found.from_original;
    put("original_max", max, LENGTH, "Largest distance of the original from the simplified.");
    put("original_mean", mean, LENGTH, "Mean of that distance over the area of the original.");
    put("original_rms", rms, LENGTH, "Root mean square over the area of the original.");
    put("original_samples", n_samples as f64, NONE, "Area samples on the original.");
    let Directed { max, mean, rms, n_samples, .. } = found.from_simplified;
    put("simplified_max", max, LENGTH, "Largest distance of the simplified from the original.");
    put("simplified_mean", mean, LENGTH, "Mean of that distance over the simplified's area.");
    put("simplified_rms", rms, LENGTH, "Root mean square over the simplified's area.");
    put("simplified_samples", n_samples as f64, NONE, "Area samples on the simplified mesh.");
    put("diagonal", found.diagonal, LENGTH, "Diagonal of the box of the original.");
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
    use super::*;
    use crate::mesh::fixtures::{mesh_of, tetrahedron};

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
}
