//! Perceptual distance of two meshes of one connectivity: MSDM, the ancestor of MSDM2.
//!
//! See [`crate::geometry::perception::msdm`] for the source, the choices and the departures.

use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::perception::warnings;
use super::{Comparison, MakeMetric, Metric, MetricError};
use crate::geometry::perception::msdm::{MsdmOptions, msdm};
use crate::prelude::*;

const DEFAULT: MsdmOptions = MsdmOptions::DEFAULT;

const WINDOW_RADIUS: Param<f64> = Param::number(
    "window_radius",
    "Radius of the windows over the longest side of the box of the original.",
    DEFAULT.window_radius,
)
.within((1e-6, 1.0))
.usually((0.002, 0.05));
const CURVATURE_RADIUS: Param<f64> = Param::number(
    "curvature_radius",
    "Radius within which curvature is measured, over the same side.",
    DEFAULT.curvature_radius,
)
.within((1e-6, 1.0))
.usually((0.001, 0.02));

const MSDM: Quantity = Quantity::new("msdm", "Mean of both directions, 0 for equal meshes.")
    .titled("MSDM")
    .lower()
    .chief();
const ORIGINAL_MSDM: Quantity = Quantity::new("original_msdm", "Windows on the original.")
    .titled("MSDM, over the original")
    .lower();
const SIMPLIFIED_MSDM: Quantity =
    Quantity::new("simplified_msdm", "Windows on the simplified mesh.")
        .titled("MSDM, over the simplified mesh")
        .lower();
const BY_INDEX: Quantity =
    Quantity::new("by_index", "1 where vertices corresponded by index, 0 where by nearest points.");

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "Msdm",
    summary: "How different two meshes with the same faces look, 0 for equal to about 1, by their \
              curvature in small windows (Lavoué et al. 2006); other meshes correspond by nearest \
              points.",
    params: &[WINDOW_RADIUS.spec(), CURVATURE_RADIUS.spec()],
    build: MakeMetric { quantities: &[MSDM, ORIGINAL_MSDM, SIMPLIFIED_MSDM, BY_INDEX], make },
};

fn make(settings: &Settings) -> Result<Box<dyn Metric>, ModuleError> {
    let options = MsdmOptions {
        window_radius: settings.get(&WINDOW_RADIUS)?,
        curvature_radius: settings.get(&CURVATURE_RADIUS)?,
    };
    Ok(Box::new(MsdmMetric { options }))
}

/// The metric with its options.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MsdmMetric {
    /// How to measure.
    pub options: MsdmOptions,
}

impl Metric for MsdmMetric {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let found = msdm(original, simplified, &self.options, control)?;
        let both = found.both;
        let scalars = vec![
            Measure::of(&MSDM, both.symmetric()),
            Measure::of(&ORIGINAL_MSDM, both.from_original.value),
            Measure::of(&SIMPLIFIED_MSDM, both.from_simplified.value),
            Measure::of(&BY_INDEX, f64::from(u8::from(found.is_by_index))),
        ];
        Ok(Comparison {
            scalars,
            warnings: warnings(&both, original, simplified),
            original_fields: vec![both.from_original.local],
            simplified_fields: vec![both.from_simplified.local],
            ..Comparison::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::tetrahedron;

    use super::*;

    #[test]
    fn the_first_measure_is_the_value() {
        let mesh = tetrahedron();
        let found = MsdmMetric::default().compare(&mesh, &mesh, Control::none()).unwrap();
        assert_eq!((found.scalars[0].name.as_ref(), found.scalar("by_index")), ("msdm", Some(1.0)));
        assert!(found.scalars[0].value < 1e-9);
        assert_eq!(found.original_fields[0].name, "msdm");
    }
}
