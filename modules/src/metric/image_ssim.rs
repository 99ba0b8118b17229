//! How similar pictures of the two meshes are: SSIM.
//!
//! See [`crate::picture::ssim`] for the index, and [`crate::metric::ImageRmsMetric`] for how
//! pictures are taken and why. [`crate::picture::difference`] says how pictures in color are
//! compared.

use mve_core::{Control, Entry};
use mve_mesh::data::{Images, Measure};
use rayon::prelude::*;

use super::pictures::{VIEW, take_pair};
use super::{Comparison, MakeMetric, Metric, MetricError};
use crate::picture::difference::{Similarity, similarity};
use crate::picture::ssim::SsimError;
use crate::picture::view::View;
use crate::prelude::*;

const SSIM: Quantity = Quantity::new(
    "ssim",
    "Mean over the cameras, each over the pixels whose window lies inside; 1 is equal.",
)
.titled("SSIM of pictures")
.higher()
.chief();
const DISSIMILARITY: Quantity = Quantity::new("dissimilarity", "1 less ssim: 0 is equal.")
    .titled("1 − SSIM of pictures")
    .lower();
const SSIM_WHOLE: Quantity = Quantity::new(
    "ssim_whole",
    "As ssim, over all pixels, the pictures mirrored at their borders.",
)
.titled("SSIM of whole pictures")
.higher();
const SSIM_RGB: Quantity = Quantity::new(
    "ssim_rgb",
    "As ssim, the mean of the indices of red, green and blue; of pictures in color alone.",
)
.titled("SSIM of red, green and blue")
.higher();
const SSIM_OF_CAMERA: Quantity = Quantity::new("ssim_#", "The index of camera #.")
    .titled("SSIM of the picture from camera #")
    .higher();

pub static METRIC: Entry<MakeMetric> = Entry {
    id: "ImageSsim",
    summary: "Structural similarity of pictures from all around: 1 where they are equal.",
    params: &VIEW.specs(),
    build: MakeMetric {
        quantities: &[SSIM, DISSIMILARITY, SSIM_WHOLE, SSIM_RGB, SSIM_OF_CAMERA],
        make: |settings| Ok(Box::new(ImageSsimMetric { view: VIEW.read(settings)? })),
    },
};

/// The metric with its view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageSsimMetric {
    /// How pictures are taken.
    pub view: View,
}

impl Metric for ImageSsimMetric {
    fn bytes(&self, original: &TriMesh, simplified: &TriMesh) -> usize {
        // Of two pictures, on each thread: the map in full, twice in color, and a channel of each;
        // of these 24 bytes a pixel 16 are there from drawing.
        const BYTES_A_PIXEL: usize = 8;
        let of_thread = self.view.size * self.view.size * BYTES_A_PIXEL;
        self.view.bytes_of_comparison(original, simplified)
            + rayon::current_num_threads() * of_thread
    }

    /// `difference_images` holds the index at each pixel: 255 where it is 1, 0 where it is 0 or
    /// less.
    fn compare(
        &self,
        original: &TriMesh,
        simplified: &TriMesh,
        control: Control,
    ) -> Result<Comparison, MetricError> {
        let (view, before) = (&self.view, control.part(0.0, 0.5));
        let (pair, warnings) = take_pair(view, original, simplified, before)?;
        let steps = control.part(0.5, 1.0).steps(pair.original.0.len());
        let both = pair.original.0.par_iter().zip(&pair.simplified.0);
        let found: Result<Vec<Similarity>, MetricError> = both
            .map(|(a, b)| {
                let index = similarity(a, b, control.part(0.5, 0.5)).map_err(of_metric)?;
                steps.step()?;
                Ok(index)
            })
            .collect();
        let found = found?;
        Ok(Comparison {
            scalars: scalars(&found),
            original_images: pair.original,
            simplified_images: pair.simplified,
            difference_images: Images(found.into_iter().map(|index| index.map).collect()),
            warnings,
            ..Comparison::default()
        })
    }
}

