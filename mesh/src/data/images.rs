//! Pictures: 8-bit gray or color, one or a whole set.

use glam::DVec3;
use mve_core::{Data, DataType};
use serde::{Deserialize, Serialize};

use super::TriMesh;

/// What a pixel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PixelKind {
    /// One byte, the luminance.
    Gray,
    /// Three bytes: red, green, blue.
    Rgb,
}

impl PixelKind {
    /// Bytes of a pixel.
    #[inline]
    pub fn n_bytes(self) -> usize {
        match self {
            Self::Gray => 1,
            Self::Rgb => 3,
        }
    }
}

/// A picture. Bytes are display values (as in an sRGB file), 0 black and 255 full.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// What it shows, for captions: `camera 3`.
    pub name: String,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// What a pixel holds.
    pub kind: PixelKind,
    /// [`PixelKind::n_bytes`] × width × height, the top row first, each from left to right.
    pub bytes: Vec<u8>,
}

impl Image {
    /// A picture of one value everywhere.
    pub fn filled(name: &str, [width, height]: [usize; 2], kind: PixelKind, value: u8) -> Self {
        let bytes = vec![value; width * height * kind.n_bytes()];
        Self { name: name.to_owned(), width, height, kind, bytes }
    }

    /// The picture at one `n`th of its size: each pixel is the average of `n` × `n`, rounded to
    /// the nearest. Columns and rows that do not fill a pixel are left out.
    pub fn averaged(&self, n: usize) -> Self {
        let n = n.max(1);
        let (width, height) = (self.width / n, self.height / n);
        let n_bytes = self.kind.n_bytes();
        let mut bytes = Vec::with_capacity(width * height * n_bytes);
        let mut sums = vec![0_u32; width * n_bytes];
        for y in 0..height {
            sums.fill(0);
            for row in y * n..(y + 1) * n {
                let row = &self.bytes[row * self.width * n_bytes..][..width * n * n_bytes];
                for (x, pixel) in row.chunks_exact(n_bytes).enumerate() {
                    let sum = &mut sums[x / n * n_bytes..][..n_bytes];
                    sum.iter_mut().zip(pixel).for_each(|(sum, byte)| *sum += u32::from(*byte));
                }
            }
            let n_samples = (n * n) as u32;
            bytes.extend(sums.iter().map(|sum| ((sum + n_samples / 2) / n_samples) as u8));
        }
        Self { name: self.name.clone(), width, height, kind: self.kind, bytes }
    }

    /// Whether there are as many bytes as the size asks for.
    pub fn is_whole(&self) -> bool {
        let n_pixels = self.width.checked_mul(self.height);
        n_pixels.and_then(|n| n.checked_mul(self.kind.n_bytes())) == Some(self.bytes.len())
    }

    /// The bytes of the pixel in column `x` of row `y`.
    ///
    /// # Panics
    /// Outside of the picture.
    #[inline]
    pub fn pixel(&self, x: usize, y: usize) -> &[u8] {
        let n = self.kind.n_bytes();
        let at = (y * self.width + x) * n;
        &self.bytes[at..at + n]
    }
}

/// A display color in bytes; what is not a number is 0.
#[inline]
pub fn bytes_of(color: DVec3) -> [u8; 3] {
    color.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8)
}

/// Pictures in an order; one picture is a set of one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Images(pub Vec<Image>);

impl Data for Images {
    const TYPE: DataType = DataType {
        id: "Images",
        doc: "One or more pictures, 8-bit gray or color.",
        color: [200, 110, 160],
    };

    fn byte_size(&self) -> usize {
        let of_image = |image: &Image| size_of::<Image>() + image.name.len() + image.bytes.len();
        size_of::<Self>() + self.0.iter().map(of_image).sum::<usize>()
    }

    fn summary(&self) -> String {
        match self.0.as_slice() {
            [] => "no image".to_owned(),
            [one] => format!("{} × {}, {}", one.width, one.height, one.name),
            [first, ..] => {
                format!("{} images, the first {} × {}", self.0.len(), first.width, first.height)
            }
        }
    }

    fn check(&self) -> Result<(), String> {
        match self.0.iter().find(|image| !image.is_whole()) {
            None => Ok(()),
            Some(image) => Err(format!(
                "image \"{}\" is {} × {} but has {} bytes",
                image.name,
                image.width,
                image.height,
                image.bytes.len()
            )),
        }
    }
}

/// A picture of one color, larger for meshes of more faces.
pub(super) fn sample(mesh: &TriMesh) -> Images {
    let side = mesh.faces.len() % 16 + 1;
    Images(vec![Image::filled("a", [side, side], PixelKind::Rgb, 99)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_with_missing_bytes_is_named() {
        let mut images = Images(vec![Image::filled("camera 0", [4, 3], PixelKind::Rgb, 7)]);
        assert_eq!(images.check(), Ok(()));
        assert_eq!(images.0[0].pixel(3, 2), [7, 7, 7]);
        images.0[0].bytes.pop();
        let message = images.check().unwrap_err();
        assert_eq!(message, "image \"camera 0\" is 4 × 3 but has 35 bytes");
    }
}
