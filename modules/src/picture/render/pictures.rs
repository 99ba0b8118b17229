//! Pictures of a mesh from many cameras, on all cores.

use std::sync::atomic::{AtomicUsize, Ordering};

use mve_core::{Cancelled, Control};
use mve_mesh::data::{Image, Images, PixelKind, TriMesh, VertexId};
use rayon::prelude::*;

use super::project::STEPS;
use super::{Camera, CameraSet, Corner, Lens, Sides, Surface, Visible, corners};

/// Pixels from one look for a stop to the next, those of the boxes around faces: a few
/// milliseconds.
const BEAT: usize = 1 << 21;

/// What a face takes beside its pixels, in pixels.
const FACE: usize = 64;

/// What pictures are like, whatever they show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureOptions {
    /// Pixels in a row, and rows; at most [`super::MAX_SIZE`].
    pub size: usize,
    /// Which sides of the faces are drawn.
    pub sides: Sides,
    /// The byte where no face is, in all channels.
    pub background: u8,
    /// Gray, or red, green and blue.
    pub kind: PixelKind,
    /// Samples along each side of a pixel, of which it is the average; `size` times this is at most
    /// [`super::MAX_SIZE`].
    pub samples: usize,
}

impl PictureOptions {
    /// Bytes that pictures of a mesh by so many cameras take, with what is drawn into on each
    /// thread.
    pub fn bytes(&self, mesh: &TriMesh, n_cameras: usize) -> usize {
        /// The nearest face and its depth, and the picture itself.
        const BYTES_A_SAMPLE: usize = 16;
        /// A corner in the picture.
        const BYTES_A_VERTEX: usize = 12;
        let n_pixels = self.size * self.size;
        let n_samples = n_pixels * self.samples * self.samples;
        let of_thread = n_samples * BYTES_A_SAMPLE + mesh.positions.len() * BYTES_A_VERTEX;
        n_cameras * n_pixels * self.kind.n_bytes() + rayon::current_num_threads() * of_thread
    }

    /// Pictures of nothing, from the cameras of these numbers.
    pub fn empty(&self, numbers: &[usize]) -> Images {
        let size = [self.size; 2];
        let image = |number| Image::filled(&name(number), size, self.kind, self.background);
        Images(numbers.iter().map(image).collect())
    }
}

/// The name of a camera's picture.
fn name(number: &usize) -> String {
    format!("camera {number}")
}

/// Cameras around a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The cameras, in the order of their set.
    pub cameras: Vec<Camera>,
    /// The diagonal of the mesh's box, in model units: as far as most cameras are from its center.
    pub distance: f64,
}

impl Frame {
    /// Cameras around the box of a mesh; `None` where it has no size or is not finite.
    pub fn around(set: CameraSet, mesh: &TriMesh) -> Option<Self> {
        let bounds = mesh.bounds()?;
        let cameras = set.around(bounds, &mesh.positions);
        let distance = (bounds.1 - bounds.0).length();
        (!cameras.is_empty()).then_some(Self { cameras, distance })
    }

    /// Takes a picture with every camera: `camera 0` and so on. The same on any number of threads.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn pictures(
        &self,
        surface: &Surface,
        options: &PictureOptions,
        control: Control,
    ) -> Result<Images, Cancelled> {
        let numbers: Vec<usize> = (0..self.cameras.len()).collect();
        pictures(self, &numbers, surface, options, control)
    }
}

/// Takes pictures with the cameras of these numbers.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn pictures(
    frame: &Frame,
    numbers: &[usize],
    surface: &Surface,
    options: &PictureOptions,
    control: Control,
) -> Result<Images, Cancelled> {
    let n_done = AtomicUsize::new(0);
    let check = || control.at(n_done.load(Ordering::Relaxed) as f64 / numbers.len().max(1) as f64);
    let chosen: Vec<(usize, &Camera)> =
        numbers.iter().filter_map(|&number| Some((number, frame.cameras.get(number)?))).collect();
    let images: Result<Vec<Image>, Cancelled> = chosen
        .into_par_iter()
        .map(|(number, camera)| {
            let lens = Lens::new(*camera, options.size * options.samples, frame.distance);
            let image = picture(surface, &lens, &name(&number), options, check)?;
            let image = if options.samples > 1 { image.averaged(options.samples) } else { image };
            n_done.fetch_add(1, Ordering::Relaxed);
            check()?;
            Ok(image)
        })
        .collect();
    images.map(Images)
}

/// Takes one picture. O(pixels + faces + covered pixels); see `benches/render.rs`.
///
/// # Errors
/// [`Cancelled`] when `check`, called at least every few milliseconds, says so.
pub fn picture(
    surface: &Surface,
    lens: &Lens,
    name: &str,
    options: &PictureOptions,
    check: impl Fn() -> Result<(), Cancelled>,
) -> Result<Image, Cancelled> {
    let mesh = surface.mesh();
    check()?;
    let placed = corners(mesh, lens);
    let mut seen = Visible::nothing(lens.size);
    let mut first = 0;
    while first < mesh.faces.len() {
        check()?;
        let mut left = BEAT;
        let is_in = |face: &&[VertexId; 3]| {
            let goes_on = left > 0;
            left = left.saturating_sub(effort(face.map(|v| placed[v.idx()]), lens.size));
            goes_on
        };
        let end = first + mesh.faces[first..].iter().take_while(is_in).count();
        seen.add(mesh, first..end, &placed, lens, options.sides);
        first = end;
    }
    let view = (lens, placed.as_slice(), options.sides);
    surface.light(&seen, view, (name, options.kind, options.background), check)
}

/// About how long a face takes, in pixels: no less than the box around it.
fn effort([a, b, c]: [Corner; 3], size: usize) -> usize {
    if !(a.is_placed() && b.is_placed() && c.is_placed()) {
        return FACE + size * size;
    }
    let side = |a: i32, b: i32, c: i32| {
        let steps = a.max(b).max(c) - a.min(b).min(c);
        size.min(steps as usize / STEPS as usize + 1)
    };
    FACE + side(a.x, b.x, c.x) * side(a.y, b.y, c.y)
}
