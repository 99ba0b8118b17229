//! How different pictures of the two meshes look where they are flipped on a screen: ꟻLIP.
//!
//! See [`crate::picture::flip`] for the source, and [`crate::metric::ImageRmsMetric`] for how
//! pictures are taken and why.

use mve_core::{Control, Entry};
use mve_mesh::data::{Image, Images, Measure, PixelKind};

use super::pictures::{VIEW, take_pair};
use super::{Comparison, MakeMetric, Metric, MetricError};
use crate::picture::flip::{FlipError, PIXELS_PER_DEGREE, flip};
use crate::picture::render::to_byte;
use crate::picture::view::View;
use crate::prelude::*;

const FLIP: Quantity = Quantity::new(
    "flip",
    "Mean over all pixels and cameras of how much of a difference one sees; 0 is equal, 1 the most.",
)
.titled("FLIP of pictures")
.lower()
.chief();
const FLIP_MAX: Quantity = Quantity::new("flip_max", "The largest value of any pixel.")
    .titled("Largest FLIP of pictures")
    .lower();
const FLIP_OF_CAMERA: Quantity = Quantity::new("flip_#", "The mean of camera #.")
    .titled("FLIP of the picture from camera #")
    .lower();

const DISTANCE: Param<f64> = Param::number(
    "pixels_per_degree",
    "How finely the pictures are seen: pixels in one degree of sight. 67 is a screen of 3,840 \
     pixels in 0.7 m, seen from 0.7 m.",
    PIXELS_PER_DEGREE,
)
.within((1.0, 1000.0))
.usually((20.0, 150.0));

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "Flip",
    summary: "How different pictures from all around look where one is flipped to the other \
              (Andersson et al. 2020): 0 where they are equal.",
    params: &[
        VIEW.cameras.spec(),
        VIEW.resolution.spec(),
        VIEW.albedo.spec(),
        VIEW.shading.spec(),
        VIEW.sides.spec(),
        VIEW.background.spec(),
        DISTANCE.spec(),
    ],
    build: MakeMetric {
        quantities: &[FLIP, FLIP_MAX, FLIP_OF_CAMERA],
        make: |settings| {
            let (view, pixels_per_degree) = (VIEW.read(settings)?, settings.get(&DISTANCE)?);
            Ok(Box::new(FlipMetric { view, pixels_per_degree }))
        },
    },
};

/// The metric with its view.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FlipMetric {
    /// How pictures are taken.
    view: View,
    /// How finely they are seen.
    pixels_per_degree: f64,
}

impl Metric for FlipMetric {
    fn bytes(&self, original: &TriMesh, simplified: &TriMesh) -> usize {
        // Of one pair of pictures at a time: channels, filtered ones, features and colors.
        const BYTES_A_PIXEL: usize = 256;
        self.view.bytes_of_comparison(original, simplified)
            + self.view.size * self.view.size * BYTES_A_PIXEL
    }

    /// `difference_images` holds the value at each pixel times 255.
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let (view, before) = (&self.view, control.part(0.0, 0.3));
        let (pair, warnings) = take_pair(view, original, simplified, before)?;
        let n = pair.original.0.len();
        let (mut means, mut largest, mut maps) = (Vec::with_capacity(n), 0.0_f64, Vec::new());
        for (camera, (a, b)) in pair.original.0.iter().zip(&pair.simplified.0).enumerate() {
            let share = |camera: usize| 0.3 + 0.7 * camera as f64 / n as f64;
            let part = control.part(share(camera), share(camera + 1));
            let values = flip(a, b, self.pixels_per_degree, part).map_err(of_metric)?;
            means.push(values.iter().sum::<f64>() / values.len() as f64);
            largest = values.iter().copied().fold(largest, f64::max);
            let (kind, bytes) = (PixelKind::Gray, values.into_iter().map(to_byte).collect());
            maps.push(Image { name: a.name.clone(), kind, bytes, ..*a });
        }
        let mean = means.iter().sum::<f64>() / n as f64;
        let mut scalars = vec![Measure::of(&FLIP, mean), Measure::of(&FLIP_MAX, largest)];
        let of_cameras = means.iter().enumerate();
        scalars.extend(of_cameras.map(|(k, &mean)| Measure::nth(&FLIP_OF_CAMERA, k, mean)));
        Ok(Comparison {
            scalars,
            original_images: pair.original,
            simplified_images: pair.simplified,
            difference_images: Images(maps),
            warnings,
            ..Comparison::default()
        })
    }
}

fn of_metric(error: FlipError) -> MetricError {
    match error {
        FlipError::Cancelled(cancelled) => cancelled.into(),
        other => MetricError::Failed(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::torus;

    use super::*;
    use crate::metric::pictures::tests::{check_contract, small};

    const METRIC: fn() -> FlipMetric =
        || FlipMetric { view: small(), pixels_per_degree: PIXELS_PER_DEGREE };

    #[test]
    fn equal_meshes_are_0_and_the_value_is_the_mean_of_the_cameras() {
        let mesh = torus(2.0, 0.5, 16);
        let found = METRIC().compare(&mesh, &mesh, Control::none()).unwrap();
        assert_eq!((found.scalar("flip"), found.scalar("flip_max")), (Some(0.0), Some(0.0)));
        assert_eq!(found.scalars.len(), 2 + 24);
        let found = METRIC().compare(&mesh, &torus(2.0, 0.5, 7), Control::none()).unwrap();
        let cameras: f64 = found.scalars.iter().skip(2).map(|measure| measure.value).sum();
        let mean = found.scalar("flip").unwrap();
        assert!((mean - cameras / 24.0).abs() < 1e-12 && (0.01..0.9).contains(&mean), "{mean}");
        // The pictures hold the same values, rounded to bytes.
        let bytes = found.difference_images.0.iter().flat_map(|image| &image.bytes);
        let of_bytes = bytes.map(|&byte| f64::from(byte)).sum::<f64>() / (24.0 * 48.0 * 48.0);
        assert!((of_bytes / 255.0 - mean).abs() < 0.5 / 255.0);
    }

    #[test]
    fn it_stands_any_mesh_and_any_number_of_threads() {
        check_contract(&METRIC());
    }
}
