//! The loss of structural similarity between pictures of the mesh and of the original.
//!
//! The price is the growth of the mean over cameras of 1 − SSIM (Z. Wang, A. C. Bovik, H. R. Sheikh
//! and E. P. Simoncelli, "Image quality assessment: from error visibility to structural
//! similarity", IEEE Transactions on Image Processing 13(4), 2004), 0 to 2, with the SSIM of a
//! picture the mean over the pixels whose window lies in it. The growth orders collapses as 1 −
//! SSIM after the collapse does, and stays comparable while other collapses change the pictures
//! elsewhere. See [`image_driven`](crate::image_driven) for how pictures are drawn.

use mve_core::Entry;

use super::MakeCost;
use super::pictures::{AREAS, RENEWAL, VIEW, image_options};
use crate::image_driven::{ImageDriven, Structure};
use crate::prelude::*;

const MARGIN: Param<i64> = Param::integer(
    "margin",
    "How far around changed pixels windows are compared again. From 5, half of a window, prices \
     are exact; less is faster.",
    Structure::EXACT_MARGIN as i64,
)
.between((0, 64))
.mostly((0, 5))
.unit("pixels");

pub static COST: Entry<MakeCost> = Entry {
    id: "ImageSsim",
    summary: "What the collapse changes in pictures from all around: the loss of structural \
              similarity (Wang et al. 2004).",
    params: &[
        VIEW.cameras.spec(),
        VIEW.resolution.spec(),
        VIEW.sides.spec(),
        VIEW.background.spec(),
        AREAS.spec(),
        RENEWAL.spec(),
        MARGIN.spec(),
    ],
    build: |mesh, settings| {
        let difference = Structure { margin: settings.get(&MARGIN)? as i32 };
        Ok(Box::new(ImageDriven::new(mesh, difference, image_options(mesh, settings)?)))
    },
};
