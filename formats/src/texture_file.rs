//! Pictures that materials name: PNG and JPEG files, whatever their names end in.
//!
//! Any bytes may be read: they give a picture or an error, within the limits of PNG files.

use std::io::Cursor;

use image::{ImageError, ImageReader};
use mve_mesh::data::Image;

use super::png::{eight_bit, limits};

/// Reads a PNG or JPEG file: gray where the file is, else color. Deeper samples are rounded to 8
/// bits; transparency is left out.
///
/// # Errors
/// What is wrong with the file, as the end of a sentence that begins with its name.
pub fn read_texture(bytes: &[u8]) -> Result<Image, String> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let mut reader = reader.map_err(|error| format!("cannot be read: {error}"))?;
    reader.limits(limits());
    let picture = reader.decode().map_err(|error| match error {
        ImageError::Limits(_) => "is too large".to_owned(),
        ImageError::Unsupported(_) => "is neither a PNG nor a JPEG file".to_owned(),
        error => format!("is no picture that can be read: {error}"),
    })?;
    // Its file is no part of what a picture shows, so it has no name of its own.
    Ok(eight_bit(picture, "texture"))
}

#[cfg(test)]
mod tests {
    use image::{ExtendedColorType, ImageFormat, codecs::jpeg::JpegEncoder};
    use mve_mesh::data::PixelKind;
    use proptest::prelude::*;

    use super::*;

    fn jpeg(color: ExtendedColorType, pixel: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let pixels = pixel.repeat(16 * 8);
        JpegEncoder::new_with_quality(&mut bytes, 95).encode(&pixels, 16, 8, color).unwrap();
        bytes
    }

    fn png(pixel: [u8; 4]) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let picture = image::RgbaImage::from_pixel(3, 2, image::Rgba(pixel));
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn both_formats_are_read_without_transparency() {
        let image = read_texture(&png([10, 20, 30, 40])).unwrap();
        assert_eq!((image.width, image.height, image.kind), (3, 2, PixelKind::Rgb));
        assert_eq!(image.pixel(2, 1), [10, 20, 30]);
        let image = read_texture(&jpeg(ExtendedColorType::L8, &[77])).unwrap();
        assert_eq!((image.kind, image.pixel(15, 7)), (PixelKind::Gray, &[77][..]));
        let image = read_texture(&jpeg(ExtendedColorType::Rgb8, &[250, 5, 5])).unwrap();
        let [r, g, b] = image.pixel(0, 0) else { panic!("three bytes") };
        assert!(r.abs_diff(250) < 4 && *g < 9 && *b < 9, "{r} {g} {b}");
    }

    #[test]
    fn what_is_no_picture_is_said() {
        let message = |bytes: &[u8]| read_texture(bytes).unwrap_err();
        assert_eq!(message(b"no picture"), "is neither a PNG nor a JPEG file");
        assert_eq!(message(b"GIF89a\x01\0\x01\0"), "is neither a PNG nor a JPEG file");
        let png = png([1, 2, 3, 255]);
        assert!(message(&png[..20]).starts_with("is no picture that can be read"));
        let mut bomb = png;
        bomb[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        assert!(read_texture(&bomb).is_err());
        let mut bomb = jpeg(ExtendedColorType::L8, &[77]);
        // Height and width stand behind the length and the depth of the frame's head.
        let frame = bomb.windows(2).position(|word| word == [0xff, 0xc0]).unwrap();
        bomb[frame + 5..frame + 9].copy_from_slice(&[0xff; 4]);
        assert_eq!(message(&bomb), "is too large");
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(
            noise in prop::collection::vec(any::<u8>(), 0..200),
            places in prop::collection::vec((0usize..1000, any::<u8>()), 0..4),
            n_kept in 0usize..1000,
        ) {
            let _ = read_texture(&noise);
            for mut bytes in [png([9, 8, 7, 6]), jpeg(ExtendedColorType::Rgb8, &[9, 8, 7])] {
                bytes.truncate(n_kept.max(4));
                for &(place, value) in &places {
                    let n_bytes = bytes.len();
                    bytes[place % n_bytes] = value;
                }
                if let Ok(image) = read_texture(&bytes) {
                    prop_assert!(image.is_whole());
                }
            }
        }
    }
}
