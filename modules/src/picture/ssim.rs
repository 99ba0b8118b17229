//! Structural similarity of two gray pictures.
//!
//! Z. Wang, A. C. Bovik, H. R. Sheikh and E. P. Simoncelli, "Image quality assessment: from error
//! visibility to structural similarity", IEEE Transactions on Image Processing 13(4), 2004, section
//! III.B–C: at each pixel, means, variances and covariance under a Gaussian window of 11 × 11
//! pixels, σ = 1.5, with weights that sum to 1; K₁ = 0.01, K₂ = 0.03, L = 255. Their mean is over
//! the pixels whose window lies inside of the picture, [`Ssim::interior`] here. At the others the
//! picture is mirrored at its border, the edge pixel repeated, as scikit-image does.
//!
//! The window is applied along rows, then along columns, to four pictures: both, the sum of their
//! squares and their product; variances are needed only in sum. Sums have a fixed order, so a value
//! is the same on any machine, and of equal pictures it is exactly 1.

use mve_core::{Cancelled, Control};
use pulp::{Arch, Simd, WithSimd};
use thiserror::Error;

/// Pixels from the middle of the window to its edge.
pub const RADIUS: usize = 5;

/// Pixels across the window.
const WINDOW: usize = 2 * RADIUS + 1;

/// exp(−k² / (2 · 1.5²)) for k = 0 to 5, over the sum of all eleven. Written out, so that no
/// library's exponential enters.
const WEIGHTS: [f64; RADIUS + 1] = [
    0.266_011_724_861_794_36,
    0.213_005_537_711_253_7,
    0.109_360_689_509_700_02,
    0.036_000_772_128_430_83,
    0.007_598_758_135_239_185,
    0.001_028_380_084_479_11,
];

/// (K₁ L)² and (K₂ L)².
const STABILIZERS: [f64; 2] = [6.5025, 58.5225];

/// Pixels between two looks whether the work was cancelled: a few milliseconds.
const STRIDE: usize = 1 << 16;

/// How many pictures are smoothed.
const N_MAPS: usize = 4;

/// How similar two pictures are; 1 is equal.
#[derive(Clone, Debug, PartialEq)]
pub struct Ssim {
    /// At each pixel, −1 to 1, rows from the top.
    pub map: Vec<f64>,
    /// The mean over all pixels.
    pub whole: f64,
    /// The mean over the pixels whose window lies inside; `None` where no window does.
    pub interior: Option<f64>,
}

/// Why two pictures cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SsimError {
    /// A list of bytes that does not fit the size.
    #[error("a picture of {width} × {height} gray pixels cannot have {found} bytes")]
    Length {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes of the picture.
        found: usize,
    },
    /// No pixel.
    #[error("a picture without pixels has no similarity")]
    Empty,
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Compares two gray pictures of `width × height` pixels. O(pixels); see `benches/render.rs`.
///
/// # Errors
/// [`SsimError`] for pictures without pixels, or whose bytes do not fit the size, and when
/// `control` ends it.
pub fn ssim(
    a: &[u8],
    b: &[u8],
    [width, height]: [usize; 2],
    control: Control,
) -> Result<Ssim, SsimError> {
    let n = width.saturating_mul(height);
    if let Some(bad) = [a, b].iter().find(|bytes| bytes.len() != n) {
        return Err(SsimError::Length { width, height, found: bad.len() });
    }
    if n == 0 {
        return Err(SsimError::Empty);
    }
    let mut map = vec![0.0; n];
    Arch::new().dispatch(Fill { pictures: [a, b], width, map: &mut map, control })?;
    let whole = map.chunks_exact(width).map(sum).sum::<f64>() / n as f64;
    let inside = [width, height].map(|side| side.saturating_sub(2 * RADIUS));
    let interior = (inside[0] > 0 && inside[1] > 0).then(|| {
        let rows = map.chunks_exact(width).skip(RADIUS).take(inside[1]);
        let sums = rows.map(|row| sum(&row[RADIUS..RADIUS + inside[0]]));
        sums.sum::<f64>() / (inside[0] * inside[1]) as f64
    });
    Ok(Ssim { map, whole, interior })
}

/// The place that a place before the first or after the last of `n` mirrors.
fn mirror(at: isize, n: usize) -> usize {
    let at = at.rem_euclid(2 * n as isize) as usize;
    if at < n { at } else { 2 * n - 1 - at }
}

/// Sums in eight lanes, one after the other in the end: an order that vectors can keep.
fn sum(values: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    for chunk in values.chunks(8) {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane += value;
        }
    }
    lanes.iter().sum()
}

/// [`fill`] with the vector instructions of the machine. A closure in its place would not be
/// compiled for them.
struct Fill<'a> {
    pictures: [&'a [u8]; 2],
    width: usize,
    map: &'a mut [f64],
    control: Control<'a>,
}

