//! The fill rule and pictures known by hand or in closed form.

use glam::DVec3;
use mve_mesh::data::TriMesh;
use mve_mesh::fixtures::mesh_of;
use proptest::prelude::*;

use super::project::STEPS;
use super::*;

fn front(size: usize) -> Lens {
    Lens::new(Camera::look_at(DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO).unwrap(), size, 2.0)
}

fn corner(x: i32, y: i32) -> Corner {
    Corner { x, y, inv_depth: 0.5 }
}

/// The pixels of a triangle, with one over their depth.
fn pixels(triangle: &Triangle, clip: &Rect) -> Vec<(i32, i32, f32)> {
    let mut found = Vec::new();
    triangle.rows(clip, |row| {
        let columns = (row.x[0]..row.x[1]).enumerate();
        found.extend(columns.map(|(k, x)| (x, row.y, row.inv_depth(k))));
    });
    found
}

#[test]
fn a_triangle_of_few_pixels_by_hand() {
    // Half of a square of four by four pixels; its long side runs through the centers of the
    // pixels (0, 0) to (3, 3). Looking at the picture, the triangle lies to the lower left of it,
    // so the long side is a right one and its centers do not belong to it.
    let [a, b, c] = [corner(0, 0), corner(0, 4 * STEPS), corner(4 * STEPS, 4 * STEPS)];
    let lower = Triangle::new([a, b, c], Sides::Both).unwrap();
    assert_eq!(lower.side, FaceSide::Front);
    let found: Vec<_> = pixels(&lower, &Rect::whole(8)).iter().map(|p| (p.0, p.1)).collect();
    assert_eq!(found, [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)]);
    let upper = Triangle::new([a, c, corner(4 * STEPS, 0)], Sides::Both).unwrap();
    let found: Vec<_> = pixels(&upper, &Rect::whole(8)).iter().map(|p| (p.0, p.1)).collect();
    let expected = [(0, 0), (1, 0), (2, 0), (3, 0), (1, 1), (2, 1), (3, 1), (2, 2), (3, 2), (3, 3)];
    assert_eq!(found, expected);
    assert_eq!(Triangle::new([a, c, b], Sides::Both).unwrap().side, FaceSide::Back);
    assert!(Triangle::new([a, c, corner(2 * STEPS, 2 * STEPS)], Sides::Both).is_none(), "no area");
}

#[test]
fn a_picture_of_few_pixels_by_hand() {
    // A square that fills the middle two by two of four by four pixels, seen from depth 2, tilted
    // by 60° about its upper left to lower right diagonal: cosine 1/2 is luminance 128.
    let lens = front(4);
    let rim = 2.0 / 3f64.sqrt();
    let square = mesh_of(
        &[[-rim / 2.0, -rim / 2.0, 0.0], [rim / 2.0, -rim / 2.0, 0.0], [rim / 2.0, rim / 2.0, 0.0]],
        &[[0, 1, 2]],
    );
    let seen = Visible::new(&square, &lens, Sides::Front);
    let n = NO_FACE;
    assert_eq!(seen.faces, [n, n, n, n, n, n, 0, n, n, 0, 0, n, n, n, n, n]);
    assert_eq!(seen.inv_depths[6], 0.5);
    let forward = lens.camera.forward;
    assert_eq!(luminance(normal([DVec3::ZERO, DVec3::X, DVec3::Y]), forward, FaceSide::Front), 255);
    let tilted = DVec3::new(3f64.sqrt() / 2.0, 0.0, 0.5);
    assert_eq!(luminance(tilted, forward, FaceSide::Front), 128);
    assert_eq!(luminance(tilted, forward, FaceSide::Back), 0);
    assert_eq!(luminance(-tilted, forward, FaceSide::Back), 128);
}

/// A sphere of radius 1 as a lattice of latitudes and longitudes.
fn sphere(n: usize) -> TriMesh {
    let step = std::f64::consts::PI / n as f64;
    let place = |i: usize, j: usize| {
        let (latitude, longitude) = (step * i as f64, step * j as f64);
        let radius = latitude.sin();
        [radius * longitude.cos(), latitude.cos(), -radius * longitude.sin()]
    };
    let columns = 2 * n;
    let points: Vec<_> = (0..=n).flat_map(|i| (0..columns).map(move |j| place(i, j))).collect();
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..columns {
            let id = |i: usize, j: usize| (i * columns + j % columns) as u32;
            faces.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            faces.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
        }
    }
    mesh_of(&points, &faces)
}

