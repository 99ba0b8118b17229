//! MSDM, the ancestor of MSDM2 for meshes of one connectivity: 0 for equal, about 1 for unlike.
//!
//! G. Lavoué, E. Drelie Gelasca, F. Dupont, A. Baskurt and T. Ebrahimi, "Perceptually driven 3D
//! distance metrics with application to watermarking", SPIE 6312, 2006: at every vertex the
//! curvature within a window, the part of the surface around the vertex within a sphere, is
//! compared with that of the other mesh by mean (L), deviation (C) and covariance (S); the local
//! value is (0.4 L³ + 0.4 C³ + 0.2 S³)^(1/3), the value the cubic mean over the vertices.
//!
//! Departures and choices. Curvature is that of `msdm2`, half the sum of the principal magnitudes;
//! the radius in which it is measured (0.002) and the default radius of windows (0.005 of the
//! longest side of the box of the original) are chosen here. A window holds the center, the
//! vertices met by the walk of `msdm2` and the points where the sphere cuts edges, all of one
//! weight. Vertices correspond by index where both meshes have the same faces; otherwise to the
//! nearest point of the other mesh, with its curvature there, which the paper does not do. The
//! value of one direction has its windows on one mesh; the symmetric one is the mean of both. Means
//! and deviations below 1e-6 (`FLAT`) count as zero: what is flat on both sides does not differ,
//! and where one side alone is flat C and S are 1.

use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;

use super::msdm2::curvature::curvatures;
use super::msdm2::window::{Kernel, Moments, Windows, local_values};
use super::msdm2::{
    Level, Levels, MeshCurvature, Msdm2, Msdm2Error, OneSided, Pair, ReferencePoint, Ties, Variant,
    carry, one_sided_of,
};

/// Dimensionless curvature below this is rounding. A crease of an angle of 1 has about 80.
const FLAT: f64 = 1e-6;

/// How to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MsdmOptions {
    /// Radius of windows over the longest side of the box of the original.
    pub window_radius: f64,
    /// Radius of the sphere in which curvature is measured, the same way.
    pub curvature_radius: f64,
}

impl MsdmOptions {
    /// The default.
    pub const DEFAULT: Self = Self { window_radius: 0.005, curvature_radius: 0.002 };
}

impl Default for MsdmOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The metric in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Msdm {
    /// Values and fields.
    pub both: Msdm2,
    /// Whether vertices corresponded by index.
    pub is_by_index: bool,
}

/// Measures two meshes against each other.
///
/// # Errors
/// As [`msdm2`](super::msdm2::msdm2).
pub fn msdm(
    original: &TriMesh,
    simplified: &TriMesh,
    options: &MsdmOptions,
    control: Control,
) -> Result<Msdm, Msdm2Error> {
    let pair = Pair::new(original, simplified, Variant::Published, control.part(0.0, 0.2))?;
    let (a, b) = (&pair.original, &pair.simplified);
    let size = a.longest_side;
    let level = Level {
        curvature_radius: options.curvature_radius * size,
        window_radius: options.window_radius * size,
    };
    let levels = Levels { size, list: vec![level] };
    let (of_a, of_b) = rayon::join(
        || curvatures(a, &levels, control.part(0.2, 0.3)),
        || curvatures(b, &levels, control.part(0.3, 0.4)),
    );
    let (of_a, of_b) = (of_a?, of_b?);
    let is_by_index = original.faces == simplified.faces && a.mesh.faces == b.mesh.faces;
    let one_sided = |from: MeshCurvature, to: MeshCurvature, part: Control| {
        let found = one_sided(&levels, is_by_index, from, to, part)?;
        Ok::<_, Cancelled>(OneSided { size: found.size / pair.scale, ..found })
    };
    let (of_original, of_simplified) = ((a, of_a.as_slice()), (b, of_b.as_slice()));
    let (from_original, from_simplified) = rayon::join(
        || one_sided(of_simplified, of_original, control.part(0.4, 0.7)),
        || one_sided(of_original, of_simplified, control.part(0.7, 1.0)),
    );
    let both = Msdm2 {
        from_original: from_original?,
        from_simplified: from_simplified?,
        spread: None,
        n_left_out_original: a.n_left_out,
        n_left_out_simplified: b.n_left_out,
    };
    Ok(Msdm { both, is_by_index })
}

fn one_sided(
    levels: &Levels,
    is_by_index: bool,
    (reference, of_reference): MeshCurvature,
    (surface, curvature): MeshCurvature,
    control: Control,
) -> Result<OneSided, Cancelled> {
    let carried = if is_by_index {
        let point = |v: usize| reference.mesh.positions.get(v).copied();
        let by_index = of_reference
            .iter()
            .enumerate()
            .filter_map(|(v, &curvature)| Some(ReferencePoint { point: point(v)?, curvature }));
        by_index.collect()
    } else {
        let sides = [(reference, of_reference), (surface, curvature)];
        carry(sides, (Variant::Published, Ties::Any), control.part(0.0, 0.3))?
    };
    let windows =
        Windows { surface, levels, curvature, carried: &carried, kernel: |_| Kernel::Uniform };
    let local = local_values(&windows, local_value, control.part(0.3, 1.0))?;
    one_sided_of("msdm", local, levels.size, control)
}

