//! What a camera sees: the nearest face at every pixel.

use std::ops::Range;

use glam::DVec3;
use mve_mesh::data::{FaceId, TriMesh};
use pulp::{Arch, Simd, WithSimd};

use super::project::{Corner, Lens};
use super::raster::{FaceSide, Rect, Row, Sides, Triangle};

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
        let corners = corners(mesh, lens);
        let mut seen = Self::nothing(lens.size);
        seen.add(mesh, 0..mesh.faces.len(), &corners, lens, sides);
        seen
    }

    /// Draws more faces of a mesh, of numbers after those that were drawn; `placed` are the corners
    /// of its vertices.
    pub fn add(
        &mut self,
        mesh: &TriMesh,
        faces: Range<usize>,
        placed: &[Corner],
        lens: &Lens,
        sides: Sides,
    ) {
        Arch::new().dispatch(Add { seen: self, mesh, faces, placed, lens, sides });
    }

    /// Draws a face of which some corner has no place.
    #[cold]
    fn add_clipped(&mut self, mesh: &TriMesh, face: FaceId, lens: &Lens, sides: Sides) {
        lens.clip(mesh.corners(face), |corners| {
            if let Some(triangle) = Triangle::new(corners, sides) {
                triangle.rows(&Rect::whole(lens.size), |row| self.draw(face.0, &row));
            }
        });
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
        for (k, (nearest, seen)) in (0i32..).zip(nearest) {
            let inv_depth = row.inv_depth_at(k);
            let is_nearer = inv_depth > *nearest;
            // Written whether or not it changes, which lets rows be drawn as vectors.
            *nearest = if is_nearer { inv_depth } else { *nearest };
            *seen = if is_nearer { face } else { *seen };
        }
    }
}

/// [`Visible::add`] with the vector instructions of the machine. A closure in its place would not
/// be compiled for them.
struct Add<'a> {
    seen: &'a mut Visible,
    mesh: &'a TriMesh,
    faces: Range<usize>,
    placed: &'a [Corner],
    lens: &'a Lens,
    sides: Sides,
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { seen, mesh, faces, placed, lens, sides } = self;
        let whole = Rect::whole(lens.size);
        for (number, face) in faces.clone().zip(&mesh.faces[faces]) {
            let number = number as u32;
            let corners = [placed[face[0].idx()], placed[face[1].idx()], placed[face[2].idx()]];
            if !is_placed(corners) {
                seen.add_clipped(mesh, FaceId(number), lens, sides);
            } else if let Some(triangle) = Triangle::new(corners, sides) {
                // Not by `face_triangles`: its closure would not be compiled for the vectors.
                triangle.rows(&whole, |row| seen.draw(number, &row));
            }
        }
    }
}

/// The corners of all vertices.
pub fn corners(mesh: &TriMesh, lens: &Lens) -> Vec<Corner> {
    mesh.positions.iter().map(|&point| lens.corner(point)).collect()
}

/// Whether all corners have a place on the grid.
#[inline(always)]
pub fn is_placed([a, b, c]: [Corner; 3]) -> bool {
    a.is_placed() && b.is_placed() && c.is_placed()
}

/// Whether a face at these corners may be seen: it has area and shows a side that is drawn, or it
/// must be clipped to know.
#[inline(always)]
pub fn may_be_seen(placed: [Corner; 3], sides: Sides) -> bool {
    let turns = turns(placed);
    let shows = if sides == Sides::Front { turns < 0 } else { turns != 0 };
    shows || !is_placed(placed)
}

/// Twice the area on the grid, negative where the front is seen: rows count downward.
#[inline(always)]
fn turns([a, b, c]: [Corner; 3]) -> i64 {
    let [bx, by, cx, cy] = [b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y].map(i64::from);
    bx * cy - by * cx
}

/// Which side of a face is seen, of a face that is seen; `placed` are its corners, `points` where
/// they are in space.
#[inline]
pub fn side_seen(lens: &Lens, placed: [Corner; 3], points: [DVec3; 3]) -> FaceSide {
    let is_front = if is_placed(placed) {
        turns(placed) < 0
    } else {
        let [a, b, c] = points;
        (b - a).cross(c - a).dot(lens.camera.eye - a) > 0.0
    };
    if is_front { FaceSide::Front } else { FaceSide::Back }
}

/// Calls `each` with the triangles that a face is on the grid, if it shows a side that is drawn:
/// one, but for a face that must be clipped. `points` are its corners in space.
#[inline(always)]
pub fn face_triangles(
    lens: &Lens,
    sides: Sides,
    placed: [Corner; 3],
    points: [DVec3; 3],
    mut each: impl FnMut(&Triangle),
) {
    if is_placed(placed) {
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
