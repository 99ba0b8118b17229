//! Ambient occlusion: which share of the sky above each vertex is open.
//!
//! Source: S. Zhukov, A. Iones and G. Kronin, "An ambient light illumination model", Rendering
//! Techniques 1998, section 3: the share of the hemisphere around the normal that no surface hides,
//! weighted by the cosine to the normal, here by rays whose density is that cosine. Directions are
//! those of a Fibonacci lattice over the disk below (R. Marques et al., "Spherical Fibonacci point
//! sets for illumination integrals", Computer Graphics Forum 32(8), 2013), turned at each vertex by
//! an angle that its place decides, so that no pattern goes over the surface.

use std::f64::consts::TAU;

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::TriMesh;
use mve_mesh::random::IndexedRandom;
use rayon::prelude::*;

use super::rays::RayTree;
use crate::geometry::surface::normals::{NormalWeight, vertex_normals};

/// How to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpennessOptions {
    /// Rays from each vertex.
    pub n_rays: u32,
    /// What is farther away hides nothing, in model units.
    pub distance: f64,
}

/// Vertices that a thread takes at a time.
const CHUNK: usize = 64;
/// Rays between two looks whether the work was cancelled.
const STRIDE: u32 = 1024;
/// How far above the surface rays start, in parts of half of the longest side of the box: far above
/// the rounding of coordinates, and far below a face.
const OFFSET: f64 = 2e-6;

/// The open share of each vertex, 0 to 1; not a number where there is no normal. A share is exact
/// to about 1 over the number of rays.
///
/// The same for any number of threads. O(n rays · log n).
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn openness(
    mesh: &TriMesh,
    options: &OpennessOptions,
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    let tree = RayTree::build(mesh, control.part(0.0, 0.1))?;
    let normals = vertex_normals(mesh, NormalWeight::Angle, control.part(0.1, 0.15))?;
    let control = control.part(0.15, 1.0);
    let steps = control.steps(normals.len().div_ceil(CHUNK));
    let offset = OFFSET * tree.half_extent();
    let mut shares = vec![f64::NAN; normals.len()];
    shares.par_chunks_mut(CHUNK).enumerate().try_for_each(|(chunk, shares)| {
        let mut stack = Vec::with_capacity(64);
        for (place, share) in shares.iter_mut().enumerate() {
            let v = chunk * CHUNK + place;
            let (point, normal) = (mesh.positions[v], normals[v]);
            if normal == DVec3::ZERO || !point.is_finite() {
                continue;
            }
            let start = turn_at(point);
            let frame = frame_of(normal);
            let mut n_open = 0_u32;
            for ray in 0..options.n_rays {
                if ray % STRIDE == STRIDE - 1 {
                    control.at(0.0)?;
                }
                let direction = direction(ray, options.n_rays, start, &frame);
                let origin = point + offset * normal;
                let is_blocked = tree.is_blocked(origin, direction, options.distance, &mut stack);
                n_open += u32::from(!is_blocked);
            }
            *share = f64::from(n_open) / f64::from(options.n_rays);
        }
        steps.step()
    })?;
    Ok(shares)
}

/// A turn, from 0 to 1, that a place decides.
fn turn_at(point: DVec3) -> f64 {
    // Adding 0 takes the sign of -0 away.
    let bits = (point + 0.0).to_array().map(f64::to_bits);
    let mixed = bits.iter().fold(0, |mixed, &bits| IndexedRandom::new(mixed).bits(bits));
    IndexedRandom::new(mixed).unit(0)
}

/// One of the rays: by the density of the cosine, stratified in the distance from the normal.
fn direction(ray: u32, n_rays: u32, start: f64, [x, y, z]: &[DVec3; 3]) -> DVec3 {
    // The inverse of the golden ratio.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let radius_sq = (f64::from(ray) + 0.5) / f64::from(n_rays);
    let (sin, cos) = (TAU * (start + f64::from(ray) * GOLDEN).fract()).sin_cos();
    let radius = radius_sq.sqrt();
    radius * cos * *x + radius * sin * *y + (1.0 - radius_sq).sqrt() * *z
}

