//! The difference of the areas of the two surfaces, as a part of the original's area.
//!
//! Say what the metric measures, in which unit, which end of its scale is good, and name its
//! source: authors, title, venue, year, and every deviation.

use mve_core::{Control, Entry, Quantity};
use mve_mesh::data::{Measure, TriMesh};

use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};

/// Which values are better, and the unit, are said here; of `chief` ones each report has a table.
const AREA: Quantity =
    Quantity::new("area", "Difference of the areas over the area of the original; 0 is equal.")
        .titled("Difference of areas")
        .lower()
        .chief();

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "Template",
    summary: "The difference of the areas of the two surfaces, as a part of the original's area.",
    params: &[],
    build: MakeMetric { quantities: &[AREA], make: |_| Ok(Box::new(Template)) },
};

/// See the file's header. Has no parameters.
#[derive(Clone, Copy, Debug)]
struct Template;

impl Metric for Template {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        control.at(0.0)?;
        let (before, after) = (original.area(), simplified.area());
        if !(before > 0.0 && before.is_finite()) {
            let message =
                format!("the original mesh has an area of {before}; a positive one is expected");
            return Err(MetricError::Input { mesh: MeshRole::Original, message });
        }
        let part = (after - before).abs() / before;
        Ok(Comparison { scalars: vec![Measure::of(&AREA, part)], ..Comparison::default() })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::fixtures::cube;

    use super::*;

    #[test]
    fn a_cube_of_half_the_side_has_a_quarter_of_the_area() {
        let mut half = cube(DVec3::ZERO);
        half.positions.iter_mut().for_each(|position| *position *= 0.5);
        let found = Template.compare(&cube(DVec3::ZERO), &half, Control::none()).unwrap();
        assert_eq!(found.scalar("area"), Some(0.75));
        let nothing = Template.compare(&TriMesh::default(), &half, Control::none());
        assert!(nothing.is_err());
    }
}
