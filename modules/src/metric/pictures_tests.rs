//! What holds for every metric on pictures.

use std::ops::ControlFlow;

use glam::DVec3;
use mve_mesh::fixtures::{cube, mesh_of, tetrahedron, torus};

use super::*;
use crate::metric::Metric;
use crate::picture::render::{Albedo, CameraSet, Shading, Sides};

/// A view that takes little time.
pub fn small() -> View {
    View {
        cameras: CameraSet::Rhombicuboctahedron,
        size: 48,
        albedo: Albedo::White,
        shading: Shading::Flat,
        sides: Sides::Both,
        background: 0,
    }
}

/// What holds for every metric on pictures.
pub fn check_contract(metric: &dyn Metric) {
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
    // Pictures are more than meshes of few faces.
    let few = metric.compare(&tetrahedron(), &tetrahedron(), Control::none()).unwrap();
    let sets = [few.original_images, few.simplified_images, few.difference_images];
    let given: usize = sets.iter().flat_map(|set| &set.0).map(|image| image.bytes.len()).sum();
    assert!(metric.bytes(&tetrahedron(), &tetrahedron()) > given);
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
