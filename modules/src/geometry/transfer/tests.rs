//! Tests of the transfer of values.

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{LayerValues, VertexId};
use mve_mesh::fixtures::mesh_of;

use super::*;
use crate::geometry::edit::checks::layered_square;

fn moved(source: &TriMesh, target: &TriMesh, most_distance: f64, name: &str) -> Layer {
    let tree = Bvh::build(source, Control::none()).unwrap();
    let places = Places::find((source, &tree), target, most_distance, Control::none()).unwrap();
    places.layer(source.layer(name).unwrap(), Control::none()).unwrap()
}

/// A triangle a little above the square: its vertices lie at (0.2, 0.1), (0.7, 0.2) and (0.6, 0.5),
/// all in the first face, whose texture coordinates are its places.
fn above(height: f64) -> TriMesh {
    mesh_of(&[[0.2, 0.1, height], [0.7, 0.2, height], [0.6, 0.5, height]], &[[0, 1, 2]])
}

#[test]
fn values_are_interpolated_at_the_nearest_point() {
    let (source, target) = (layered_square(), above(0.1));
    let texcoord = moved(&source, &target, 1.0, Layer::TEXCOORD);
    let LayerValues::Vec2(values) = &texcoord.values else { panic!() };
    for (corner, v) in target.faces[0].iter().enumerate() {
        let found = values[texcoord.index[corner] as usize];
        let expected: DVec2 = target.positions[v.idx()].truncate();
        assert!(found.distance(expected) < 1e-12, "{found}");
    }
    // Heights 0, 1, 2 at (0, 0), (1, 0), (1, 1) are x + y in that face.
    let height = moved(&source, &target, 1.0, "height");
    let LayerValues::Number(values) = &height.values else { panic!() };
    assert!((values[height.index[1] as usize] - 0.9).abs() < 1e-12);
    assert_eq!(moved(&source, &target, 1.0, Layer::MATERIAL).index, [0]);
    let normal = moved(&source, &target, 1.0, Layer::NORMAL);
    assert_eq!(normal.index, [0; 3]);
}

#[test]
fn what_is_too_far_has_no_value() {
    let (source, target) = (layered_square(), above(0.1));
    for name in [Layer::TEXCOORD, Layer::MATERIAL, "height"] {
        let found = moved(&source, &target, 0.09, name);
        assert!(found.index.iter().all(|value| *value == NO_VALUE), "{name}");
    }
}

/// Two squares side by side, whose texture jumps by 10 between them. A face across the seam has the
/// values of the side that its middle is on, though one vertex lies beyond.
#[test]
fn corners_do_not_cross_a_seam() {
    let points = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 1.0, 0.0],
    ];
    let mut source = mesh_of(&points, &[[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]);
    let texcoord = |(corner, v): (usize, &VertexId)| {
        let jump = if corner < 6 { 0.0 } else { 10.0 };
        source.positions[v.idx()].truncate() + DVec2::X * jump
    };
    let all: Vec<DVec2> = source.faces.iter().flatten().enumerate().map(texcoord).collect();
    // Corners of one side that have one value share it.
    let index = [0, 1, 2, 0, 2, 5, 6, 7, 8, 6, 8, 11].to_vec();
    let (name, domain) = (Layer::TEXCOORD.to_owned(), Domain::Corner);
    source.set_layer(Layer { name, domain, values: LayerValues::Vec2(all), index });
    let target = mesh_of(&[[0.2, 0.2, 0.0], [1.3, 0.4, 0.0], [0.2, 0.8, 0.0]], &[[0, 1, 2]]);
    let found = moved(&source, &target, 1.0, Layer::TEXCOORD);
    let LayerValues::Vec2(values) = &found.values else { panic!() };
    let across = values[found.index[1] as usize];
    assert!(across.distance(DVec2::new(1.0, 0.4)) < 1e-12, "{across}");
}

#[test]
fn a_field_comes_along() {
    let (source, target) = (layered_square(), above(0.0));
    let tree = Bvh::build(&source, Control::none()).unwrap();
    let places = Places::find((&source, &tree), &target, 1.0, Control::none()).unwrap();
    let values = source.positions.iter().map(|p: &DVec3| 3.0 * p.x - p.y).collect();
    let (name, unit) = ("f".to_owned(), "m".to_owned());
    let field = Field { name, unit, domain: Domain::Vertex, values };
    let found = places.field(&field, Control::none()).unwrap();
    let expected = [0.5, 1.9, 1.3];
    assert!(found.values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
    assert_eq!(found.unit, "m");
}
