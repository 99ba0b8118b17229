//! Structural similarity in a form that a few changed pixels bring up to date.
//!
//! Z. Wang, A. C. Bovik, H. R. Sheikh and E. P. Simoncelli, "Image quality assessment: from error
//! visibility to structural similarity", IEEE Transactions on Image Processing 13(4), 2004: 11 × 11
//! Gaussian windows of σ 1.5, K₁ 0.01, K₂ 0.03, L 255, windows that lie in the picture.
//!
//! Windows are separable: the means of y, y² and x y (x the original, y the mesh) along rows are
//! kept for the picture as it is, so a change needs new ones for its own rows only, and then the
//! means along the columns that meet them. All in single precision with a fixed order of additions,
//! so a window gives the same bits whether it is computed with its neighbors or alone; the values
//! of windows are rounded to 2⁻²⁴ and added as whole numbers. Against double precision the
//! value of a window is off by up to about 10⁻⁴, where both pictures are flat.

use super::picture::{Difference, Patch, Picture};
use crate::geometry::render::Rect;

/// Pixels from the center of a window to its rim.
const RADIUS: usize = 5;
/// Pixels along a side of a window.
const WINDOW: usize = 2 * RADIUS + 1;
/// (K₁ L)² and (K₂ L)².
const STABLE: [f32; 2] = [2.55 * 2.55, 7.65 * 7.65];
/// Whole numbers to one unit of similarity.
const UNIT: f32 = 16_777_216.0;

/// exp(−k² / (2 · 1.5²)) for k = −5..5, over their sum.
const WEIGHTS: [f32; WINDOW] = [
    0.001_028_380_1,
    0.007_598_758,
    0.036_000_773,
    0.109_360_69,
    0.213_005_53,
    0.266_011_72,
    0.213_005_53,
    0.109_360_69,
    0.036_000_773,
    0.007_598_758,
    0.001_028_380_1,
];

/// The difference 1 − SSIM.
#[derive(Clone, Copy, Debug)]
pub struct Structure {
    /// How far around changed pixels windows are compared again; from [`Structure::EXACT_MARGIN`]
    /// the result is that of comparing all.
    pub margin: i32,
}

impl Structure {
    /// Half of a window: windows farther off do not see a pixel.
    pub const EXACT_MARGIN: i32 = RADIUS as i32;
}

impl Default for Structure {
    fn default() -> Self {
        Self { margin: Self::EXACT_MARGIN }
    }
}

/// Weighted means of y, y² and x y.
type Means = [Vec<f32>; 3];

/// What is kept of a camera.
///
/// A window has the number of its first row and column: window (r, c) covers rows r to r + 10 and
/// columns c to c + 10 of the picture.
#[derive(Debug)]
pub struct Windows {
    /// Windows in a row, and rows of windows.
    n: usize,
    /// Means along each row of the picture, one for each window in the row.
    along_rows: Means,
    /// Mean and variance of the original in every window.
    original: [Vec<f32>; 2],
    /// Similarity of every window, in [`UNIT`]s.
    similarity: Vec<i32>,
}

/// Buffers of a thread.
#[derive(Debug, Default)]
pub struct Buffers {
    /// The new luminances of a row.
    bytes: Vec<u8>,
    /// y, y² and x y of a row.
    pixels: Means,
    /// Means along the rows that change.
    along_rows: Means,
    /// Means of a row of windows.
    windows: Means,
    similarity: Vec<i32>,
}

/// Sets the length, whatever is in there.
#[inline(always)]
fn size<T: Copy + Default>(lists: &mut [Vec<T>], n: usize) {
    lists.iter_mut().for_each(|list| list.resize(n, T::default()));
}

/// y, y² and x y of a row of pixels.
#[inline(always)]
fn products(y: &[u8], x: &[u8], to: &mut Means) {
    size(to, y.len());
    let [to_y, to_yy, to_xy] = to;
    let to = to_y.iter_mut().zip(to_yy).zip(to_xy);
    for (((to_y, to_yy), to_xy), (&y, &x)) in to.zip(y.iter().zip(x)) {
        let (y, x) = (f32::from(y), f32::from(x));
        (*to_y, *to_yy, *to_xy) = (y, y * y, x * y);
    }
}