/// The local value of a window.
fn local_value(moments: &Moments) -> f64 {
    let or_zero = |value: f64| if value < FLAT { 0.0 } else { value };
    let means = moments.means.map(or_zero);
    let deviations = moments.deviations.map(or_zero);
    let part = |[a, b]: [f64; 2]| if a.max(b) > 0.0 { (a - b).abs() / a.max(b) } else { 0.0 };
    let product = deviations[0] * deviations[1];
    let structure = if product > 0.0 {
        (product - moments.covariance).abs() / product
    } else {
        part(deviations)
    };
    let cube = |x: f64| x * x * x;
    (0.4 * cube(part(means)) + 0.4 * cube(part(deviations)) + 0.2 * cube(structure)).cbrt()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::fixtures::{mesh_of, torus};

    use super::*;
    use crate::test_models::reference_mesh;

    fn measured(a: &TriMesh, b: &TriMesh) -> Msdm {
        msdm(a, b, &MsdmOptions::DEFAULT, Control::none()).unwrap()
    }

    #[test]
    fn the_local_value_by_hand() {
        let moments = |means, deviations, covariance| Moments { means, deviations, covariance };
        assert_eq!(local_value(&moments([3.0, 3.0], [2.0, 2.0], 4.0)), 0.0);
        assert_eq!(local_value(&moments([1e-9, 0.0], [0.0, 1e-8], 0.0)), 0.0);
        // L = 1/2, C = 3/4, S = |4 − 2| / 4 = 1/2.
        let expected = (0.4 / 8.0 + 0.4 * 27.0 / 64.0 + 0.2 / 8.0f64).cbrt();
        let found = local_value(&moments([1.0, 2.0], [1.0, 4.0], 2.0));
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        // Flat on one side alone: C and S are 1.
        let found = local_value(&moments([1.0, 1.0], [0.0, 4.0], 0.0));
        assert!((found - 0.6f64.cbrt()).abs() < 1e-15);
    }

    /// One crease of a right angle against one of half of that, with the same faces: both ends of
    /// it have L = C = 1/2 and S = 0; at the other vertices the curvature is 0 but for what the
    /// window reaches, and that is nothing.
    #[test]
    fn a_crease_against_half_of_it() {
        let bent = |degrees: f64| {
            let (z, y) = degrees.to_radians().sin_cos();
            mesh_of(
                &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -y, -z]],
                &[[0, 1, 2], [1, 0, 3]],
            )
        };
        let found = measured(&bent(90.0), &bent(45.0));
        assert!(found.is_by_index);
        let local = (0.4f64 / 8.0 * 2.0).cbrt();
        for one_sided in [&found.both.from_original, &found.both.from_simplified] {
            for vertex in [0, 1] {
                let at = one_sided.local.values[vertex];
                assert!((at - local).abs() < 1e-3, "{at} {local}");
            }
        }
    }

    #[test]
    fn equal_meshes_and_noise_in_order() {
        let mesh = torus(2.0, 0.5, 24);
        assert!(measured(&mesh, &mesh).both.symmetric() < 1e-12);
        let shaken = |height: f64| {
            let mut mesh = mesh.clone();
            for (n, p) in mesh.positions.iter_mut().enumerate() {
                *p += DVec3::new(0.3, 0.5, 1.0) * height * ((n * n % 17) as f64 / 17.0 - 0.5);
            }
            measured(&torus(2.0, 0.5, 24), &mesh).both.symmetric()
        };
        let values = [0.001, 0.01, 0.1].map(shaken);
        assert!(values.is_sorted() && values[2] < 1.3, "{values:?}");
        let other = torus(2.0, 0.5, 20);
        let found = measured(&mesh, &other);
        assert!(!found.is_by_index && found.both.symmetric() > 0.1);
    }

    /// The order of MSDM2 on real pairs: noise is worse than half of the faces.
    #[test]
    fn pairs_of_the_references() {
        let Some(original) = reference_mesh("models/spot.obj.gz") else { return };
        let [noise, half] = ["noise", "q50"].map(|name| {
            let mesh = reference_mesh(&format!("models/spot__{name}.obj.gz")).unwrap();
            measured(&original, &mesh)
        });
        assert!(noise.is_by_index && !half.is_by_index);
        assert!(noise.both.symmetric() > half.both.symmetric());
    }
}