impl WithSimd for Fill<'_> {
    type Output = Result<(), Cancelled>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        fill(self.pictures, self.width, self.map, self.control)
    }
}

/// Fills the map, row by row; the last eleven rows, smoothed along themselves, are at hand in a
/// ring.
#[inline(always)]
fn fill(
    pictures: [&[u8]; 2],
    width: usize,
    map: &mut [f64],
    control: Control,
) -> Result<(), Cancelled> {
    let height = map.len() / width;
    let mut padded = vec![0.0; N_MAPS * (width + 2 * RADIUS)];
    let mut ring = vec![0.0; WINDOW * N_MAPS * width];
    let mut smooth = vec![0.0; N_MAPS * width];
    let n_steps = height + 2 * RADIUS;
    let pause = STRIDE.div_ceil(width);
    for step in 0..n_steps {
        if step.is_multiple_of(pause) {
            control.at(step as f64 / n_steps as f64)?;
        }
        let from = mirror(step as isize - RADIUS as isize, height) * width;
        let rows = pictures.map(|picture| &picture[from..from + width]);
        pad(rows, &mut padded);
        let slot = step % WINDOW * N_MAPS * width;
        let slot = &mut ring[slot..slot + N_MAPS * width];
        let stride = width + 2 * RADIUS;
        for (out, padded) in slot.chunks_exact_mut(width).zip(padded.chunks_exact(stride)) {
            weigh(std::array::from_fn(|k| &padded[k..k + width]), out);
        }
        if let Some(y) = step.checked_sub(2 * RADIUS) {
            for (kind, out) in smooth.chunks_exact_mut(width).enumerate() {
                let row = |k: usize| ((y + k) % WINDOW * N_MAPS + kind) * width;
                weigh(std::array::from_fn(|k| &ring[row(k)..row(k) + width]), out);
            }
            compare(&smooth, &mut map[y * width..(y + 1) * width]);
        }
    }
    Ok(())
}

/// A row of each of the four pictures, with its mirrored ends.
#[inline(always)]
fn pad([a, b]: [&[u8]; 2], padded: &mut [f64]) {
    let (width, stride) = (a.len(), a.len() + 2 * RADIUS);
    let (first, rest) = padded.split_at_mut(stride);
    let (second, rest) = rest.split_at_mut(stride);
    let (squares, products) = rest.split_at_mut(stride);
    let inner = RADIUS..RADIUS + width;
    let means = first[inner.clone()].iter_mut().zip(&mut second[inner.clone()]);
    let powers = squares[inner.clone()].iter_mut().zip(&mut products[inner]);
    for (((a, b), (mean_a, mean_b)), (square, product)) in a.iter().zip(b).zip(means).zip(powers) {
        let (a, b) = (i32::from(*a), i32::from(*b));
        (*mean_a, *mean_b) = (f64::from(a), f64::from(b));
        (*square, *product) = (f64::from(a * a + b * b), f64::from(a * b));
    }
    for row in padded.chunks_exact_mut(stride) {
        for k in 0..RADIUS {
            row[k] = row[RADIUS + mirror(k as isize - RADIUS as isize, width)];
            row[RADIUS + width + k] = row[RADIUS + mirror((width + k) as isize, width)];
        }
    }
}

/// The weighted sum of eleven rows, at each place.
#[inline(always)]
fn weigh(taps: [&[f64]; WINDOW], out: &mut [f64]) {
    let n = out.len();
    let taps = taps.map(|tap| &tap[..n]);
    for (x, out) in out.iter_mut().enumerate() {
        let pair = |k: usize| WEIGHTS[k] * (taps[RADIUS - k][x] + taps[RADIUS + k][x]);
        let near = WEIGHTS[0] * taps[RADIUS][x] + pair(1);
        *out = near + (pair(2) + pair(3)) + (pair(4) + pair(5));
    }
}

/// A row of the map from a row of the smoothed pictures.
#[inline(always)]
fn compare(smooth: &[f64], out: &mut [f64]) {
    let n = out.len();
    let [mean_a, mean_b, squares, products] =
        std::array::from_fn(|kind| &smooth[kind * n..(kind + 1) * n]);
    let [c1, c2] = STABILIZERS;
    for (x, out) in out.iter_mut().enumerate() {
        let product = mean_a[x] * mean_b[x];
        let square = mean_a[x] * mean_a[x] + mean_b[x] * mean_b[x];
        let above = (2.0 * product + c1) * (2.0 * (products[x] - product) + c2);
        let below = (square + c1) * ((squares[x] - square) + c2);
        *out = above / below;
    }
}

#[cfg(test)]
#[path = "ssim_tests.rs"]
mod tests;
