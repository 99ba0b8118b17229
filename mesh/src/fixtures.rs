//! Small meshes with known properties, for tests and benches.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::data::{
    Domain, FaceId, Image, Layer, LayerValues, Material, Texture, TextureImage, TextureRole,
    TriMesh, VertexId,
};

/// A mesh from plain arrays.
pub fn mesh_of(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
    TriMesh::new(
        positions.iter().map(|&p| DVec3::from(p)).collect(),
        faces.iter().map(|f| f.map(VertexId)).collect(),
    )
}

/// The corner tetrahedron with legs of 1: closed, manifold, volume 1/6.
pub fn tetrahedron() -> TriMesh {
    mesh_of(
        &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    )
}

/// The cube from `low` to `low + (1, 1, 1)`, two triangles a side: closed, manifold, volume 1.
pub fn cube(low: DVec3) -> TriMesh {
    let corner = |i: u32| DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into()) + low;
    let corners: Vec<[f64; 3]> = (0..8).map(|i| corner(i).to_array()).collect();
    let quads: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[u32; 3]> =
        quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh_of(&corners, &faces)
}

/// A grid torus around z, `n` by `n` quads cut in two: closed, manifold, genus 1, 2 n² faces.
pub fn torus(radius: f64, tube_radius: f64, n: u32) -> TriMesh {
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let point = |u: u32, v: u32| {
        let from_axis = radius + tube_radius * angle(v).cos();
        [from_axis * angle(u).cos(), from_axis * angle(u).sin(), tube_radius * angle(v).sin()]
    };
    let at = |u: u32, v: u32| (u % n) * n + v % n;
    let cells = || (0..n).flat_map(|u| (0..n).map(move |v| (u, v)));
    let points: Vec<[f64; 3]> = cells().map(|(u, v)| point(u, v)).collect();
    let faces: Vec<[u32; 3]> = cells()
        .flat_map(|(u, v)| {
            let [a, b, c, d] = [at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    mesh_of(&points, &faces)
}

/// The square from (0, 0, 0) to (1, 1, 0) in two triangles, with a picture all over it.
pub fn textured_square(image: Image) -> TriMesh {
    let square = mesh_of(
        &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        &[[0, 1, 2], [0, 2, 3]],
    );
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let texcoords: Vec<DVec2> = square.faces.iter().flatten().map(|v| corners[v.idx()]).collect();
    textured(square, image, |FaceId(face), k| texcoords[3 * face as usize + k])
}

/// A mesh with one material for all of its faces, whose texture is laid on by the texture
/// coordinates of each face's corners.
pub fn textured(
    mut mesh: TriMesh,
    image: Image,
    texcoord: impl Fn(FaceId, usize) -> DVec2,
) -> TriMesh {
    let n_faces = mesh.faces.len() as u32;
    let corners = (0..n_faces).flat_map(|face| [0, 1, 2].map(|k| (FaceId(face), k)));
    let texcoords = corners.map(|(face, k)| texcoord(face, k)).collect();
    let layer =
        |name: &str, domain, values, index| Layer { name: name.to_owned(), domain, values, index };
    let all = (0..3 * n_faces).collect();
    mesh.set_layer(layer(Layer::TEXCOORD, Domain::Corner, LayerValues::Vec2(texcoords), all));
    let names = LayerValues::Label(vec!["paint".to_owned()]);
    mesh.set_layer(layer(Layer::MATERIAL, Domain::Face, names, vec![0; n_faces as usize]));
    let texture = Texture {
        role: TextureRole::BaseColor,
        keyword: "map_Kd".to_owned(),
        options: String::new(),
        name: "t.png".to_owned(),
        place: 0,
        image: Some(Arc::new(TextureImage::new(image))),
    };
    mesh.materials =
        vec![Material { name: "paint".to_owned(), textures: vec![texture], ..Material::default() }];
    mesh
}
