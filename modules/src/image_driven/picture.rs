//! A picture of the working mesh, and the part of it that a collapse would change.

use crate::picture::render::Rect;

/// What one camera sees, and what it saw of the original. Luminances, the top row first.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels in a row, and rows.
    pub size: usize,
    /// The picture of the original, `size` × `size`.
    pub original: Vec<u8>,
    /// The picture of the mesh as it is now, `size` × `size`.
    pub now: Vec<u8>,
}

/// New luminances for a rectangle of a picture.
#[derive(Clone, Debug)]
pub struct Patch {
    /// The pixels that may change. Never empty, always within the picture.
    pub area: Rect,
    /// The part of it that does change: the smallest rectangle around all pixels whose value
    /// becomes another. Never empty.
    pub changed: Rect,
    /// New values of all pixels of `area`, row by row, with [`Patch::stride`] from row to row.
    pub values: Vec<u8>,
    /// Values from one row to the next, at least the width of the area.
    pub stride: usize,
}

impl Default for Patch {
    fn default() -> Self {
        Self { area: Rect::NONE, changed: Rect::NONE, values: Vec::new(), stride: 0 }
    }
}

impl Patch {
    /// The new values of row `y` of the picture in columns `x`, which lie in the area.
    #[inline]
    pub fn row(&self, y: i32, x: [i32; 2]) -> &[u8] {
        let start = (y - self.area.y[0]) as usize * self.stride;
        let [from, to] = x.map(|x| start + (x - self.area.x[0]) as usize);
        &self.values[from..to]
    }

    /// Puts the new values into a picture.
    pub fn apply(&self, picture: &mut Picture) {
        let x = self.changed.x;
        for y in self.changed.y[0]..self.changed.y[1] {
            let [from, to] = x.map(|x| y as usize * picture.size + x as usize);
            picture.now[from..to].copy_from_slice(self.row(y, x));
        }
    }
}

/// How different a picture is from that of the original, in a form that can be brought up to date.
///
/// A whole number measures the difference of one camera, so that a sum over areas, cameras and
/// threads does not depend on its order. An image-driven cost is one implementation of this and a
/// [`COST`](crate::cost) entry; see `cost/image_mse.rs`.
pub trait Difference: Clone + Send + Sync {
    /// What is kept for each camera, beside the picture.
    type Kept: Send;
    /// Buffers of a thread.
    type Scratch: Default + Send;

    /// Prepares for one camera; the picture is that of the original.
    fn keep(&self, picture: &Picture) -> Self::Kept;

    /// By how much the difference of this camera grows if the patch is put in. A function of the
    /// picture and of the patch as a picture would show it: a larger area with the same changes
    /// gives the same number.
    fn change(
        &self,
        picture: &Picture,
        kept: &Self::Kept,
        patch: &Patch,
        scratch: &mut Self::Scratch,
    ) -> i64;

    /// Brings what is kept up to date before the patch is put in.
    fn update(
        &self,
        _picture: &Picture,
        _kept: &mut Self::Kept,
        _patch: &Patch,
        _scratch: &mut Self::Scratch,
    ) {
    }

    /// The price that is reported for a growth of the difference, summed over `n_cameras` pictures
    /// of `size` × `size` pixels.
    fn price(&self, growth: i64, n_cameras: usize, size: usize) -> f64;
}
