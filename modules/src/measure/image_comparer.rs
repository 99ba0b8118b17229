//! Measures how pictures differ from others: pictures that were loaded as well as rendered ones.
//!
//! The numbers are those of the metrics ImageRms, ImageSsim and Flip on the same pictures; see
//! [`crate::picture::difference`] and [`crate::picture::flip`].

use mve_mesh::data::{Image, Measure, PixelKind, TableColumn};

use crate::picture::difference::{
    Similarity, absolute_difference, in_color, similarity, sum_of_squares,
};
use crate::picture::flip::{FlipError, PIXELS_PER_DEGREE, flip, flip_colors};
use crate::picture::render::to_byte;
use crate::picture::ssim::SsimError;
use crate::prelude::*;

const REFERENCE_IN: In<Images> = In::new(
    "reference",
    "The pictures to measure against: one for all, or as many as there are to measure.",
);
const IMAGES_IN: In<Images> = In::new("images", "The pictures to measure, of the same sizes.");

/// What the pictures of the differences show.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shown {
    Absolute,
    Ssim,
    Flip,
    FlipColors,
}

impl Enumeration for Shown {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Absolute", "The absolute difference of each channel, as it is."),
        ("Ssim", "The structural similarity in gray: white where they are equal."),
        ("Flip", "FLIP in gray: black where one sees no difference."),
        ("FlipColors", "FLIP in the colors of Magma, from black over purple to pale yellow."),
    ];
    const VALUES: &'static [Self] = &[Self::Absolute, Self::Ssim, Self::Flip, Self::FlipColors];
}

const DIFFERENCE: Param<Shown> =
    Param::one_of("difference", "What the pictures of the differences show.", "FlipColors");
const DISTANCE: Param<f64> = Param::number(
    "pixels_per_degree",
    "How finely the pictures are seen, for FLIP: pixels in one degree of sight. 67 is a screen of \
     3,840 pixels in 0.7 m, seen from 0.7 m.",
    PIXELS_PER_DEGREE,
)
.within((1.0, 1000.0))
.usually((20.0, 150.0));

const RMS: Quantity = Quantity::new(
    "rms",
    "Root mean square of the differences of all pixels, and of red, green and blue in color.",
)
.titled("RMS of pictures")
.in_unit(Unit::Fixed("of 255"))
.lower()
.chief();
const PSNR: Quantity = Quantity::new(
    "psnr",
    "Peak signal to noise ratio, 20 log10(255 / rms); infinite for equal pictures.",
)
.titled("PSNR of pictures")
.in_unit(Unit::Fixed("dB"))
.higher();
const SSIM: Quantity = Quantity::new(
    "ssim",
    "Mean structural similarity, of each picture over the pixels whose window lies inside; 1 is \
     equal.",
)
.titled("SSIM of pictures")
.higher()
.chief();
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
const FLIP: Quantity = Quantity::new(
    "flip",
    "Mean of how much of a difference one sees where one is flipped to the other; 0 is equal.",
)
.titled("FLIP of pictures")
.lower()
.chief();
const FLIP_MAX: Quantity = Quantity::new("flip_max", "The largest value of any pixel.")
    .titled("Largest FLIP of pictures")
    .lower();

const MEASURES_OUT: Out<Measures> = Out::new("measures", "How all pictures differ together.")
    .giving(mve_core::Quantities::Row(&[RMS, PSNR, SSIM, SSIM_WHOLE, SSIM_RGB, FLIP, FLIP_MAX]));
const TABLE_OUT: Out<Table> = Out::new("table", "How each picture differs, a row a picture.");
const DIFFERENCES_OUT: Out<Images> =
    Out::new("differences", "How each picture differs, pixel by pixel.");

pub static MODULE: Module = Module {
    id: "ImageComparer",
    summary: "Measures how pictures differ from others: RMS, PSNR, SSIM and FLIP.",
    inputs: &[REFERENCE_IN.spec(), IMAGES_IN.spec()],
    outputs: &[MEASURES_OUT.spec(), TABLE_OUT.spec(), DIFFERENCES_OUT.spec()],
    params: &[DIFFERENCE.spec(), DISTANCE.spec()],
    run,
};

/// What was found of one pair of pictures.
struct Found {
    squares: u64,
    n_values: usize,
    similarity: Similarity,
    flip_mean: f64,
    flip_max: f64,
    shown: Image,
}

