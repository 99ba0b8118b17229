//! A terrain: a grid whose heights are noise or come from a picture.
//!
//! Source: K. Perlin, "Improving noise", SIGGRAPH 2002, for the quintic blend of gradients at the
//! points of a grid, here of two dimensions with directions of any angle; B. Mandelbrot and J. Van
//! Ness, "Fractional Brownian motions, fractional noises and applications", SIAM Review 10(4),
//! 1968, for the sum of octaves.

use std::f64::consts::{SQRT_2, TAU};

use glam::DVec2;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{Image, PixelKind, TriMesh};
use mve_mesh::random::IndexedRandom;

use super::{PlaneOptions, plane};

/// What the heights are.
#[derive(Clone, Debug, PartialEq)]
pub enum Heights<'a> {
    /// A sum of noises, each finer than the one before.
    Noise(NoiseHeights),
    /// The luminance of a picture that is laid over the grid: black is 0, white the height.
    Picture(&'a Image),
}

/// Noise of several octaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseHeights {
    /// What the random numbers start from.
    pub seed: u64,
    /// How many noises.
    pub octaves: u32,
    /// The size of hills of the first noise, in model units; those of each other are half as large
    /// as those of the one before.
    pub hill_size: f64,
    /// How high each noise is beside the one before, 0 to 1: rough near 1.
    pub roughness: f64,
}

/// Makes a grid in the xy plane, looking along z, of [`PlaneOptions`]; heights are between
/// `-height` and `height` of noise, and from 0 to `height` of a picture. A place has the same
/// height at any number of segments.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn terrain(
    options: &PlaneOptions,
    heights: &Heights,
    height: f64,
    control: Control,
) -> Result<TriMesh, Cancelled> {
    let mut mesh = plane(options);
    let n_vertices = mesh.positions.len();
    for (v, position) in mesh.positions.iter_mut().enumerate() {
        control.item(v, n_vertices)?;
        let place = position.truncate();
        position.z = height
            * match heights {
                Heights::Noise(noise) => noise.at(place),
                Heights::Picture(image) => brightness(image, place / options.size + 0.5),
            };
    }
    Ok(mesh)
}

impl NoiseHeights {
    /// Between -1 and 1.
    fn at(&self, place: DVec2) -> f64 {
        let (mut sum, mut whole, mut weight, mut scale) = (0.0, 0.0, 1.0, 1.0 / self.hill_size);
        for octave in 0..self.octaves {
            let random = IndexedRandom::new(self.seed.wrapping_add(u64::from(octave) << 32));
            // So that the points of a grid of vertices are not those of one of gradients.
            let shift = DVec2::new(random.unit(u64::MAX), random.unit(u64::MAX - 1));
            sum += weight * gradient_noise(random, place * scale + shift);
            whole += weight;
            weight *= self.roughness;
            scale *= 2.0;
        }
        sum / whole
    }
}

/// Between -1 and 1; 0 at the points of the grid of whole numbers.
fn gradient_noise(random: IndexedRandom, place: DVec2) -> f64 {
    let cell = place.floor();
    let within = place - cell;
    let corner = |offset: DVec2| {
        let [i, j] = (cell + offset).to_array().map(|x| x as i64 as u32);
        let (sin, cos) = (TAU * random.unit(u64::from(i) << 32 | u64::from(j))).sin_cos();
        DVec2::new(cos, sin).dot(within - offset)
    };
    let blend = within * within * within * (within * (within * 6.0 - 15.0) + 10.0);
    let row = |y: f64| {
        let (from, to) = (corner(DVec2::new(0.0, y)), corner(DVec2::new(1.0, y)));
        from + blend.x * (to - from)
    };
    let (below, above) = (row(0.0), row(1.0));
    // In the middle of a cell, between directions towards it, is the most: half a diagonal.
    SQRT_2 * (below + blend.y * (above - below))
}

