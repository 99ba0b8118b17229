//! Tests of the facts about a mesh.

use mve_mesh::fixtures::{cube, mesh_of, tetrahedron, torus};

use super::*;
use crate::test_models::model;

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-12 * expected.abs()
}

fn info_of(mesh: &TriMesh) -> MeshInfo {
    mesh_info(mesh, Control::none()).unwrap()
}

#[test]
fn a_tetrahedron_is_a_sphere() {
    let info = info_of(&tetrahedron());
    assert_eq!((info.n_vertices, info.n_edges, info.n_faces), (4, 6, 4));
    assert_eq!((info.euler_characteristic, info.genus), (2, Some(0)));
    assert!(info.is_closed() && info.is_manifold() && info.is_oriented());
    assert!(near(info.area, 1.5 + 3f64.sqrt() / 2.0));
    assert!(near(info.volume.unwrap(), 1.0 / 6.0));
    assert_eq!(info.bounds, Some((DVec3::ZERO, DVec3::ONE)));
}

#[test]
fn a_torus_has_a_handle_and_two_cubes_have_none() {
    let info = info_of(&torus(2.0, 0.5, 12));
    assert_eq!((info.euler_characteristic, info.genus), (0, Some(1)));
    let mut two = cube(DVec3::ZERO);
    let other = cube(DVec3::splat(1e6));
    two.positions.extend(other.positions);
    two.faces.extend(other.faces.iter().map(|f| f.map(|v| VertexId(v.0 + 8))));
    let info = info_of(&two);
    assert_eq!((info.n_components_by_edge, info.genus), (2, Some(0)));
    // From a center 5e5 away the parts of a sum of 2 are 1e11 wide: eleven digits are gone.
    assert!((info.volume.unwrap() - 2.0).abs() < 1e-3);
    assert!(near(info_of(&other_cube()).volume.unwrap(), 1.0));
}

fn other_cube() -> TriMesh {
    cube(DVec3::splat(1e6))
}

#[test]
fn an_open_cube_has_one_border_and_no_volume() {
    let mut open = cube(DVec3::ZERO);
    open.faces.truncate(10);
    let info = info_of(&open);
    assert_eq!((info.n_border_edges, info.n_border_loops), (4, 1));
    assert_eq!((info.euler_characteristic, info.genus, info.volume), (1, Some(0), None));
    assert!(!info.is_closed() && info.is_manifold());
}

/// Holes that touch at a vertex are two loops: each stays with its fan.
#[test]
fn two_triangles_at_a_point() {
    let info = info_of(&mesh_of(&[[0.0; 3]; 5], &[[0, 1, 2], [0, 3, 4]]));
    assert_eq!((info.n_border_edges, info.n_border_loops), (6, 2));
    assert_eq!((info.n_components_by_vertex, info.n_components_by_edge), (1, 2));
    assert_eq!((info.n_non_manifold_vertices, info.genus), (1, None));
    assert_eq!(info.n_zero_area_faces, 2);
}

#[test]
fn faults_are_counted() {
    let mut mesh = tetrahedron();
    mesh.positions.push(DVec3::NAN);
    mesh.positions.push(DVec3::ZERO);
    let face = |f: [u32; 3]| f.map(VertexId);
    mesh.faces.extend([face([2, 1, 0]), face([0, 0, 1]), face([0, 1, 4])]);
    let info = info_of(&mesh);
    assert_eq!((info.n_duplicate_faces, info.n_degenerate_index_faces), (1, 1));
    assert_eq!((info.n_zero_area_faces, info.n_non_finite_faces), (1, 1));
    assert_eq!(info.n_isolated_vertices, 1);
    assert_eq!(info.n_non_manifold_edges, 3);
    assert_eq!((info.genus, info.volume), (None, None));
    assert!(near(info.area, 2.0 + 3f64.sqrt() / 2.0));
}

#[test]
fn a_turned_face_is_not_oriented() {
    let mut mesh = tetrahedron();
    mesh.faces[0].swap(1, 2);
    let info = info_of(&mesh);
    assert_eq!((info.n_inconsistent_edges, info.genus, info.volume), (3, None, None));
}

#[test]
fn nothing_is_not_closed() {
    let info = info_of(&TriMesh::default());
    assert!(!info.is_closed());
    assert_eq!((info.n_components_by_vertex, info.volume, info.bounds), (0, None, None));
    assert_eq!(info.genus, Some(0));
}

/// Numbers of trimesh 5.2, PyMeshLab 2025.7 and libigl 2.6.3, which agree where they count the
/// same: area and volume are those of trimesh (`f64`), and PyMeshLab counts the one non-manifold
/// edge of suzanne once for each of its four faces.
#[test]
fn real_models() {
    // Name, edges, χ, components by edge, border edges and loops, non-manifold edges and vertices,
    // duplicates, isolated, genus, area, volume.
    type Row = (&'static str, [usize; 8], i64, Option<u64>, f64, Option<f64>);
    let rows: [Row; 5] = [
        (
            "cow.obj",
            [8706, 1, 0, 0, 0, 1, 0, 0],
            1,
            None,
            108.84536412297015,
            Some(53.567445842479465),
        ),
        (
            "fandisk.obj",
            [19419, 1, 0, 0, 0, 0, 0, 0],
            2,
            Some(0),
            60.669109234919674,
            Some(20.243374882839458),
        ),
        (
            "spot.obj",
            [8784, 1, 0, 0, 0, 0, 0, 0],
            2,
            Some(0),
            5.709518785165158,
            Some(0.7182587880998647),
        ),
        (
            "stanford-bunny.obj",
            [104288, 1, 223, 5, 0, 0, 0, 1113],
            -3,
            Some(0),
            0.057128786060864294,
            None,
        ),
        ("suzanne.obj", [1472, 3, 42, 4, 1, 0, 1, 0], 3, None, 12.468539112387251, None),
    ];
    for (name, counts, euler, genus, area, volume) in rows {
        let Some(mesh) = model(name) else { return };
        let info = info_of(&mesh);
        let found = [
            info.n_edges,
            info.n_components_by_edge,
            info.n_border_edges,
            info.n_border_loops,
            info.n_non_manifold_edges,
            info.n_non_manifold_vertices,
            info.n_duplicate_faces,
            info.n_isolated_vertices,
        ];
        assert_eq!(found, counts, "{name}");
        assert_eq!((info.euler_characteristic, info.genus), (euler, genus), "{name}");
        assert!(near(info.area, area), "{name}: {}", info.area);
        match (info.volume, volume) {
            (Some(found), Some(expected)) => assert!(near(found, expected), "{name}: {found}"),
            (found, expected) => assert_eq!(found, expected, "{name}"),
        }
        assert!(info.is_oriented(), "{name}");
    }
}
