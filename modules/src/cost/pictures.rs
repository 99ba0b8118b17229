//! The parameters that image-driven costs share: which pictures are taken.

use crate::geometry::simplify::collapse::Renewal;
use crate::image_driven::{Areas, ImageOptions};
use crate::picture::missing::lack_of_colors;
use crate::picture::view::{ViewDefaults, ViewParams};
use crate::prelude::*;

const IMAGE_DEFAULT: ImageOptions = ImageOptions::DEFAULT;

/// From where pictures are taken, and how. Surfaces are shaded flat, or not at all; colors count
/// with their luminance.
pub const VIEW: ViewParams = ViewParams::new(ViewDefaults {
    cameras: "Dodecahedron",
    resolution: IMAGE_DEFAULT.resolution as i64,
    albedo: "White",
    shading: "Flat",
    sides: "Front",
    background: IMAGE_DEFAULT.background as i64,
});

/// Pixels of all cameras together that a cost may keep; one takes about 40 bytes.
const MOST_PIXELS: usize = 1 << 26;

impl Enumeration for Areas {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Active", "Only the pixels that the collapse changes are drawn and compared."),
        (
            "Whole",
            "Whole pictures are drawn and compared: the same prices, some hundred times as slowly.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::Active, Self::Whole];
}

pub const AREAS: Param<Areas> =
    Param::one_of("areas", "How much of a picture a price looks at.", "Active");

pub const LIT: Param<bool> = Param::flag(
    "lit",
    "Whether light falls on the surface, one luminance a face. Off: colors as they are, so that a \
     price is of the outline and of what slides on the surface, not of its shape.",
    IMAGE_DEFAULT.is_lit,
);

impl Enumeration for Renewal {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("AtOnce", "All edges whose faces have changed."),
        (
            "Lazy",
            "Only those at the merged vertex; others wait at a third of their price and are priced \
             again when they come up. Half of the work, and results as good.",
        ),
    ];
    const VALUES: &'static [Self] = &[Self::AtOnce, Self::Lazy];
}

pub const RENEWAL: Param<Renewal> =
    Param::one_of("renewal", "Which edges are priced again after each collapse.", "Lazy");

/// Reads these parameters, for a mesh that must fit pictures.
pub fn image_options(mesh: &TriMesh, settings: &Settings) -> Result<ImageOptions, ModuleError> {
    let cameras = VIEW.read_cameras(settings)?;
    let resolution = settings.get(&VIEW.resolution)? as usize;
    let n_pixels = cameras.len().saturating_mul(resolution * resolution);
    if n_pixels > MOST_PIXELS {
        let message = format!(
            "{} cameras of {resolution} × {resolution} pixels are {n_pixels} pixels; an \
             image-driven cost keeps at most {MOST_PIXELS}: lower it or take fewer cameras",
            cameras.len()
        );
        return Err(ModuleError::param(&VIEW.resolution, message));
    }
    let is_seen =
        mesh.bounds().is_some_and(|bounds| !cameras.around(bounds, &mesh.positions).is_empty());
    if !is_seen && !mesh.faces.is_empty() {
        let message = "no camera can be placed around the mesh: its box has no extent, or one too \
                       large or too small; an image-driven cost needs pictures";
        return Err(ModuleError::Failed(message.to_owned()));
    }
    let albedo = settings.get(&VIEW.albedo)?;
    if let Some(message) = lack_of_colors(&[mesh], albedo) {
        return Err(ModuleError::param(&VIEW.albedo, message));
    }
    Ok(ImageOptions {
        cameras,
        resolution,
        albedo,
        is_lit: settings.get(&LIT)?,
        sides: settings.get(&VIEW.sides)?,
        background: settings.get(&VIEW.background)? as u8,
        areas: settings.get(&AREAS)?,
        renewal: settings.get(&RENEWAL)?,
    })
}
