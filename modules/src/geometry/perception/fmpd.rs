//! FMPD: how much rougher or smoother one mesh looks than another, whatever their faces.
//!
//! K. Wang, F. Torkhani and A. Montanvert, "A fast roughness-based approach to the assessment of 3D
//! mesh visual quality", Computers & Graphics 36(7), 2012, with the numbers of the authors' own
//! program:
//!
//! - the Gaussian curvature of a vertex is what its angles lack of 2π, or of π at a border;
//! - its roughness is by how much the magnitude of that differs from the mean of its neighbors',
//!   weighted by cotangents, half of each between 0.001 and 1000;
//! - it is clamped from 0.0005 to 0.2, or to five times the mean roughness of the smoother mesh
//!   where that is more, and raised to 0.15, less what the least one gives; of what is then beyond
//!   the value of that mean roughness half counts, since rough regions hide more;
//! - the roughness of a mesh is the mean over its area, and the distance eight times the difference
//!   of the two, at most 1.
//!
//! So it compares how rough the meshes are, not where: two meshes of one roughness are at 0.
//! Departures: faces that are not finite, or name a vertex twice, are left out; vertices of faces
//! without area have angles of 0.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::{Adjacency, EdgeId};
use mve_mesh::data::{Domain, FaceId, Field, TriMesh, VertexId};
use thiserror::Error;

use crate::geometry::distance::hausdorff::MeshRole;

/// The least roughness, and the largest unless the meshes are rougher.
const ROUGHNESS: [f64; 2] = [0.0005, 0.2];
/// So many times the mean roughness of the smoother mesh is not clamped.
const MOST_OF_MEAN: f64 = 5.0;
/// What roughness is raised to.
const EXPONENT: f64 = 0.15;
/// The part of what is beyond the mean that counts.
const BEYOND: f64 = 0.5;
/// What brings distances to about 0 to 1.
const SCALE: f64 = 8.0;
/// Both ends of half a cotangent.
const HALF_COTANGENT: [f64; 2] = [0.001, 1000.0];

/// The distance of two meshes.
#[derive(Clone, Debug, PartialEq)]
pub struct Fmpd {
    /// From 0, equally rough, to 1.
    pub distance: f64,
    /// The original.
    pub original: Roughness,
    /// The simplified mesh.
    pub simplified: Roughness,
}

/// How rough a mesh is.
#[derive(Clone, Debug, PartialEq)]
pub struct Roughness {
    /// The mean over the area.
    pub global: f64,
    /// Of each vertex, as it enters that mean; not a number without a face.
    pub local: Field,
    /// Faces that were left out.
    pub n_left_out: usize,
}

/// Why there is no distance.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FmpdError {
    /// A mesh without a face.
    #[error("the {0} mesh has no faces; roughness is that of a surface")]
    NoFaces(MeshRole),
    /// A mesh whose faces have no area, or whose coordinates are not finite.
    #[error("the {0} mesh has {1} faces but none with an area that is finite")]
    NoArea(MeshRole, usize),
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Measures two meshes against each other. O(n log n).
///
/// # Errors
/// [`FmpdError`] for a mesh without a face that has area, and when `control` ends it.
pub fn fmpd(original: &TriMesh, simplified: &TriMesh, control: Control) -> Result<Fmpd, FmpdError> {
    let (a, b) = rayon::join(
        || Raw::of(MeshRole::Original, original, control.part(0.0, 0.5)),
        || Raw::of(MeshRole::Simplified, simplified, control.part(0.5, 1.0)),
    );
    let (a, b) = (a?, b?);
    let mean = a.mean.min(b.mean);
    let (original, simplified) = (a.modulated(mean), b.modulated(mean));
    let distance = (SCALE * (original.global - simplified.global).abs()).min(1.0);
    Ok(Fmpd { distance, original, simplified })
}

/// Roughness before it is modulated.
struct Raw {
    roughness: Vec<f64>,
    /// A third of the area of the faces around each vertex.
    areas: Vec<f64>,
    area: f64,
    mean: f64,
    n_left_out: usize,
}

