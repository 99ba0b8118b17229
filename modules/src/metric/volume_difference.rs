//! By how much the volume within the surface changed.
//!
//! The volume of a mesh is the sum over its faces of the cones between them and one point, the
//! middle of the original's box, those of faces that turn their front away from it positive. For
//! a closed surface this is the volume that it encloses, and the point does not matter. For an open
//! one it is that of the body between the surface and the point, which a simplification with the
//! same borders changes in the same way; a warning says so.

use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::surface_sums::{finite_bounds, surface_sums, warnings};
use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::geometry::surface::mesh_info::mesh_info;
use crate::prelude::*;

/// A volume below this part of the cube over the diagonal of the original is none: rounding leaves
/// as much of a flat surface.
const EMPTY: f64 = 1e-13;

/// Unit of volumes.
const CUBED: Unit = Unit::Model("model units³");

const VOLUME_DIFFERENCE: Quantity = Quantity::new(
    "volume_difference",
    "By how much the volumes differ over that of the original; 0 is equal.",
)
.titled("Difference of volumes / volume")
.lower()
.chief();
const VOLUME_CHANGE: Quantity = Quantity::new(
    "volume_change",
    "Volume of the simplified mesh less that of the original; below 0 where it shrank.",
)
.titled("Change of volume")
.in_unit(CUBED);
const ORIGINAL_VOLUME: Quantity =
    Quantity::new("original_volume", "Volume of the original; below 0 where it is inside out.")
        .titled("Volume of the original")
        .in_unit(CUBED);
const SIMPLIFIED_VOLUME: Quantity =
    Quantity::new("simplified_volume", "Volume of the simplified mesh, in the same way.")
        .titled("Volume of the simplified mesh")
        .in_unit(CUBED);

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "VolumeDifference",
    summary: "By how much the volume within the surface changed, as a part of it.",
    params: &[],
    build: MakeMetric {
        quantities: &[VOLUME_DIFFERENCE, VOLUME_CHANGE, ORIGINAL_VOLUME, SIMPLIFIED_VOLUME],
        make: |_| Ok(Box::new(VolumeDifferenceMetric)),
    },
};

/// See the file's header. Has no parameters.
#[derive(Clone, Copy, Debug)]
struct VolumeDifferenceMetric;

impl Metric for VolumeDifferenceMetric {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let [low, high] = finite_bounds(original, control.part(0.0, 0.1))?;
        let center = low + (high - low) / 2.0;
        let of = |role, mesh, part| surface_sums(role, mesh, center, part);
        let before = of(MeshRole::Original, original, control.part(0.1, 0.2))?;
        let after = of(MeshRole::Simplified, simplified, control.part(0.2, 0.3))?;
        let mut warnings = warnings(&before, &after);
        let sides = [
            (MeshRole::Original, original, control.part(0.3, 0.7)),
            (MeshRole::Simplified, simplified, control.part(0.7, 1.0)),
        ];
        for (role, mesh, part) in sides {
            if mesh_info(mesh, part)?.volume.is_none() {
                warnings.push(format!(
                    "the {role} mesh encloses no volume, since it is open or its faces are turned \
                     against each other; what counts is the volume between its faces and the \
                     middle of the original's box (FillHoles and OrientFaces mend this)"
                ));
            }
        }
        let change = after.volume - before.volume;
        let empty = EMPTY * (high - low).length().powi(3);
        let part = match change.abs() {
            // Nothing is no part of anything, also where there is no volume.
            change if change <= empty => 0.0,
            change if before.volume.abs() > empty => change / before.volume.abs(),
            _ => f64::NAN,
        };
        let scalars = vec![
            Measure::of(&VOLUME_DIFFERENCE, part),
            Measure::of(&VOLUME_CHANGE, change),
            Measure::of(&ORIGINAL_VOLUME, before.volume),
            Measure::of(&SIMPLIFIED_VOLUME, after.volume),
        ];
        Ok(Comparison { scalars, warnings, ..Comparison::default() })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::fixtures::{cube, mesh_of, tetrahedron};

    use super::*;
    use crate::test_models::reference_mesh;

    fn compared(a: &TriMesh, b: &TriMesh) -> Comparison {
        VolumeDifferenceMetric.compare(a, b, Control::none()).unwrap()
    }

    #[test]
    fn the_corner_of_a_cube_is_a_sixth_of_it() {
        // Far from the origin, where cones from there would lose their digits.
        let far = DVec3::new(4e6, -5e5, 3e2);
        let mut corner = tetrahedron();
        corner.positions.iter_mut().for_each(|position| *position += far);
        let found = compared(&cube(far), &corner);
        assert!((found.scalar("volume_difference").unwrap() - 5.0 / 6.0).abs() < 1e-12);
        assert!((found.scalar("volume_change").unwrap() + 5.0 / 6.0).abs() < 1e-12);
        assert!((found.scalar("original_volume").unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(found.warnings, [""; 0]);
        // The sum of the volumes where one is inside out.
        corner.faces.iter_mut().for_each(|face| face.swap(0, 1));
        let found = compared(&cube(far), &corner);
        assert!((found.scalar("volume_difference").unwrap() - 7.0 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn an_open_surface_is_measured_from_the_middle_of_the_box() {
        // A cube without its upper side: five pyramids of 1/6.
        let mut open = cube(DVec3::ZERO);
        open.faces.drain(2..4);
        let found = compared(&cube(DVec3::ZERO), &open);
        assert!((found.scalar("volume_difference").unwrap() - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(found.warnings.len(), 1);
        assert!(found.warnings[0].starts_with("the simplified mesh encloses no volume"));
        let flat = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
        assert_eq!(compared(&flat, &flat).scalar("volume_difference"), Some(0.0));
        assert!(compared(&flat, &open).scalar("volume_difference").unwrap().is_nan());
    }

    #[test]
    fn volumes_of_the_references_are_those_of_trimesh() {
        let Some(spot) = reference_mesh("models/spot.obj.gz") else { return };
        let tenth = reference_mesh("models/spot__q10.obj.gz").unwrap();
        let found = compared(&spot, &tenth);
        let [before, after] = [0.718_258_788_099_864_7, 0.707_990_023_709_164];
        assert!((found.scalar("original_volume").unwrap() - before).abs() < 1e-12);
        let part = found.scalar("volume_difference").unwrap();
        assert!((part - (before - after) / before).abs() < 1e-12, "{part}");
    }
}
