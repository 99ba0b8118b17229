//! Image RMS of pictures known by hand, and of odd meshes.

use glam::DVec3;
use mve_mesh::data::{Domain, Image, LayerValues, PixelKind, VertexId};
use mve_mesh::fixtures::{cube, mesh_of, tetrahedron, textured};

use super::*;
use crate::cost::EdgeLength;
use crate::geometry::simplify::collapse::{Boundary, SimplifyOptions, Stop, simplify};
use crate::metric::pictures::tests::{check_contract, small};
use crate::picture::render::{Albedo, Frame, Lens, NO_FACE, Shading, Visible};
use crate::placement::Endpoint;

#[test]
fn equal_meshes_differ_by_nothing() {
    let metric = ImageRmsMetric { view: small() };
    let found = metric.compare(&tetrahedron(), &tetrahedron(), Control::none()).unwrap();
    assert_eq!(found.scalars[0].name, "rms");
    assert_eq!((found.scalar("rms"), found.scalar("psnr")), (Some(0.0), Some(f64::INFINITY)));
    assert_eq!(found.scalars.len(), 2 + 24);
    assert_eq!(found.original_images, found.simplified_images);
}

#[test]
fn against_nothing_it_is_the_luminance_itself() {
    // The root mean square of the luminance of a cube against a black picture.
    let metric = ImageRmsMetric { view: small() };
    let found = metric.compare(&cube(DVec3::ZERO), &TriMesh::default(), Control::none()).unwrap();
    let bytes: Vec<u8> = found.original_images.0.iter().flat_map(|i| i.bytes.clone()).collect();
    let sum: f64 = bytes.iter().map(|&byte| f64::from(byte).powi(2)).sum();
    let expected = (sum / bytes.len() as f64).sqrt();
    assert!((found.scalar("rms").unwrap() - expected).abs() < 1e-12);
    assert_eq!(found.difference_images, found.original_images);
    let mean: f64 = (0..24).map(|k| found.scalar(&format!("rms_{k}")).unwrap().powi(2)).sum();
    assert!(((mean / 24.0).sqrt() - expected).abs() < 1e-12);
    // Every camera of this set sees one side of the cube at a cosine of (1 + √2) / √(5 + 2√2) and
    // two at 1 / √(5 + 2√2): 220 and 91 of 255.
    assert!(bytes.iter().all(|byte| [0, 220, 91].contains(byte)));
    assert!([0, 220, 91].iter().all(|byte| bytes.contains(byte)));
}

#[test]
fn it_stands_any_mesh_and_any_number_of_threads() {
    check_contract(&ImageRmsMetric { view: small() });
}