fn of_metric(error: SsimError) -> MetricError {
    match error {
        SsimError::Cancelled(cancelled) => cancelled.into(),
        other => MetricError::Failed(other.to_string()),
    }
}

fn scalars(found: &[Similarity]) -> Vec<Measure> {
    let mean =
        |value: fn(&Similarity) -> f64| found.iter().map(value).sum::<f64>() / found.len() as f64;
    let index = mean(|index| index.interior);
    let mut scalars = vec![
        Measure::of(&SSIM, index),
        Measure::of(&DISSIMILARITY, 1.0 - index),
        Measure::of(&SSIM_WHOLE, mean(|index| index.whole)),
    ];
    if found.iter().all(|index| index.of_channels.is_some()) {
        let of_channels = mean(|index| index.of_channels.unwrap_or(f64::NAN));
        scalars.push(Measure::of(&SSIM_RGB, of_channels));
    }
    let of_cameras = found.iter().enumerate();
    scalars.extend(
        of_cameras.map(|(camera, index)| Measure::nth(&SSIM_OF_CAMERA, camera, index.interior)),
    );
    scalars
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use mve_mesh::data::LayerValues;
    use mve_mesh::fixtures::torus;

    use super::*;
    use crate::metric::pictures::tests::{check_contract, small};
    use crate::picture::render::Albedo;

    #[test]
    fn equal_meshes_are_1_and_the_map_is_white() {
        let metric = ImageSsimMetric { view: small() };
        let mesh = torus(2.0, 0.5, 16);
        let found = metric.compare(&mesh, &mesh, Control::none()).unwrap();
        assert_eq!(found.scalar("ssim"), Some(1.0));
        assert_eq!(found.scalar("dissimilarity"), Some(0.0));
        assert_eq!(found.scalars.len(), 3 + 24);
        let maps = &found.difference_images.0;
        assert!(maps.iter().flat_map(|map| &map.bytes).all(|&byte| byte == 255));
    }

    #[test]
    fn colors_of_a_surface_count_if_they_are_asked_for() {
        let mesh = torus(2.0, 0.5, 16);
        let mut red = mesh.clone();
        let (values, index) = (LayerValues::Vec3(vec![DVec3::X]), vec![0; red.positions.len()]);
        red.set_layer(Layer {
            name: Layer::COLOR.to_owned(),
            domain: Domain::Vertex,
            values,
            index,
        });
        let of = |albedo| {
            let metric = ImageSsimMetric { view: View { albedo, ..small() } };
            metric.compare(&mesh, &red, Control::none()).unwrap()
        };
        let white = of(Albedo::White);
        assert_eq!((white.scalar("ssim"), white.scalar("ssim_rgb")), (Some(1.0), None));
        let colored = of(Albedo::Colors);
        assert!(colored.scalar("ssim").unwrap() < 0.9, "{:?}", colored.scalars[0]);
        assert!(colored.scalar("ssim_rgb").unwrap() < 0.9);
        assert_eq!(colored.scalars.len(), 4 + 24);
    }

    #[test]
    fn the_index_is_the_mean_of_the_cameras() {
        let metric = ImageSsimMetric { view: small() };
        let (fine, coarse) = (torus(2.0, 0.5, 32), torus(2.0, 0.5, 9));
        let found = metric.compare(&fine, &coarse, Control::none()).unwrap();
        let cameras = found.scalars.iter().skip(3).map(|measure| measure.value);
        let mean = cameras.sum::<f64>() / 24.0;
        assert!((found.scalar("ssim").unwrap() - mean).abs() < 1e-12);
        assert!((0.2..0.95).contains(&mean), "{mean}");
    }

    #[test]
    fn it_stands_any_mesh_and_any_number_of_threads() {
        check_contract(&ImageSsimMetric { view: small() });
    }
}
