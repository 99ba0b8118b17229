//! Shading against painting triangle by triangle, and colors known by hand.

use glam::DVec2;
use mve_mesh::data::{Domain, LayerValues, VertexId};
use mve_mesh::fixtures::{cube, mesh_of, torus};
use proptest::prelude::*;

use super::*;
use crate::picture::render::{
    Camera, CameraSet, Frame, PictureOptions, Rect, corners, face_triangles, luminance, picture,
};

fn lens(size: usize) -> Lens {
    Lens::new(Camera::look_at(DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO).unwrap(), size, 2.0)
}

fn options(size: usize, sides: Sides, kind: PixelKind) -> PictureOptions {
    PictureOptions { size, sides, background: 7, kind, samples: 1 }
}

fn shot(
    mesh: &TriMesh,
    shading: Shading,
    source: NormalSource,
    albedo: Albedo,
    lens: &Lens,
    options: PictureOptions,
) -> Image {
    let surface = Surface::new(mesh, shading, source, albedo, Control::none()).unwrap();
    picture(&surface, lens, "a", &options, || Ok(())).unwrap()
}

/// Painted triangle by triangle, without deferring anything.
fn by_painting(mesh: &TriMesh, lens: &Lens, sides: Sides) -> Vec<u8> {
    let mut bytes = vec![7; lens.size * lens.size];
    let mut nearest = vec![0f32; bytes.len()];
    let placed = corners(mesh, lens);
    for (number, face) in (0u32..).zip(&mesh.faces) {
        let points = mesh.corners(FaceId(number));
        let placed = face.map(|v| placed[v.idx()]);
        face_triangles(lens, sides, placed, points, |triangle| {
            let lit = luminance(normal(points), lens.camera.forward, triangle.side);
            triangle.rows(&Rect::whole(lens.size), |row| {
                for (k, x) in (row.x[0]..row.x[1]).enumerate() {
                    let at = row.y as usize * lens.size + x as usize;
                    let depth = row.inv_depth(k);
                    assert_eq!(depth.to_bits(), row.inv_depth_at(k as i32).to_bits());
                    if depth > nearest[at] {
                        (nearest[at], bytes[at]) = (depth, lit);
                    }
                }
            });
        });
    }
    bytes
}

/// A square in the plane z = 0 that fills the middle half of a picture from (0, 0, 2), with texture
/// coordinates from 0 to 1 and the colors red, green, blue and white at its corners.
fn square() -> TriMesh {
    let h = 1.0 / 3f64.sqrt();
    let mut mesh =
        mesh_of(&[[-h, -h, 0.0], [h, -h, 0.0], [h, h, 0.0], [-h, h, 0.0]], &[[0, 1, 2], [0, 2, 3]]);
    let texcoords = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].to_vec();
    mesh.set_layer(Layer {
        name: Layer::TEXCOORD.to_owned(),
        domain: Domain::Corner,
        values: LayerValues::Vec2(texcoords),
        index: vec![0, 1, 2, 0, 2, 3],
    });
    mesh.set_layer(Layer {
        name: Layer::COLOR.to_owned(),
        domain: Domain::Vertex,
        values: LayerValues::Vec3(vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE]),
        index: vec![0, 1, 2, 3],
    });
    mesh
}

#[test]
fn colors_are_interpolated_between_corners() {
    let color = options(8, Sides::Front, PixelKind::Rgb);
    let found =
        shot(&square(), Shading::Flat, NormalSource::Faces, Albedo::Colors, &lens(8), color);
    // The lower left pixel of the square: its center is an eighth of the side from both sides, so
    // 7/8 − 1/8 + … along the diagonal from red to blue: 7/8 red, 1/8 blue.
    assert_eq!(found.pixel(2, 5), [223, 0, 32]);
    // Next to it: 5/8 red, 1/4 green, 1/8 blue.
    assert_eq!(found.pixel(3, 5), [159, 64, 32]);
    assert_eq!(found.pixel(1, 5), [7, 7, 7]);
    let gray = options(8, Sides::Front, PixelKind::Gray);
    let found = shot(&square(), Shading::Flat, NormalSource::Faces, Albedo::Colors, &lens(8), gray);
    let expected = 255.0 * (0.875 * 0.299 + 0.125 * 0.114);
    assert_eq!(found.pixel(2, 5), [(expected + 0.5) as u8]);
}