/// The luminance at a place of a picture, 0 to 1 from its lower left, between the four nearest
/// middles of pixels.
fn brightness(image: &Image, place: DVec2) -> f64 {
    if image.width == 0 || image.height == 0 {
        return 0.0;
    }
    let last = [image.width - 1, image.height - 1];
    let luminance = |x: usize, y: usize| {
        let pixel = image.pixel(x, y);
        let byte = |k: usize| pixel.get(k).map_or(0.0, |byte| f64::from(*byte));
        match image.kind {
            PixelKind::Gray => byte(0) / 255.0,
            // Rec. 709.
            PixelKind::Rgb => (0.2126 * byte(0) + 0.7152 * byte(1) + 0.0722 * byte(2)) / 255.0,
        }
    };
    let at = |share: f64, n: usize, last: usize| {
        let along = (share * n as f64 - 0.5).clamp(0.0, last as f64);
        let first = (along.floor() as usize).min(last);
        (first, (first + 1).min(last), along - along.floor())
    };
    let (left, right, across) = at(place.x, image.width, last[0]);
    // The first row is at the top.
    let (top, bottom, down) = at(1.0 - place.y, image.height, last[1]);
    let row = |y: usize| {
        let (from, to) = (luminance(left, y), luminance(right, y));
        from + across * (to - from)
    };
    let (above, below) = (row(top), row(bottom));
    above + down * (below - above)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: NoiseHeights =
        NoiseHeights { seed: 1, octaves: 6, hill_size: 0.5, roughness: 0.5 };

    fn heights(segments: u32, noise: NoiseHeights) -> Vec<f64> {
        let options = PlaneOptions { size: DVec2::splat(4.0), segments: [segments; 2] };
        let mesh = terrain(&options, &Heights::Noise(noise), 2.0, Control::none()).unwrap();
        mesh.positions.iter().map(|p| p.z).collect()
    }

    #[test]
    fn noise_keeps_to_its_range_and_its_places() {
        let fine = heights(200, NOISE);
        assert!(fine.iter().all(|z| z.abs() <= 2.0));
        let mean = fine.iter().sum::<f64>() / fine.len() as f64;
        let spread = fine.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / fine.len() as f64;
        assert!(mean.abs() < 0.2 && (0.05..1.0).contains(&spread), "{mean} {spread}");
        // Every second vertex of the finer grid is one of the coarser.
        let coarse = heights(100, NOISE);
        assert_eq!(coarse[101 * 50 + 20], fine[201 * 100 + 40]);
        assert_ne!(heights(20, NOISE), heights(20, NoiseHeights { seed: 2, ..NOISE }));
    }

    #[test]
    fn rough_terrain_has_steeper_slopes() {
        let slope = |roughness: f64| {
            let all = heights(128, NoiseHeights { roughness, ..NOISE });
            all.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>()
        };
        assert!(slope(0.8) > 1.5 * slope(0.4));
    }

    #[test]
    fn gradients_vanish_at_whole_numbers_and_are_smooth_between() {
        let random = IndexedRandom::new(7);
        let at = |x: f64, y: f64| gradient_noise(random, DVec2::new(x, y));
        assert_eq!((at(3.0, -2.0), at(0.0, 0.0)), (0.0, 0.0));
        for k in 0..1000 {
            let x = -2.0 + f64::from(k) * 0.004_1;
            assert!((at(x + 1e-6, 0.37) - at(x, 0.37)).abs() < 1e-5, "{x}");
        }
    }

    /// Four pixels: black and white above, gray below.
    #[test]
    fn a_picture_is_laid_over_the_grid() {
        let image = Image {
            name: "heights".to_owned(),
            width: 2,
            height: 2,
            kind: PixelKind::Gray,
            bytes: vec![0, 255, 51, 51],
        };
        let options = PlaneOptions { size: DVec2::new(2.0, 6.0), segments: [4, 4] };
        let mesh = terrain(&options, &Heights::Picture(&image), 10.0, Control::none()).unwrap();
        let at = |i: usize, j: usize| mesh.positions[5 * j + i].z;
        assert_eq!((at(0, 4), at(4, 4), at(0, 0), at(4, 0)), (0.0, 10.0, 2.0, 2.0));
        // In the middle is the mean of all four.
        assert!((at(2, 2) - 3.5).abs() < 1e-12, "{}", at(2, 2));
    }
}
