//! Real models: the same surface as tobj, trimesh and MeshLab read, and round trips.
//!
//! The numbers are of the triangles that trimesh 5.2.0 and PyMeshLab 2025.7 read, which agree:
//! half the sum of |(b - a) × (c - a)| and a sixth of the sum of a · (b × c), summed by numpy. For
//! Suzanne those are 12.468539112387251 and 2.593076421933958, since both fan its four concave
//! quadrilaterals to the outside; the numbers below are with these four cut within.

use std::path::Path;

use glam::DVec3;
use mve_core::Control;
use mve_mesh::data::{Layer, TriMesh, VertexId};
use mve_mesh::testing::model;

use super::tests::{read, written};
use super::*;

fn load_model(path: &Path) -> TriMesh {
    let (mesh, warnings) = load(path, Control::none()).expect("load");
    assert_eq!(warnings, []);
    assert_eq!(mesh.check(), Ok(()));
    mesh
}

fn is_near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-11 * expected.abs()
}

#[test]
fn models_measure_what_trimesh_and_meshlab_find() {
    for (name, n_vertices, n_faces, area, volume) in [
        ("cow", 2903, 5804, 108.84536412297015, 53.567445842479465),
        ("suzanne", 507, 968, 12.46424717406228, 2.5931172725300677),
        ("spot", 2930, 5856, 5.709518785165158, 0.7182587880998647),
        ("fandisk", 6475, 12946, 60.669109234919674, 20.243374882839458),
        ("stanford-bunny", 35947, 69451, 0.057128786060864294, 0.0007700565238985447),
    ] {
        let Some(path) = model(&format!("{name}.obj")) else { continue };
        let mesh = load_model(&path);
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (n_vertices, n_faces), "{name}");
        let found = (mesh.area(), mesh.signed_volume());
        assert!(is_near(found.0, area), "{name}: {found:?}");
        assert!(is_near(found.1, volume), "{name}: {found:?}");
    }
}

#[test]
fn models_survive_a_round_trip() {
    for name in ["cow", "suzanne", "spot", "fandisk"] {
        let Some(path) = model(&format!("{name}.obj")) else { continue };
        let mesh = load_model(&path);
        let text = written(&mesh);
        let (again, warnings) = read(&text).expect("read");
        assert_eq!((again == mesh, warnings), (true, Vec::new()), "{name}");
        assert!(written(&again) == text, "{name}");
    }
}

#[test]
fn seams_of_spot_have_several_texture_coordinates_a_vertex() {
    let Some(path) = model("spot.obj") else { return };
    let mesh = load_model(&path);
    let layer = mesh.layer(Layer::TEXCOORD).expect("texcoord");
    assert_eq!(layer.values.len(), 3225);
    let corners = mesh.faces.iter().flatten().zip(&layer.index);
    let wedges: std::collections::BTreeSet<_> = corners.collect();
    assert_eq!(wedges.len(), 3225);
}

/// All triangles that tobj reads, as points.
fn peer_triangles(text: &[u8]) -> (Vec<[DVec3; 3]>, Vec<tobj::Model>) {
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let no_mtl = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut &text[..], &options, no_mtl).expect("tobj");
    let point = |model: &tobj::Model, i: u32| {
        DVec3::from_slice(&model.mesh.positions[3 * i as usize..3 * i as usize + 3])
    };
    let triangles = models
        .iter()
        .flat_map(|model| {
            model
                .mesh
                .indices
                .chunks_exact(3)
                .map(move |t| [t[0], t[1], t[2]].map(|i| point(model, i)))
        })
        .collect();
    (triangles, models)
}

#[test]
fn tobj_reads_the_same_triangles() {
    for name in ["cow", "spot", "fandisk", "stanford-bunny"] {
        let Some(path) = model(&format!("{name}.obj")) else { continue };
        let text = std::fs::read(path).expect("read");
        let (mesh, _) = read(&text).expect("ours");
        let ours: Vec<[DVec3; 3]> =
            mesh.faces.iter().map(|f| f.map(|v| mesh.positions[v.idx()])).collect();
        // Digits are read exactly by both, so that nothing but equality will do.
        assert!(ours == peer_triangles(&text).0, "{name}");
    }
}

/// Why the reader is our own: what tobj makes of a file with two groups, a vertex that no face
/// uses and a concave quadrilateral.
#[test]
fn tobj_splits_groups_renumbers_vertices_and_fans_concave_polygons() {
    let text = "v 9 9 9\nv 0 0 0\nv 4 -3 0\nv 0 6 0\nv 1 0.5 0\ng a\nf 5 2 3\ng b\nf 2 3 4 5\n";
    let (triangles, models) = peer_triangles(text.as_bytes());
    let counts: Vec<usize> = models.iter().map(|m| m.mesh.positions.len() / 3).collect();
    assert_eq!(counts, [3, 4], "five vertices of the file, three of them twice and one dropped");
    assert_eq!(models[0].mesh.positions[..2], [1.0, 0.5], "the file's vertex 5 is now the first");

    let (mesh, _) = read(text).expect("ours");
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(mesh.faces[0], [4, 1, 2].map(VertexId));
    let area = |triangles: &[[DVec3; 3]]| -> f64 {
        let doubled = triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a).length());
        doubled.sum::<f64>() / 2.0
    };
    let ours: Vec<_> = mesh.faces.iter().map(|f| f.map(|v| mesh.positions[v.idx()])).collect();
    let (ours, fan) = (area(&ours[1..]), area(&triangles[1..]));
    assert!(fan > 1.2 * ours, "the fan covers {fan} where the polygon has {ours}");

    let bad = tobj::load_obj_buf(&mut &b"v 0 0 0\nv 1 x 0\n"[..], &Default::default(), |_| {
        Err(tobj::LoadError::OpenFileFailed)
    });
    let message = bad.expect_err("a letter").to_string();
    assert!(!message.contains('2'), "no line number: {message}");
}