#[test]
fn a_picture_lies_on_the_surface_as_it_stands() {
    // Two by two: upper row 10 and 20, lower row 30 and 40.
    let kind = PixelKind::Gray;
    let texture =
        Image { name: String::new(), width: 2, height: 2, kind, bytes: vec![10, 20, 30, 40] };
    let gray = options(4, Sides::Front, PixelKind::Gray);
    let painted = |mesh: &TriMesh| {
        let faces = NormalSource::Faces;
        let surface = Surface::new(mesh, Shading::Flat, faces, Albedo::Colors, Control::none());
        let surface = surface.unwrap().painted(&texture);
        picture(&surface, &lens(4), "a", &gray, || Ok(())).unwrap().bytes
    };
    let on_square = |[a, b, c, d]: [u8; 4]| [7, 7, 7, 7, 7, a, b, 7, 7, c, d, 7, 7, 7, 7, 7];
    assert_eq!(painted(&square()), on_square([10, 20, 30, 40]));
    // It takes the place of colors, also where it cannot lie.
    let mut bare = square();
    bare.layers.retain(|layer| layer.name == Layer::COLOR);
    assert_eq!(painted(&bare), on_square([255; 4]));
}

#[test]
fn light_is_interpolated_in_space() {
    // A floor that runs away from the camera, its far end five times as far as the near one. With
    // lights 1 at the near end and 0 at the far one, the middle of the floor is half lit, wherever
    // perspective puts it.
    let mut mesh = mesh_of(
        &[[-1.0, -0.5, 1.0], [1.0, -0.5, 1.0], [1.0, -0.5, -3.0], [-1.0, -0.5, -3.0]],
        &[[0, 1, 2], [0, 2, 3]],
    );
    mesh.set_layer(Layer {
        name: Layer::NORMAL.to_owned(),
        domain: Domain::Vertex,
        values: LayerValues::Vec3(vec![DVec3::Z, DVec3::Y]),
        index: vec![0, 0, 1, 1],
    });
    let (lens, size) = (lens(256), 256);
    let gray = options(size, Sides::Front, PixelKind::Gray);
    let found = shot(&mesh, Shading::Gouraud, NormalSource::Layer, Albedo::White, &lens, gray);
    let seen = Visible::new(&mesh, &lens, Sides::Front);
    for y in 0..size {
        for x in 0..size {
            if seen.faces[y * size + x] == NO_FACE {
                continue;
            }
            let ray = lens.ray([x, y]);
            let hit = lens.camera.eye + ray * (-0.5 / ray.y);
            let expected = (hit.z + 3.0) / 4.0 * 255.0;
            let off = f64::from(found.pixel(x, y)[0]) - expected.clamp(0.0, 255.0);
            assert!(off.abs() <= 0.5 + 1e-6, "({x}, {y})");
        }
    }
}

#[test]
fn a_sphere_is_as_bright_as_its_normal_is_steep() {
    let n = 64;
    let angle = |k: usize, of: usize| std::f64::consts::PI * k as f64 / of as f64;
    let place = |k: usize| {
        let (down, around) = (angle(k / (2 * n), n), angle(k % (2 * n), n));
        DVec3::new(down.sin() * around.cos(), down.cos(), -down.sin() * around.sin()).to_array()
    };
    let points: Vec<_> = (0..2 * n * (n + 1)).map(place).collect();
    let quad = |k: usize| {
        let (i, j) = (k / (2 * n), k % (2 * n));
        let id = |i: usize, j: usize| (i * 2 * n + j % (2 * n)) as u32;
        [[id(i, j), id(i + 1, j), id(i + 1, j + 1)], [id(i, j), id(i + 1, j + 1), id(i, j + 1)]]
    };
    let faces: Vec<_> = (0..2 * n * n).flat_map(quad).collect();
    let mesh = mesh_of(&points, &faces);
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO).unwrap();
    let lens = Lens::new(camera, 128, 4.0);
    let gray = options(128, Sides::Both, PixelKind::Gray);
    let found = shot(&mesh, Shading::Gouraud, NormalSource::Faces, Albedo::White, &lens, gray);
    for y in 0..128 {
        for x in 0..128 {
            let ray = lens.ray([x, y]).normalize();
            let across = -ray.dot(camera.eye);
            let root = across * across - 15.0;
            if root > 0.05 {
                let hit = camera.eye + ray * (across - root.sqrt());
                let off = f64::from(found.pixel(x, y)[0]) - 255.0 * hit.z;
                assert!(off.abs() < 1.2, "({x}, {y}): {off}");
            }
        }
    }
}

