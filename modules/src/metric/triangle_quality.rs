//! How well shaped the triangles of the simplified mesh are, and how much was lost.
//!
//! The quality of a triangle is twice the radius of its inscribed circle over that of its
//! circumscribed one, 1 for an equilateral triangle and 0 for one without area: with sides a, b, c
//! and area A it is 16 A² / (a b c (a + b + c)) (Shewchuk, "What is a good linear finite element?",
//! 2002, table 6, after Cavendish, Field and Frey 1985). MeshLab calls it "inradius/circumradius".
//! Means are over the faces, each counting the same.

use glam::DVec3;
use mve_core::{Control, Entry};
use mve_mesh::data::{FaceId, Measure};

use super::{Comparison, MakeMetric, MeshRole, Metric, MetricError};
use crate::prelude::*;

/// Unit of angles.
const DEGREES: Unit = Unit::Fixed("°");

const QUALITY_LOSS: Quantity = Quantity::new(
    "quality_loss",
    "Mean quality of the triangles of the original less that of the simplified mesh; below 0 where \
     shapes became better.",
)
.titled("Loss of triangle quality")
.lower();
const QUALITY: Quantity = Quantity::new(
    "quality",
    "Mean over the triangles of the simplified mesh of 2 × inradius / circumradius, 1 for \
     equilateral ones.",
)
.titled("Triangle quality")
.higher()
.chief();
const ORIGINAL_QUALITY: Quantity = Quantity::new("original_quality", "The same of the original.")
    .titled("Triangle quality of the original");
const LEAST_QUALITY: Quantity =
    Quantity::new("least_quality", "The least over the triangles of the simplified mesh.")
        .titled("Least triangle quality")
        .higher();
const MEAN_LEAST_ANGLE: Quantity = Quantity::new(
    "mean_least_angle",
    "Mean over the triangles of the simplified mesh of their least angle; at most 60°.",
)
.titled("Mean of least angles")
.in_unit(DEGREES)
.higher();
const LEAST_ANGLE: Quantity =
    Quantity::new("least_angle", "The least angle of all triangles of the simplified mesh.")
        .titled("Least angle")
        .in_unit(DEGREES)
        .higher();
const LARGEST_ANGLE: Quantity =
    Quantity::new("largest_angle", "The largest angle of all triangles of the simplified mesh.")
        .titled("Largest angle")
        .in_unit(DEGREES)
        .lower();

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "TriangleQuality",
    summary: "How well shaped the triangles of the simplified mesh are, beside the original's.",
    params: &[],
    build: MakeMetric {
        quantities: &[
            QUALITY_LOSS,
            QUALITY,
            ORIGINAL_QUALITY,
            LEAST_QUALITY,
            MEAN_LEAST_ANGLE,
            LEAST_ANGLE,
            LARGEST_ANGLE,
        ],
        make: |_| Ok(Box::new(TriangleQualityMetric)),
    },
};

/// See the file's header. Has no parameters.
#[derive(Clone, Copy, Debug)]
struct TriangleQualityMetric;

impl Metric for TriangleQualityMetric {
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let before = shapes(MeshRole::Original, original, control.part(0.0, 0.5))?;
        let after = shapes(MeshRole::Simplified, simplified, control.part(0.5, 1.0))?;
        let scalars = vec![
            Measure::of(&QUALITY_LOSS, before.quality - after.quality),
            Measure::of(&QUALITY, after.quality),
            Measure::of(&ORIGINAL_QUALITY, before.quality),
            Measure::of(&LEAST_QUALITY, after.least_quality),
            Measure::of(&MEAN_LEAST_ANGLE, after.mean_least_angle_rad.to_degrees()),
            Measure::of(&LEAST_ANGLE, after.least_angle_rad.to_degrees()),
            Measure::of(&LARGEST_ANGLE, after.largest_angle_rad.to_degrees()),
        ];
        let sides = [(MeshRole::Original, &before), (MeshRole::Simplified, &after)];
        let left_out = sides.into_iter().filter(|(_, shapes)| shapes.n_left_out > 0);
        let sentence = |(role, shapes): (MeshRole, &Shapes)| {
            let n = shapes.n_left_out;
            format!("{n} faces of the {role} mesh are not finite and do not count")
        };
        Ok(Comparison {
            scalars,
            warnings: left_out.map(sentence).collect(),
            original_fields: vec![before.field],
            simplified_fields: vec![after.field],
            ..Comparison::default()
        })
    }
}

/// The shapes of the triangles of a mesh.
struct Shapes {
    field: Field,
    quality: f64,
    least_quality: f64,
    mean_least_angle_rad: f64,
    least_angle_rad: f64,
    largest_angle_rad: f64,
    n_left_out: usize,
}

fn shapes(role: MeshRole, mesh: &TriMesh, control: Control) -> Result<Shapes, MetricError> {
    let n_faces = mesh.faces.len();
    let mut values = Vec::with_capacity(n_faces);
    let (mut qualities, mut angles, mut n_counted) = (0.0, 0.0, 0_usize);
    let (mut least_quality, mut extremes) = (f64::INFINITY, [f64::INFINITY, 0.0]);
    for face in 0..n_faces {
        control.item(face, n_faces)?;
        let corners = mesh.corners(FaceId(face as u32));
        let quality = quality(corners);
        values.push(quality);
        if quality.is_nan() {
            continue;
        }
        let [least, largest] = angle_range_rad(corners);
        n_counted += 1;
        qualities += quality;
        angles += least;
        least_quality = least_quality.min(quality);
        extremes = [extremes[0].min(least), extremes[1].max(largest)];
    }
    if n_counted == 0 {
        let message = match n_faces {
            0 => format!("the {role} mesh has no faces, so there are no shapes to compare"),
            n => format!("the {role} mesh has {n} faces but none with finite coordinates"),
        };
        return Err(MetricError::Input { mesh: role, message });
    }
    let (name, unit) = ("quality".to_owned(), String::new());
    Ok(Shapes {
        field: Field { name, unit, domain: Domain::Face, values },
        quality: qualities / n_counted as f64,
        least_quality,
        mean_least_angle_rad: angles / n_counted as f64,
        least_angle_rad: extremes[0],
        largest_angle_rad: extremes[1],
        n_left_out: n_faces - n_counted,
    })
}

