//! Image RMS of pictures known by hand, and of odd meshes.

use std::ops::ControlFlow;

use glam::DVec3;

use super::*;
use crate::mesh::fixtures::{cube, mesh_of, tetrahedron, torus};
use crate::picture::render::{CameraSet, Shading, Sides};

/// A view that takes little time.
pub(in crate::metric) fn small() -> View {
    View {
        cameras: CameraSet::Rhombicuboctahedron,
        size: 48,
        shading: Shading::Flat,
        sides: Sides::Both,
        background: 0,
    }
}

/// What holds for both metrics on pictures.
pub(in crate::metric) fn check_contract(metric: &dyn Metric) {
    let (fine, coarse) = (torus(2.0, 0.5, 40), torus(2.0, 0.5, 9));
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    let on = |n| pool(n).install(|| metric.compare(&fine, &coarse, Control::none()).unwrap());
    assert_eq!(on(1), on(3));

    let nothing = metric.compare(&fine, &TriMesh::default(), Control::none()).unwrap();
    assert_eq!(nothing.warnings, ["the simplified mesh has no faces; its pictures are empty"]);
    let mut broken = tetrahedron();
    broken.positions[1].x = f64::NAN;
    let found = metric.compare(&fine, &broken, Control::none()).unwrap();
    assert!(found.warnings[0].starts_with("3 faces of the simplified mesh"), "{found:?}");
    let point = mesh_of(&[[1.0; 3]; 3], &[[0, 1, 2]]);
    for bad in [TriMesh::default(), point] {
        let error = metric.compare(&bad, &fine, Control::none()).unwrap_err();
        assert!(error.to_string().starts_with("the original mesh has no finite extent"), "{error}");
    }
    // A mesh far outside of every picture, and around every camera.
    for low in [DVec3::splat(1e9), DVec3::splat(-0.5)] {
        metric.compare(&fine, &cube(low), Control::none()).unwrap();
    }
    let stop = |_| ControlFlow::Break(());
    let stopped = metric.compare(&fine, &coarse, Control::new(&stop));
    assert!(matches!(stopped, Err(MetricError::Cancelled(_))));
}

#[test]
fn equal_meshes_differ_by_nothing() {
    let metric = ImageRmsMetric { view: small() };
    let found = metric.compare(&tetrahedron(), &tetrahedron(), Control::none()).unwrap();
    assert_eq!(found.scalars[0].name, "rms");
    assert_eq!((found.scalar("rms"), found.scalar("psnr")), (Some(0.0), Some(f64::INFINITY)));
    assert_eq!(found.scalars.len(), 2 + 24);
    assert_eq!(found.original_images, found.simplified_images);
}

#[test]
fn against_nothing_it_is_the_luminance_itself() {
    // The root mean square of the luminance of a cube against a black picture.
    let metric = ImageRmsMetric { view: small() };
    let found = metric.compare(&cube(DVec3::ZERO), &TriMesh::default(), Control::none()).unwrap();
    let bytes: Vec<u8> = found.original_images.0.iter().flat_map(|i| i.bytes.clone()).collect();
    let sum: f64 = bytes.iter().map(|&byte| f64::from(byte).powi(2)).sum();
    let expected = (sum / bytes.len() as f64).sqrt();
    assert!((found.scalar("rms").unwrap() - expected).abs() < 1e-12);
    assert_eq!(found.difference_images, found.original_images);
    let mean: f64 = (0..24).map(|k| found.scalar(&format!("rms_{k}")).unwrap().powi(2)).sum();
    assert!(((mean / 24.0).sqrt() - expected).abs() < 1e-12);
    // Every camera of this set sees one side of the cube at a cosine of (1 + √2) / √(5 + 2√2) and
    // two at 1 / √(5 + 2√2): 220 and 91 of 255.
    assert!(bytes.iter().all(|byte| [0, 220, 91].contains(byte)));
    assert!([0, 220, 91].iter().all(|byte| bytes.contains(byte)));
}

#[test]
fn it_stands_any_mesh_and_any_number_of_threads() {
    check_contract(&ImageRmsMetric { view: small() });
}
