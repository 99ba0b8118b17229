//! How different two pictures look where they are flipped on a screen: ꟻLIP.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild, "FLIP:
//! a difference evaluator for alternating images", Proceedings of the ACM on Computer Graphics and
//! Interactive Techniques 3(2), 2020, for pictures of display values (LDR), with the kernels of the
//! authors' program from version 1.2 on. At each pixel:
//!
//! - colors (sRGB) become YCxCz, are filtered by the contrast sensitivity of the eye at that many
//!   pixels per degree, become L\*a\*b\* with Hunt's effect, and differ by HyAB, raised to 0.7 and
//!   mapped to 0 to 1 so that 0.4 of the largest difference is 0.95;
//! - edges and points of the unfiltered luminance, found by derivatives of a Gaussian as wide as
//!   the eye sees, differ by the larger of both, over √2 and raised to 0.5;
//! - the value is the color difference raised to 1 less that of the features.
//!
//! It is 0 where the pictures look the same and at most 1. Beyond its border a picture goes on
//! with the pixels at it. Values are computed in `f64`, the authors' in `f32`. Powers and cubic
//! roots are those of the system's library, so that last bits may differ between machines, but not
//! between numbers of threads.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use mve_core::{Cancelled, Control};
use mve_mesh::data::bytes_of;
use mve_mesh::data::{Image, PixelKind};
use rayon::prelude::*;
use thiserror::Error;

use super::color_scale::{ColorTable, Scale};

/// Pixels per degree at 0.7 m from a screen of 3,840 pixels in 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// What the difference of two colors is raised to.
const COLOR_EXPONENT: f64 = 0.7;
/// What the difference of features is raised to.
const FEATURE_EXPONENT: f64 = 0.5;
/// This part of the largest color difference is mapped to `KNEE_VALUE`.
const KNEE: f64 = 0.4;
const KNEE_VALUE: f64 = 0.95;
/// Width of a feature that the eye sees, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// From linear red, green and blue to X, Y and Z: the primaries of sRGB and D65.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// Of each channel: the sum of Gaussians that is the contrast sensitivity, as pairs of a and b in
/// a √(π / b) exp(−π² x² / b), x in degrees.
const SENSITIVITY: [[(f64, f64); 2]; 3] =
    [[(1.0, 0.0047), (0.0, 1e-5)], [(1.0, 0.0053), (0.0, 1e-5)], [(34.1, 0.04), (13.5, 0.025)]];

/// Why two pictures cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FlipError {
    /// Pictures of two sizes, or without the bytes that their size asks for, or without a pixel.
    #[error("pictures of {0} × {1} and {2} × {3} pixels cannot be compared; one size is needed")]
    Sizes(usize, usize, usize, usize),
    /// The caller ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The difference at each pixel, 0 to 1, rows from the top. O(pixels × pixels per degree).
///
/// # Errors
/// [`FlipError`] for pictures without pixels or of two sizes, and when `control` ends it.
pub fn flip(
    reference: &Image,
    test: &Image,
    pixels_per_degree: f64,
    control: Control,
) -> Result<Vec<f64>, FlipError> {
    let sizes = [[reference.width, reference.height], [test.width, test.height]];
    let is_empty = reference.bytes.is_empty() || test.bytes.is_empty();
    if sizes[0] != sizes[1] || is_empty || !reference.is_whole() || !test.is_whole() {
        let [[a, b], [c, d]] = sizes;
        return Err(FlipError::Sizes(a, b, c, d));
    }
    let space = ColorSpace::new();
    let kernels = Kernels::new(pixels_per_degree);
    let prepare = |image, control: Control| {
        let picture = Planes::of(image, &space, control.part(0.0, 0.1))?;
        let features = picture.features(&kernels, control.part(0.1, 0.5))?;
        let colors = picture.filtered(&kernels, &space, control.part(0.5, 1.0))?;
        Ok::<_, Cancelled>((features, colors))
    };
    let (features_a, colors_a) = prepare(reference, control.part(0.0, 0.45))?;
    let (features_b, colors_b) = prepare(test, control.part(0.45, 0.9))?;
    let largest = space.largest_difference();
    let mut map = vec![0.0; colors_a.len()];
    let width = reference.width;
    let rows = map.par_chunks_mut(width).enumerate();
    let control = control.part(0.9, 1.0);
    rows.try_for_each(|(y, row)| {
        control.at(0.0)?;
        for (x, value) in row.iter_mut().enumerate() {
            let at = y * width + x;
            let color = color_difference(colors_a[at], colors_b[at], largest);
            let [edges, points] = [0, 1].map(|k| (features_a[at][k] - features_b[at][k]).abs());
            let feature = (edges.max(points) / 2.0_f64.sqrt()).powf(FEATURE_EXPONENT);
            *value = color.powf(1.0 - feature);
        }
        Ok::<_, Cancelled>(())
    })?;
    Ok(map)
}