#[test]
fn a_sphere_has_its_silhouette_and_shading() {
    let (size, distance) = (256, 4.0);
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, distance), DVec3::ZERO).unwrap();
    let lens = Lens::new(camera, size, distance);
    let mesh = sphere(400);
    let seen = Visible::new(&mesh, &lens, Sides::Front);
    let half = size as f64 / 2.0;
    for y in 0..size {
        for x in 0..size {
            let at = |side: usize| (side as f64 + 0.5 - half) / half / 3f64.sqrt();
            let ray = DVec3::new(at(x), -at(y), -1.0).normalize();
            // The ray o + t d meets the unit sphere where t² + 2 t o·d + |o|² − 1 = 0.
            let across = -ray.dot(camera.eye);
            let root = across * across - (distance * distance - 1.0);
            let face = seen.faces[y * size + x];
            if root.abs() < 0.02 {
                continue; // At the silhouette, where the lattice and the sphere differ.
            }
            assert_eq!(face != NO_FACE, root > 0.0, "pixel ({x}, {y})");
            if root > 0.0 {
                let hit = camera.eye + (across - root.sqrt()) * ray;
                let depth = distance - hit.z;
                let found = f64::from(seen.inv_depths[y * size + x]);
                assert!((found * depth - 1.0).abs() < 2e-4, "pixel ({x}, {y})");
                let lit = luminance(
                    normal(mesh.corners(mve_mesh::data::FaceId(face))),
                    camera.forward,
                    FaceSide::Front,
                );
                // A face of the lattice turns by at most 0.8°, which is 3 of 255 steps.
                assert!((f64::from(lit) - 255.0 * hit.z).abs() < 4.0, "pixel ({x}, {y})");
            }
        }
    }
}

proptest! {
    /// A fan of triangles around a point, its corners anywhere on the grid: every pixel inside of
    /// its outline is drawn exactly once.
    #[test]
    fn a_fan_has_no_gaps_and_no_overlaps(
        center in (1024..3072i32, 1024..3072i32),
        turns in prop::collection::vec(1..2000i32, 3..12),
        snap in prop::sample::select(vec![1, 64, 128, 256]),
    ) {
        let whole = Rect::whole(16);
        let to_grid = |v: i32| v / snap * snap;
        let center = corner(to_grid(center.0), to_grid(center.1));
        let total: i32 = turns.iter().sum();
        let mut sum = 0;
        // Points of the outline of the square of 16 × 16 pixels, in order around it.
        let rim: Vec<Corner> = turns.iter().map(|turn| {
            let side = 16 * STEPS;
            let at = to_grid(((i64::from(sum) * 4 * i64::from(side)) / i64::from(total)) as i32);
            sum += turn;
            match at / side {
                0 => corner(0, at),
                1 => corner(at - side, side),
                2 => corner(side, 3 * side - at),
                _ => corner(4 * side - at, 0),
            }
        }).collect();
        let mut drawn = [0; 256];
        for (k, &from) in rim.iter().enumerate() {
            let to = rim[(k + 1) % rim.len()];
            if let Some(triangle) = Triangle::new([center, from, to], Sides::Both) {
                prop_assume!(triangle.side == FaceSide::Front);
                for (x, y, _) in pixels(&triangle, &whole) {
                    drawn[(y * 16 + x) as usize] += 1;
                }
            }
        }
        // The same outline as a fan from another corner covers the same pixels if it is convex
        // from there; what is drawn here must be drawn once.
        prop_assert!(drawn.iter().all(|&n| n <= 1));
        let inside = |x: i32, y: i32| {
            let p = [x * STEPS + 128, y * STEPS + 128];
            (0..rim.len()).all(|k| {
                let (a, b) = (rim[k], rim[(k + 1) % rim.len()]);
                let cross = i64::from(b.x - a.x) * i64::from(p[1] - a.y)
                    - i64::from(b.y - a.y) * i64::from(p[0] - a.x);
                cross < 0
            })
        };
        for y in 0..16 {
            for x in 0..16 {
                if inside(x, y) {
                    prop_assert_eq!(drawn[(y * 16 + x) as usize], 1, "pixel ({}, {})", x, y);
                }
            }
        }
    }

    /// A row found by division is the row found pixel by pixel, and a clipped triangle has the
    /// pixels of the whole one, with the same depths to the last bit.
    #[test]
    fn clipping_changes_no_pixel(
        points in prop::array::uniform3((-9000..9000i32, -9000..9000i32, 0.1..2f32)),
        window in (0..30i32, 0..30i32, 1..13i32, 1..40i32),
    ) {
        let corners = points.map(|(x, y, inv_depth)| Corner { x, y, inv_depth });
        let Some(triangle) = Triangle::new(corners, Sides::Both) else { return Ok(()) };
        let (x, y, width, height) = window;
        let clip = Rect { x: [x, x + width], y: [y, y + height] };
        let is_in = |p: &&(i32, i32, f32)| {
            (clip.x[0]..clip.x[1]).contains(&p.0) && (clip.y[0]..clip.y[1]).contains(&p.1)
        };
        let whole = pixels(&triangle, &triangle.bounds);
        let expected: Vec<_> = whole.iter().filter(is_in).copied().collect();
        prop_assert_eq!(pixels(&triangle, &clip), expected);
        let range = corners.map(|c| c.inv_depth);
        let (low, high) = range.iter().fold((f32::MAX, 0f32), |(l, h), &z| (l.min(z), h.max(z)));
        for (x, y, z) in whole {
            prop_assert!(z >= low * 0.999_999 && z <= high * 1.000_001, "({}, {}): {}", x, y, z);
        }
    }
}
