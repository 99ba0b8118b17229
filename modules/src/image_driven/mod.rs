//! Image-driven prices: how much more the pictures of a mesh differ from those of the original
//! after a collapse.
//!
//! P. Lindstrom and G. Turk, "Image-driven simplification", ACM Transactions on Graphics 19(3),
//! 2000: a collapse is worth what it changes in pictures from all around. What is new here is how a
//! price is found. Each camera keeps its picture with all faces behind every pixel (`layers`). To
//! price a collapse only the few faces that it makes are drawn, over the pixels that they and the
//! faces before them span (the *active area*); where a face goes, the next one behind it is known.
//! So a price costs the same in a mesh of any size, and it is exactly that of drawing the whole
//! pictures, which [`Areas::Whole`] does, for comparison.
//!
//! Departures from the paper: faces are shaded flat, so that a collapse changes no other faces than
//! those around its edge; a price goes stale when the faces of its edge have changed, not when
//! some other part of the surface comes before or behind them in a picture, nor when only pixels
//! beside them change that a window of [`Structure`] sees, too.
//!
//! Surfaces are white, or have the colors and textures of the mesh (`albedo`), in the light or
//! without it; what counts is their luminance, as in the paper. The faces that a collapse makes are
//! drawn with the attributes that the engine would give the merged vertex, so a price is what the
//! collapse changes in the pictures, whatever it does to a texture. On `spot`, textured, to 1,000
//! faces, the RMS of textured pictures (24 cameras, 256²) is 9.86 by quadrics, 9.48 by `ImageMse`
//! of white pictures, and 7.97 of textured ones.
//!
//! Stale prices are asked for again lazily ([`Renewal::Lazy`]), which halves the work: on `cow` to
//! 3,000 faces 30,036 prices instead of 61,424, of which 8,706 are the first ones. The pictures of
//! cow, spot, fandisk and the bunny come out as near to the original as with [`Renewal::AtOnce`]:
//! RMS by -1.6 to +0.8 % and SSIM by up to 0.0002 different, without a trend. To let the edges at
//! the merged vertex wait, too, would save another fifth, at up to 5 % of RMS.

mod canvas;
mod change;
#[cfg(test)]
mod color_tests;
mod colors;
mod layered_view;
mod layers;
mod picture;
mod structure;
#[cfg(test)]
mod tests;

use std::sync::{Mutex, MutexGuard, PoisonError};

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use canvas::Canvas;
use change::{Change, PatchFace};
use colors::Colors;
use layered_view::LayeredView;
use mve_mesh::data::{FaceId, TriMesh};
pub use picture::{Difference, Patch, Picture};
pub use structure::Structure;

use crate::geometry::simplify::collapse::{Batch, Collapse, Cost, Reach, Renewal, WorkingMesh};
use crate::picture::render::{Albedo, CameraSet, Lens, Sides};
use mve_core::{Cancelled, Control};

/// How much of the pictures a price looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Areas {
    /// Only what the collapse changes.
    #[default]
    Active,
    /// All of it, drawn anew: the same prices, slowly.
    Whole,
}

/// What pictures are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageOptions {
    /// From where.
    pub cameras: CameraSet,
    /// Pixels a side.
    pub resolution: usize,
    /// Which sides of a face are drawn.
    pub sides: Sides,
    /// What colors the surface.
    pub albedo: Albedo,
    /// Whether light falls on it.
    pub is_lit: bool,
    /// Luminance where no face is.
    pub background: u8,
    /// How much of the pictures a price looks at.
    pub areas: Areas,
    /// When edges are priced again after a collapse.
    pub renewal: Renewal,
}

impl ImageOptions {
    /// The default.
    pub const DEFAULT: Self = Self {
        cameras: CameraSet::Dodecahedron,
        resolution: 256,
        sides: Sides::Front,
        albedo: Albedo::White,
        is_lit: true,
        background: 255,
        areas: Areas::Active,
        renewal: Renewal::Lazy,
    };
}

