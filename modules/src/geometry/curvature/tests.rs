//! Tests of curvature: spheres and tori whose curvature is known, borders, odd meshes.

use mve_core::Control;
use mve_mesh::fixtures::{cube, mesh_of, tetrahedron, torus};

use super::*;
use crate::geometry::surface::subdivide::{Scheme, subdivide};
use crate::test_models;

const FITS: [FitOptions; 3] = [
    FitOptions { ring: 1, degree: 2 },
    FitOptions { ring: 2, degree: 3 },
    FitOptions { ring: 2, degree: 4 },
];

fn both(mesh: &TriMesh) -> Vec<Vec<Curvature>> {
    let fits = FITS.map(|options| quadric_fit(mesh, options, Control::none()).unwrap());
    std::iter::once(discrete(mesh, Control::none()).unwrap()).chain(fits).collect()
}

fn sphere(radius: f64) -> TriMesh {
    let mut mesh = subdivide(tetrahedron(), Scheme::Midpoint, 5, Control::none()).unwrap();
    let center = DVec3::splat(0.25);
    mesh.positions.iter_mut().for_each(|p| *p = radius * (*p - center).normalize());
    mesh
}

#[test]
fn a_sphere_bends_by_the_inverse_of_its_radius() {
    // The triangles are far from even, and their worst ones far from what a fit can bear.
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let mut cavity = sphere(2.0);
    cavity.faces.iter_mut().for_each(|face| face.swap(1, 2));
    for (mesh, mean) in [(sphere(2.0), 0.5), (cavity, -0.5)] {
        for found in both(&mesh) {
            let off = median(found.iter().map(|c| (c.mean / mean - 1.0).abs()).collect());
            assert!(off < 0.01, "{off}");
            let off = median(found.iter().map(|c| (c.gaussian / 0.25 - 1.0).abs()).collect());
            assert!(off < 0.02, "{off}");
        }
    }
}

#[test]
fn angle_defects_of_a_cube_are_right_angles() {
    // A cube has three right angles at each of its vertices, whose defect is π/2. The mixed areas
    // of all vertices add up to its area.
    let found = discrete(&cube(DVec3::ZERO), Control::none()).unwrap();
    let inverse_sum: f64 = found.iter().map(|c| std::f64::consts::FRAC_PI_2 / c.gaussian).sum();
    assert!((inverse_sum - 6.0).abs() < 1e-12, "{inverse_sum}");
}

