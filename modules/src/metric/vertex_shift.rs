//! How far the vertices of the original moved: the error of simplification by clustering.
//!
//! See [`crate::geometry::distance::vertex_shift`] for what corresponds to what. Relative to the
//! diagonal of the box of the original a shift is at most 1 where vertices stay within the box.

use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::{Comparison, MakeMetric, Metric, MetricError};
use crate::geometry::distance::vertex_shift::{ShiftError, vertex_shift};
use crate::prelude::*;

const MEAN_RELATIVE: Quantity = Quantity::new(
    "mean_relative",
    "Mean way of a vertex of the original to its vertex of the simplified mesh, over the diagonal \
     of the original.",
)
.titled("Mean vertex shift / diagonal")
.lower()
.chief();
const MAX_RELATIVE: Quantity =
    Quantity::new("max_relative", "The longest such way over the diagonal of the original.")
        .titled("Largest vertex shift / diagonal")
        .lower()
        .chief();
const SUM_RELATIVE: Quantity =
    Quantity::new("sum_relative", "All such ways together over the diagonal of the original.")
        .titled("Sum of vertex shifts / diagonal")
        .lower();
const MEAN: Quantity = Quantity::new("mean", "Mean way of a vertex of the original to its vertex.")
    .titled("Mean vertex shift")
    .in_unit(Unit::LENGTH)
    .lower();
const MAX: Quantity = Quantity::new("max", "The longest such way.")
    .titled("Largest vertex shift")
    .in_unit(Unit::LENGTH)
    .lower();
const BY_INDEX: Quantity = Quantity::new(
    "by_index",
    "1 where vertices corresponded by index, 0 where each to the nearest one.",
);
const DIAGONAL: Quantity = Quantity::new("diagonal", "Diagonal of the box of the original.")
    .titled("Diagonal of the original")
    .in_unit(Unit::LENGTH);

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "VertexShift",
    summary: "How far the vertices of the original moved: to the nearest vertex of the simplified \
              mesh, or to that of the same index where both have the same faces.",
    params: &[],
    build: MakeMetric {
        quantities: &[MEAN_RELATIVE, MAX_RELATIVE, SUM_RELATIVE, MEAN, MAX, BY_INDEX, DIAGONAL],
        make: |_| Ok(Box::new(VertexShiftMetric)),
    },
};

/// See the file's header. Has no parameters.
#[derive(Clone, Copy, Debug)]
struct VertexShiftMetric;

impl Metric for VertexShiftMetric {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let found = vertex_shift(original, simplified, control).map_err(of_metric)?;
        // Nothing is no part of anything, also where all lies in one place.
        let relative = |value: f64| if value == 0.0 { 0.0 } else { value / found.diagonal };
        let n = found.n_vertices as f64;
        let scalars = vec![
            Measure::of(&MEAN_RELATIVE, relative(found.mean)),
            Measure::of(&MAX_RELATIVE, relative(found.max)),
            Measure::of(&SUM_RELATIVE, relative(found.mean * n)),
            Measure::of(&MEAN, found.mean),
            Measure::of(&MAX, found.max),
            Measure::of(&BY_INDEX, f64::from(u8::from(found.is_by_index))),
            Measure::of(&DIAGONAL, found.diagonal),
        ];
        let n_alone = original.positions.len() - found.n_vertices;
        let warnings = match n_alone {
            0 => Vec::new(),
            n => vec![format!(
                "{n} vertices of the original mesh have no face or no finite coordinates, there or \
                 after, and do not count"
            )],
        };
        let original_fields = vec![found.field];
        Ok(Comparison { scalars, warnings, original_fields, ..Comparison::default() })
    }
}

fn of_metric(error: ShiftError) -> MetricError {
    let message = error.to_string();
    match error {
        ShiftError::NoVertices(mesh) => MetricError::Input { mesh, message },
        ShiftError::Cancelled(cancelled) => MetricError::Cancelled(cancelled),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::fixtures::cube;

    use super::*;
    use crate::test_models::reference_mesh;

    #[test]
    fn a_cube_that_moved_by_its_side() {
        let (mesh, moved) = (cube(DVec3::ZERO), cube(DVec3::X));
        let found = VertexShiftMetric.compare(&mesh, &moved, Control::none()).unwrap();
        let relative = 1.0 / 3.0_f64.sqrt();
        assert_eq!(found.scalar("mean_relative"), Some(relative));
        assert_eq!(found.scalar("max_relative"), Some(relative));
        assert!((found.scalar("sum_relative").unwrap() - 8.0 * relative).abs() < 1e-14);
        assert_eq!(found.original_fields[0].values, [1.0; 8]);
        let nothing = VertexShiftMetric.compare(&mesh, &TriMesh::default(), Control::none());
        assert!(nothing.unwrap_err().to_string().starts_with("the simplified mesh has no vertex"));
    }

    /// Distances of scipy's `cKDTree`.
    #[test]
    fn shifts_of_the_references() {
        let Some(spot) = reference_mesh("models/spot.obj.gz") else { return };
        let cases = [
            ("q50", [0.007_387_308_776_085_803, 0.034_208_906_948_246_09]),
            ("q10", [0.022_293_136_166_185_078, 0.070_446_101_978_949_02]),
            ("noise", [0.001_010_119_276_290_762_7, 0.001_999_339_395_179_997]),
        ];
        for (name, expected) in cases {
            let other = reference_mesh(&format!("models/spot__{name}.obj.gz")).unwrap();
            let found = VertexShiftMetric.compare(&spot, &other, Control::none()).unwrap();
            let values = ["mean_relative", "max_relative"].map(|name| found.scalar(name).unwrap());
            for (value, expected) in values.into_iter().zip(expected) {
                assert!((value - expected).abs() < 1e-10, "{name}: {value} {expected}");
            }
            assert_eq!(found.scalar("by_index"), Some(f64::from(u8::from(name == "noise"))));
        }
    }
}
