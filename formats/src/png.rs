//! PNG files.
//!
//! The bytes of a picture depend on nothing but its pixels. Any bytes may be read: they give a
//! picture or an error, within limits of size.

use std::io::{self, Cursor, Write};

use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageError, Limits};
use mve_core::Control;

use mve_mesh::data::{Image, PixelKind};

/// Most pixels in a row, or rows, of a picture that is read.
const MAX_SIDE: u32 = 1 << 15;

/// Most bytes that reading a picture may take; a few kilobytes of file can ask for any number.
const MAX_BYTES: u64 = 1 << 30;

/// Bytes of pixels that are packed between two looks at the control: a few milliseconds.
const PIECE: usize = 1 << 16;

/// Writes a picture as PNG, 8 bits, gray or color.
///
/// # Errors
/// `InvalidInput` for a picture without a pixel or with too many for the format; whatever the
/// writer reports; `Other` when `control` ends it.
pub fn write_png(image: &Image, out: &mut dyn Write, control: Control) -> io::Result<()> {
    let invalid = |message: &str| io::Error::new(io::ErrorKind::InvalidInput, message.to_owned());
    if image.bytes.is_empty() {
        return Err(invalid("the image has no pixel"));
    }
    let (Ok(width), Ok(height)) = (u32::try_from(image.width), u32::try_from(image.height)) else {
        return Err(invalid("the image is too large for a PNG file"));
    };
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_color(match image.kind {
        PixelKind::Gray => png::ColorType::Grayscale,
        PixelKind::Rgb => png::ColorType::Rgb,
    });
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::Adaptive);
    let mut header = encoder.write_header()?;
    let mut stream = header.stream_writer_with_size(PIECE)?;
    let n_pieces = image.bytes.len().div_ceil(PIECE);
    for (place, piece) in image.bytes.chunks(PIECE).enumerate() {
        let cancelled = control.at(place as f64 / n_pieces as f64);
        cancelled.map_err(io::Error::other)?;
        stream.write_all(piece)?;
    }
    stream.finish()?;
    Ok(header.finish()?)
}

/// Reads a PNG file as a picture of this name: gray where the file is, else color. Deeper samples
/// are rounded to 8 bits; transparency is left out.
///
/// # Errors
/// What is wrong with the file, in a sentence.
pub fn read_png(bytes: &[u8], name: &str) -> Result<Image, String> {
    let picture = PngDecoder::with_limits(Cursor::new(bytes), limits())
        .and_then(DynamicImage::from_decoder)
        .map_err(|error| match error {
            ImageError::Limits(_) => {
                format!("it is larger than {MAX_SIDE} × {MAX_SIDE} pixels or takes over 1 GB")
            }
            other => format!("it is not a PNG file that can be read: {other}"),
        })?;
    Ok(eight_bit(picture, name))
}

/// How large a picture may be that is read.
pub(super) fn limits() -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    limits
}

/// A decoded picture, with 8 bits a sample and without transparency.
pub(super) fn eight_bit(picture: DynamicImage, name: &str) -> Image {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let (kind, bytes) = if picture.color().has_color() {
        (PixelKind::Rgb, picture.into_rgb8().into_raw())
    } else {
        (PixelKind::Gray, picture.into_luma8().into_raw())
    };
    Image { name: name.to_owned(), width, height, kind, bytes }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use proptest::prelude::*;

    use super::*;

    fn written(image: &Image) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_png(image, &mut bytes, Control::none()).unwrap();
        bytes
    }

    #[test]
    fn pixels_come_back() {
        for kind in [PixelKind::Gray, PixelKind::Rgb] {
            let mut image = Image::filled("a", [37, 21], kind, 0);
            (0..image.bytes.len()).for_each(|i| image.bytes[i] = (i * i % 251) as u8);
            assert_eq!(read_png(&written(&image), "a"), Ok(image.clone()));
            assert_eq!(written(&image), written(&image));
        }
        let empty = Image::filled("a", [0, 5], PixelKind::Gray, 0);
        let message = write_png(&empty, &mut Vec::new(), Control::none()).unwrap_err().to_string();
        assert!(message.contains("no pixel"), "{message}");
    }

    #[test]
    fn packing_ends_where_it_is_told_to() {
        let image = Image::filled("a", [2000, 1000], PixelKind::Rgb, 7);
        let report = |share: f64| {
            if share < 0.5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let mut bytes = Vec::new();
        let error = write_png(&image, &mut bytes, Control::new(&report)).unwrap_err();
        assert_eq!(error.to_string(), "cancelled");
        assert!(bytes.len() < written(&image).len());
    }

    #[test]
    fn a_bomb_is_refused() {
        let mut bytes = written(&Image::filled("a", [4, 4], PixelKind::Gray, 0));
        // Width and height stand behind the signature and the head of the first chunk.
        bytes[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        assert!(read_png(&bytes, "a").is_err());
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(
            noise in prop::collection::vec(any::<u8>(), 0..200),
            places in prop::collection::vec((0usize..100, any::<u8>()), 0..4),
        ) {
            let _ = read_png(&noise, "noise");
            let mut bytes = written(&Image::filled("a", [9, 5], PixelKind::Rgb, 3));
            for (place, value) in places {
                let n_bytes = bytes.len();
                bytes[place % n_bytes] = value;
            }
            if let Ok(image) = read_png(&bytes, "a") {
                let n_bytes = image.width * image.height * image.kind.n_bytes();
                prop_assert_eq!(image.bytes.len(), n_bytes);
            }
        }
    }
}