/// A cost that looks at pictures; `D` says how two pictures differ.
pub struct ImageDriven<D: Difference> {
    difference: D,
    options: ImageOptions,
    lenses: Vec<Lens>,
    colors: Option<Colors>,
    cameras: Vec<Mutex<CameraState<D>>>,
    /// The vertices of every face, as the cameras know them.
    faces: Vec<[u32; 3]>,
    /// Collapses that some camera may not have seen yet: they see them when they are next asked,
    /// which saves calling all threads together twice.
    pending: Vec<Change>,
    scratch: Mutex<Vec<Scratch<D>>>,
}

/// A camera with what its difference keeps.
struct CameraState<D: Difference> {
    view: LayeredView,
    kept: D::Kept,
    /// How many of the pending collapses it has seen.
    n_seen: usize,
}

/// Buffers of a thread.
struct Scratch<D: Difference> {
    canvas: Canvas,
    patch: Patch,
    difference: D::Scratch,
}

/// The work of one camera, with the vector instructions that the machine has. (A closure would be
/// compiled for the least machine.)
struct CameraWork<'a, D: Difference> {
    cost: &'a ImageDriven<D>,
    watched: &'a mut CameraState<D>,
    scratch: &'a mut Scratch<D>,
    /// The mesh, if whole pictures are to be drawn.
    mesh: Option<&'a WorkingMesh>,
    changes: &'a [Change],
}

impl<D: Difference> WithSimd for CameraWork<'_, D> {
    type Output = Vec<i64>;

    /// Shows the camera the collapses that it has not seen; then by how much each change makes its
    /// picture differ more.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<i64> {
        let Self { cost, watched, scratch, mesh, changes } = self;
        let CameraState { view, kept, n_seen } = watched;
        let Scratch { canvas, patch, difference: buffers } = scratch;
        let (difference, pending) = (&cost.difference, &cost.pending[*n_seen..]);
        let colors = cost.colors.as_ref();
        let mut growths = Vec::with_capacity(changes.len());
        // One loop over both, so that what it calls has one caller and is inlined.
        for (at, change) in pending.iter().chain(changes).enumerate() {
            let is_made = at < pending.len();
            let differs = match mesh.filter(|_| !is_made) {
                None => view.redraw(change, colors, canvas, patch),
                Some(mesh) => {
                    view.redraw_whole(mesh, change, colors, canvas, patch);
                    true
                }
            };
            if is_made {
                if differs {
                    difference.update(&view.picture, kept, patch, buffers);
                    patch.apply(&mut view.picture);
                }
                view.make(change, colors);
            } else {
                let picture = &view.picture;
                growths.push(if differs {
                    difference.change(picture, kept, patch, buffers)
                } else {
                    0
                });
            }
        }
        *n_seen = cost.pending.len();
        growths
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<D: Difference> ImageDriven<D> {
    /// Looks at the mesh from around its box. A mesh without extent is in no picture; its prices
    /// are all 0.
    pub fn new(mesh: &TriMesh, difference: D, options: ImageOptions) -> Self {
        let lenses = mesh.bounds().map_or_else(Vec::new, |bounds| {
            let distance = (bounds.1 - bounds.0).length();
            let cameras = options.cameras.around(bounds, &mesh.positions);
            cameras.into_iter().map(|c| Lens::new(c, options.resolution, distance)).collect()
        });
        Self {
            difference,
            options,
            lenses,
            colors: Colors::of(mesh, options.albedo),
            cameras: Vec::new(),
            faces: Vec::new(),
            pending: Vec::new(),
            scratch: Mutex::default(),
        }
    }

    fn watch(
        &self,
        lens: Lens,
        mesh: &WorkingMesh,
        control: Control,
    ) -> Result<CameraState<D>, Cancelled> {
        let view = LayeredView::new(lens, &self.options, self.colors.as_ref(), mesh, control)?;
        let kept = self.difference.keep(&view.picture);
        Ok(CameraState { view, kept, n_seen: 0 })
    }

    /// By how much each change makes the picture of a camera differ more.
    fn ask(&self, camera: usize, mesh: &WorkingMesh, changes: &[Change]) -> Vec<i64> {
        let mesh = (self.options.areas == Areas::Whole).then_some(mesh);
        let mut scratch = lock(&self.scratch).pop().unwrap_or_default();
        let watched = &mut *lock(&self.cameras[camera]);
        let asked = CameraWork { cost: self, watched, scratch: &mut scratch, mesh, changes };
        let growths = Arch::new().dispatch(asked);
        lock(&self.scratch).push(scratch);
        growths
    }
}