impl Found {
    fn rms(&self) -> f64 {
        (self.squares as f64 / self.n_values as f64).sqrt()
    }
}

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (references, images) = (io.get(REFERENCE_IN)?, io.get(IMAGES_IN)?);
    let (n_references, n) = (references.0.len(), images.0.len());
    if n == 0 || (n_references != 1 && n_references != n) {
        return Err(ModuleError::input(
            &IMAGES_IN,
            format!(
                "there are {n} pictures to measure against {n_references}; one reference for all of \
                 at least one picture is expected, or one for each"
            ),
        ));
    }
    let shown = io.param(DIFFERENCE)?;
    let pixels_per_degree = io.param(DISTANCE)?;
    let largest = images.0.iter().map(|image| image.width * image.height).max().unwrap_or(0);
    io.reserve(256 * largest + images.0.iter().map(|image| image.bytes.len()).sum::<usize>())?;
    let mut found = Vec::with_capacity(n);
    for (place, image) in images.0.iter().enumerate() {
        let reference = &references.0[if n_references == 1 { 0 } else { place }];
        let part = io.control().part(place as f64 / n as f64, (place + 1) as f64 / n as f64);
        let one =
            compare(reference, image, (shown, pixels_per_degree), part).map_err(
                |error| match error {
                    FlipError::Cancelled(cancelled) => cancelled.into(),
                    other => ModuleError::input(&IMAGES_IN, format!("picture {place}: {other}")),
                },
            )?;
        found.push(one);
    }
    let n_small = found.iter().filter(|one| one.similarity.interior.is_nan()).count();
    if n_small > 0 {
        io.warn(format!(
            "{n_small} pictures are smaller than the 11 × 11 pixels of a window of SSIM; ssim is \
             not defined, ssim_whole is"
        ));
    }
    io.put(MEASURES_OUT, measures(&found));
    io.put(TABLE_OUT, table(&images, &found));
    io.put(DIFFERENCES_OUT, Images(found.into_iter().map(|one| one.shown).collect()));
    Ok(())
}

fn compare(
    reference: &Image,
    image: &Image,
    (shown, pixels_per_degree): (Shown, f64),
    control: mve_core::Control,
) -> Result<Found, FlipError> {
    // It looks at the sizes, too.
    let values = flip(reference, image, pixels_per_degree, control.part(0.0, 0.8))?;
    // Where one is gray and the other is not, both are compared in color.
    let is_gray = reference.kind == PixelKind::Gray && image.kind == PixelKind::Gray;
    let colored = (!is_gray).then(|| (in_color(reference), in_color(image)));
    let (a, b) = colored.as_ref().map_or((reference, image), |(a, b)| (a.as_ref(), b.as_ref()));
    let similarity = similarity(a, b, control.part(0.8, 1.0)).map_err(|error| match error {
        SsimError::Cancelled(cancelled) => FlipError::Cancelled(cancelled),
        _ => FlipError::Sizes(a.width, a.height, b.width, b.height),
    })?;
    let difference = absolute_difference(a, b);
    let (squares, n_values) = (sum_of_squares(&difference), difference.bytes.len());
    let flip_mean = values.iter().sum::<f64>() / values.len() as f64;
    let flip_max = values.iter().copied().fold(0.0, f64::max);
    let map = |kind, bytes| Image { name: String::new(), kind, bytes, ..*a };
    let mut shown = match shown {
        Shown::Absolute => difference,
        Shown::Ssim => similarity.map.clone(),
        Shown::Flip => map(PixelKind::Gray, values.into_iter().map(to_byte).collect()),
        Shown::FlipColors => map(PixelKind::Rgb, flip_colors(&values, control.part(1.0, 1.0))?),
    };
    shown.name.clone_from(&image.name);
    Ok(Found { squares, n_values, similarity, flip_mean, flip_max, shown })
}

fn psnr(rms: f64) -> f64 {
    20.0 * (255.0 / rms).log10()
}

fn measures(found: &[Found]) -> Measures {
    let n = found.len() as f64;
    let mean = |value: fn(&Found) -> f64| found.iter().map(value).sum::<f64>() / n;
    let squares: u64 = found.iter().map(|one| one.squares).sum();
    let n_values: usize = found.iter().map(|one| one.n_values).sum();
    let rms = (squares as f64 / n_values as f64).sqrt();
    let mut measures = vec![
        Measure::of(&RMS, rms),
        Measure::of(&PSNR, psnr(rms)),
        Measure::of(&SSIM, mean(|one| one.similarity.interior)),
        Measure::of(&SSIM_WHOLE, mean(|one| one.similarity.whole)),
    ];
    if found.iter().all(|one| one.similarity.of_channels.is_some()) {
        let of_channels = mean(|one| one.similarity.of_channels.unwrap_or(f64::NAN));
        measures.push(Measure::of(&SSIM_RGB, of_channels));
    }
    measures.push(Measure::of(&FLIP, mean(|one| one.flip_mean)));
    let largest = found.iter().map(|one| one.flip_max).fold(0.0, f64::max);
    measures.push(Measure::of(&FLIP_MAX, largest));
    Measures(measures)
}

