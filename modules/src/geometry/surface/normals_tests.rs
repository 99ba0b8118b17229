//! Tests of the normals.

use mve_mesh::fixtures::{cube, mesh_of, tetrahedron, torus};

use super::*;
use crate::test_models::model;

/// The functions without a control.
mod plain {
    use super::super::*;

    pub fn vertex_normals(mesh: &TriMesh, weight: NormalWeight) -> Vec<DVec3> {
        super::super::vertex_normals(mesh, weight, Control::none()).unwrap()
    }

    pub fn vertex_normal_layer(mesh: &TriMesh, weight: NormalWeight) -> Layer {
        super::super::vertex_normal_layer(mesh, weight, Control::none()).unwrap()
    }

    pub fn corner_normal_layer(mesh: &TriMesh, weight: NormalWeight, crease: f64) -> Layer {
        super::super::corner_normal_layer(mesh, weight, crease, Control::none()).unwrap()
    }
}

const ALL: [NormalWeight; 3] = [NormalWeight::Uniform, NormalWeight::Area, NormalWeight::Angle];

fn values(layer: &Layer) -> &[DVec3] {
    match &layer.values {
        LayerValues::Vec3(values) => values,
        _ => panic!("normals are vectors"),
    }
}

/// At the corner of a cube some sides have one triangle and some have two: only angles see three
/// equal sides.
#[test]
fn angles_do_not_depend_on_the_cut() {
    let cube = cube(DVec3::ZERO);
    let normals = plain::vertex_normals(&cube, NormalWeight::Angle);
    for (point, normal) in cube.positions.iter().zip(&normals) {
        assert!(normal.distance((*point - 0.5) * 2.0 / 3f64.sqrt()) < 1e-15);
    }
    let uniform = plain::vertex_normals(&cube, NormalWeight::Uniform);
    assert!(uniform.iter().zip(&normals).any(|(a, b)| a.distance(*b) > 0.1));
}

#[test]
fn weights_at_the_corner_of_a_tetrahedron() {
    // At (1, 0, 0): -y and -z faces with angle π/4 and area 1/2, the slanted face with π/3 and
    // area √3/2.
    let slanted = DVec3::ONE / 3f64.sqrt();
    let expected = |right: f64, slant: f64| {
        ((DVec3::NEG_Y + DVec3::NEG_Z) * right + slanted * slant).normalize()
    };
    let found = ALL.map(|weight| plain::vertex_normals(&tetrahedron(), weight)[1]);
    assert!(found[0].distance(expected(1.0, 1.0)) < 1e-15);
    assert!(found[1].distance(expected(0.5, 3f64.sqrt() / 2.0)) < 1e-15);
    assert!(found[2].distance(expected(PI / 4.0, PI / 3.0)) < 1e-15);
}

#[test]
fn a_cube_creases_at_thirty_degrees_and_not_at_a_hundred() {
    let cube = cube(DVec3::ZERO);
    let sharp = plain::corner_normal_layer(&cube, NormalWeight::Angle, 30f64.to_radians());
    assert_eq!(values(&sharp).len(), 24);
    let faces = face_normals(&cube, Control::none()).unwrap();
    for (corner, &value) in sharp.index.iter().enumerate() {
        assert!(values(&sharp)[value as usize].distance(faces[corner / 3]) < 1e-15);
    }
    let round = plain::corner_normal_layer(&cube, NormalWeight::Angle, 100f64.to_radians());
    assert_eq!(values(&round).len(), 8);
}

/// The normals of a torus point away from the circle in its tube.
#[test]
fn a_smooth_torus_has_the_normals_of_the_surface() {
    let mesh = torus(2.0, 0.5, 120);
    let layer = plain::corner_normal_layer(&mesh, NormalWeight::Angle, 30f64.to_radians());
    assert_eq!(values(&layer).len(), mesh.positions.len());
    for (corner, &value) in layer.index.iter().enumerate() {
        let point = mesh.positions[mesh.faces[corner / 3][corner % 3].idx()];
        let on_circle = DVec3::new(point.x, point.y, 0.0).normalize() * 2.0;
        let expected = (point - on_circle).normalize();
        assert!(values(&layer)[value as usize].distance(expected) < 2e-3);
    }
}

/// A flat strip with a face without area between two others: it takes a neighbor's normal.
#[test]
fn a_face_without_area_takes_a_neighbor() {
    let mesh = mesh_of(
        &[[0.0; 3], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0]],
        &[[0, 1, 2], [0, 3, 1], [0, 4, 3], [3, 4, 1]],
    );
    for weight in ALL {
        let layer = plain::corner_normal_layer(&mesh, weight, 0.5);
        let all = layer.index.iter().map(|&v| values(&layer)[v as usize]);
        assert!(all.into_iter().all(|n| n == DVec3::Z));
        assert!(plain::vertex_normals(&mesh, weight).iter().all(|&n| n == DVec3::Z));
    }
}

#[test]
fn no_normal_is_no_value_and_never_nan() {
    let mut mesh = mesh_of(&[[0.0; 3], [f64::NAN; 3], [1.0; 3]], &[[0, 0, 0], [0, 1, 2]]);
    mesh.positions.push(DVec3::ONE);
    for weight in ALL {
        assert_eq!(plain::vertex_normals(&mesh, weight), [DVec3::ZERO; 4]);
        assert_eq!(plain::vertex_normal_layer(&mesh, weight).index, [NO_VALUE; 4]);
        assert_eq!(plain::corner_normal_layer(&mesh, weight, 1.0).index, [NO_VALUE; 6]);
    }
}

/// Three leaves on one edge: nobody knows which two belong together, so none do.
#[test]
fn an_edge_of_three_faces_is_a_crease() {
    let points = [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-1.0, 0.1, 0.0], [0.0, 1.0, 0.0]];
    let mesh = mesh_of(&points, &[[0, 1, 2], [1, 0, 3], [1, 0, 4]]);
    let layer = plain::corner_normal_layer(&mesh, NormalWeight::Area, PI);
    assert_eq!(values(&layer).len(), 9);
}

/// Vertices 0, 1000 and 2500 of spot from `igl.per_vertex_normals` of libigl 2.6.3.
#[test]
fn spot_agrees_with_libigl() {
    let Some(mesh) = model("spot.obj") else { return };
    let expected = IGL_SPOT;
    for (weight, rows) in ALL.into_iter().zip(expected) {
        let found = plain::vertex_normals(&mesh, weight);
        for (vertex, row) in [0, 1000, 2500].into_iter().zip(rows) {
            let row = DVec3::from(row);
            assert!(found[vertex].distance(row) < 1e-9, "{weight:?} {vertex}: {}", found[vertex]);
        }
    }
}

/// By weight in the order of `ALL`.
const IGL_SPOT: [[[f64; 3]; 3]; 3] = [
    [
        [0.7099530182, 0.0944264860, -0.6978899273],
        [0.8137667257, 0.4563682313, -0.3598774148],
        [-0.1229700742, -0.5209655400, -0.8446734677],
    ],
    [
        [0.7063821655, 0.0930025251, -0.7016942116],
        [0.8143122873, 0.4554507743, -0.3598056292],
        [-0.1253054774, -0.5200311178, -0.8449060148],
    ],
    [
        [0.7136666897, 0.0930118770, -0.6942828291],
        [0.8121457552, 0.4563279902, -0.3635712279],
        [-0.1225021245, -0.5223388013, -0.8438930063],
    ],
];
