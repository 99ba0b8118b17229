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

use wide::{f32x8, i32x8};

use super::picture::{Difference, Patch, Picture};
use crate::picture::render::{LANES, Rect};

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
    /// Means along each row of the picture, one for each window in the row; rows are
    /// [`Windows::stride`] apart here and below.
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
    /// Means along all rows that the windows in question see.
    along_rows: Means,
}

/// Eight numbers of a list.
#[inline(always)]
fn load(list: &[f32], from: usize) -> f32x8 {
    let part = &list[from..from + LANES];
    f32x8::new(std::array::from_fn(|lane| part[lane]))
}

/// Eight weighted means of 11 numbers each: those of `list` from `first` on and each so many
/// further.
#[inline(always)]
fn means(list: &[f32], first: usize, step: usize) -> f32x8 {
    // One look at the length for all.
    let list = &list[first..first + (WINDOW - 1) * step + LANES];
    let at = |k: usize| load(list, k * step);
    // The weights are the same on both sides.
    let mut sum = f32x8::splat(WEIGHTS[RADIUS]) * at(RADIUS);
    for (k, weight) in WEIGHTS[..RADIUS].iter().enumerate() {
        sum += f32x8::splat(*weight) * (at(k) + at(WINDOW - 1 - k));
    }
    sum
}

/// y, y² and x y of a row of pixels, and a block of zeros.
#[inline(always)]
fn products(y: &[u8], x: &[u8], to: &mut Means) {
    for list in to.iter_mut() {
        list.resize(y.len(), 0.0);
    }
    let [to_y, to_yy, to_xy] = to;
    let lists = to_y.iter_mut().zip(to_yy).zip(to_xy);
    for (((to_y, to_yy), to_xy), (&y, &x)) in lists.zip(y.iter().zip(x)) {
        let (y, x) = (f32::from(y), f32::from(x));
        (*to_y, *to_yy, *to_xy) = (y, y * y, x * y);
    }
    for list in to {
        list.extend([0.0; LANES]);
    }
}

/// Means along a row, of eight windows at a time; `to` has room for whole blocks.
#[inline(always)]
fn along_row(pixels: &Means, n_windows: usize, to: [&mut [f32]; 3]) {
    for (pixels, to) in pixels.iter().zip(to) {
        for from in (0..n_windows).step_by(LANES) {
            let found = means(pixels, from, 1);
            to[from..from + LANES].copy_from_slice(found.as_array());
        }
    }
}

/// The similarities of eight windows, from the means of y, y² and x y, and the mean and variance
/// of the original.
#[inline(always)]
fn similarity([y, yy, xy]: [f32x8; 3], x: f32x8, var_x: f32x8) -> i32x8 {
    let [c1, c2] = STABLE.map(f32x8::splat);
    let two = f32x8::splat(2.0);
    let (var_y, covariance) = (yy - y * y, xy - x * y);
    let above = (two * (x * y) + c1) * (two * covariance + c2);
    let below = (x * x + y * y + c1) * (var_x + var_y + c2);
    (above / below * f32x8::splat(UNIT)).fast_round_int()
}

/// The windows that a patch may change: `[rows, columns]`, each first and one after the last.
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

/// Windows in whole blocks.
fn whole_blocks(n: usize) -> usize {
    n.next_multiple_of(LANES)
}

impl Windows {
    /// From one row to the next: a row is read in blocks that begin in it.
    fn stride(&self) -> usize {
        self.n + LANES
    }

    /// Means along all rows of the windows in `rows` and `columns`, as a patch makes them, into the
    /// buffers; returns the length of a row there.
    #[inline(always)]
    fn new_rows(
        &self,
        picture: &Picture,
        patch: &Patch,
        [rows, columns]: [[usize; 2]; 2],
        buffers: &mut Buffers,
    ) -> usize {
        let n_windows = columns[1] - columns[0];
        let width = whole_blocks(n_windows);
        let rows = rows[0]..rows[1] + WINDOW - 1;
        let Buffers { bytes, pixels, along_rows } = buffers;
        for list in along_rows.iter_mut() {
            list.resize(width * rows.len(), 0.0);
        }
        let pixel_columns = [columns[0], columns[1] + WINDOW - 1];
        // The part of the row that the patch has new values for.
        let x = patch.changed.x.map(|x| x.clamp(pixel_columns[0] as i32, pixel_columns[1] as i32));
        for (at, y) in rows.enumerate() {
            let row = at * width..(at + 1) * width;
            let changed = patch.changed.y.map(|y| y as usize);
            if y < changed[0] || y >= changed[1] {
                let start = y * self.stride() + columns[0];
                for (list, kept) in along_rows.iter_mut().zip(&self.along_rows) {
                    let blocks = list[row.clone()].chunks_exact_mut(LANES);
                    for (to, from) in blocks.zip(kept[start..start + width].chunks_exact(LANES)) {
                        to.copy_from_slice(from);
                    }
                }
                continue;
            }
            let [from, to] = pixel_columns.map(|x| y * picture.size + x);
            bytes.clear();
            bytes.extend_from_slice(&picture.now[from..to]);
            let [first, end] = x.map(|x| x as usize - pixel_columns[0]);
            bytes[first..end].copy_from_slice(patch.row(y as i32, x));
            products(bytes, &picture.original[from..to], pixels);
            let [y, yy, xy] = along_rows;
            let to = [&mut y[row.clone()], &mut yy[row.clone()], &mut xy[row]];
            along_row(pixels, n_windows, to);
        }
        width
    }

