//! How pictures of the two meshes differ: the root mean square of their values.
//!
//! P. Lindstrom and G. Turk, "Image-driven simplification", ACM Transactions on Graphics 19(3),
//! 2000, section 6: white surfaces, a light at the camera, 24 cameras at the vertices of a
//! rhombicuboctahedron around the original, which are none of those that their simplification looks
//! from, and 512² pixels.
//!
//! Faces are lit by their own normals (`Flat`), so that the value depends on the two surfaces alone
//! and not on how normals are averaged, and both sides are drawn, so that open surfaces are not
//! invisible for half of the cameras.
//!
//! Surfaces are white unless `albedo` says otherwise. Pictures in color differ by their red, green
//! and blue display values (as in an sRGB file), and the mean is over these as over pixels, so that
//! gray pictures have the value that they have in color; the paper compares luminance.

use mve_core::{Control, Entry};
use mve_mesh::data::{Images, Measure};

use super::pictures::{VIEW, take_pair};
use super::{Comparison, MakeMetric, Metric, MetricError};
use crate::picture::difference::{absolute_difference, sum_of_squares};
use crate::picture::view::View;
use crate::prelude::*;

const RMS: Quantity = Quantity::new(
    "rms",
    "Root mean square over all pixels and cameras, and over red, green and blue in color.",
)
.titled("RMS of pictures")
.in_unit(LUMINANCE)
.lower()
.chief();
const PSNR: Quantity = Quantity::new(
    "psnr",
    "Peak signal to noise ratio, 20 log10(255 / rms); infinite for equal pictures.",
)
.titled("PSNR of pictures")
.in_unit(Unit::Fixed("dB"))
.higher();
const RMS_OF_CAMERA: Quantity =
    Quantity::new("rms_#", "Root mean square over the pixels of camera #.")
        .titled("RMS of the picture from camera #")
        .in_unit(LUMINANCE)
        .lower();

/// Unit of luminance.
const LUMINANCE: Unit = Unit::Fixed("of 255");

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "ImageRms",
    summary: "Root mean square difference of pictures from all around, of luminance or of colors, 0 \
              to 255.",
    params: &VIEW.specs(),
    build: MakeMetric {
        quantities: &[RMS, PSNR, RMS_OF_CAMERA],
        make: |settings| Ok(Box::new(ImageRmsMetric { view: VIEW.read(settings)? })),
    },
};

/// The metric with its view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageRmsMetric {
    /// How pictures are taken.
    pub view: View,
}

impl Metric for ImageRmsMetric {
    fn bytes(&self, original: &TriMesh, simplified: &TriMesh) -> usize {
        self.view.bytes_of_comparison(original, simplified)
    }

    /// `difference_images` holds |original − simplified| at each pixel as it is, not scaled, so
    /// that the measures can be computed from it.
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let (pair, warnings) = take_pair(&self.view, original, simplified, control)?;
        let mut differences = Vec::with_capacity(pair.original.0.len());
        let mut errors = Vec::with_capacity(pair.original.0.len());
        for (a, b) in pair.original.0.iter().zip(&pair.simplified.0) {
            control.at(1.0)?;
            let difference = absolute_difference(a, b);
            errors.push(sum_of_squares(&difference));
            differences.push(difference);
        }
        // Of one picture: pixels, or three times as many in color.
        let n_values = pair.original.0.first().map_or(1, |image| image.bytes.len()) as f64;
        let rms = (errors.iter().sum::<u64>() as f64 / (n_values * errors.len() as f64)).sqrt();
        let mut scalars =
            vec![Measure::of(&RMS, rms), Measure::of(&PSNR, 20.0 * (255.0 / rms).log10())];
        scalars.extend(errors.iter().enumerate().map(|(camera, &error)| {
            Measure::nth(&RMS_OF_CAMERA, camera, (error as f64 / n_values).sqrt())
        }));
        Ok(Comparison {
            scalars,
            original_images: pair.original,
            simplified_images: pair.simplified,
            difference_images: Images(differences),
            warnings,
            ..Comparison::default()
        })
    }
}

#[cfg(test)]
#[path = "image_rms_tests.rs"]
mod tests;