/// Values as the authors show them: in the colors of Magma, from black over purple to pale yellow,
/// three bytes a pixel.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn flip_colors(values: &[f64], control: Control) -> Result<Vec<u8>, Cancelled> {
    let magma = ColorTable::new(Scale::Magma);
    let mut bytes = Vec::with_capacity(3 * values.len());
    for (place, &value) in values.iter().enumerate() {
        control.item(place, values.len())?;
        bytes.extend(bytes_of(magma.color(value)));
    }
    Ok(bytes)
}

/// The difference of two colors (L\*, and a\*, b\* by Hunt), 0 to 1.
fn color_difference(a: DVec3, b: DVec3, largest: f64) -> f64 {
    let difference = hyab(a, b).powf(COLOR_EXPONENT);
    let knee = KNEE * largest;
    if difference < knee {
        difference * KNEE_VALUE / knee
    } else {
        KNEE_VALUE + (difference - knee) / (largest - knee) * (1.0 - KNEE_VALUE)
    }
}

/// The distance of two colors: along lightness as it is, across it as the crow flies.
fn hyab(a: DVec3, b: DVec3) -> f64 {
    let [lightness, across, beside] = (a - b).to_array();
    lightness.abs() + (across * across + beside * beside).sqrt()
}

/// From and to the color spaces.
struct ColorSpace {
    xyz_from_rgb: DMat3,
    rgb_from_xyz: DMat3,
    /// X, Y and Z of white.
    white: DVec3,
    /// The linear value of each byte.
    linear: [f64; 256],
}

impl ColorSpace {
    fn new() -> Self {
        let xyz_from_rgb = DMat3::from_cols_array_2d(&XYZ_FROM_RGB).transpose();
        let linear = std::array::from_fn(|byte| {
            let value = byte as f64 / 255.0;
            if value > 0.04045 { ((value + 0.055) / 1.055).powf(2.4) } else { value / 12.92 }
        });
        let (rgb_from_xyz, white) = (xyz_from_rgb.inverse(), xyz_from_rgb * DVec3::ONE);
        Self { xyz_from_rgb, rgb_from_xyz, white, linear }
    }

    fn ycxcz(&self, rgb: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = self.xyz_from_rgb * rgb / self.white;
        DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
    }