#[test]
fn flat_pictures_are_what_painting_gives() {
    let mut turned = torus(0.6, 0.25, 20);
    turned.faces.iter_mut().step_by(3).for_each(|face| face.swap(1, 2));
    // Around the camera: faces behind it, and faces that are cut.
    let around = cube(DVec3::new(-0.4, -0.7, 1.5));
    for mesh in [torus(0.6, 0.25, 24), turned, around] {
        for sides in [Sides::Front, Sides::Both] {
            let gray = options(64, sides, PixelKind::Gray);
            let (flat, faces) = (Shading::Flat, NormalSource::Faces);
            let found = shot(&mesh, flat, faces, Albedo::White, &lens(64), gray);
            assert_eq!(found.bytes, by_painting(&mesh, &lens(64), sides), "{sides:?}");
        }
    }
}

/// A coordinate, as a rule near the picture, and sometimes anything.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => -1.5..3.0f64,
        2 => -1e-7..1e-7f64,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, 1e200, -1e200, 1e-200, 1e9, 2.0]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Tiny, flat, huge, behind the camera, not a number: there is a picture, the same for every
    /// shading where nothing is seen, and flat ones are what painting gives.
    #[test]
    fn any_triangles_give_a_picture(
        points in prop::collection::vec(prop::array::uniform3(coordinate()), 3..12),
        faces in prop::collection::vec(prop::array::uniform3(0..12u32), 1..12),
    ) {
        let n = points.len() as u32;
        let mut mesh = mesh_of(&points, &faces);
        mesh.faces.iter_mut().flatten().for_each(|v| *v = VertexId(v.0 % n));
        mesh.set_layer(Layer {
            name: Layer::COLOR.to_owned(),
            domain: Domain::Vertex,
            values: LayerValues::Vec3(points.iter().map(|&p| p.into()).collect()),
            index: (0..n).collect(),
        });
        let lens = lens(24);
        for sides in [Sides::Front, Sides::Both] {
            let gray = options(24, sides, PixelKind::Gray);
            let (flat, faces) = (Shading::Flat, NormalSource::Faces);
            let found = shot(&mesh, flat, faces, Albedo::White, &lens, gray);
            prop_assert_eq!(&found.bytes, &by_painting(&mesh, &lens, sides));
            let seen = Visible::new(&mesh, &lens, sides);
            for albedo in [Albedo::White, Albedo::Colors] {
                let color = options(24, sides, PixelKind::Rgb);
                let found = shot(&mesh, Shading::Gouraud, faces, albedo, &lens, color);
                for (face, pixel) in seen.faces.iter().zip(found.bytes.chunks(3)) {
                    prop_assert!(*face != NO_FACE || pixel == [7, 7, 7]);
                }
            }
        }
        if let Some(frame) = Frame::around(CameraSet::Fibonacci(5), &mesh) {
            let (shading, faces) = (Shading::Gouraud, NormalSource::Faces);
            let surface =
                Surface::new(&mesh, shading, faces, Albedo::Colors, Control::none()).unwrap();
            let gray = options(16, Sides::Both, PixelKind::Gray);
            let images = frame.pictures(&surface, &gray, Control::none()).unwrap();
            prop_assert_eq!(images.0.len(), 5);
        }
    }
}