impl<D: Difference> Default for Scratch<D> {
    fn default() -> Self {
        Self { canvas: Canvas::default(), patch: Patch::default(), difference: Default::default() }
    }
}

impl<D: Difference> Cost for ImageDriven<D> {
    fn begin(&mut self, mesh: &WorkingMesh, control: Control) -> Result<(), Cancelled> {
        let n = self.lenses.len().max(1) as f64;
        let numbered = self.lenses.par_iter().enumerate();
        let watched = numbered.map(|(k, &lens)| {
            self.watch(lens, mesh, control.part(k as f64 / n, (k + 1) as f64 / n)).map(Mutex::new)
        });
        self.cameras = watched.collect::<Result<_, _>>()?;
        self.faces = mesh.face_ids().fold(Vec::new(), |mut faces, face| {
            faces.resize(face.idx(), [0; 3]);
            faces.push(mesh.face(face).map_or([0; 3], |vertices| vertices.map(|v| v.0)));
            faces
        });
        Ok(())
    }

    fn price(&self, mesh: &WorkingMesh, batch: Batch, prices: &mut [f64]) {
        // Threads that have had something to do just before are awake for the cameras.
        let proposed = |proposal| {
            let mut change = Change::proposed(mesh, proposal);
            if let Some(colors) = &self.colors {
                let given = batch.attributes(proposal);
                change.colors = colors.proposed(mesh, proposal, given, &change.new);
            }
            change
        };
        let changes: Vec<Change> =
            batch.proposals.par_iter().with_min_len(8).map(proposed).collect();
        let of_camera = |camera| self.ask(camera, mesh, &changes);
        let growths: Vec<Vec<i64>> =
            (0..self.cameras.len()).into_par_iter().map(of_camera).collect();
        let (n_cameras, size) = (self.cameras.len(), self.options.resolution);
        for (at, price) in prices.iter_mut().enumerate() {
            let growth = growths.iter().map(|of_camera| of_camera[at]).sum();
            *price = self.difference.price(growth, n_cameras, size);
        }
    }

    fn collapsed(&mut self, mesh: &WorkingMesh, collapse: &Collapse) {
        let is_seen = |watched: &mut Mutex<CameraState<D>>| {
            watched.get_mut().unwrap_or_else(PoisonError::into_inner).n_seen == self.pending.len()
        };
        if self.cameras.iter_mut().all(is_seen) {
            self.pending.clear();
            for watched in &mut self.cameras {
                watched.get_mut().unwrap_or_else(PoisonError::into_inner).n_seen = 0;
            }
        }
        let mut change = Change::made(mesh, collapse, |face| self.faces[face as usize]);
        if let Some(colors) = &self.colors {
            let color = |new: &PatchFace| colors.of_face(mesh, FaceId(new.face));
            change.colors = change.new.iter().map(color).collect();
        }
        for new in &change.new {
            self.faces[new.face as usize] = new.vertices;
        }
        self.pending.push(change);
    }

    fn renewal(&self) -> Renewal {
        self.options.renewal
    }

    fn uses_threads(&self) -> bool {
        true
    }

    // The faces of an edge are those around its ends.
    fn reach(&self) -> Reach {
        Reach::NEIGHBORS
    }

    // A price is that of the pixels of its faces, before which others may come from afar.
    fn exact_reach(&self) -> Option<Reach> {
        None
    }
}
