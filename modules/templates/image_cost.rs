//! The growth of the absolute luminance difference from pictures of the original.
//!
//! The price is the sum over cameras and pixels of |y₀ − yₖ₊₁| − |y₀ − yₖ|, in 8-bit luminances: a
//! whole number, negative where the collapse brings the pictures nearer to those of the original.
//! Say what the difference measures, in which unit, and name its source: authors, title, venue,
//! year. See [`image_driven`](crate::image_driven) for how pictures are drawn.

use mve_core::Entry;

use super::MakeCost;
use super::pictures::{AREAS, LIT, RENEWAL, VIEW, image_options};
use crate::image_driven::{Difference, ImageDriven, Patch, Picture};

pub static COST: Entry<MakeCost> = Entry {
    id: "Template",
    summary: "What the collapse changes in pictures from all around: the growth of the absolute \
              luminance difference.",
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
        Ok(Box::new(ImageDriven::new(mesh, Template, image_options(mesh, settings)?)))
    },
};

/// See the file's header. Keeps nothing for a camera.
#[derive(Clone, Copy, Debug)]
struct Template;

impl Difference for Template {
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
            let growth = |((&original, &now), &new): ((&u8, &u8), &u8)| {
                i32::from(new.abs_diff(original)) - i32::from(now.abs_diff(original))
            };
            i64::from(pixels.map(growth).sum::<i32>())
        })
        .sum()
    }

    fn price(&self, growth: i64, _n_cameras: usize, _size: usize) -> f64 {
        growth as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::generate::{BoxOptions, subdivided_box};
    use crate::geometry::simplify::collapse::{SimplifyOptions, Stop, simplify};
    use crate::image_driven::{Areas, ImageOptions};
    use crate::picture::render::Rect;
    use crate::placement::Endpoint;
    use mve_core::{Control, Settings};

    #[test]
    fn the_difference_grows_by_what_a_patch_changes() {
        let picture = Picture { size: 2, original: vec![10, 20, 30, 40], now: vec![10, 25, 30, 0] };
        // The right column: 25 becomes 21 (5 off, then 1), and 0 becomes 38 (40 off, then 2).
        let area = Rect { x: [1, 2], y: [0, 2] };
        let patch = Patch { area, changed: area, values: vec![21, 0, 38, 0], stride: 2 };
        assert_eq!(Template.change(&picture, &(), &patch, &mut ()), -(5 - 1) - (40 - 2));
    }

    #[test]
    fn it_is_made_from_its_defaults() {
        let settings = Settings::defaults(COST.params).unwrap();
        let mesh = subdivided_box(&BoxOptions::default());
        assert!((COST.build)(&mesh, &settings).is_ok());
    }

    #[test]
    fn active_areas_give_the_mesh_that_whole_pictures_give() {
        let mesh = subdivided_box(&BoxOptions::default());
        let simplified = |areas| {
            let options = ImageOptions { resolution: 32, areas, ..ImageOptions::DEFAULT };
            let mut cost = ImageDriven::new(&mesh, Template, options);
            let stop = Stop { faces: Some(mesh.faces.len() - 20), ..Stop::default() };
            let options = SimplifyOptions { stop, ..SimplifyOptions::default() };
            simplify(&mesh, &mut cost, &mut Endpoint, options, Control::none()).unwrap().mesh
        };
        assert_eq!(simplified(Areas::Active), simplified(Areas::Whole));
    }
}