    /// The similarities of eight windows, of which the first has the place `place`; what is along
    /// their rows begins at `at` in the buffers, with `width` from row to row.
    #[inline(always)]
    fn new_windows(&self, place: usize, along_rows: &Means, at: usize, width: usize) -> i32x8 {
        let [y, yy, xy] = along_rows;
        let means = [means(y, at, width), means(yy, at, width), means(xy, at, width)];
        similarity(means, load(&self.original[0], place), load(&self.original[1], place))
    }
}

impl Difference for Structure {
    type Kept = Windows;
    type Scratch = Buffers;

    fn keep(&self, picture: &Picture) -> Windows {
        let n = (picture.size + 1).saturating_sub(WINDOW);
        let stride = n + LANES;
        let rows = || vec![0.0; stride * picture.size + LANES];
        let mut kept = Windows {
            n,
            along_rows: [rows(), rows(), rows()],
            original: [rows(), rows()],
            similarity: vec![UNIT as i32; stride * n],
        };
        let mut pixels = Means::default();
        for (y, row) in picture.now.chunks_exact(picture.size).enumerate() {
            products(row, row, &mut pixels);
            let [a, b, c] = &mut kept.along_rows;
            let row = y * stride..(y + 1) * stride;
            along_row(&pixels, n, [&mut a[row.clone()], &mut b[row.clone()], &mut c[row]]);
        }
        for row in 0..n {
            for column in (0..n).step_by(LANES) {
                let of = |map: usize| means(&kept.along_rows[map], row * stride + column, stride);
                let (mean, square) = (of(0), of(1));
                let place = row * stride + column..row * stride + column + LANES;
                kept.original[0][place.clone()].copy_from_slice(mean.as_array());
                kept.original[1][place].copy_from_slice((square - mean * mean).as_array());
            }
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
        let Some([rows, columns]) = reached(&patch.changed, self.margin, kept.n) else { return 0 };
        let width = kept.new_rows(picture, patch, [rows, columns], buffers);
        let mut loss = 0;
        for row in rows[0]..rows[1] {
            for column in (columns[0]..columns[1]).step_by(LANES) {
                let place = row * kept.stride() + column;
                let at = (row - rows[0]) * width + column - columns[0];
                let new = kept.new_windows(place, &buffers.along_rows, at, width);
                let n = (columns[1] - column).min(LANES);
                let pairs = new.as_array().iter().zip(&kept.similarity[place..place + n]);
                loss += pairs.map(|(new, now)| i64::from(now - new)).sum::<i64>();
            }
        }
        loss
    }

    fn update(&self, picture: &Picture, kept: &mut Windows, patch: &Patch, buffers: &mut Buffers) {
        let margin = Self::EXACT_MARGIN;
        let Some([rows, columns]) = reached(&patch.changed, margin, kept.n) else { return };
        let width = kept.new_rows(picture, patch, [rows, columns], buffers);
        for row in rows[0]..rows[1] {
            for column in (columns[0]..columns[1]).step_by(LANES) {
                let place = row * kept.stride() + column;
                let at = (row - rows[0]) * width + column - columns[0];
                let new = kept.new_windows(place, &buffers.along_rows, at, width);
                let n = (columns[1] - column).min(LANES);
                kept.similarity[place..place + n].copy_from_slice(&new.as_array()[..n]);
            }
        }
        let (stride, n) = (kept.stride(), columns[1] - columns[0]);
        for (along, new) in kept.along_rows.iter_mut().zip(&buffers.along_rows) {
            for (row, new) in (rows[0]..).zip(new.chunks_exact(width)) {
                along[row * stride + columns[0]..][..n].copy_from_slice(&new[..n]);
            }
        }
    }

    fn price(&self, growth: i64, n_cameras: usize, size: usize) -> f64 {
        let n = (size + 1).saturating_sub(WINDOW);
        growth as f64 / (f64::from(UNIT) * (n * n * n_cameras).max(1) as f64)
    }
}
