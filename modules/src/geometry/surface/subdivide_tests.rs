//! Tests of subdivision: known answers by hand, values of a peer, layers, odd meshes.

use mve_mesh::fixtures::{cube, mesh_of, tetrahedron, torus};

use super::*;
use crate::geometry::generate::{BoxOptions, subdivided_box};
use crate::test_models::model;

fn run(mesh: TriMesh, scheme: Scheme, levels: u32) -> TriMesh {
    let mesh = subdivide(mesh, scheme, levels, Control::none()).unwrap();
    assert_eq!(mesh.check(), Ok(()));
    mesh
}

fn assert_near(found: DVec3, expected: [f64; 3]) {
    assert!((found - DVec3::from(expected)).length() < 1e-15, "{found} {expected:?}");
}

#[test]
fn a_tetrahedron_by_hand() {
    let mesh = run(tetrahedron(), Scheme::Loop, 1);
    // Valence 3: 7/16 of the vertex and 3/16 of each neighbor.
    assert_near(mesh.positions[0], [3.0 / 16.0; 3]);
    assert_near(mesh.positions[1], [7.0 / 16.0, 3.0 / 16.0, 3.0 / 16.0]);
    // The edge 0–1: 3/8 of its ends and 1/8 of the two vertices across.
    assert_near(mesh.positions[4], [0.375, 0.125, 0.125]);
    let first: Vec<_> = mesh.faces[..4].iter().map(|f| f.map(|v| v.0)).collect();
    // The face (0, 2, 1); the middles of 0–2, 1–2 and 0–1 are vertices 5, 7 and 4.
    assert_eq!(first, [[0, 5, 4], [5, 2, 7], [4, 7, 1], [5, 7, 4]]);
}

#[test]
fn borders_are_curves_of_their_own() {
    // A square of two triangles: all vertices are on the border and have two creases.
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = run(mesh_of(&corners, &[[0, 1, 2], [0, 2, 3]]), Scheme::Loop, 1);
    assert_near(mesh.positions[0], [0.125, 0.125, 0.0]);
    assert_near(mesh.positions[4], [0.5, 0.0, 0.0]);
    // The diagonal 0–2 has two faces.
    assert_near(mesh.positions[5], [0.5, 0.5, 0.0]);
}

#[test]
fn where_the_surface_is_not_manifold_it_is_creased() {
    let corners =
        [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let mesh = mesh_of(&corners, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    let mesh = run(mesh, Scheme::Loop, 1);
    // The edge of three faces; its ends have four creases each and stay.
    assert_near(mesh.positions[5], [0.0; 3]);
    assert_near(mesh.positions[0], corners[0]);
    // Two parts that touch at a vertex: it stays.
    let mesh = mesh_of(&corners, &[[0, 1, 2], [0, 3, 4]]);
    assert_near(run(mesh, Scheme::Loop, 1).positions[0], corners[0]);
}

#[test]
fn midpoints_keep_the_surface() {
    let mesh = torus(1.0, 0.4, 7);
    let (area, volume) = (mesh.area(), mesh.signed_volume());
    let fine = run(mesh, Scheme::Midpoint, 3);
    assert_eq!((fine.faces.len(), fine.positions.len()), (98 * 64, 49 * 64));
    assert!((fine.area() - area).abs() < 1e-12 && (fine.signed_volume() - volume).abs() < 1e-12);
}

/// Area, and sum of the squared distances of the vertices from the origin. The numbers are those of
/// trimesh 5.2.0, `remesh.subdivide_loop` with 2 iterations. On the torus vtk 9.7.2,
/// `vtkLoopSubdivisionFilter`, has the same vertices to 6e-8: it computes in single precision.
#[test]
fn loop_agrees_with_a_peer() {
    let mut open = cube(DVec3::ZERO);
    open.faces.drain(..2);
    let peers = [
        // All vertices have six neighbors; four and five, and six; and with a border.
        (torus(1.0, 0.4, 5), [8.519836614579795, 274.9882081365264]),
        (cube(DVec3::ZERO), [2.6443109846326376, 95.04257210344076]),
        (open, [2.8098715017190883, 88.7783031873405]),
    ];
    for (mesh, expected) in peers {
        let fine = run(mesh, Scheme::Loop, 2);
        let squares: f64 = fine.positions.iter().map(|p| p.length_squared()).sum();
        for (found, expected) in [fine.area(), squares].into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }
}

/// The same of vtk 9.7.2, `vtkButterflySubdivisionFilter` with 2 subdivisions, which computes in
/// single precision: vertices of three, four and six neighbors, and many on a model.
#[test]
fn butterfly_agrees_with_a_peer() {
    let corners = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5]];
    let mut octahedron = mesh_of(&corners.map(|p| p.to_array()), &faces);
    octahedron.faces.push([0, 3, 5].map(VertexId));
    let mut peers = vec![
        (tetrahedron(), [3.7422301853252575, 19.132811808958664]),
        (octahedron, [9.934051268830856, 54.7353515625]),
        (torus(1.0, 0.4, 7), [15.258776083008271, 892.5404139375294]),
    ];
    let spot = model("spot.obj").map(|spot| (spot, [5.73801913059459, 26181.89834570475]));
    peers.extend(spot);
    for (mesh, expected) in peers {
        let n_old = mesh.positions.len();
        let fine = run(mesh.clone(), Scheme::Butterfly, 2);
        assert_eq!(fine.positions[..n_old], mesh.positions[..]);
        let squares: f64 = fine.positions.iter().map(|p| p.length_squared()).sum();
        for (found, expected) in [fine.area(), squares].into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
    }
}

