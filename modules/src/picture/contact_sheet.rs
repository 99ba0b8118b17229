//! Many pictures on one sheet.

use mve_mesh::data::{Image, Images, PixelKind};
use thiserror::Error;

use super::text::{Font, draw_text};

/// Most pixels of a sheet.
pub const MAX_PIXELS: usize = 1 << 28;

/// Space between pictures and around them, in pixels.
const GAP: usize = 8;

/// How a sheet is laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SheetOptions {
    /// Pictures in a row; `None` for as many as make the sheet about square.
    pub columns: Option<usize>,
    /// Whether the name of each picture stands below it.
    pub has_captions: bool,
}

/// Why there is no sheet.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SheetError {
    /// There is nothing to show.
    #[error("there is no image with a pixel in it")]
    Empty,
    /// The sheet would be too large.
    #[error(
        "{n_images} images of up to {width} × {height} pixels make a sheet of more than the \
         {MAX_PIXELS} pixels that are allowed"
    )]
    TooLarge {
        /// How many pictures.
        n_images: usize,
        /// Width of the widest.
        width: usize,
        /// Height of the highest.
        height: usize,
    },
}

/// Puts pictures on a white sheet, row by row in their order, each in the middle of a cell that
/// would hold the largest.
///
/// The sheet is gray where all pictures are, else in color. A caption that is too long for its
/// cell is cut.
///
/// # Errors
/// See [`SheetError`]; a sheet that is too large is refused before it is made.
pub fn contact_sheet(images: &Images, options: SheetOptions) -> Result<Image, SheetError> {
    let images = images.0.as_slice();
    let width = images.iter().map(|image| image.width).max().unwrap_or(0);
    let height = images.iter().map(|image| image.height).max().unwrap_or(0);
    if width == 0 || height == 0 {
        return Err(SheetError::Empty);
    }
    let caption = if options.has_captions { Font::HEIGHT + GAP / 2 } else { 0 };
    let cell = [width.saturating_add(GAP), height.saturating_add(GAP + caption)];
    let square = (images.len() as f64 * cell[1] as f64 / cell[0] as f64).sqrt().round();
    let columns = options.columns.unwrap_or(square as usize).clamp(1, images.len());
    let rows = images.len().div_ceil(columns);
    let side = |n: usize, size: usize| n.checked_mul(size)?.checked_add(GAP);
    let sides = side(columns, cell[0]).zip(side(rows, cell[1]));
    let fits = |(w, h): &(usize, usize)| w.checked_mul(*h).is_some_and(|n| n <= MAX_PIXELS);
    let Some((sheet_width, sheet_height)) = sides.filter(fits) else {
        return Err(SheetError::TooLarge { n_images: images.len(), width, height });
    };
    let is_gray = images.iter().all(|image| image.kind == PixelKind::Gray);
    let kind = if is_gray { PixelKind::Gray } else { PixelKind::Rgb };
    let mut sheet = Image::filled("contact sheet", [sheet_width, sheet_height], kind, 255);
    for (place, image) in images.iter().enumerate() {
        let left = GAP + place % columns * cell[0];
        let top = GAP + place / columns * cell[1];
        let middle = [(width - image.width) / 2, (height - image.height) / 2];
        paste(&mut sheet, image, [left + middle[0], top + middle[1]]);
        if options.has_captions {
            let name: String = image.name.chars().take(cell[0] / Font::width_of("x")).collect();
            draw_text(&mut sheet, &name, [left, top + height + GAP / 4], [0; 3]);
        }
    }
    Ok(sheet)
}

/// Copies a picture into a larger one of the same kind or in color.
fn paste(sheet: &mut Image, image: &Image, [left, top]: [usize; 2]) {
    let n = sheet.kind.n_bytes();
    for y in 0..image.height {
        let start = n * ((top + y) * sheet.width + left);
        let to = &mut sheet.bytes[start..start + n * image.width];
        let n_from = image.kind.n_bytes();
        let from = &image.bytes[n_from * y * image.width..][..n_from * image.width];
        if n == n_from {
            to.copy_from_slice(from);
        } else {
            to.chunks_exact_mut(n).zip(from).for_each(|(pixel, gray)| pixel.fill(*gray));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(size: [usize; 2], kind: PixelKind, value: u8) -> Image {
        Image::filled("camera 12", size, kind, value)
    }

    #[test]
    fn pictures_lie_in_rows_with_space_around_them() {
        let images = [10, 20, 30, 40, 50].map(|v| filled([32, 16], PixelKind::Gray, v));
        let options = SheetOptions { columns: Some(3), has_captions: false };
        let sheet = contact_sheet(&Images(images.to_vec()), options).unwrap();
        assert_eq!((sheet.width, sheet.height), (3 * 40 + 8, 2 * 24 + 8));
        assert_eq!(sheet.kind, PixelKind::Gray);
        assert_eq!([sheet.pixel(8, 8), sheet.pixel(8 + 40 + 31, 8 + 15)], [[10], [20]]);
        assert_eq!([sheet.pixel(8 + 40, 8 + 24), sheet.pixel(8 + 80, 8 + 24)], [[50], [255]]);
        assert_eq!([sheet.pixel(7, 8), sheet.pixel(8 + 32, 8)], [[255], [255]]);
    }

    #[test]
    fn gray_becomes_color_beside_color_and_small_ones_are_centered() {
        let images = vec![filled([4, 4], PixelKind::Gray, 9), filled([10, 6], PixelKind::Rgb, 77)];
        let options = SheetOptions { columns: None, has_captions: true };
        let sheet = contact_sheet(&Images(images), options).unwrap();
        assert_eq!(sheet.kind, PixelKind::Rgb);
        assert_eq!(sheet.pixel(8 + 3, 8 + 1), [9, 9, 9]);
        assert_eq!(sheet.pixel(8 + 2, 8 + 1), [255; 3]);
        assert!(sheet.bytes.contains(&0), "captions are black");
    }

    #[test]
    fn nothing_and_too_much_are_refused() {
        let none = SheetOptions::default();
        assert_eq!(contact_sheet(&Images(Vec::new()), none), Err(SheetError::Empty));
        let flat = Images(vec![filled([0, 3], PixelKind::Gray, 0)]);
        assert_eq!(contact_sheet(&flat, none), Err(SheetError::Empty));
        let strips =
            [filled([30_000, 1], PixelKind::Gray, 0), filled([1, 30_000], PixelKind::Gray, 0)];
        let message = contact_sheet(&Images(strips.to_vec()), none).unwrap_err().to_string();
        assert!(message.contains("2 images of up to 30000 × 30000"), "{message}");
    }
}
