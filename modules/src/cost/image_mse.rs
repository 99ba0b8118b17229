//! The growth of the squared luminance difference between pictures of the mesh and of the original.
//!
//! P. Lindstrom and G. Turk, "Image-driven simplification", ACM Transactions on Graphics 19(3),
//! 2000. The price of the collapse that makes mesh k + 1 of mesh k is the sum over cameras and
//! pixels of (y₀ − yₖ₊₁)² − (y₀ − yₖ)², in squared 8-bit luminances: a whole number, negative where
//! the collapse brings the pictures nearer to those of the original. See
//! [`image_driven`](crate::image_driven) for how pictures are drawn.

use mve_core::Entry;

use super::MakeCost;
use super::pictures::{AREAS, LIT, RENEWAL, VIEW, image_options};
use crate::image_driven::{Difference, ImageDriven, Patch, Picture};

pub static COST: Entry<MakeCost> = Entry {
    id: "ImageMse",
    summary: "What the collapse changes in pictures from all around: the growth of the squared \
              luminance difference (Lindstrom and Turk 2000).",
    params: &[
        VIEW.cameras.spec(),
        VIEW.resolution.spec(),
        VIEW.albedo.spec(),
        LIT.spec(),
        VIEW.sides.spec(),
        VIEW.background.spec(),
        AREAS.spec(),
        RENEWAL.spec(),
    ],
    build: |mesh, settings| {
        Ok(Box::new(ImageDriven::new(mesh, Squares, image_options(mesh, settings)?)))
    },
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
        // Loops, not folds, which would not be compiled for the vectors of the machine.
        let mut growth = 0;
        for y in patch.changed.y[0]..patch.changed.y[1] {
            let x = patch.changed.x;
            let [from, to] = x.map(|x| y as usize * picture.size + x as usize);
            let (original, now) = (&picture.original[from..to], &picture.now[from..to]);
            let mut of_row = 0;
            for ((&original, &now), &new) in original.iter().zip(now).zip(patch.row(y, x)) {
                let [original, now, new] = [i32::from(original), i32::from(now), i32::from(new)];
                of_row += (new - now) * (new + now - 2 * original);
            }
            growth += i64::from(of_row);
        }
        growth
    }

    fn price(&self, growth: i64, _: usize, _: usize) -> f64 {
        growth as f64
    }
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::mesh_of;

    use super::*;
    use crate::picture::render::Rect;
    use crate::prelude::*;

    #[test]
    fn squares_grow_by_what_a_patch_changes() {
        let picture = Picture { size: 2, original: vec![10, 20, 30, 40], now: vec![10, 25, 30, 0] };
        // The right column: 25 becomes 21 (25 less 1), and 0 becomes 38 (1600 less 4).
        let area = Rect { x: [1, 2], y: [0, 2] };
        let patch = Patch { area, changed: area, values: vec![21, 0, 38, 0], stride: 2 };
        assert_eq!(Squares.change(&picture, &(), &patch, &mut ()), -(25 - 1) - (1600 - 4));
    }

    #[test]
    fn a_mesh_that_no_camera_can_see_is_an_error() {
        let settings = Settings::defaults(COST.params).unwrap();
        let point = mesh_of(&[[1.0; 3]; 3], &[[0, 1, 2]]);
        let message = (COST.build)(&point, &settings).err().unwrap().to_string();
        assert!(message.contains("no camera can be placed"), "{message}");
        assert!((COST.build)(&TriMesh::default(), &settings).is_ok());
    }
}