#[test]
fn the_directions_of_a_torus_run_around_its_tube_and_its_axis() {
    let mesh = torus(1.0, 0.3, 60);
    for found in both(&mesh) {
        for (curvature, p) in found.iter().zip(&mesh.positions) {
            let around_axis = DVec3::new(-p.y, p.x, 0.0).normalize();
            assert!(curvature.min_direction.dot(around_axis).abs() > 0.99, "{curvature:?}");
            assert!(curvature.max_direction.dot(around_axis).abs() < 0.1, "{curvature:?}");
            assert!((curvature.max_direction.length() - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_fit_of_a_quadric_is_exact_also_at_the_border() {
    let n = 8;
    let point = |i: u32, j: u32| {
        let [x, y] = [i, j].map(|k| f64::from(k) / 4.0 - 1.0);
        [x, y, 0.5 * (x * x - 3.0 * y * y)]
    };
    let points: Vec<[f64; 3]> = (0..=n).flat_map(|i| (0..=n).map(move |j| point(i, j))).collect();
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let faces: Vec<[u32; 3]> = (0..n * n)
        .flat_map(|cell| {
            let (i, j) = (cell / n, cell % n);
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let mesh = mesh_of(&points, &faces);
    let found = quadric_fit(&mesh, FitOptions { ring: 2, degree: 2 }, Control::none()).unwrap();
    // In the middle the frame is that of the quadric: z bends up by 1 along x, which is concave,
    // and down by 3 along y.
    let middle = found[at(4, 4) as usize];
    assert!((middle.maximum - 3.0).abs() < 1e-9 && (middle.minimum + 1.0).abs() < 1e-9);
    assert!(middle.max_direction.y.abs() > 1.0 - 1e-9, "{middle:?}");
    assert!(found.iter().all(|c| c.mean.is_finite() && c.gaussian < 0.0));
    let by_angles = discrete(&mesh, Control::none()).unwrap();
    assert!(by_angles[0].mean.is_nan() && by_angles[at(4, 4) as usize].gaussian < 0.0);
}

#[test]
fn size_and_place_scale_out() {
    let mesh = torus(1.0, 0.3, 12);
    for scale in [1e-170, 1e170] {
        let mut other = mesh.clone();
        other.positions.iter_mut().for_each(|p| *p *= scale);
        for (one, two) in both(&mesh).into_iter().zip(both(&other)) {
            for (one, two) in one.iter().zip(&two) {
                assert!((two.maximum * scale / one.maximum - 1.0).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn what_has_no_curvature_says_so() {
    let flat = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2], [0, 1, 1]]);
    for found in both(&flat) {
        assert!(found.iter().all(|c| c.mean.is_nan() && c.max_direction == DVec3::ZERO));
    }
    // A wheel of more spokes than points are ever looked at.
    let n = 3000;
    let rim = |k: u32| (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
    let points: Vec<_> = (0..n).map(|k| [rim(k).0, rim(k).1, 0.0]).chain([[0.0; 3]]).collect();
    let faces: Vec<_> = (0..n).map(|k| [k, n, (k + 1) % n]).collect();
    assert_eq!(both(&mesh_of(&points, &faces))[1].len(), 3001);
}

/// Whether a vertex is far from borders, and the analytic mean, Gaussian, larger and smaller
/// curvature.
type Expected = (bool, [f64; 4]);

/// A reference mesh with what is known of its vertices.
fn reference(name: &str) -> Option<(TriMesh, Vec<Expected>)> {
    let read = |file: String| test_models::reference(&format!("models/{file}"));
    let mut mtl = |_: &str| Ok(Vec::new());
    let obj = read(format!("curv_{name}.obj.gz"))?;
    let (mesh, _) = mve_formats::obj::parse(obj.as_bytes(), &mut mtl, Control::none()).unwrap();
    let rows = read(format!("curv_{name}_values.csv.gz"))?;
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|word| word.parse().unwrap()).collect();
        (numbers[1] == 1.0, [numbers[2], numbers[3], numbers[4], numbers[5]])
    };
    Some((mesh, rows.lines().skip(1).map(row).collect()))
}

/// The largest errors of the four values over the inner vertices, relative to the largest absolute
/// principal curvature of the surface, or its square.
fn errors(found: &[Curvature], expected: &[Expected]) -> [f64; 4] {
    let largest = expected.iter().flat_map(|(_, e)| [e[2].abs(), e[3].abs()]).fold(0.0, f64::max);
    let mut errors = [0.0f64; 4];
    for (found, (_, expected)) in found.iter().zip(expected).filter(|(_, (inner, _))| *inner) {
        let found = [found.mean, found.gaussian, found.maximum, found.minimum];
        for k in 0..4 {
            let unit = if k == 1 { largest * largest } else { largest };
            let off = (found[k] - expected[k]).abs() / unit;
            errors[k] = if off.is_nan() { f64::INFINITY } else { errors[k].max(off) };
        }
    }
    errors
}

/// The largest errors at any inner vertex. Against the smallest radius, edges are 0.08 long on the
/// sphere, 0.24 on the torus, 0.12 on the cylinder and 0.04 on the saddle.
#[test]
fn references_agree_to_one_percent() {
    for name in ["sphere", "torus", "cylinder", "saddle"] {
        let Some((mesh, expected)) = reference(name) else { return };
        for (method, found) in both(&mesh).iter().enumerate() {
            let errors = errors(found, &expected);
            let allowed = match (method, name) {
                // On its alternating grid the angle defect itself is off.
                (0, "saddle") => [0.02, 0.05, 0.05, 0.05],
                // Two rings are wide for a cubic.
                (2, "torus") => [0.03, 0.03, 0.05, 0.03],
                (2, _) => [0.01, 0.02, 0.02, 0.01],
                _ => [0.01; 4],
            };
            let is_near = errors.iter().zip(allowed).all(|(error, allowed)| *error < allowed);
            eprintln!("{name} {method} {errors:.5?}");
            assert!(is_near, "{name} {method}: {errors:.5?}");
        }
    }
}
