//! How similar pictures of the two meshes are: SSIM.
//!
//! See [`crate::picture::ssim`] for the index, and [`crate::metric::ImageRmsMetric`] for how
//! pictures are taken and why. Pictures in color are compared by luminance, as Wang et al. do:
//! the bytes of red, green and blue weighted as in ITU-R BT.601, rounded to a byte. Where hues
//! differ and luminance does not, that sees nothing, so such pictures are compared by channel, too
//! (`channel_axis` of scikit-image, `skimage.metrics.structural_similarity`).

use mve_core::{Control, Entry};
use rayon::prelude::*;

use super::pictures::{VIEW, take_pair};
use super::{Comparison, MakeMetric, Metric, MetricError};
use crate::data::{Image, Images, Measure, PixelKind};
use crate::picture::render::{luma, to_byte};
use crate::picture::ssim::{Ssim, SsimError, ssim};
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

/// What is kept of a camera: the map as a picture, and the means.
struct Index {
    map: Image,
    interior: f64,
    whole: f64,
    /// The mean over the channels, of pictures in color.
    of_channels: Option<f64>,
}

impl Metric for ImageSsimMetric {
    fn bytes(&self, original: &TriMesh, simplified: &TriMesh) -> usize {
        // The map is a third set of pictures. What is made of two pictures on each thread: the map
        // in full, twice in color, and a channel of each.
        const BYTES_A_PIXEL: usize = 24;
        let of_thread = self.view.size * self.view.size * BYTES_A_PIXEL;
        self.view.bytes_of_pair(original, simplified) * 3 / 2
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
        let found: Result<Vec<Index>, MetricError> = both
            .map(|(a, b)| {
                let index = compare(a, b, &control.part(0.5, 0.5))?;
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

fn compare(a: &Image, b: &Image, control: &Control) -> Result<Index, MetricError> {
    let size = [a.width, a.height];
    let index = |a: &[u8], b: &[u8]| {
        ssim(a, b, size, *control).map_err(|error| match error {
            SsimError::Cancelled(cancelled) => cancelled.into(),
            other => MetricError::Failed(other.to_string()),
        })
    };
    // Pictures have at least 16 pixels a side, so there is an interior.
    let inside = |found: &Ssim| found.interior.unwrap_or(f64::NAN);
    let found = index(&luma(a), &luma(b))?;
    let of_channels = match a.kind {
        PixelKind::Gray => None,
        PixelKind::Rgb => {
            let channel = |image: &Image, k: usize| -> Vec<u8> {
                image.bytes.chunks_exact(3).map(|pixel| pixel[k]).collect()
            };
            let of_channel = |k| Ok(inside(&index(&channel(a, k), &channel(b, k))?));
            let [red, green, blue]: [Result<f64, MetricError>; 3] = [0, 1, 2].map(of_channel);
            Some((red? + green? + blue?) / 3.0)
        }
    };
    let (interior, whole) = (inside(&found), found.whole);
    let bytes = found.map.into_iter().map(to_byte).collect();
    let map = Image { bytes, kind: PixelKind::Gray, name: a.name.clone(), ..*a };
    Ok(Index { map, interior, whole, of_channels })
}

fn scalars(found: &[Index]) -> Vec<Measure> {
    let mean = |value: fn(&Index) -> f64| found.iter().map(value).sum::<f64>() / found.len() as f64;
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

    use super::*;
    use crate::data::LayerValues;
    use crate::mesh::fixtures::torus;
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
        let found = compare(&a, &b, &Control::none()).unwrap();
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
        let found = compare(&red, &green, &Control::none()).unwrap();
        assert_eq!(found.interior, 1.0);
        // Without variance only the means count: 6.5025 / (100² + 6.5025), 6.5025 / (51² + 6.5025)
        // and 1.
        let expected = (6.5025 / 10_006.502_5 + 6.5025 / 2_607.502_5 + 1.0) / 3.0;
        assert!((found.of_channels.unwrap() - expected).abs() < 1e-9);
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
