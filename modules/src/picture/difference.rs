//! How two pictures of one size differ: pixel by pixel, and in structure.
//!
//! Pictures in color differ by their red, green and blue display values. Their structure (SSIM, see
//! [`super::ssim`]) is compared by luminance, as Wang et al. do: the bytes of red, green and blue
//! weighted as in ITU-R BT.601, rounded to a byte. Where hues differ and luminance does not, that
//! sees nothing, so such pictures are compared by channel, too (`channel_axis` of scikit-image,
//! `skimage.metrics.structural_similarity`).

use std::borrow::Cow;

use mve_core::Control;
use mve_mesh::data::{Image, PixelKind};

use super::render::{luma, to_byte};
use super::ssim::{Ssim, SsimError, ssim};

/// How alike two pictures are in structure; 1 is equal.
#[derive(Clone, Debug, PartialEq)]
pub struct Similarity {
    /// The index at each pixel: 255 where it is 1, 0 where it is 0 or less.
    pub map: Image,
    /// The mean over the pixels whose window lies inside; not a number where none does.
    pub interior: f64,
    /// The mean over all pixels, the pictures mirrored at their borders.
    pub whole: f64,
    /// The mean of the channels' means over the interior, of pictures in color.
    pub of_channels: Option<f64>,
}

/// Compares the structure of two pictures of one size and kind.
///
/// # Errors
/// As [`ssim`].
pub fn similarity(a: &Image, b: &Image, control: Control) -> Result<Similarity, SsimError> {
    let size = [a.width, a.height];
    let index = |a: &[u8], b: &[u8]| ssim(a, b, size, control);
    let inside = |found: &Ssim| found.interior.unwrap_or(f64::NAN);
    let found = index(&luma(a), &luma(b))?;
    let of_channels = match a.kind {
        PixelKind::Gray => None,
        PixelKind::Rgb => {
            let channel = |image: &Image, k: usize| -> Vec<u8> {
                image.bytes.chunks_exact(3).map(|pixel| pixel[k]).collect()
            };
            let of_channel = |k| Ok(inside(&index(&channel(a, k), &channel(b, k))?));
            let [red, green, blue]: [Result<f64, SsimError>; 3] = [0, 1, 2].map(of_channel);
            Some((red? + green? + blue?) / 3.0)
        }
    };
    let (interior, whole) = (inside(&found), found.whole);
    let bytes = found.map.into_iter().map(to_byte).collect();
    let map = Image { bytes, kind: PixelKind::Gray, name: a.name.clone(), ..*a };
    Ok(Similarity { map, interior, whole, of_channels })
}

/// |a − b| at each pixel, channel by channel, of two pictures of one size and kind.
pub fn absolute_difference(a: &Image, b: &Image) -> Image {
    let bytes = a.bytes.iter().zip(&b.bytes).map(|(a, b)| a.abs_diff(*b)).collect();
    Image { bytes, ..a.clone() }
}

/// The sum of the squares of all bytes.
pub fn sum_of_squares(image: &Image) -> u64 {
    image.bytes.iter().map(|&byte| u64::from(byte) * u64::from(byte)).sum()
}

/// The picture in color; gray ones have three equal channels.
pub fn in_color(image: &Image) -> Cow<'_, Image> {
    match image.kind {
        PixelKind::Rgb => Cow::Borrowed(image),
        PixelKind::Gray => {
            let bytes = image.bytes.iter().flat_map(|&byte| [byte; 3]).collect();
            Cow::Owned(Image { bytes, kind: PixelKind::Rgb, name: image.name.clone(), ..*image })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of 32 by 24 pixels, by column and row.
    fn color(pixel: impl Fn(u32, u32) -> [u32; 3]) -> Image {
        let of_pixel = |k: u32| pixel(k % 32, k / 32).map(|value| (value % 256) as u8);
        let bytes = (0..32 * 24).flat_map(of_pixel).collect();
        Image { name: "a".to_owned(), width: 32, height: 24, kind: PixelKind::Rgb, bytes }
    }

    #[test]
    fn pictures_in_color_have_the_indices_of_scikit_image() {
        let a = color(|x, y| [x * 7 + y * 3, x * y, 200 - 5 * y]);
        let b = color(|x, y| [x * 7 + y * 3 + x / 8 * 9, x * y + 13, 190 - 5 * y + x]);
        let found = similarity(&a, &b, Control::none()).unwrap();
        // scikit-image 0.26.0: structural_similarity(a, b, gaussian_weights=True, sigma=1.5,
        // use_sample_covariance=False, data_range=255), of (299 r + 587 g + 114 b + 500) // 1000,
        // the mean of its full map, and with channel_axis=2.
        assert!((found.interior - 0.800_768_647_650_929_6).abs() < 1e-12, "{}", found.interior);
        assert!((found.whole - 0.792_933_811_900_994_7).abs() < 1e-12, "{}", found.whole);
        let of_channels = found.of_channels.unwrap();
        assert!((of_channels - 0.879_495_689_271_128_4).abs() < 1e-12, "{of_channels}");
        assert_eq!((found.map.kind, found.map.bytes.len()), (PixelKind::Gray, 32 * 24));
    }

    #[test]
    fn hues_of_one_luminance_differ_by_channel_alone() {
        // 299 · 100 is 587 · 51 but for 37 thousandths: both are 30.
        let (red, green) = (color(|_, _| [100, 0, 0]), color(|_, _| [0, 51, 0]));
        let found = similarity(&red, &green, Control::none()).unwrap();
        assert_eq!(found.interior, 1.0);
        // Without variance only the means count: 6.5025 / (100² + 6.5025), 6.5025 / (51² + 6.5025)
        // and 1.
        let expected = (6.5025 / 10_006.502_5 + 6.5025 / 2_607.502_5 + 1.0) / 3.0;
        assert!((found.of_channels.unwrap() - expected).abs() < 1e-9);
    }

    #[test]
    fn a_gray_picture_in_color_has_the_luminance_that_it_had() {
        let gray =
            Image { kind: PixelKind::Gray, bytes: (0..=255).collect(), ..color(|_, _| [0; 3]) };
        let gray = Image { width: 16, height: 16, ..gray };
        assert_eq!(luma(&in_color(&gray)), luma(&gray));
        assert_eq!(sum_of_squares(&absolute_difference(&gray, &gray)), 0);
    }
}
