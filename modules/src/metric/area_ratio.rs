//! How much of the area of the original the simplified mesh has.
//!
//! The ratio is 1 for equal surfaces, below 1 where detail is gone, and can be above 1 where faces
//! are folded, as clustering leaves them: then a ratio of 1 does not mean that the surfaces are
//! alike.

use glam::DVec3;
use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::surface_sums::{surface_sums, warnings};
use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::prelude::*;

/// Unit of areas.
const SQUARED: Unit = Unit::Model("model units²");

const AREA_RATIO: Quantity = Quantity::new(
    "area_ratio",
    "Area of the simplified mesh over that of the original; 1 is equal.",
)
.titled("Area / area of the original");
const AREA_DIFFERENCE: Quantity =
    Quantity::new("area_difference", "By how much area_ratio differs from 1; 0 is equal.")
        .titled("Difference of areas / area")
        .lower()
        .chief();
const ORIGINAL_AREA: Quantity = Quantity::new("original_area", "Area of the original.")
    .titled("Area of the original")
    .in_unit(SQUARED);
const SIMPLIFIED_AREA: Quantity = Quantity::new("simplified_area", "Area of the simplified mesh.")
    .titled("Area of the simplified mesh")
    .in_unit(SQUARED);

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "AreaRatio",
    summary: "The area of the simplified mesh over that of the original.",
    params: &[],
    build: MakeMetric {
        quantities: &[AREA_RATIO, AREA_DIFFERENCE, ORIGINAL_AREA, SIMPLIFIED_AREA],
        make: |_| Ok(Box::new(AreaRatioMetric)),
    },
};

/// See the file's header. Has no parameters.
#[derive(Clone, Copy, Debug)]
struct AreaRatioMetric;

impl Metric for AreaRatioMetric {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let of = |role, mesh, part| surface_sums(role, mesh, DVec3::ZERO, part);
        let before = of(MeshRole::Original, original, control.part(0.0, 0.5))?;
        let after = of(MeshRole::Simplified, simplified, control.part(0.5, 1.0))?;
        // Two surfaces without area are equally large.
        let ratio = if before.area == after.area { 1.0 } else { after.area / before.area };
        let scalars = vec![
            Measure::of(&AREA_RATIO, ratio),
            Measure::of(&AREA_DIFFERENCE, (ratio - 1.0).abs()),
            Measure::of(&ORIGINAL_AREA, before.area),
            Measure::of(&SIMPLIFIED_AREA, after.area),
        ];
        Ok(Comparison { scalars, warnings: warnings(&before, &after), ..Comparison::default() })
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, tetrahedron};

    use super::*;
    use crate::test_models::reference_mesh;

    fn compared(a: &TriMesh, b: &TriMesh) -> Result<Comparison, MetricError> {
        AreaRatioMetric.compare(a, b, Control::none())
    }

    #[test]
    fn a_cube_of_half_the_side_has_a_quarter_of_the_area() {
        let mut half = cube(DVec3::splat(1e6));
        half.positions.iter_mut().for_each(|position| *position *= 0.5);
        let found = compared(&cube(DVec3::ZERO), &half).unwrap();
        assert_eq!(found.scalar("area_ratio"), Some(0.25));
        assert_eq!(found.scalar("area_difference"), Some(0.75));
        assert_eq!(found.scalar("original_area"), Some(6.0));
        // Three legs of 1/2 and one of √3/2.
        let area = compared(&half, &tetrahedron()).unwrap().scalar("simplified_area").unwrap();
        assert!((area - (1.5 + 0.75_f64.sqrt())).abs() < 1e-15);
    }

    #[test]
    fn broken_faces_are_left_out_and_a_mesh_of_such_faces_is_named() {
        let (mesh, mut broken) = (cube(DVec3::ZERO), cube(DVec3::ZERO));
        broken.positions[7].x = f64::NAN;
        let found = compared(&mesh, &broken).unwrap();
        // Of the twelve faces three squares' halves and the three whole ones' diagonals meet there.
        let n = mesh.faces.iter().filter(|face| face.iter().any(|v| v.0 == 7)).count();
        assert_eq!(found.scalar("area_ratio"), Some(1.0 - n as f64 / 12.0));
        assert!(found.warnings[0].starts_with(&format!("{n} faces of the simplified mesh")));
        broken.positions.iter_mut().for_each(|position| position.y = f64::INFINITY);
        let message = compared(&broken, &mesh).unwrap_err().to_string();
        assert_eq!(message, "the original mesh has 12 faces but none with finite coordinates");
    }

    #[test]
    fn areas_of_the_references_are_those_of_trimesh() {
        let Some(spot) = reference_mesh("models/spot.obj.gz") else { return };
        let half = reference_mesh("models/spot__q50.obj.gz").unwrap();
        let ratio = compared(&spot, &half).unwrap().scalar("area_ratio").unwrap();
        assert!((ratio - 5.711_540_207_401_672 / 5.709_518_785_165_158).abs() < 1e-12, "{ratio}");
    }
}