/// A flat grid of `n` by `n` squares of side 1.
fn grid(n: u32) -> TriMesh {
    let id = |x: u32, y: u32| y * (n + 1) + x;
    let points: Vec<[f64; 3]> = (0..(n + 1) * (n + 1))
        .map(|k| [f64::from(k % (n + 1)), f64::from(k / (n + 1)), 0.0])
        .collect();
    let cells = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let faces: Vec<[u32; 3]> = cells
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [id(x, y), id(x + 1, y), id(x + 1, y + 1), id(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    mesh_of(&points, &faces)
}

/// A grid of 8 by 8 squares, white but for the faces of the third column, which are red.
fn striped() -> TriMesh {
    let mut mesh = grid(8);
    let index = (0..mesh.faces.len() as u32).map(|face| u32::from(face / 2 % 8 == 2)).collect();
    let values = LayerValues::Vec3(vec![DVec3::ONE, DVec3::X]);
    mesh.set_layer(Layer { name: Layer::COLOR.to_owned(), domain: Domain::Face, values, index });
    mesh
}

#[test]
fn colors_that_neither_mesh_has_are_refused() {
    let of = |albedo| {
        let metric = ImageRmsMetric { view: View { albedo, ..small() } };
        metric.compare(&grid(8), &grid(4), Control::none())
    };
    for albedo in [Albedo::Colors, Albedo::Textures] {
        match of(albedo) {
            Err(MetricError::Param { name: "albedo", message }) => {
                assert!(message.starts_with("neither mesh has colors"), "{message}");
                assert!(message.ends_with("choose White, or a mesh with colors"), "{message}");
            }
            other => panic!("{other:?}"),
        }
    }
    of(Albedo::White).unwrap();
}

#[test]
fn a_painted_stripe_counts_as_often_as_it_is_seen() {
    let (plain, striped) = (grid(8), striped());
    let of =
        |view: View| ImageRmsMetric { view }.compare(&striped, &plain, Control::none()).unwrap();
    let white = of(small());
    assert_eq!((white.scalar("rms"), white.warnings.len()), (Some(0.0), 0));

    let view = View { albedo: Albedo::Colors, shading: Shading::Unlit, ..small() };
    let found = of(view);
    let missing = "the simplified mesh has no layer \"color\" of three numbers, so it is white in \
                   pictures";
    assert_eq!(found.warnings, [missing]);
    // Red is (255, 0, 0), white (255, 255, 255): two of three values differ by 255.
    let frame = Frame::around(view.cameras, &striped).unwrap();
    let mut n_all = 0;
    for (camera, &place) in frame.cameras.iter().enumerate() {
        let seen = Visible::new(&striped, &Lens::new(place, 48, frame.distance), view.sides);
        let is_red = |face: &&u32| **face != NO_FACE && **face / 2 % 8 == 2;
        let n = seen.faces.iter().filter(is_red).count();
        let expected = (2.0 / 3.0 * n as f64 / (48.0 * 48.0)).sqrt() * 255.0;
        assert!((found.scalar(&format!("rms_{camera}")).unwrap() - expected).abs() < 1e-9);
        let differences = found.difference_images.0[camera].bytes.chunks_exact(3);
        assert_eq!(differences.filter(|pixel| *pixel == [0, 255, 255]).count(), n);
        n_all += n;
    }
    assert!(n_all > 1000, "{n_all}");
    let expected = (2.0 / 3.0 * n_all as f64 / (24.0 * 48.0 * 48.0)).sqrt() * 255.0;
    assert!((found.scalar("rms").unwrap() - expected).abs() < 1e-9);

    // In the light it is less.
    let lit = of(View { albedo: Albedo::Colors, ..small() }).scalar("rms").unwrap();
    assert!(lit > 0.3 * expected && lit < 0.99 * expected, "{lit} of {expected}");
}

#[test]
fn gray_pictures_have_the_value_that_they_have_in_color() {
    let (mut cube, mut other) = (cube(DVec3::ZERO), tetrahedron());
    let gray = ImageRmsMetric { view: small() }.compare(&cube, &other, Control::none()).unwrap();
    for mesh in [&mut cube, &mut other] {
        let (values, index) = (LayerValues::Vec3(vec![DVec3::ONE]), vec![0; mesh.positions.len()]);
        let name = Layer::COLOR.to_owned();
        mesh.set_layer(Layer { name, domain: Domain::Vertex, values, index });
    }
    let view = View { albedo: Albedo::Colors, ..small() };
    let color = ImageRmsMetric { view }.compare(&cube, &other, Control::none()).unwrap();
    assert_eq!(color.original_images.0[0].kind, PixelKind::Rgb);
    assert!(gray.scalar("rms").unwrap() > 10.0);
    assert_eq!(gray.scalar("rms"), color.scalar("rms"));
}

#[test]
fn a_texture_that_slides_on_a_plane_is_seen() {
    // Texture coordinates are no linear function of the place, so that simplification leaves the
    // plane as it is and moves what is on it.
    let mesh = grid(8);
    let stripes = |k: usize| if k % 8 < 4 { [250, 40, 40] } else { [40, 40, 250] };
    let bytes = (0..64).flat_map(stripes).collect();
    let (name, kind) = (String::new(), PixelKind::Rgb);
    let image = Image { name, width: 8, height: 8, kind, bytes };
    let (positions, faces) = (mesh.positions.clone(), mesh.faces.clone());
    let original = textured(mesh, image, |face, k| {
        let VertexId(v) = faces[face.idx()][k];
        let p = positions[v as usize] / 8.0;
        glam::DVec2::new(p.x * p.x, p.y)
    });
    let stop = Stop { faces: Some(40), ..Stop::default() };
    let options = SimplifyOptions { stop, boundary: Boundary::Locked, ..SimplifyOptions::DEFAULT };
    let cost = &mut EdgeLength;
    let found = simplify(&original, cost, &mut Endpoint, options, Control::none());
    let simplified = found.unwrap().mesh;
    assert!(simplified.faces.len() <= 60, "{}", simplified.faces.len());
    let rms = |albedo| {
        let metric = ImageRmsMetric { view: View { albedo, ..small() } };
        let found = metric.compare(&original, &simplified, Control::none()).unwrap();
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        found.scalar("rms").unwrap()
    };
    assert_eq!(rms(Albedo::White), 0.0);
    assert!(rms(Albedo::Textures) > 1.0, "{}", rms(Albedo::Textures));
}