/// Two directions across a unit vector, and itself: T. Duff et al., "Building an orthonormal basis,
/// revisited", Journal of Computer Graphics Techniques 6(1), 2017.
fn frame_of(z: DVec3) -> [DVec3; 3] {
    let sign = 1.0_f64.copysign(z.z);
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    let x = DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x);
    let y = DVec3::new(b, sign + z.y * z.y * a, -z.y);
    [x, y, z]
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of};

    use super::*;
    use crate::geometry::edit::transform::flipped;
    use crate::geometry::generate::{PlaneOptions, ico_sphere, plane};

    const OPTIONS: OpennessOptions = OpennessOptions { n_rays: 4000, distance: f64::INFINITY };

    fn shares(mesh: &TriMesh, options: OpennessOptions) -> Vec<f64> {
        openness(mesh, &options, Control::none()).unwrap()
    }

    #[test]
    fn faces_at_no_place_hide_nothing() {
        let far = mesh_of(&[[1e200, 0.0, 0.0], [0.0, 1e200, 0.0], [0.0, 0.0, 0.0]], &[[0, 1, 2]]);
        assert_eq!(shares(&far, OPTIONS).len(), 3);
    }

    #[test]
    fn planes_and_convex_bodies_are_open_and_their_insides_closed() {
        let plane = plane(&PlaneOptions { segments: [5, 5], ..PlaneOptions::DEFAULT });
        let sphere = ico_sphere(1.0, 2, Control::none()).unwrap();
        for mesh in [&plane, &sphere, &cube(DVec3::ZERO)] {
            assert!(shares(mesh, OPTIONS).iter().all(|share| *share == 1.0));
        }
        for mesh in [sphere, cube(DVec3::ZERO)] {
            let inside = flipped(mesh, Control::none()).unwrap();
            assert!(shares(&inside, OPTIONS).iter().all(|share| *share == 0.0));
        }
    }

    /// In the bottom of a valley between long slopes, whose normal is upright, the sky is open
    /// between the slopes: the sine of half the angle between these.
    #[test]
    fn a_valley_is_open_by_the_sine_of_half_its_angle() {
        for degrees in [20.0_f64, 45.0, 70.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let far = 1e4;
            let points = [
                [0.0, -far, 0.0],
                [0.0, 0.0, 0.0],
                [0.0, far, 0.0],
                [far * sin, -far, far * cos],
                [far * sin, far, far * cos],
                [-far * sin, -far, far * cos],
                [-far * sin, far, far * cos],
            ];
            let faces = [[0, 3, 1], [1, 3, 4], [1, 4, 2], [0, 1, 5], [1, 6, 5], [1, 2, 6]];
            let mesh = mesh_of(&points, &faces);
            let found = shares(&mesh, OPTIONS)[1];
            assert!((found - sin).abs() < 0.01, "{degrees}: {found} {sin}");
        }
    }

    /// A disk of radius r at height h above the middle of a plane hides r² / (r² + h²) of the sky.
    #[test]
    fn a_disk_hides_its_form_factor_and_nothing_beyond_the_distance() {
        let n = 64;
        let mut points = vec![[0.0; 3], [9.0, 0.0, 0.0], [-9.0, 9.0, 0.0], [-9.0, -9.0, 0.0]];
        points.push([0.0, 0.0, 2.0]);
        for k in 0..n {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(n)).sin_cos();
            points.push([1.5 * cos, 1.5 * sin, 2.0]);
        }
        let mut faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]];
        faces.extend((0..n).map(|k| [4, 5 + k, 5 + (k + 1) % n]));
        let mesh = mesh_of(&points, &faces);
        let expected = 1.0 - 2.25 / (2.25 + 4.0);
        let found = shares(&mesh, OPTIONS)[0];
        assert!((found - expected).abs() < 0.005, "{found} {expected}");
        assert_eq!(shares(&mesh, OpennessOptions { distance: 1.9, ..OPTIONS })[0], 1.0);
    }

    #[test]
    fn what_has_no_normal_has_no_share() {
        let mesh = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0]], &[[0, 1, 2]]);
        assert!(shares(&mesh, OPTIONS).iter().all(|share| share.is_nan()));
        assert!(shares(&TriMesh::default(), OPTIONS).is_empty());
    }

    #[test]
    fn frames_are_upright() {
        for z in [DVec3::Z, DVec3::NEG_Z, DVec3::new(0.6, -0.48, 0.64), DVec3::X] {
            let [x, y, _] = frame_of(z);
            assert!(x.cross(y).distance(z) < 1e-15 && x.dot(y).abs() < 1e-15, "{z}");
        }
    }
}
