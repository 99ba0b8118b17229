//! Pictures as the window and the GPU take them: four bytes a pixel, no larger than a texture.

use eframe::egui;
use mve_modules::data::{Image, PixelKind};

/// The size of a picture, made smaller by whole factors until no side is longer than `most`.
pub fn fitting_size(image: &Image, most: usize) -> [usize; 2] {
    let factor = image.width.max(image.height).div_ceil(most.max(1)).max(1);
    [image.width.div_ceil(factor).max(1), image.height.div_ceil(factor).max(1)]
}

/// Red, green and blue of a pixel; black outside of the picture or where it has no bytes.
pub fn rgb_at(image: &Image, x: usize, y: usize) -> [u8; 3] {
    let n = image.kind.n_bytes();
    let is_inside = x < image.width && y < image.height;
    let at = (y * image.width + x) * n;
    match image.bytes.get(at..at + n).filter(|_| is_inside) {
        Some([gray]) => [*gray; 3],
        Some([r, g, b]) => [*r, *g, *b],
        _ => [0; 3],
    }
}

/// The picture in another size with full opacity, each pixel the nearest one.
pub fn rgba(image: &Image, [width, height]: [usize; 2]) -> Vec<u8> {
    let mut pixels = Vec::with_capacity(4 * width * height);
    for y in 0..height {
        let from_y = y * image.height / height;
        for x in 0..width {
            let [r, g, b] = rgb_at(image, x * image.width / width, from_y);
            pixels.extend([r, g, b, 255]);
        }
    }
    pixels
}

/// The picture as the window takes it.
pub fn color_image(image: &Image, most: usize) -> egui::ColorImage {
    let size = fitting_size(image, most);
    egui::ColorImage::from_rgba_unmultiplied(size, &rgba(image, size))
}

/// What two pictures differ by, as a picture: absolute differences times a gain, at most 255.
///
/// # Errors
/// When they are of different sizes; the message names both.
pub fn difference(a: &Image, b: &Image, gain: f32) -> Result<Image, String> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(format!(
            "pictures of {} × {} and {} × {} have no difference",
            a.width, a.height, b.width, b.height
        ));
    }
    let both_gray = a.kind == PixelKind::Gray && b.kind == PixelKind::Gray;
    let kind = if both_gray { PixelKind::Gray } else { PixelKind::Rgb };
    let gained = |a: u8, b: u8| (f32::from(a.abs_diff(b)) * gain).round() as u8;
    let mut bytes = Vec::with_capacity(a.width * a.height * kind.n_bytes());
    for y in 0..a.height {
        for x in 0..a.width {
            let (a, b) = (rgb_at(a, x, y), rgb_at(b, x, y));
            let parts = [0, 1, 2].map(|k| gained(a[k], b[k]));
            bytes.extend(&parts[..kind.n_bytes()]);
        }
    }
    let name = format!("difference of {} and {}", a.name, b.name);
    Ok(Image { name, width: a.width, height: a.height, kind, bytes })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: usize, height: usize, kind: PixelKind, bytes: &[u8]) -> Image {
        Image { name: "a".to_owned(), width, height, kind, bytes: bytes.to_vec() }
    }

    #[test]
    fn a_difference_is_absolute_and_gained() {
        let a = image(2, 1, PixelKind::Gray, &[10, 200]);
        let b = image(2, 1, PixelKind::Gray, &[13, 100]);
        let found = difference(&a, &b, 4.0).unwrap();
        assert_eq!((found.kind, found.bytes), (PixelKind::Gray, vec![12, 255]));
        let c = image(2, 1, PixelKind::Rgb, &[10, 11, 9, 200, 200, 201]);
        let found = difference(&a, &c, 1.0).unwrap();
        assert_eq!((found.kind, found.bytes), (PixelKind::Rgb, vec![0, 1, 1, 0, 0, 1]));
        let d = image(1, 2, PixelKind::Gray, &[0, 0]);
        assert!(difference(&a, &d, 1.0).unwrap_err().contains("2 × 1 and 1 × 2"));
    }

    #[test]
    fn pictures_larger_than_a_texture_become_smaller() {
        let wide = Image::filled("wide", [5000, 3], PixelKind::Gray, 9);
        let size = fitting_size(&wide, 2048);
        assert_eq!(size, [1667, 1]);
        assert_eq!(color_image(&wide, 2048).size, size);
        assert_eq!(fitting_size(&Image::filled("none", [0, 0], PixelKind::Rgb, 0), 64), [1, 1]);
        let none = image(0, 0, PixelKind::Rgb, &[]);
        assert_eq!(rgba(&none, [1, 1]), [0, 0, 0, 255]);
    }

    #[test]
    fn pixels_outside_are_black() {
        let a = image(2, 1, PixelKind::Rgb, &[1, 2, 3, 4, 5, 6]);
        assert_eq!(rgb_at(&a, 1, 0), [4, 5, 6]);
        assert_eq!(rgb_at(&a, 2, 0), [0; 3]);
        assert_eq!(rgb_at(&image(9, 9, PixelKind::Rgb, &[1]), 3, 3), [0; 3]);
    }
}
