//! Image RMS of pictures known by hand, and of odd meshes.

use glam::DVec3;

use super::*;
use crate::mesh::fixtures::{cube, tetrahedron};
use crate::metric::pictures::tests::{check_contract, small};

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