    /// Linear red, green and blue of a filtered color; what no screen can show is clamped.
    fn rgb(&self, ycxcz: DVec3) -> DVec3 {
        let y = (ycxcz.x + 16.0) / 116.0;
        let xyz = DVec3::new(y + ycxcz.y / 500.0, y, y - ycxcz.z / 200.0) * self.white;
        (self.rgb_from_xyz * xyz).clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// L\*, and a\* and b\* less the darker it is (Hunt's effect).
    fn hunt_lab(&self, rgb: DVec3) -> DVec3 {
        const DELTA: f64 = 6.0 / 29.0;
        let curve = |t: f64| {
            let is_bright = t > DELTA * DELTA * DELTA;
            if is_bright { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
        };
        let xyz = self.xyz_from_rgb * rgb / self.white;
        let [x, y, z] = xyz.to_array().map(curve);
        let lightness = 116.0 * y - 16.0;
        let hunt = 0.01 * lightness;
        DVec3::new(lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z))
    }

    /// That of green and blue, by which differences are scaled.
    fn largest_difference(&self) -> f64 {
        hyab(self.hunt_lab(DVec3::Y), self.hunt_lab(DVec3::Z)).powf(COLOR_EXPONENT)
    }
}

/// One-dimensional kernels, from the middle outwards in both directions: a filter is one along rows
/// and one along columns.
struct Kernels {
    /// Of each channel, the Gaussians of its sensitivity; their weights in two dimensions sum to 1.
    sensitivity: [Vec<Vec<f64>>; 3],
    /// Gaussian, first and second derivative, for features.
    features: [Vec<f64>; 3],
}

impl Kernels {
    fn new(pixels_per_degree: f64) -> Self {
        let widest = SENSITIVITY.iter().flatten().map(|(_, b)| *b).fold(0.0, f64::max);
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i64;
        let sensitivity = SENSITIVITY.map(|gaussians| {
            let used = gaussians.iter().filter(|(a, _)| *a > 0.0);
            let mut kernels: Vec<Vec<f64>> = used
                .map(|&(a, b)| {
                    // The product of two such weights is that of the pixel.
                    let scale = (a * (PI / b).sqrt()).sqrt();
                    let weight = |k: i64| {
                        let degrees = k as f64 / pixels_per_degree;
                        scale * (-(PI * degrees).powi(2) / b).exp()
                    };
                    (-radius..=radius).map(weight).collect()
                })
                .collect();
            let total: f64 = kernels.iter().map(|kernel| kernel.iter().sum::<f64>().powi(2)).sum();
            kernels.iter_mut().flatten().for_each(|weight| *weight /= total.sqrt());
            kernels
        });
        let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = (3.0 * deviation).ceil() as i64;
        let gaussian = |k: i64| (-(k as f64 / deviation).powi(2) / 2.0).exp();
        let of = |weight: &dyn Fn(i64) -> f64| (-radius..=radius).map(weight).collect();
        let first = |k: i64| -(k as f64) * gaussian(k);
        let second = |k: i64| ((k as f64 / deviation).powi(2) - 1.0) * gaussian(k);
        let features = [of(&gaussian), of(&first), of(&second)].map(balanced);
        Self { sensitivity, features }
    }
}

/// The positive weights scaled so that they sum to 1, the negative ones to −1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let sum_of = |is_of: fn(f64) -> bool| -> f64 {
        kernel.iter().copied().filter(|weight| is_of(*weight)).sum()
    };
    let (above, below) = (sum_of(|weight| weight > 0.0), -sum_of(|weight| weight < 0.0));
    let scaled = |&weight: &f64| match weight {
        weight if weight > 0.0 => weight / above,
        weight if weight < 0.0 => weight / below,
        _ => 0.0,
    };
    kernel.iter().map(scaled).collect()
}

/// A picture as YCxCz, channel by channel.
struct Planes {
    width: usize,
    channels: [Vec<f64>; 3],
}

impl Planes {
    fn of(image: &Image, space: &ColorSpace, control: Control) -> Result<Self, Cancelled> {
        let n = image.width * image.height;
        let mut channels = [0; 3].map(|_| Vec::with_capacity(n));
        for (place, pixel) in image.bytes.chunks_exact(image.kind.n_bytes()).enumerate() {
            control.item(place, n)?;
            let linear = |k: usize| space.linear[usize::from(pixel[k])];
            let rgb = match image.kind {
                PixelKind::Gray => DVec3::splat(linear(0)),
                PixelKind::Rgb => DVec3::new(linear(0), linear(1), linear(2)),
            };
            let color = space.ycxcz(rgb).to_array();
            channels.iter_mut().zip(color).for_each(|(channel, value)| channel.push(value));
        }
        Ok(Self { width: image.width, channels })
    }

