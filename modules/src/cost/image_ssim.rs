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
use super::pictures::{AREAS, LIT, RENEWAL, VIEW, image_options};
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
        VIEW.albedo.spec(),
        LIT.spec(),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::{BoxOptions, subdivided_box};
    use crate::geometry::simplify::collapse::trial::first_prices;
    use crate::image_driven::ImageOptions;
    use crate::placement::Midpoint;

    #[test]
    fn within_a_side_of_a_box_nothing_is_lost() {
        let mesh = subdivided_box(&BoxOptions { segments: 4, ..BoxOptions::DEFAULT });
        let options = ImageOptions { resolution: 48, ..ImageOptions::DEFAULT };
        let mut cost = ImageDriven::new(&mesh, Structure::default(), options);
        let (low, high) = mesh.bounds().unwrap();
        let is_inner = |v: u32| {
            let p = mesh.positions[v as usize];
            (0..3).filter(|&axis| p[axis] == low[axis] || p[axis] == high[axis]).count() == 1
        };
        let prices = first_prices(&mesh, &mut cost, &mut Midpoint);
        let mut inner = prices.iter().filter(|(from, to, _)| is_inner(*from) && is_inner(*to));
        assert!(inner.all(|&(_, _, price)| price == 0.0));
        assert!(prices.iter().any(|&(_, _, price)| price > 0.0));
        assert!((COST.build)(&mesh, &Settings::defaults(COST.params).unwrap()).is_ok());
    }
}
