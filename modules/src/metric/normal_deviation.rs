//! How far the two surfaces are turned against each other: the angle between their normals.
//!
//! From a point of either surface one goes to the nearest point of the other; the angle is that
//! between the normals of the two faces there, 0 to 180°. See
//! [`crate::geometry::distance::pointwise`] for how points are taken, and what holds where several
//! faces are equally near. Shading follows normals, so that this sees what a distance does not: a
//! surface may be nowhere far away and rough everywhere.

use mve_core::{Control, Entry};
use mve_mesh::data::Measure;

use super::nearest::{Trees, trees, warnings};
use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::geometry::distance::pointwise::{Difference, FacePoint, Pointwise, angle_rad};
use crate::prelude::*;

/// Unit of angles.
const DEGREES: Unit = Unit::Fixed("°");

const MEAN: Quantity =
    Quantity::new("mean", "The larger mean angle of both directions, over the area.")
        .titled("Mean normal deviation")
        .in_unit(DEGREES)
        .lower()
        .chief();
const RMS: Quantity = Quantity::new("rms", "The larger root mean square angle of both directions.")
    .titled("RMS normal deviation")
    .in_unit(DEGREES)
    .lower();
const MAX: Quantity =
    Quantity::new("max", "The largest angle at any sample of both directions, a lower bound.")
        .titled("Largest normal deviation")
        .in_unit(DEGREES)
        .lower();
const ORIGINAL_MEAN: Quantity =
    Quantity::new("original_mean", "Mean angle at the points of the original.")
        .titled("Mean normal deviation from the original")
        .in_unit(DEGREES)
        .lower();
const SIMPLIFIED_MEAN: Quantity =
    Quantity::new("simplified_mean", "Mean angle at the points of the simplified mesh.")
        .titled("Mean normal deviation from the simplified")
        .in_unit(DEGREES)
        .lower();
const ORIGINAL_SAMPLES: Quantity =
    Quantity::new("original_samples", "Samples on the original at which there are two normals.");
const SIMPLIFIED_SAMPLES: Quantity =
    Quantity::new("simplified_samples", "The same on the simplified mesh.");

const SAMPLES: Param<i64> = Param::integer("samples", "Area samples on each mesh.", 200_000)
    .between((1, 1_000_000_000))
    .mostly((10_000, 10_000_000));
const SEED: Param<Seed> = Param::seed("seed", "Chooses among sets of samples.", 0);

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "NormalDeviation",
    summary: "The angle between the normals of the two surfaces at nearest points, both ways.",
    params: &[SAMPLES.spec(), SEED.spec()],
    build: MakeMetric {
        quantities: &[
            MEAN,
            RMS,
            MAX,
            ORIGINAL_MEAN,
            SIMPLIFIED_MEAN,
            ORIGINAL_SAMPLES,
            SIMPLIFIED_SAMPLES,
        ],
        make: |settings| {
            let (n_samples, seed) = (settings.get(&SAMPLES)? as usize, settings.get(&SEED)?.0);
            Ok(Box::new(NormalDeviationMetric { n_samples, seed }))
        },
    },
};

/// See the file's header.
#[derive(Clone, Copy, Debug)]
struct NormalDeviationMetric {
    n_samples: usize,
    seed: u64,
}

impl Metric for NormalDeviationMetric {
    /// `original_fields` and `simplified_fields` hold the angle at the middle of each face.
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let Trees { of_original, of_simplified } =
            trees(original, simplified, control.part(0.0, 0.2))?;
        let there = Pointwise::new(original, simplified, &of_simplified);
        let back = Pointwise::new(simplified, original, &of_original);
        let (from_original, original_field) = self.directed(&there, control.part(0.2, 0.6))?;
        let (from_simplified, simplified_field) = self.directed(&back, control.part(0.6, 1.0))?;
        let sides = [(MeshRole::Original, from_original), (MeshRole::Simplified, from_simplified)];
        if let Some((mesh, _)) = sides.into_iter().find(|(_, difference)| difference.n == 0) {
            let message = format!(
                "no point of the {mesh} mesh has a normal there and at the nearest point of the \
                 other; faces with area are expected on both sides"
            );
            return Err(MetricError::Input { mesh, message });
        }
        let larger = |value: fn(&Difference) -> f64| {
            value(&from_original).max(value(&from_simplified)).to_degrees()
        };
        let scalars = vec![
            Measure::of(&MEAN, larger(Difference::mean)),
            Measure::of(&RMS, larger(Difference::rms)),
            Measure::of(&MAX, larger(Difference::max)),
            Measure::of(&ORIGINAL_MEAN, from_original.mean().to_degrees()),
            Measure::of(&SIMPLIFIED_MEAN, from_simplified.mean().to_degrees()),
            Measure::of(&ORIGINAL_SAMPLES, from_original.n as f64),
            Measure::of(&SIMPLIFIED_SAMPLES, from_simplified.n as f64),
        ];
        Ok(Comparison {
            scalars,
            original_fields: vec![original_field],
            simplified_fields: vec![simplified_field],
            warnings: warnings(&of_original, &of_simplified),
            ..Comparison::default()
        })
    }
}

