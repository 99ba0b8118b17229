//! Luminance of faces: 8-bit values under a light at the camera.
//!
//! A face is white and perfectly matt (Lambert): its luminance is the cosine between its normal and
//! the light's rays, 0 to 1, times 255, rounded to the nearest whole number. A back face, where it
//! is drawn, is lit as if it were turned. Colors become luminance by the NTSC weights. Values are
//! not gamma-corrected: a byte is what a screen is given, as in the first experiments of this kind.

use std::borrow::Cow;

use glam::DVec3;
use mve_mesh::data::{Image, PixelKind};

use super::raster::FaceSide;

/// Thousandths of red, green and blue in the luminance (NTSC, 1953; ITU-R BT.601).
const NTSC_THOUSANDTHS: [u32; 3] = [299, 587, 114];
/// The parts of red, green and blue in the luminance.
const NTSC: DVec3 = DVec3::new(
    NTSC_THOUSANDTHS[0] as f64 / 1000.0,
    NTSC_THOUSANDTHS[1] as f64 / 1000.0,
    NTSC_THOUSANDTHS[2] as f64 / 1000.0,
);

/// The unit normal of a triangle, counter-clockwise from its front; zero where it has none.
#[inline]
pub fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let across = (b - a).cross(c - a);
    let length = across.length();
    if length > 0.0 && length.is_finite() { across / length } else { DVec3::ZERO }
}

/// The cosine between this unit normal, on this side of its surface, and the way back to the light,
/// which shines along `forward`.
#[inline]
pub fn cosine(normal: DVec3, forward: DVec3, side: FaceSide) -> f64 {
    let along = normal.dot(forward);
    if side == FaceSide::Front { -along } else { along }
}

/// The luminance of a surface with this unit normal, seen from this side along `forward`.
#[inline]
pub fn luminance(normal: DVec3, forward: DVec3, side: FaceSide) -> u8 {
    to_byte(cosine(normal, forward, side))
}

/// A value from 0 to 1 as a byte; others are clamped, and what is not a number is 0.
#[inline]
pub fn to_byte(value: f64) -> u8 {
    // Cutting off the fraction of a positive number after adding a half rounds it.
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// The luminance of a color in this light, both 0 to 1.
#[inline]
pub fn gray(light: f64, color: DVec3) -> u8 {
    to_byte(light * NTSC.dot(color))
}

/// The luminance of a display color, rounded.
pub fn luma_of([r, g, b]: [u8; 3]) -> u8 {
    let [red, green, blue] = NTSC_THOUSANDTHS;
    let sum = red * u32::from(r) + green * u32::from(g) + blue * u32::from(b);
    ((sum + 500) / 1000) as u8
}

/// The luminance of each pixel, from the bytes of its color.
pub fn luma(image: &Image) -> Cow<'_, [u8]> {
    match image.kind {
        PixelKind::Gray => Cow::Borrowed(&image.bytes),
        PixelKind::Rgb => {
            let (pixels, _) = image.bytes.as_chunks();
            Cow::Owned(pixels.iter().map(|&pixel| luma_of(pixel)).collect())
        }
    }
}