/// The sides opposite to the corners, each over the longest of them, so that nothing overflows;
/// not numbers for a triangle in one place.
fn sides([a, b, c]: [DVec3; 3]) -> ([DVec3; 3], [f64; 3]) {
    let sides = [c - b, a - c, b - a];
    let longest = sides.iter().map(|side| side.abs().max_element()).fold(0.0, f64::max);
    let sides = sides.map(|side| side / longest);
    (sides, sides.map(DVec3::length))
}

/// See the file's header: from 0 to 1, not a number where a corner is not finite.
fn quality(corners: [DVec3; 3]) -> f64 {
    if corners.iter().any(|corner| !corner.is_finite()) {
        return f64::NAN;
    }
    let ([_, to_a, to_b], [a, b, c]) = sides(corners);
    // (2 A)² × 4 is 16 A².
    let quality = 4.0 * to_a.cross(to_b).length_squared() / (a * b * c * (a + b + c));
    // A side without length, or no extent at all.
    if quality.is_nan() { 0.0 } else { quality.min(1.0) }
}

/// The least and the largest angle; 0 and 180° in a triangle with a side of no length.
fn angle_range_rad(corners: [DVec3; 3]) -> [f64; 2] {
    let ([a, b, c], lengths) = sides(corners);
    if lengths.iter().any(|length| length.is_nan() || *length == 0.0) {
        return [0.0, std::f64::consts::PI];
    }
    let double_area = a.cross(b).length();
    let angles = [double_area.atan2(-b.dot(c)), double_area.atan2(-c.dot(a))];
    let angles = [angles[0], angles[1], double_area.atan2(-a.dot(b))];
    [angles[0].min(angles[1]).min(angles[2]), angles[0].max(angles[1]).max(angles[2])]
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{mesh_of, tetrahedron};

    use super::*;
    use crate::test_models::reference_mesh;

    fn compared(a: &TriMesh, b: &TriMesh) -> Comparison {
        TriangleQualityMetric.compare(a, b, Control::none()).unwrap()
    }

    #[test]
    fn right_and_equilateral_triangles_by_hand() {
        // Legs of 1: r = 1 − √2/2, R = √2/2, so that 2 r / R = 2 √2 − 2.
        let right = 2.0 * 2.0_f64.sqrt() - 2.0;
        let found = compared(&tetrahedron(), &tetrahedron());
        let mean = (3.0 * right + 1.0) / 4.0;
        let is = |name: &str, value: f64| {
            let found = found.scalar(name).unwrap();
            assert!((found - value).abs() < 1e-14, "{name}: {found} {value}");
        };
        is("quality", mean);
        is("quality_loss", 0.0);
        is("least_quality", right);
        is("mean_least_angle", (3.0 * 45.0 + 60.0) / 4.0);
        is("least_angle", 45.0);
        is("largest_angle", 90.0);
        assert!((found.simplified_fields[0].values[3] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn shapes_do_not_depend_on_size_and_degenerate_ones_are_the_worst() {
        for scale in [1e-200, 1.0, 1e100] {
            let mut mesh = tetrahedron();
            mesh.positions.iter_mut().for_each(|position| *position *= scale);
            let loss = compared(&mesh, &tetrahedron()).scalar("quality_loss").unwrap();
            assert!(loss.abs() < 1e-12, "{scale}: {loss}");
        }
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [f64::NAN; 3]];
        let flat = mesh_of(&points, &[[0, 1, 2], [0, 0, 1], [2, 2, 2], [0, 1, 3]]);
        let found = compared(&tetrahedron(), &flat);
        assert_eq!(found.scalar("quality"), Some(0.0));
        assert_eq!(found.scalar("largest_angle"), Some(180.0));
        assert_eq!(found.scalar("mean_least_angle"), Some(0.0));
        assert_eq!(
            found.warnings,
            ["1 faces of the simplified mesh are not finite and do not count"]
        );
        assert!(found.simplified_fields[0].values[3].is_nan());
    }

    /// Qualities of pymeshlab 2025.7, which computes in `f32`, and angles of trimesh.
    #[test]
    fn shapes_of_the_references_are_those_of_other_programs() {
        let Some(spot) = reference_mesh("models/spot.obj.gz") else { return };
        let half = reference_mesh("models/spot__q50.obj.gz").unwrap();
        let found = compared(&spot, &half);
        let is = |name: &str, value: f64, tolerance: f64| {
            let found = found.scalar(name).unwrap();
            assert!((found - value).abs() < tolerance, "{name}: {found} {value}");
        };
        is("original_quality", 0.818_083_986_5, 1e-6);
        is("quality", 0.780_764_355_5, 1e-6);
        is("least_quality", 0.054_966_594_3, 1e-6);
        is("mean_least_angle", 36.851_269_395_891_92, 1e-9);
        is("least_angle", 7.931_019_921_879_359, 1e-9);
        is("largest_angle", 160.779_758_762_325_78, 1e-6);
    }
}