    /// How strong edges and points are at each pixel.
    fn features(&self, kernels: &Kernels, control: Control) -> Result<Vec<[f64; 2]>, Cancelled> {
        let luminance: Vec<f64> =
            self.channels[0].iter().map(|value| (value + 16.0) / 116.0).collect();
        let [gaussian, first, second] = &kernels.features;
        let filter = |along: &[f64], across: &[f64], from: f64| {
            separable(&luminance, self.width, [along, across], control.part(from, from + 0.25))
        };
        let edges = [filter(first, gaussian, 0.0)?, filter(gaussian, first, 0.25)?];
        let points = [filter(second, gaussian, 0.5)?, filter(gaussian, second, 0.75)?];
        let length = |[x, y]: &[Vec<f64>; 2], at: usize| (x[at] * x[at] + y[at] * y[at]).sqrt();
        let mut features = vec![[0.0; 2]; luminance.len()];
        let width = self.width;
        features.par_chunks_mut(width).enumerate().try_for_each(|(y, row)| {
            control.at(1.0)?;
            for (x, feature) in row.iter_mut().enumerate() {
                *feature = [&edges, &points].map(|kind| length(kind, y * width + x));
            }
            Ok(())
        })?;
        Ok(features)
    }

    /// What the eye sees of the colors, as [`ColorSpace::hunt_lab`].
    fn filtered(
        &self,
        kernels: &Kernels,
        space: &ColorSpace,
        control: Control,
    ) -> Result<Vec<DVec3>, Cancelled> {
        let mut seen = vec![DVec3::ZERO; self.channels[0].len()];
        for (k, (channel, gaussians)) in self.channels.iter().zip(&kernels.sensitivity).enumerate()
        {
            for gaussian in gaussians {
                let part = control.part(k as f64 * 0.3, k as f64 * 0.3 + 0.3);
                let filtered = separable(channel, self.width, [gaussian, gaussian], part)?;
                seen.iter_mut().zip(filtered).for_each(|(seen, value)| seen[k] += value);
            }
        }
        seen.par_chunks_mut(self.width).try_for_each(|row| {
            control.at(1.0)?;
            row.iter_mut().for_each(|color| *color = space.hunt_lab(space.rgb(*color)));
            Ok(())
        })?;
        Ok(seen)
    }
}

/// A picture filtered along its rows and then along its columns, its border pixels repeated.
fn separable(
    values: &[f64],
    width: usize,
    [along, across]: [&[f64]; 2],
    control: Control,
) -> Result<Vec<f64>, Cancelled> {
    let height = values.len() / width;
    let mut rows = vec![0.0; values.len()];
    rows.par_chunks_mut(width).zip(values.par_chunks(width)).try_for_each(|(out, row)| {
        control.at(0.0)?;
        let radius = along.len() / 2;
        for (x, out) in out.iter_mut().enumerate() {
            let at = |k: usize| (x + k).saturating_sub(radius).min(width - 1);
            *out = along.iter().enumerate().map(|(k, weight)| weight * row[at(k)]).sum();
        }
        Ok(())
    })?;
    let mut filtered = vec![0.0; values.len()];
    filtered.par_chunks_mut(width).enumerate().try_for_each(|(y, out)| {
        control.at(0.5)?;
        let radius = across.len() / 2;
        for (k, weight) in across.iter().enumerate() {
            let at = (y + k).saturating_sub(radius).min(height - 1);
            let row = &rows[at * width..(at + 1) * width];
            out.iter_mut().zip(row).for_each(|(out, value)| *out += weight * value);
        }
        Ok(())
    })?;
    Ok(filtered)
}

#[cfg(test)]
#[path = "flip_tests.rs"]
mod tests;