#[test]
fn butterfly_by_hand() {
    // Both ends have three neighbors: 7/12 of them, -1/12 of the two vertices across.
    let mesh = run(tetrahedron(), Scheme::Butterfly, 1);
    assert_near(mesh.positions[4], [7.0 / 12.0, -1.0 / 12.0, -1.0 / 12.0]);
    // A square's border goes through its corners: 9/16 of its ends, -1/16 of the two others.
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mesh = run(mesh_of(&corners, &[[0, 1, 2], [0, 2, 3]]), Scheme::Butterfly, 1);
    assert_near(mesh.positions[4], [0.5, -0.125, 0.0]);
    // Three faces at an edge: a crease that ends at both of its ends goes on straight.
    let corners =
        [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let mesh = mesh_of(&corners, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
    assert_near(run(mesh, Scheme::Butterfly, 1).positions[5], [0.0; 3]);
}

#[test]
fn seams_stay_seams_and_all_layers_come_along() {
    let mut mesh = subdivided_box(&BoxOptions { segments: 1, ..BoxOptions::DEFAULT });
    let (n_vertices, n_faces) = (mesh.positions.len(), mesh.faces.len());
    // Each pair of faces is an island of texture: 4 values for 6 corners.
    let texcoords = (0..4 * n_faces / 2).map(|i| DVec2::new(i as f64, -(i as f64))).collect();
    let mut islands = Vec::new();
    for pair in 0..n_faces / 2 {
        let mut known: Vec<VertexId> = Vec::new();
        for vertex in mesh.faces[2 * pair..2 * pair + 2].iter().flatten() {
            let place = known.iter().position(|v| v == vertex).unwrap_or(known.len());
            if place == known.len() {
                known.push(*vertex);
            }
            islands.push((4 * pair + place) as u32);
        }
    }
    let mut put = |name: &str, domain, values, index| {
        mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
    };
    put(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(texcoords), islands);
    let normals = mesh_normals(n_vertices);
    put(Layer::NORMAL, Domain::Vertex, normals, (0..n_vertices as u32).collect());
    let labels = LayerValues::Label(vec!["a".into(), "b".into()]);
    put(Layer::GROUP, Domain::Face, labels, (0..n_faces as u32).map(|f| f % 2).collect());
    let fine = run(mesh, Scheme::Loop, 1);
    // 4 values and 5 edges an island: its diagonal has one value, the seams around have their own.
    assert_eq!(fine.layer(Layer::TEXCOORD).unwrap().values.len(), 9 * n_faces / 2);
    let LayerValues::Vec3(normals) = &fine.layer(Layer::NORMAL).unwrap().values else { panic!() };
    assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-15));
    assert_eq!(fine.layer(Layer::GROUP).unwrap().index[..8], [0, 0, 0, 0, 1, 1, 1, 1]);
}

fn mesh_normals(n: usize) -> LayerValues {
    LayerValues::Vec3((0..n).map(|i| DVec3::new((i as f64).cos(), (i as f64).sin(), 0.0)).collect())
}

#[test]
fn odd_faces_are_cut_too() {
    let mesh = mesh_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 1], [0, 1, 2]]);
    for scheme in [Scheme::Midpoint, Scheme::Loop, Scheme::Butterfly] {
        assert_eq!(run(mesh.clone(), scheme, 3).faces.len(), 128);
        assert_eq!(run(TriMesh::default(), scheme, 13), TriMesh::default());
    }
    let refused = subdivide(mesh, Scheme::Loop, 40, Control::none());
    assert!(matches!(refused, Err(SubdivideError::TooManyFaces { .. })), "{refused:?}");
}

#[test]
fn a_real_mesh_keeps_its_topology() {
    let Some(mesh) = model("spot.obj") else { return };
    let euler = |mesh: &TriMesh| {
        let edges = Adjacency::new(mesh, Control::none()).unwrap().edges().len();
        mesh.positions.len() as i64 - edges as i64 + mesh.faces.len() as i64
    };
    let fine = run(mesh.clone(), Scheme::Loop, 1);
    assert_eq!((fine.faces.len(), euler(&fine)), (4 * mesh.faces.len(), euler(&mesh)));
}
