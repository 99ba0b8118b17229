//! The growth of the squared luminance difference between pictures of the mesh and of the original.
//!
//! P. Lindstrom and G. Turk, "Image-driven simplification", ACM Transactions on Graphics 19(3),
//! 2000. The price of the collapse that makes mesh k + 1 of mesh k is the sum over cameras and
//! pixels of (y₀ − yₖ₊₁)² − (y₀ − yₖ)², in squared 8-bit luminances: a whole number, negative where
//! the collapse brings the pictures nearer to those of the original. See
//! [`image_driven`](crate::geometry::image_driven) for how pictures are drawn.

use mve_core::Entry;

use super::MakeCost;
use super::pictures::{AREAS, VIEW, image_options};
use crate::geometry::image_driven::{Difference, ImageDriven, Patch, Picture};

pub static COST: Entry<MakeCost> = Entry {
    id: "ImageMse",
    summary: "What the collapse changes in pictures from all around: the growth of the squared \
              luminance difference (Lindstrom and Turk 2000).",
    params: &[
        VIEW.cameras.spec(),
        VIEW.resolution.spec(),
        VIEW.sides.spec(),
        VIEW.background.spec(),
        AREAS.spec(),
    ],
    build: |mesh, settings| Ok(Box::new(ImageDriven::new(mesh, Squares, image_options(settings)?))),
};

/// See the file's header.
#[derive(Clone, Copy, Debug, Default)]
pub struct Squares;

impl Difference for Squares {
    type Kept = ();
    type Scratch = ();

    fn keep(&self, _: &Picture) {}

    #[inline(always)]
    fn change(&self, picture: &Picture, (): &(), patch: &Patch, (): &mut ()) -> i64 {
        let rows = patch.changed.y[0]..patch.changed.y[1];
        rows.map(|y| {
            let x = patch.changed.x;
            let [from, to] = x.map(|x| y as usize * picture.size + x as usize);
            let (original, now) = (&picture.original[from..to], &picture.now[from..to]);
            let pixels = original.iter().zip(now).zip(patch.row(y, x));
            let growth = |((&original, &now), &new)| {
                let [original, now, new] = [original, now, new].map(i32::from);
                (new - now) * (new + now - 2 * original)
            };
            i64::from(pixels.map(growth).sum::<i32>())
        })
        .sum()
    }

    fn price(&self, growth: i64, _: usize, _: usize) -> f64 {
        growth as f64
    }
}