impl NormalDeviationMetric {
    fn directed(
        &self,
        pointwise: &Pointwise,
        control: Control,
    ) -> Result<(Difference, Field), MetricError> {
        let angle = |a: &FacePoint, b: &FacePoint| angle_rad(a.normal, b.normal);
        let (samples, faces) = (control.part(0.0, 0.7), control.part(0.7, 1.0));
        let count = (self.n_samples, self.seed);
        let [difference] = pointwise.differences(count, |a, b| [angle(a, b)], samples)?;
        let angles = pointwise.at_faces(angle, faces)?;
        let values = angles.into_iter().map(f64::to_degrees).collect();
        let (name, unit) = ("normal deviation".to_owned(), "°".to_owned());
        Ok((difference, Field { name, unit, domain: Domain::Face, values }))
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;
    use crate::test_models::reference_mesh;

    fn compared(a: &TriMesh, b: &TriMesh) -> Result<Comparison, MetricError> {
        NormalDeviationMetric { n_samples: 20_000, seed: 0 }.compare(a, b, Control::none())
    }

    /// A square turned about its lower side.
    fn square(degrees: f64) -> TriMesh {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, cos, sin], [0.0, cos, sin]];
        mesh_of(&points, &[[0, 1, 2], [0, 2, 3]])
    }

    #[test]
    fn a_turned_square_deviates_by_its_angle() {
        let found = compared(&square(0.0), &square(30.0)).unwrap();
        for name in ["mean", "rms", "max", "original_mean", "simplified_mean"] {
            assert!((found.scalar(name).unwrap() - 30.0).abs() < 1e-9, "{name}: {found:?}");
        }
        assert_eq!(found.scalar("original_samples"), Some(20_000.0));
        assert!(found.original_fields[0].values.iter().all(|angle| (angle - 30.0).abs() < 1e-9));
    }

    #[test]
    fn what_has_no_normal_does_not_count() {
        let mut mesh = square(0.0);
        mesh.positions.extend([glam::DVec3::splat(9.0); 3]);
        mesh.faces.push([4, 5, 6].map(mve_mesh::data::VertexId));
        let found = compared(&square(90.0), &mesh).unwrap();
        assert!((found.scalar("max").unwrap() - 90.0).abs() < 1e-9);
        assert!(found.simplified_fields[0].values[2].is_nan());
        let flat = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]]);
        let message = compared(&flat, &flat).unwrap_err().to_string();
        assert!(message.starts_with("no point of the original mesh has a normal"), "{message}");
        let message = compared(&mesh, &TriMesh::default()).unwrap_err().to_string();
        assert_eq!(message, "the simplified mesh has no faces; surfaces are compared");
    }

    /// Angles at the middle of each face by a loop over all faces with trimesh's `closest_point`;
    /// of equally near faces the least.
    #[test]
    fn angles_of_the_references() {
        let Some(spot) = reference_mesh("models/spot.obj.gz") else { return };
        let tenth = reference_mesh("models/spot__q10.obj.gz").unwrap();
        let found = compared(&spot, &tenth).unwrap();
        let angles = &found.original_fields[0].values;
        let mean = angles.iter().sum::<f64>() / angles.len() as f64;
        assert!((mean - 13.008_381_205_312_643).abs() < 1e-6, "{mean}");
        let places = [0, 1000, 5000].map(|face| angles[face]);
        for (angle, expected) in
            places.into_iter().zip([4.789_890_711_9, 18.124_396_686_4, 57.218_339_278])
        {
            assert!((angle - expected).abs() < 1e-6, "{angle} {expected}");
        }
        let largest = angles.iter().copied().fold(0.0, f64::max);
        assert!((largest - 130.520_078_756_4).abs() < 1e-6, "{largest}");
    }
}