fn table(images: &Images, found: &[Found]) -> Table {
    let column = |quantity: &Quantity, value: fn(&Found) -> f64| {
        TableColumn::of(quantity, found.iter().map(value).collect())
    };
    let names = images.0.iter().map(|image| image.name.clone()).collect();
    Table {
        columns: vec![
            TableColumn::texts("picture", names),
            column(&RMS, Found::rms),
            column(&PSNR, |one| psnr(one.rms())),
            column(&SSIM, |one| one.similarity.interior),
            column(&SSIM_WHOLE, |one| one.similarity.whole),
            column(&FLIP, |one| one.flip_mean),
            column(&FLIP_MAX, |one| one.flip_max),
        ],
    }
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_mesh::data::{ColumnValues, Image, PixelKind};
    use mve_mesh::fixtures::torus;

    use crate::metric::{ImageRmsMetric, ImageSsimMetric, Metric};
    use crate::picture::render::{Albedo, CameraSet, Shading, Sides};
    use crate::picture::view::View;
    use crate::prelude::*;

    fn trial(reference: Images, images: Images) -> Trial {
        Trial::of(&super::MODULE).input("reference", reference).input("images", images)
    }

    fn gray(value: u8) -> Image {
        Image::filled("gray", [20, 16], PixelKind::Gray, value)
    }

    #[test]
    fn flat_pictures_by_hand() {
        let color = Image::filled("color", [20, 16], PixelKind::Rgb, 100);
        let outputs = trial(Images(vec![gray(90)]), Images(vec![gray(90), color])).run().unwrap();
        let measures = outputs["measures"].get::<Measures>().unwrap();
        let of = |name: &str| {
            let measure = measures.0.iter().find(|measure| measure.name == name);
            measure.map(|measure| measure.value)
        };
        // The first has 320 values that do not differ, the second 960 that differ by 10.
        assert!((of("rms").unwrap() - 75.0_f64.sqrt()).abs() < 1e-12);
        let second = (2.0 * 9000.0 + 6.5025) / (8100.0 + 10_000.0 + 6.5025);
        assert!((of("ssim").unwrap() - (1.0 + second) / 2.0).abs() < 1e-12);
        assert_eq!(of("ssim_rgb"), None);
        let table = outputs["table"].get::<Table>().unwrap();
        assert_eq!(table.column("rms").unwrap().values, ColumnValues::Numbers(vec![0.0, 10.0]));
        let psnr = &table.column("psnr").unwrap().values;
        let ColumnValues::Numbers(psnr) = psnr else { panic!("numbers") };
        assert!(psnr[0].is_infinite() && (psnr[1] - 20.0 * 25.5_f64.log10()).abs() < 1e-12);
        let differences = outputs["differences"].get::<Images>().unwrap();
        assert_eq!(differences.0[1].name, "color");
        // The first color of Magma.
        assert_eq!(differences.0[0].pixel(3, 3), [0, 0, 4]);
    }

    /// The same pictures give the numbers of the metrics that took them.
    #[test]
    fn numbers_are_those_of_the_metrics() {
        let view = View {
            cameras: CameraSet::Rhombicuboctahedron,
            size: 48,
            albedo: Albedo::White,
            shading: Shading::Flat,
            sides: Sides::Both,
            background: 0,
        };
        let (fine, coarse) = (torus(2.0, 0.5, 24), torus(2.0, 0.5, 8));
        let none = mve_core::Control::none();
        let rms = ImageRmsMetric { view }.compare(&fine, &coarse, none).unwrap();
        let ssim = ImageSsimMetric { view }.compare(&fine, &coarse, none).unwrap();
        let trial = trial(rms.original_images.clone(), rms.simplified_images.clone());
        let outputs = trial.set("difference", "Absolute").run().unwrap();
        assert_eq!(*outputs["differences"].get::<Images>().unwrap(), rms.difference_images);
        for measure in &outputs["measures"].get::<Measures>().unwrap().0 {
            let known = rms.scalar(&measure.name).or_else(|| ssim.scalar(&measure.name));
            if let Some(known) = known {
                assert!((measure.value - known).abs() < 1e-12, "{}", measure.name);
            }
        }
    }

    #[test]
    fn what_does_not_go_together_is_said() {
        let message = |reference: Vec<Image>, images: Vec<Image>| {
            trial(Images(reference), Images(images)).run().unwrap_err().to_string()
        };
        let found = message(vec![gray(1); 2], vec![gray(1); 3]);
        assert!(found.contains("3 pictures to measure against 2"), "{found}");
        assert!(message(Vec::new(), Vec::new()).contains("0 pictures"));
        let small = Image::filled("small", [4, 4], PixelKind::Gray, 1);
        let found = message(vec![gray(1)], vec![gray(1), small]);
        assert!(found.contains("picture 1: pictures of 20 × 16 and 4 × 4 pixels"), "{found}");
    }
}
