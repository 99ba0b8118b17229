//! Meshes for the tests of this folder, and the property that every change keeps.

use glam::{DVec2, DVec3};
use proptest::prelude::*;

use mve_mesh::data::{Domain, Layer, LayerValues, Material, NO_VALUE, TriMesh, VertexId};
use mve_mesh::fixtures::mesh_of;

/// The unit square in two triangles, with a layer over each domain: vertex `v` has height `v`,
/// corners their texture coordinate, faces the materials "a" and "b", vertices the normal z.
pub fn layered_square() -> TriMesh {
    let mut mesh = mesh_of(
        &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        &[[0, 1, 2], [0, 2, 3]],
    );
    let texcoord = |v: &VertexId| mesh.positions[v.idx()].truncate();
    let texcoords: Vec<DVec2> = mesh.faces.iter().flatten().map(texcoord).collect();
    let heights = vec![0.0, 1.0, 2.0, 3.0];
    let names = ["a", "b"].map(str::to_owned).to_vec();
    let layer =
        |name: &str, domain, values, index| Layer { name: name.to_owned(), domain, values, index };
    mesh.layers = vec![
        layer("height", Domain::Vertex, LayerValues::Number(heights), vec![0, 1, 2, 3]),
        layer(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(texcoords), (0..6).collect()),
        layer(Layer::MATERIAL, Domain::Face, LayerValues::Label(names), vec![0, 1]),
        layer(Layer::NORMAL, Domain::Vertex, LayerValues::Vec3(vec![DVec3::Z]), vec![0; 4]),
    ];
    mesh.materials = vec![Material { name: "a".to_owned(), ..Material::default() }];
    mesh
}

/// Any mesh: few vertices, so that faces are doubled, turned, degenerate and not manifold;
/// coordinates that are not finite; layers over all domains, with missing values.
pub fn any_mesh() -> impl Strategy<Value = TriMesh> {
    let number = prop_oneof![
        8 => (-2..3_i32).prop_map(f64::from),
        3 => -1.0..1.0_f64,
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(1e200), Just(1e-200)],
    ];
    let positions = prop::collection::vec(prop::array::uniform3(number), 1..9);
    positions
        .prop_flat_map(|positions| {
            let corner = 0..positions.len() as u32;
            let faces = prop::collection::vec(prop::array::uniform3(corner), 0..16);
            (Just(positions), faces, any::<u32>())
        })
        .prop_map(|(positions, faces, salt)| with_layers(mesh_of(&positions, &faces), salt))
}

fn with_layers(mut mesh: TriMesh, salt: u32) -> TriMesh {
    let index = |n: usize, n_values: u32| {
        let value = |i: u32| match (i.wrapping_mul(0x9e37_79b9) ^ salt) >> 3 {
            hash if hash % 7 == 0 => NO_VALUE,
            hash => hash % n_values,
        };
        (0..n as u32).map(value).collect()
    };
    let names = LayerValues::Label(["a", "b"].map(str::to_owned).to_vec());
    let (unit, color) = (vec![DVec3::X, DVec3::Y, DVec3::NEG_X], vec![DVec3::ONE, DVec3::ZERO]);
    let all = [
        (Layer::NORMAL, Domain::Corner, LayerValues::Vec3(unit)),
        (Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(vec![DVec2::ONE, DVec2::ZERO])),
        (Layer::COLOR, Domain::Vertex, LayerValues::Vec3(color)),
        (Layer::GROUP, Domain::Face, names),
        ("field", Domain::Face, LayerValues::Number(vec![1.0, 2.0, 3.0])),
    ];
    for (name, domain, values) in all {
        let index = index(mesh.n_elements(domain), values.len() as u32);
        mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
    }
    mesh
}
