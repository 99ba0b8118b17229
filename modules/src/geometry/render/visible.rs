//! What a camera sees: the nearest face at every pixel.

use glam::DVec3;

use super::project::{Corner, Lens};
use super::raster::{Rect, Row, Sides, Triangle};
use crate::data::{FaceId, TriMesh};

/// Where no face is.
pub const NO_FACE: u32 = u32::MAX;

/// The nearest face at every pixel, and how near it is; rows from the top.
///
/// Of two faces that are equally near, the first one is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Visible {
    /// Pixels in a row, and rows.
    pub size: usize,
    /// The face, or [`NO_FACE`].
    pub faces: Vec<u32>,
    /// One over the depth along the camera's axis, in model units; 0 where no face is.
    pub inv_depths: Vec<f32>,
}

impl Visible {
    /// Looks at a mesh. Faces of which a corner is not a number are not seen. O(pixels + faces +
    /// covered pixels).
    pub fn new(mesh: &TriMesh, lens: &Lens, sides: Sides) -> Self {
        let corners: Vec<Corner> = mesh.positions.iter().map(|&point| lens.corner(point)).collect();
        let mut seen = Self::nothing(lens.size);
        let whole = Rect::whole(lens.size);
        for (number, face) in (0u32..).zip(&mesh.faces) {
            let placed = face.map(|v| corners[v.idx()]);
            let points = mesh.corners(FaceId(number));
            face_triangles(lens, sides, placed, points, |triangle| {
                triangle.rows(&whole, |row| seen.draw(number, &row));
            });
        }
        seen
    }

    /// Sees nothing.
    pub fn nothing(size: usize) -> Self {
        let n = size * size;
        Self { size, faces: vec![NO_FACE; n], inv_depths: vec![0.0; n] }
    }

    /// Draws a row of a face, after all faces of a smaller number.
    #[inline(always)]
    fn draw(&mut self, face: u32, row: &Row) {
        let at = row.y as usize * self.size;
        let range = at + row.x[0] as usize..at + row.x[1] as usize;
        let nearest = self.inv_depths[range.clone()].iter_mut().zip(&mut self.faces[range]);
        for (k, (nearest, seen)) in nearest.enumerate() {
            let inv_depth = row.inv_depth(k);
            if inv_depth > *nearest {
                *nearest = inv_depth;
                *seen = face;
            }
        }
    }
}

/// Calls `each` with the triangles that a face is on the grid, if it shows a side that is drawn: one, but for a face that must be
/// clipped. `points` gives its corners in space.
#[inline(always)]
pub fn face_triangles(
    lens: &Lens,
    sides: Sides,
    placed: [Corner; 3],
    points: [DVec3; 3],
    mut each: impl FnMut(&Triangle),
) {
    if placed.iter().all(|corner| corner.is_placed()) {
        if let Some(triangle) = Triangle::new(placed, sides) {
            each(&triangle);
        }
    } else {
        lens.clip(points, |corners| {
            if let Some(triangle) = Triangle::new(corners, sides) {
                each(&triangle);
            }
        });
    }
}