/// Adds a multiple of a row.
#[inline(always)]
fn add_weighted(weight: f32, from: &[f32], to: &mut [f32]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += weight * from;
    }
}

/// Weighted means of 11 neighbors each: `to[i]` of `from[i..i + 11]`.
#[inline(always)]
fn along_row(from: &[f32], to: &mut [f32]) {
    to.fill(0.0);
    for (k, weight) in WEIGHTS.iter().enumerate() {
        add_weighted(*weight, &from[k..], to);
    }
}

/// Weighted means of 11 rows of `n`, from `row` on.
#[inline(always)]
fn along_columns(rows: &[f32], n: usize, row: usize, to: &mut [f32]) {
    to.fill(0.0);
    for (weight, y) in WEIGHTS.iter().zip(row..) {
        add_weighted(*weight, &rows[y * n..], to);
    }
}

/// The similarity of each window of a row, from its means and those of the original.
#[inline(always)]
fn similarity(means: &Means, mean: &[f32], variance: &[f32], to: &mut [i32]) {
    let [c1, c2] = STABLE;
    let windows = means[0].iter().zip(&means[1]).zip(&means[2]);
    let windows = windows.zip(mean.iter().zip(variance));
    for (to, (((&y, &yy), &xy), (&x, &var_x))) in to.iter_mut().zip(windows) {
        let (var_y, covariance) = (yy - y * y, xy - x * y);
        let above = (2.0 * (x * y) + c1) * (2.0 * covariance + c2);
        let below = (x * x + y * y + c1) * (var_x + var_y + c2);
        *to = (above / below * UNIT) as i32;
    }
}

/// The windows that a patch may change: `(rows, columns)`, each first and one after the last.
fn reached(changed: &Rect, margin: i32, n: usize) -> Option<[[usize; 2]; 2]> {
    let n = n as i32;
    let side = |at: [i32; 2]| {
        let radius = RADIUS as i32;
        [(at[0] - margin - radius).clamp(0, n), (at[1] + margin - radius).clamp(0, n)]
    };
    let (rows, columns) = (side(changed.y), side(changed.x));
    let is_any = rows[0] < rows[1] && columns[0] < columns[1];
    is_any.then(|| [rows, columns].map(|range| range.map(|at| at as usize)))
}

impl Windows {
    /// Means along the rows that a patch changes, of the windows in `columns`, into the buffers.
    #[inline(always)]
    fn new_rows(picture: &Picture, patch: &Patch, columns: [usize; 2], buffers: &mut Buffers) {
        let width = columns[1] - columns[0];
        let rows = patch.changed.y[0]..patch.changed.y[1];
        let Buffers { bytes, pixels, along_rows, .. } = buffers;
        size(along_rows, width * rows.len());
        let pixel_columns = [columns[0], columns[1] + WINDOW - 1];
        // The part of the row that the patch has new values for.
        let x = patch.changed.x.map(|x| x.clamp(pixel_columns[0] as i32, pixel_columns[1] as i32));
        for (at, y) in rows.enumerate() {
            let [from, to] = pixel_columns.map(|x| y as usize * picture.size + x);
            bytes.clear();
            bytes.extend_from_slice(&picture.now[from..to]);
            let [first, end] = x.map(|x| x as usize - pixel_columns[0]);
            bytes[first..end].copy_from_slice(patch.row(y, x));
            products(bytes, &picture.original[from..to], pixels);
            for (pixels, along) in pixels.iter().zip(along_rows.iter_mut()) {
                along_row(pixels, &mut along[at * width..(at + 1) * width]);
            }
        }
    }

