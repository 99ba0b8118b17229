//! Perceptual distance of the two meshes, whatever their connectivity: MSDM2.
//!
//! See [`crate::geometry::perception::msdm2`] for the source, the rules and the departures.

use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::perception::warnings;
use super::{Comparison, MakeMetric, Metric, MetricError};
use crate::geometry::perception::msdm2::{MAX_LEVELS, Msdm2Options, Variant, msdm2};
use crate::prelude::*;

const DEFAULT: Msdm2Options = Msdm2Options::DEFAULT;

impl Enumeration for Variant {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Published", "As the published program computes it, for values to compare with others'."),
        ("Mended", "The same, but no rotation or order changes it, and borders bend as they do."),
    ];
    const VALUES: &'static [Self] = &[Self::Published, Self::Mended];
}

const LEVELS: Param<i64> = Param::integer(
    "levels",
    "How many sizes of windows, from the smallest: radii of 1, 1.5 and 2 % of the mesh.",
    DEFAULT.n_levels as i64,
)
.between((1, MAX_LEVELS as i64));
const VARIANT: Param<Variant> = Param::one_of("variant", "Which rules to follow.", "Published");
const SPREAD: Param<bool> = Param::flag(
    "spread",
    "Also say by how much the choice among equally near faces can move the value; takes three \
     times as long.",
    false,
);

const MSDM2: Quantity = Quantity::new("msdm2", "Mean of both directions, 0 for equal meshes.")
    .titled("MSDM2")
    .lower()
    .chief();
const ORIGINAL_MSDM2: Quantity = Quantity::new(
    "original_msdm2",
    "Over the vertices of the original: sees detail that is lost, and creases of the simplified \
     mesh that they lie near; its own larger faces there count as creases, so that a flat side in \
     fewer faces is not at 0.",
)
.titled("MSDM2, over the original")
.lower();
const SIMPLIFIED_MSDM2: Quantity = Quantity::new(
    "simplified_msdm2",
    "Over the vertices of the simplified mesh, as published: sees what is new or bent there, and \
     nothing of detail that has no vertex left; few well placed vertices give about 0.",
)
.titled("MSDM2, over the simplified mesh")
.lower();

const MSDM2_SPREAD: Quantity = Quantity::new(
    "msdm2_spread",
    "By how much the choice among equally near faces can move msdm2.",
)
.titled("Spread of MSDM2");

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "Msdm2",
    summary: "How different the meshes look, 0 for equal to about 1, by the statistics of their \
              curvature in small windows (Lavoué 2011).",
    params: &[LEVELS.spec(), VARIANT.spec(), SPREAD.spec()],
    build: MakeMetric {
        quantities: &[MSDM2, ORIGINAL_MSDM2, SIMPLIFIED_MSDM2, MSDM2_SPREAD],
        make,
    },
};

fn make(settings: &Settings) -> Result<Box<dyn Metric>, ModuleError> {
    let n_levels = settings.get(&LEVELS)? as usize;
    let (variant, has_spread) = (settings.get(&VARIANT)?, settings.get(&SPREAD)?);
    let options = Msdm2Options { n_levels, variant, has_spread };
    Ok(Box::new(Msdm2Metric { options }))
}

/// The metric with its options.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Msdm2Metric {
    /// How to measure.
    pub options: Msdm2Options,
}

impl Metric for Msdm2Metric {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let found = msdm2(original, simplified, &self.options, control)?;
        let (of_original, of_simplified) = (&found.from_original, &found.from_simplified);
        let mut scalars = vec![
            Measure::of(&MSDM2, found.symmetric()),
            Measure::of(&ORIGINAL_MSDM2, of_original.value),
            Measure::of(&SIMPLIFIED_MSDM2, of_simplified.value),
        ];
        if let Some(spread) = found.spread {
            scalars.push(Measure::of(&MSDM2_SPREAD, spread));
        }
        let warnings = warnings(&found, original, simplified);
        Ok(Comparison {
            scalars,
            warnings,
            original_fields: vec![found.from_original.local],
            simplified_fields: vec![found.from_simplified.local],
            ..Comparison::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{mesh_of, tetrahedron};

    use super::*;

    #[test]
    fn a_mesh_is_not_different_from_itself_and_a_lonely_vertex_is_named() {
        let mut mesh = tetrahedron();
        let metric = Msdm2Metric::default();
        let found = metric.compare(&mesh, &mesh, Control::none()).unwrap();
        assert!(found.scalar("msdm2").unwrap() < 1e-15);
        assert_eq!(found.warnings, [""; 0]);
        mesh.positions.push(glam::DVec3::ONE);
        let found = metric.compare(&tetrahedron(), &mesh, Control::none()).unwrap();
        assert!(found.scalar("msdm2").unwrap() < 1e-15);
        assert!(found.simplified_fields[0].values[4].is_nan());
        assert!(found.warnings[0].contains("1 vertices of the simplified mesh"));
    }

    #[test]
    fn what_cannot_be_measured_is_named() {
        let place = mesh_of(&[[1.0; 3]; 3], &[[0, 1, 2]]);
        for (mesh, words) in [(TriMesh::default(), "has no faces"), (place, "has no extent")] {
            let found = Msdm2Metric::default().compare(&tetrahedron(), &mesh, Control::none());
            let text = found.unwrap_err().to_string();
            assert!(text.contains("simplified mesh") && text.contains(words), "{text}");
        }
    }
}
