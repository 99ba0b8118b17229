//! The parameters that image-driven costs share: which pictures are taken.

use crate::geometry::image_driven::{Areas, PictureOptions};
use crate::geometry::render::{CameraSet, Sides};
use crate::prelude::*;

const DEFAULT: PictureOptions = PictureOptions::DEFAULT;

/// Names of the camera sets; Fibonacci takes its number from [`N_CAMERAS`].
#[derive(Clone, Copy, PartialEq)]
pub enum Cameras {
    Dodecahedron,
    Rhombicuboctahedron,
    Fibonacci,
}

impl Enumeration for Cameras {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Dodecahedron", "20 cameras, at the vertices of a dodecahedron."),
        ("Rhombicuboctahedron", "24 cameras, at the vertices of a rhombicuboctahedron."),
        ("Fibonacci", "As many as `n_cameras`, spread evenly."),
    ];
    const VALUES: &'static [Self] =
        &[Self::Dodecahedron, Self::Rhombicuboctahedron, Self::Fibonacci];
}

impl Enumeration for Sides {
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("Front", "Back faces are culled."), ("Both", "Both sides of a face are drawn.")];
    const VALUES: &'static [Self] = &[Self::Front, Self::Both];
}

impl Enumeration for Areas {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Active", "Only the pixels that the collapse changes are drawn and compared."),
        ("Whole", "Whole pictures are drawn and compared: the same prices, slowly."),
    ];
    const VALUES: &'static [Self] = &[Self::Active, Self::Whole];
}

pub const CAMERAS: Param<Cameras> =
    Param::one_of("cameras", "From where pictures are taken.", "Dodecahedron");
pub const N_CAMERAS: Param<i64> =
    Param::integer("n_cameras", "How many cameras, for the set Fibonacci.", 20)
        .between((1, 1000))
        .mostly((6, 100));
pub const RESOLUTION: Param<i64> =
    Param::integer("resolution", "Rows and columns of a picture.", DEFAULT.resolution as i64)
        .between((16, 1024))
        .mostly((64, 512))
        .unit("pixels");
pub const SIDES: Param<Sides> = Param::one_of("sides", "Which sides of a face are drawn.", "Front");
pub const BACKGROUND: Param<i64> =
    Param::integer("background", "Luminance where no face is.", DEFAULT.background as i64)
        .between((0, 255));
pub const AREAS: Param<Areas> =
    Param::one_of("areas", "How much of a picture a price looks at.", "Active");

/// Reads these parameters.
pub fn picture_options(settings: &Settings) -> Result<PictureOptions, ModuleError> {
    let cameras = match settings.get(&CAMERAS)? {
        Cameras::Dodecahedron => CameraSet::Dodecahedron,
        Cameras::Rhombicuboctahedron => CameraSet::Rhombicuboctahedron,
        Cameras::Fibonacci => CameraSet::Fibonacci(settings.get(&N_CAMERAS)? as usize),
    };
    Ok(PictureOptions {
        cameras,
        resolution: settings.get(&RESOLUTION)? as usize,
        sides: settings.get(&SIDES)?,
        background: settings.get(&BACKGROUND)? as u8,
        areas: settings.get(&AREAS)?,
    })
}
