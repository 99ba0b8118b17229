//! Text in pictures, in one bitmap font.
//!
//! The font is the 8 × 13 pixel one of the crate embedded-graphics, which has the letters of
//! western Europe (ISO 8859-1); others become question marks.

use std::convert::Infallible;

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::iso_8859_1::FONT_8X13;
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::text::{Baseline, Text};
use mve_mesh::data::{Image, PixelKind};

use crate::picture::render::luma_of;

/// The font's measures in pixels.
pub struct Font;

impl Font {
    /// From the top of a line to the top of the next.
    pub const HEIGHT: usize = 13;

    /// Width of a text in one line.
    pub fn width_of(text: &str) -> usize {
        8 * text.chars().count()
    }
}

/// Draws a text with its upper left corner at `[x, y]`, in a color that is turned into its
/// luminance for a gray picture. What does not fit into the picture is cut off; what ends a line
/// becomes a blank.
pub fn draw_text(image: &mut Image, text: &str, [x, y]: [usize; 2], [r, g, b]: [u8; 3]) {
    // Beyond this nothing could be seen, and the coordinates of the crate end.
    const FAR: usize = 1 << 24;
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let style = MonoTextStyle::new(&FONT_8X13, Rgb888::new(r, g, b));
    let at = Point::new(x.min(FAR) as i32, y.min(FAR) as i32);
    let Ok(_) = Text::with_baseline(&line, at, style, Baseline::Top).draw(&mut Canvas(image));
}

/// A picture to draw on.
struct Canvas<'i>(&'i mut Image);

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.0.width as u32, self.0.height as u32)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        let image = &mut *self.0;
        for Pixel(at, color) in pixels {
            let (Ok(x), Ok(y)) = (usize::try_from(at.x), usize::try_from(at.y)) else { continue };
            if x >= image.width || y >= image.height {
                continue;
            }
            let place = y * image.width + x;
            let [r, g, b] = [color.r(), color.g(), color.b()];
            match image.kind {
                PixelKind::Gray => image.bytes[place] = luma_of([r, g, b]),
                PixelKind::Rgb => image.bytes[3 * place..3 * place + 3].copy_from_slice(&[r, g, b]),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_letter_is_drawn_where_it_belongs_and_cut_at_the_border() {
        let mut image = Image::filled("a", [20, 20], PixelKind::Gray, 255);
        draw_text(&mut image, "I", [4, 3], [0; 3]);
        let black: Vec<_> =
            (0..400).filter(|i| image.bytes[*i] == 0).map(|i| (i % 20, i / 20)).collect();
        assert!(black.len() > 10);
        assert!(black.iter().all(|&(x, y)| (4..12).contains(&x) && (3..16).contains(&y)));
        draw_text(&mut image, "far away \u{1F600}\n", [15, 15], [0; 3]);
        draw_text(&mut image, "nowhere", [usize::MAX, usize::MAX], [0; 3]);
        let mut empty = Image::filled("a", [0, 0], PixelKind::Rgb, 0);
        draw_text(&mut empty, "nothing", [0, 0], [9; 3]);
    }
}
