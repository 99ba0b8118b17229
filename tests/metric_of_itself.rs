//! Every metric of a mesh with itself has its perfect value, mostly 0, whatever the mesh.

use glam::DVec3;
use mve_core::testing::Trial;
use mve_modules::data::{Measures, TriMesh, VertexId};
use mve_modules::mesh::fixtures::{cube, torus};
use mve_modules::metric::METRICS;
use mve_modules::registry;
use serde_json::json;

use crate::contracts::meshes;

/// The value of a measure for equal meshes; `None` of one that says what one of them is like: what
/// is counted, a size, an infinite ratio.
fn perfect(name: &str) -> Option<f64> {
    const OF_ONE_MESH: [&str; 15] = [
        "by_index",
        "diagonal",
        "largest_angle",
        "least_angle",
        "least_quality",
        "mean_least_angle",
        "original_area",
        "original_quality",
        "original_roughness",
        "original_volume",
        "psnr",
        "quality",
        "simplified_area",
        "simplified_roughness",
        "simplified_volume",
    ];
    match name {
        name if OF_ONE_MESH.contains(&name) || name.ends_with("_samples") => None,
        "area_ratio" => Some(1.0),
        name if name.starts_with("ssim") => Some(1.0),
        _ => Some(0.0),
    }
}

/// Meshes whose parts lie on each other or far away.
fn touching() -> Vec<(&'static str, TriMesh)> {
    let ring = torus(2.0, 0.5, 16);
    let mut split = ring.clone();
    split.positions = ring.faces.iter().flat_map(|f| f.map(|v| ring.positions[v.idx()])).collect();
    split.faces =
        (0..ring.faces.len() as u32).map(|f| [0, 1, 2].map(|k| VertexId(3 * f + k))).collect();
    let mut doubled = ring.clone();
    doubled.faces.extend_from_within(..7);
    let mut inside_out = split.clone();
    inside_out.faces.extend(split.faces.iter().map(|&[a, b, c]| [c, b, a]));
    let mut sheets = ring.clone();
    let n = ring.positions.len() as u32;
    sheets.positions.extend_from_within(..);
    sheets.faces.extend(ring.faces[..90].iter().map(|f| f.map(|v| VertexId(v.0 + n))));
    let mut far = ring.clone();
    far.positions.iter_mut().for_each(|p| *p += DVec3::new(4e6, 5e5, 300.0));
    let mut cubes = cube(DVec3::ZERO);
    let beside = cube(DVec3::X);
    cubes.positions.extend(beside.positions);
    cubes.faces.extend(beside.faces.iter().map(|f| f.map(|v| VertexId(v.0 + 8))));
    vec![
        ("faces that share no vertices", split),
        ("doubled faces", doubled),
        ("both sides of every face", inside_out),
        ("a sheet over a part of another", sheets),
        ("map coordinates", far),
        ("cubes side by side", cubes),
    ]
}

#[test]
fn a_metric_of_a_mesh_with_itself_is_perfect() {
    let comparer = registry().find("MeshComparer").expect("the module").module;
    for (name, mesh) in meshes().into_iter().chain(touching()) {
        let diagonal = mesh.diagonal();
        for metric in METRICS.entries.iter().map(|listed| listed.item) {
            let takes_pictures = metric.params.iter().any(|param| param.name == "resolution");
            let params = if takes_pictures { json!({ "resolution": 64 }) } else { json!({}) };
            let trial = Trial::of(comparer).set("metric", json!({ metric.id: params }));
            let trial = trial.input("original", mesh.clone()).input("simplified", mesh.clone());
            let Ok(outputs) = trial.run() else { continue };
            let measures = outputs["measures"].get::<Measures>().expect("measures");
            for measure in &measures.0 {
                let Some(perfect) = perfect(&measure.name) else { continue };
                let limit = if measure.unit == "model units" { 1e-8 * diagonal } else { 1e-8 };
                let is_perfect = (measure.value - perfect).abs() <= limit;
                assert!(is_perfect, "{} of {name}: {measure:?}", metric.id);
            }
        }
    }
}
