//! Tests of joined vertices.

use super::*;
use crate::data::LayerValues;
use crate::fixtures::{cube, mesh_of, tetrahedron};

/// The mesh with three vertices a face.
fn soup_of(mesh: &TriMesh) -> TriMesh {
    let corners = mesh.faces.iter().flatten().map(|vertex| mesh.positions[vertex.idx()]);
    let faces = (0..mesh.faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2].map(VertexId));
    TriMesh::new(corners.collect(), faces.collect())
}

fn welded(mesh: &TriMesh, tolerance: f64) -> Welded {
    let welded = weld(mesh, tolerance, Control::none()).unwrap();
    assert_eq!(welded.mesh.check(), Ok(()));
    welded
}

#[test]
fn a_soup_becomes_the_surface_that_it_was_made_of() {
    let mut soup = soup_of(&cube(DVec3::ZERO));
    soup.positions.iter_mut().filter(|p| p.x == 0.0).take(3).for_each(|p| p.x = -0.0);
    let index = (0..36).collect();
    let values = LayerValues::Number((0..36).map(f64::from).collect());
    soup.set_layer(Layer { name: "own".into(), domain: Domain::Corner, values, index });
    let joined = welded(&soup, 0.0);
    assert_eq!((joined.n_joined, joined.n_left_out), (28, 0));
    let adjacency = Adjacency::new(&joined.mesh, Control::none()).unwrap();
    let edges = (0..adjacency.edges().len() as u32).map(EdgeId);
    assert!(edges.clone().all(|edge| adjacency.sides_of(edge).len() == 2));
    assert_eq!((edges.len(), joined.mesh.positions.len(), joined.mesh.faces.len()), (18, 8, 12));
    assert_eq!(joined.mesh.signed_volume(), 1.0);
    assert_eq!(joined.mesh.layers, soup.layers);
    assert_eq!(coincident_border_edges(&soup, Control::none()), Ok(36));
    assert_eq!(coincident_border_edges(&joined.mesh, Control::none()), Ok(0));
    assert_eq!(welded(&joined.mesh, 0.0).mesh, joined.mesh);
}

#[test]
fn near_vertices_are_joined_in_any_order_and_faces_between_them_go() {
    let gap = 1e-6;
    // Two triangles with a gap between, which a third, thin one bridges.
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, gap, 0.0],
        [gap, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    ];
    let faces = [[0, 1, 2], [3, 5, 4], [1, 3, 2]];
    let mesh = mesh_of(&points, &faces);
    assert_eq!(welded(&mesh, 1e-7).n_joined, 0);
    let joined = welded(&mesh, 1e-6);
    assert_eq!((joined.n_joined, joined.n_left_out), (2, 1));
    assert_eq!(joined.mesh.area(), 1.0);
    let order = [4, 2, 5, 0, 3, 1];
    let shuffled = order.map(|v: usize| points[v]);
    let place = |v: u32| order.iter().position(|&old| old == v as usize).unwrap() as u32;
    let shuffled = welded(&mesh_of(&shuffled, &faces.map(|face| face.map(place))), 1e-6).mesh;
    let corners = |mesh: &TriMesh| -> Vec<_> {
        (0..2).map(|f| mesh.corners(crate::data::FaceId(f))).collect()
    };
    assert_eq!(corners(&shuffled), corners(&joined.mesh));
    assert_eq!(welded(&mesh, 0.1).mesh.faces.len(), 2);
}

#[test]
fn what_is_not_finite_stays_apart() {
    let mut mesh = tetrahedron();
    mesh.positions[1].x = f64::NAN;
    mesh.positions[2].y = f64::INFINITY;
    mesh.positions.push(mesh.positions[2]);
    for tolerance in [0.0, 0.1] {
        assert_eq!(welded(&mesh, tolerance).n_joined, 0);
    }
}
