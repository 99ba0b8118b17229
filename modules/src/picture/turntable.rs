//! Cameras around an upright axis, and their pictures side by side: a model that turns.
//!
//! Angles come from the library's sine and cosine, so unlike other pictures these may differ by a
//! pixel from machine to machine.

use glam::DVec3;
use mve_mesh::data::{Image, Images, TriMesh};

use super::render::{Camera, Frame};

/// Which axis of a model is upright.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Upright {
    /// As graphics has it.
    Y,
    /// As scans and printers have it.
    Z,
}

impl Upright {
    /// The axis that seems to point up, of a model in a box: y, as in most files, unless it is as
    /// wide as it is deep along x and y and of another height along z. So are solids of revolution
    /// and height fields that stand on the xy plane, though simplified ones only about, around the
    /// z axis.
    pub fn of(low: DVec3, high: DVec3) -> Self {
        // Halves first, as the sum may be larger than the largest number.
        let (size, middle) = (high - low, 0.5 * low + 0.5 * high);
        let across = size.x.max(size.y);
        let is_near = |a: f64, b: f64, share: f64| (a - b).abs() <= share * across;
        let is_round = |share: f64| is_near(size.x, size.y, share);
        let is_around_z = is_near(middle.x, 0.0, 0.02) && is_near(middle.y, 0.0, 0.02);
        let stands = size.z > 0.05 * across && !is_near(size.z, across, 0.01);
        match stands && (is_round(1e-3) || (is_round(0.02) && is_around_z)) {
            true => Self::Z,
            false => Self::Y,
        }
    }
}

/// From how far above the cameras look down, as the sine of the angle: about 17°.
const SINE_ABOVE: f64 = 0.3;

/// The tangent of half of the opening angle of 60°, less a margin of a twentieth.
const TANGENT: f64 = 0.95 * 0.577_350_269_189_625_8;

/// `n` cameras at equal angles around a mesh, all as near as every picture of it allows; `None`
/// where it has no size or is not finite. O(n vertices).
pub fn turntable(mesh: &TriMesh, upright: Upright, n: usize) -> Option<Frame> {
    let (low, high) = mesh.bounds()?;
    let (center, diagonal) = (low.midpoint(high), (high - low).length());
    if !(diagonal > 0.0 && diagonal.is_finite()) {
        return None;
    }
    let up = match upright {
        Upright::Y => DVec3::Y,
        Upright::Z => DVec3::Z,
    };
    let cosine_above = (1.0 - SINE_ABOVE * SINE_ABOVE).sqrt();
    let directions = (0..n).map(|place| {
        let (sin, cos) = (std::f64::consts::TAU * place as f64 / n as f64).sin_cos();
        let level = match upright {
            Upright::Y => DVec3::new(sin, 0.0, cos),
            Upright::Z => DVec3::new(sin, -cos, 0.0),
        };
        cosine_above * level + SINE_ABOVE * up
    });
    let axes: Vec<[DVec3; 3]> = directions
        .map(|toward| {
            let right = up.cross(toward).normalize();
            [right, toward.cross(right), toward]
        })
        .collect();
    let points = mesh.positions.iter().filter(|point| point.is_finite());
    let mut distance: f64 = 0.0;
    for point in points {
        let from_center = *point - center;
        for [right, up, toward] in &axes {
            let aside = right.dot(from_center).abs().max(up.dot(from_center).abs());
            distance = distance.max(aside / TANGENT + toward.dot(from_center));
        }
    }
    let camera = |[right, up, toward]: [DVec3; 3]| Camera {
        eye: center + distance * toward,
        right,
        up,
        forward: -toward,
    };
    Some(Frame { cameras: axes.into_iter().map(camera).collect(), distance: diagonal })
}

/// Pictures of one size in rows, without anything between them; the last row is filled with black.
/// `None` of no pictures, or of such that differ in size or kind.
pub fn sheet(images: &Images, columns: usize) -> Option<Image> {
    let first = images.0.first()?;
    let is_alike = |image: &Image| {
        (image.width, image.height, image.kind) == (first.width, first.height, first.kind)
    };
    if columns == 0 || !images.0.iter().all(is_alike) {
        return None;
    }
    let n_rows = images.0.len().div_ceil(columns);
    let mut sheet =
        Image::filled("sheet", [columns * first.width, n_rows * first.height], first.kind, 0);
    let (row, whole) = (first.width * first.kind.n_bytes(), sheet.width * first.kind.n_bytes());
    for (place, image) in images.0.iter().enumerate() {
        let corner = place / columns * first.height * whole + place % columns * row;
        for (y, bytes) in image.bytes.chunks_exact(row).enumerate() {
            sheet.bytes[corner + y * whole..][..row].copy_from_slice(bytes);
        }
    }
    Some(sheet)
}

#[cfg(test)]
mod tests {
    use mve_mesh::data::PixelKind;

    use super::*;
    use crate::geometry::generate::{BoxOptions, subdivided_box};

    #[test]
    fn every_camera_sees_all_of_the_model_and_stands_upright() {
        let mut mesh = subdivided_box(&BoxOptions::DEFAULT);
        mesh.positions.iter_mut().for_each(|p| *p = *p * DVec3::new(1.0, 3.0, 2.0) + 5.0);
        for upright in [Upright::Y, Upright::Z] {
            let frame = turntable(&mesh, upright, 7).unwrap();
            let mut fullest: f64 = 0.0;
            for camera in &frame.cameras {
                assert!((camera.right.cross(camera.up) + camera.forward).length() < 1e-12);
                let side = if upright == Upright::Y { camera.right.y } else { camera.right.z };
                assert!(side.abs() < 1e-12);
                for point in &mesh.positions {
                    let seen = camera.view(*point);
                    let share = seen.x.abs().max(seen.y.abs()) / (seen.z * 3f64.sqrt().recip());
                    assert!(seen.z > 0.0 && share < 0.951, "{share}");
                    fullest = fullest.max(share);
                }
            }
            // One of them is full.
            assert!(fullest > 0.949, "{fullest}");
        }
        assert!(turntable(&TriMesh::default(), Upright::Y, 3).is_none());
    }

    #[test]
    fn what_stands_on_the_xy_plane_points_along_z() {
        let of = |x: f64, y: f64, z: f64| Upright::of(DVec3::ZERO, DVec3::new(x, y, z));
        assert_eq!([of(1.0, 1.0, 3.0), of(1.0, 3.0, 1.0)], [Upright::Z, Upright::Y]);
        assert_eq!([of(1.0, 1.0, 1.0), of(1.0, 1.0, 0.01)], [Upright::Y, Upright::Y]);
    }

    #[test]
    fn a_sheet_has_pictures_in_rows() {
        let image = |value| Image::filled("a", [2, 1], PixelKind::Gray, value);
        let images = Images(vec![image(1), image(2), image(3)]);
        let found = sheet(&images, 2).unwrap();
        assert_eq!((found.width, found.height), (4, 2));
        assert_eq!(found.bytes, [1, 1, 2, 2, 3, 3, 0, 0]);
        let odd = Images(vec![image(1), Image::filled("b", [1, 1], PixelKind::Gray, 0)]);
        assert!(sheet(&odd, 2).is_none() && sheet(&Images::default(), 2).is_none());
    }
}