impl Raw {
    fn of(role: MeshRole, mesh: &TriMesh, control: Control) -> Result<Self, FmpdError> {
        let n_faces = mesh.faces.len();
        if n_faces == 0 {
            return Err(FmpdError::NoFaces(role));
        }
        let is_usable = |face: &[VertexId; 3]| {
            let [a, b, c] = face;
            let is_finite = |vertex: &VertexId| mesh.positions[vertex.idx()].is_finite();
            a != b && b != c && c != a && face.iter().all(is_finite)
        };
        let usable = TriMesh::new(
            mesh.positions.clone(),
            mesh.faces.iter().copied().filter(|face| is_usable(face)).collect(),
        );
        let n_left_out = n_faces - usable.faces.len();
        let curvature = curvature(&usable, control.part(0.0, 0.7))?;
        let control = control.part(0.7, 1.0);
        let n = mesh.positions.len();
        let (mut sums, mut weights) = (vec![0.0; n], vec![0.0; n]);
        let mut areas = vec![0.0; n];
        for (place, face) in usable.faces.iter().enumerate() {
            control.item(place, usable.faces.len())?;
            let corners = usable.corners(FaceId(place as u32));
            for k in 0..3 {
                let [at, i, j] = [0, 1, 2].map(|step| (k + step) % 3);
                let [low, high] = HALF_COTANGENT;
                let weight = (0.5 * cotangent(corners, at)).clamp(low, high);
                let [i, j] = [i, j].map(|corner| face[corner].idx());
                sums[i] += weight * (curvature[i] - curvature[j]);
                sums[j] += weight * (curvature[j] - curvature[i]);
                weights[i] += weight;
                weights[j] += weight;
                areas[face[at].idx()] += double_area(corners) / 6.0;
            }
        }
        let area: f64 = areas.iter().sum();
        if !(area > 0.0 && area.is_finite()) {
            return Err(FmpdError::NoArea(role, n_faces));
        }
        let roughness: Vec<f64> = sums
            .iter()
            .zip(&weights)
            .map(|(sum, weight): (&f64, _)| (sum / weight).abs())
            .collect();
        let mean = mean_over(&roughness, &areas, area);
        Ok(Self { roughness, areas, area, mean, n_left_out })
    }

    /// The roughness as the eye takes it, beside a mesh of which the smoother has this mean.
    fn modulated(self, mean: f64) -> Roughness {
        let [least, most] = ROUGHNESS;
        let most = most.max(MOST_OF_MEAN * mean);
        let power = |roughness: f64| roughness.powf(EXPONENT) - least.powf(EXPONENT);
        let turn = power(mean.max(least));
        let modulate = |&roughness: &f64| {
            let value = power(roughness.clamp(least, most));
            if value > turn { turn + BEYOND * (value - turn) } else { value }
        };
        let values: Vec<f64> = self.roughness.iter().map(modulate).collect();
        let global = mean_over(&values, &self.areas, self.area);
        let (name, unit) = ("roughness".to_owned(), String::new());
        let local = Field { name, unit, domain: Domain::Vertex, values };
        Roughness { global, local, n_left_out: self.n_left_out }
    }
}

/// The mean of what is a number at vertices with area.
fn mean_over(values: &[f64], areas: &[f64], area: f64) -> f64 {
    let counted = values.iter().zip(areas).filter(|(value, area)| !value.is_nan() && **area > 0.0);
    counted.map(|(value, area)| value * area).sum::<f64>() / area
}

/// The magnitude of what the angles at each vertex lack of a whole turn, or of half of one at a
/// border.
fn curvature(mesh: &TriMesh, control: Control) -> Result<Vec<f64>, Cancelled> {
    use std::f64::consts::{PI, TAU};
    let adjacency = Adjacency::new(mesh, control.part(0.0, 0.7))?;
    let mut whole = vec![TAU; mesh.positions.len()];
    for edge in (0..adjacency.edges().len() as u32).map(EdgeId) {
        if adjacency.sides_of(edge).len() == 1 {
            for vertex in adjacency.edges()[edge.idx()] {
                whole[vertex.idx()] = PI;
            }
        }
    }
    let control = control.part(0.7, 1.0);
    for (place, face) in mesh.faces.iter().enumerate() {
        control.item(place, mesh.faces.len())?;
        let corners = mesh.corners(FaceId(place as u32));
        for (k, vertex) in face.iter().enumerate() {
            let [p, q] = sides_at(corners, k);
            whole[vertex.idx()] -= p.cross(q).length().atan2(p.dot(q));
        }
    }
    Ok(whole.into_iter().map(f64::abs).collect())
}

/// The sides that leave a corner.
fn sides_at(corners: [DVec3; 3], k: usize) -> [DVec3; 2] {
    [corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]]
}

/// Of the angle at a corner; infinite, of either sign, where the face has no area.
fn cotangent(corners: [DVec3; 3], k: usize) -> f64 {
    let [p, q] = sides_at(corners, k);
    let (dot, cross) = (p.dot(q), p.cross(q).length());
    // A side without length: nothing can be said of the angle.
    if dot == 0.0 && cross == 0.0 { 0.0 } else { dot / cross }
}