    /// The similarities of the windows of a row in `columns` as a patch makes them, into the
    /// buffers, which hold the patch's rows; the place of the first window among all.
    #[inline(always)]
    fn new_windows(
        &self,
        patch: &Patch,
        row: usize,
        columns: [usize; 2],
        buffers: &mut Buffers,
    ) -> usize {
        let width = columns[1] - columns[0];
        let changed = patch.changed.y.map(|y| y as usize);
        let Buffers { along_rows, windows, similarity: found, .. } = buffers;
        size(windows, width);
        found.resize(width, 0);
        for map in 0..3 {
            let (kept, new, to) = (&self.along_rows[map], &along_rows[map], &mut windows[map]);
            to.fill(0.0);
            for (weight, y) in WEIGHTS.iter().zip(row..) {
                let from = if changed[0] <= y && y < changed[1] {
                    &new[(y - changed[0]) * width..][..width]
                } else {
                    &kept[y * self.n + columns[0]..][..width]
                };
                add_weighted(*weight, from, to);
            }
        }
        let place = row * self.n + columns[0];
        let mean = &self.original[0][place..place + width];
        let variance = &self.original[1][place..place + width];
        similarity(windows, mean, variance, found);
        place
    }
}

impl Difference for Structure {
    type Kept = Windows;
    type Scratch = Buffers;

    fn keep(&self, picture: &Picture) -> Windows {
        let n = (picture.size + 1).saturating_sub(WINDOW);
        let rows = || vec![0.0; n * picture.size];
        let mut kept = Windows {
            n,
            along_rows: [rows(), rows(), rows()],
            original: [vec![0.0; n * n], vec![0.0; n * n]],
            similarity: vec![UNIT as i32; n * n],
        };
        let mut pixels = Means::default();
        for (y, row) in picture.now.chunks_exact(picture.size).enumerate() {
            products(row, row, &mut pixels);
            for (pixels, along) in pixels.iter().zip(&mut kept.along_rows) {
                along_row(pixels, &mut along[y * n..(y + 1) * n]);
            }
        }
        let [mean, variance] = &mut kept.original;
        let rows = mean.chunks_exact_mut(n.max(1)).zip(variance.chunks_exact_mut(n.max(1)));
        for (row, (mean, variance)) in rows.enumerate() {
            along_columns(&kept.along_rows[0], n, row, mean);
            along_columns(&kept.along_rows[1], n, row, variance);
            mean.iter().zip(variance).for_each(|(mean, variance)| *variance -= mean * mean);
        }
        kept
    }

    #[inline(always)]
    fn change(
        &self,
        picture: &Picture,
        kept: &Windows,
        patch: &Patch,
        buffers: &mut Buffers,
    ) -> i64 {
        let Some(reached) = reached(&patch.changed, self.margin, kept.n) else { return 0 };
        Windows::new_rows(picture, patch, reached[1], buffers);
        let mut loss = 0;
        let [rows, columns] = reached;
        for row in rows[0]..rows[1] {
            let place = kept.new_windows(patch, row, columns, buffers);
            for (new, now) in buffers.similarity.iter().zip(&kept.similarity[place..]) {
                loss += i64::from(now - new);
            }
        }
        loss
    }

    fn update(&self, picture: &Picture, kept: &mut Windows, patch: &Patch, buffers: &mut Buffers) {
        let margin = Self::EXACT_MARGIN;
        let Some(reached) = reached(&patch.changed, margin, kept.n) else { return };
        let [rows, columns] = reached;
        let (n, width) = (kept.n, columns[1] - columns[0]);
        Windows::new_rows(picture, patch, columns, buffers);
        for row in rows[0]..rows[1] {
            let place = kept.new_windows(patch, row, columns, buffers);
            kept.similarity[place..place + width].copy_from_slice(&buffers.similarity);
        }
        for (along, new) in kept.along_rows.iter_mut().zip(&buffers.along_rows) {
            for (row, new) in (patch.changed.y[0] as usize..).zip(new.chunks_exact(width)) {
                along[row * n + columns[0]..][..width].copy_from_slice(new);
            }
        }
    }

    fn price(&self, growth: i64, n_cameras: usize, size: usize) -> f64 {
        let n = (size + 1).saturating_sub(WINDOW);
        growth as f64 / (f64::from(UNIT) * (n * n * n_cameras).max(1) as f64)
    }
}