fn double_area(corners: [DVec3; 3]) -> f64 {
    let [p, q] = sides_at(corners, 0);
    p.cross(q).length()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use mve_mesh::fixtures::{mesh_of, tetrahedron};

    use super::*;
    use crate::test_models::reference_mesh;

    fn measured(a: &TriMesh, b: &TriMesh) -> Fmpd {
        fmpd(a, b, Control::none()).unwrap()
    }

    fn octahedron() -> TriMesh {
        let ends = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
        let points = [&ends[..], &[[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]].concat();
        let upper = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
        let lower = upper.map(|[a, b, _]| [b, a, 5]);
        mesh_of(&points, &[upper, lower].concat())
    }

    /// The corner of a cube: three right angles at its tip (π/2 is lacking), and 150° at the other
    /// vertices (7π/6 are). Cotangents are 1 at the legs and 1/√3 and 0 at the hypotenuses.
    #[test]
    fn a_corner_by_hand() {
        let raw = Raw::of(MeshRole::Original, &tetrahedron(), Control::none()).unwrap();
        let (leg, hypotenuse) = (1.0, 0.5 / 3.0_f64.sqrt() + 0.001);
        let others = 2.0 * PI / 3.0 * leg / (leg + 2.0 * hypotenuse);
        let expected = [2.0 * PI / 3.0, others, others, others];
        for (found, expected) in raw.roughness.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let areas = [0.5, (1.0 + 0.75_f64.sqrt()) / 3.0];
        let mean = (areas[0] * expected[0] + 3.0 * areas[1] * others) / (areas[0] + 3.0 * areas[1]);
        assert!((raw.mean - mean).abs() < 1e-12);
        // All vertices of an octahedron are alike: no roughness, and the corner's counts by half.
        let found = measured(&octahedron(), &tetrahedron());
        assert_eq!(found.original.global, 0.0);
        let expected = 0.5 * (0.2_f64.powf(0.15) - 0.0005_f64.powf(0.15));
        assert!((found.simplified.global - expected).abs() < 1e-12);
        assert_eq!(found.distance, 1.0);
    }

    #[test]
    fn a_flat_border_is_not_rough_and_what_is_broken_is_left_out() {
        let flat = mesh_of(
            &[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
            &[[0, 1, 4], [0, 4, 3], [1, 2, 4]],
        );
        // The vertex in the middle of a straight border lacks nothing.
        let curvature = curvature(&flat, Control::none()).unwrap();
        assert!(curvature[1].abs() < 1e-12 && (curvature[0] - PI / 2.0).abs() < 1e-12);
        let mut broken = octahedron();
        broken.positions.push(DVec3::NAN);
        broken.faces.extend([[0, 0, 1], [0, 1, 6]].map(|face| face.map(VertexId)));
        let found = measured(&octahedron(), &broken);
        assert_eq!((found.distance, found.simplified.n_left_out), (0.0, 2));
        assert!(found.simplified.local.values[6].is_nan());
        let nothing = fmpd(&TriMesh::default(), &broken, Control::none());
        assert_eq!(nothing.unwrap_err(), FmpdError::NoFaces(MeshRole::Original));
        let point = mesh_of(&[[1.0; 3]; 3], &[[0, 1, 2]]);
        let nothing = fmpd(&octahedron(), &point, Control::none());
        assert_eq!(nothing.unwrap_err(), FmpdError::NoArea(MeshRole::Simplified, 1));
    }

    /// Values of a program in numpy with sparse matrices, as the authors' has them, written for
    /// this test alone.
    #[test]
    fn pairs_of_the_references() {
        let Some(original) = reference_mesh("models/spot.obj.gz") else { return };
        let cases = [
            ("noise", 0.219_374_831_016_973),
            ("q50", 0.175_193_398_653_596_87),
            ("q10", 0.287_868_150_206_595_56),
        ];
        for (name, expected) in cases {
            let other = reference_mesh(&format!("models/spot__{name}.obj.gz")).unwrap();
            let found = measured(&original, &other);
            let global = 0.133_055_509_623_910_66;
            assert!((found.original.global - global).abs() < 1e-9, "{found:?}");
            let of_other = found.simplified.global;
            assert!((of_other - expected).abs() < 1e-9, "{name}: {of_other} {expected}");
            assert!((found.distance - (8.0 * (expected - global)).min(1.0)).abs() < 1e-8);
        }
    }
}
