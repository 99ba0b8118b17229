//! One mesh in a view: its arrays in the making and on the GPU, and its picture.

use std::sync::Arc;

use eframe::{egui, wgpu};
use glam::DMat4;
use mve_modules::data::TriMesh;
use mve_modules::geometry::color_map::Outside;

use super::arrays::{Arrays, Shading, Sharing, arrays};
use super::coarse::coarse_indices;
use super::coloring::{Attribute, Reading, Source, Spacing, Values, attribute};
use super::edges::{Edges, edges};
use super::gpu::{Drawing, FINE, Gpu, Lines, Target, Texture, Uniforms};
use super::gpu_buffers::{LineBuffers, SurfaceBuffers, attribute_buffer};
use super::settings::{BackFaces, Settings};
use crate::views::camera::{Bounds, Camera, Projection};
use crate::views::slot::{Same, Slot};

/// What arrays are made for.
#[derive(Clone, Debug, PartialEq)]
struct Wanted {
    crease_angle_rad: f32,
    sharing: Sharing,
    source: Source,
    spacing: Spacing,
}

/// A mesh on the GPU.
pub struct Prepared {
    /// The arrays.
    pub arrays: Arc<Arrays>,
    /// The numbers that color it, when numbers do.
    pub values: Option<Arc<Values>>,
    surface: Arc<SurfaceBuffers>,
    reading: Reading,
    attribute: wgpu::Buffer,
}

/// Why there is nothing to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Undrawable {
    /// No face with finite corners.
    Empty,
    /// More than the GPU takes.
    TooLarge,
}

type Preparation = Result<Prepared, Undrawable>;

/// What is computed in the background. The upload is not: some drivers let one thread at a time
/// use the GPU, and give up when that takes long.
struct Made {
    arrays: Arc<Arrays>,
    /// Faces of a rough version.
    coarse: Arc<Vec<u32>>,
    attribute: Attribute,
}

impl Made {
    /// What does not depend on colors.
    fn arrays(&self) -> (Arc<Arrays>, Arc<Vec<u32>>) {
        (Arc::clone(&self.arrays), Arc::clone(&self.coarse))
    }
}

/// The colors that a picture uses; the numbers change with the content.
#[derive(Clone, Copy)]
pub struct Colors<'a> {
    /// Of values.
    pub table: (&'a Texture, u64),
    /// The texture; `None` shows squares instead.
    pub picture: Option<(&'a Texture, u64)>,
    /// The range, in numbers that colors follow.
    pub range: [f64; 2],
}

/// How a picture is to be drawn.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// From where.
    pub camera: &'a Camera,
    /// The box around all that is shown, for depth.
    pub bounds: &'a Bounds,
    /// In pixels.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub samples: u32,
}

/// What a picture was drawn from: drawn anew when it differs.
#[derive(PartialEq)]
struct Drawn {
    uniforms: Uniforms,
    prepared: Same<Preparation>,
    lines: Option<(Same<Edges>, Lines)>,
    colors: [u64; 2],
    size: [u32; 2],
    samples: u32,
    is_culled: bool,
}

/// One mesh in a view.
pub struct Item {
    /// The mesh.
    pub mesh: Arc<TriMesh>,
    /// `None` for a mesh without a face that can be drawn.
    made: Slot<Wanted, Option<Made>>,
    /// What was uploaded, and of what.
    prepared: Option<(Same<Option<Made>>, Arc<Preparation>)>,
    edges: Slot<Same<Arrays>, Edges>,
    /// `None` when they are more than the GPU takes.
    lines: Option<(Same<Edges>, Option<LineBuffers>)>,
    target: Option<Target>,
    drawn: Option<Drawn>,
    /// How often it was drawn.
    pub n_drawn: u64,
}

impl Item {
    /// A mesh of which nothing is prepared.
    pub fn new(mesh: Arc<TriMesh>) -> Self {
        Self {
            mesh,
            made: Slot::default(),
            prepared: None,
            edges: Slot::default(),
            lines: None,
            target: None,
            drawn: None,
            n_drawn: 0,
        }
    }

    /// Sees to it that what is wanted is made, in the background, and uploads what has been made.
    pub fn prepare(
        &mut self,
        context: &egui::Context,
        device: &wgpu::Device,
        source: Source,
        settings: &Settings,
    ) {
        let wanted = Wanted {
            crease_angle_rad: settings.crease_angle_rad(),
            sharing: source.sharing(&self.mesh),
            source,
            spacing: settings.scale.spacing,
        };
        let same_arrays = |known: &Wanted| {
            (known.crease_angle_rad, known.sharing) == (wanted.crease_angle_rad, wanted.sharing)
        };
        let latest = self.made.latest_with_key().filter(|(key, _)| same_arrays(key));
        let known = latest.and_then(|(_, made)| made.as_ref().as_ref());
        let job = (Arc::clone(&self.mesh), wanted.clone(), known.map(Made::arrays));
        self.made.want(context, wanted, move || {
            let (mesh, wanted, known) = job;
            let make = || {
                let arrays = arrays(&mesh, wanted.crease_angle_rad, wanted.sharing)?;
                let coarse = Arc::new(coarse_indices(&arrays));
                Some((Arc::new(arrays), coarse))
            };
            let (arrays, coarse) = known.or_else(make)?;
            let attribute = attribute(&mesh, &arrays, &wanted.source, wanted.spacing);
            Some(Made { arrays, coarse, attribute })
        });
        self.upload(device);
        let Some(arrays) = self.arrays() else { return };
        let job = (Arc::clone(&self.mesh), Arc::clone(&arrays));
        self.edges.want(context, Same(arrays), move || edges(&job.0, &job.1));
        if let Some(edges) = self.edges.latest().map(Same)
            && self.lines.as_ref().is_none_or(|(known, _)| *known != edges)
            && settings.lines != Lines::default()
        {
            let buffers = LineBuffers::new(device, &edges.0).ok();
            self.lines = Some((edges, buffers));
        }
    }

    /// Uploads what has been made since the last time.
    fn upload(&mut self, device: &wgpu::Device) {
        let Some(made) = self.made.latest().map(Same) else { return };
        if self.prepared.as_ref().is_some_and(|(known, _)| *known == made) {
            return;
        }
        let known = self.prepared.take().map(|(_, known)| known);
        let known = known.as_deref().and_then(|known| known.as_ref().ok());
        let preparation = match made.0.as_ref() {
            Some(made) => prepare(device, made, known),
            None => Err(Undrawable::Empty),
        };
        self.prepared = Some((made, Arc::new(preparation)));
    }

    /// What is on the GPU: `None` while there is nothing yet, or after a loss.
    pub fn prepared(&self) -> Option<Arc<Preparation>> {
        self.prepared.as_ref().map(|(_, prepared)| Arc::clone(prepared))
    }

    fn arrays(&self) -> Option<Arc<Arrays>> {
        let (_, prepared) = self.prepared.as_ref()?;
        prepared.as_ref().as_ref().ok().map(|prepared| Arc::clone(&prepared.arrays))
    }

    /// The box around what is drawn, once it is known.
    pub fn bounds(&self) -> Option<Bounds> {
        self.arrays().map(|arrays| arrays.bounds)
    }

    /// The edges, once they are known.
    pub fn edges(&self) -> Option<Arc<Edges>> {
        self.edges.latest()
    }

    /// Whether something is in the making.
    pub fn is_busy(&self) -> bool {
        self.made.is_busy() || self.edges.is_busy()
    }

    /// Whether the making failed in a way that nobody foresaw.
    pub fn is_lost(&self) -> bool {
        self.made.is_lost()
    }

    /// The picture, drawn anew if anything that it shows has changed.
    pub fn picture(
        &mut self,
        gpu: &mut Gpu,
        settings: &Settings,
        colors: &Colors,
        frame: &Frame,
    ) -> Option<&Target> {
        let shared = self.prepared()?;
        let prepared = shared.as_ref().as_ref().ok()?;
        let uniforms = uniforms(prepared, settings, colors, frame);
        // Lines of earlier arrays do not fit.
        let fitting = self.edges.latest_with_key();
        let fitting = fitting.filter(|(key, _)| Arc::ptr_eq(&key.0, &prepared.arrays));
        let lines = self.lines.as_ref().filter(|(known, _)| {
            let is_latest = fitting.is_some_and(|(_, edges)| Arc::ptr_eq(edges, &known.0));
            is_latest && settings.lines != Lines::default()
        });
        let is_culled = settings.back_faces == BackFaces::Hidden;
        let picture = colors.picture.unwrap_or(colors.table);
        let drawn = Drawn {
            uniforms,
            prepared: Same(Arc::clone(&shared)),
            lines: lines.map(|(edges, _)| (edges.clone(), settings.lines)),
            colors: [colors.table.1, picture.1],
            size: frame.size,
            samples: frame.samples,
            is_culled,
        };
        if self.drawn.as_ref() != Some(&drawn) {
            let lines = lines.and_then(|(_, buffers)| buffers.as_ref());
            let drawing = Drawing {
                uniforms,
                surface: Some((&prepared.surface, &prepared.attribute)),
                lines: lines.map(|lines| (lines, settings.lines)),
                table: colors.table.0,
                picture: picture.0,
                is_culled,
                is_rough: frame.samples < FINE,
            };
            gpu.draw(&mut self.target, frame.size, frame.samples, &drawing);
            self.drawn = Some(drawn);
            self.n_drawn += 1;
        }
        self.target.as_ref()
    }
}

/// Uploads; positions stay on the GPU when they are those that are there.
fn prepare(device: &wgpu::Device, made: &Made, known: Option<&Prepared>) -> Preparation {
    let known = known.filter(|known| Arc::ptr_eq(&known.arrays, &made.arrays));
    let surface = match known {
        Some(known) => Arc::clone(&known.surface),
        None => {
            let surface = SurfaceBuffers::new(device, &made.arrays, &made.coarse);
            Arc::new(surface.map_err(|_| Undrawable::TooLarge)?)
        }
    };
    let attribute = attribute_buffer(device, &made.attribute, made.arrays.positions.len());
    Ok(Prepared {
        arrays: Arc::clone(&made.arrays),
        values: made.attribute.values.clone(),
        surface,
        reading: made.attribute.reading,
        attribute: attribute.map_err(|_| Undrawable::TooLarge)?,
    })
}

/// A neutral gray, a little warm, that stands out from light and dark alike.
const SURFACE: [f32; 4] = [0.74, 0.74, 0.72, 1.0];
const BACK: [f32; 3] = [0.72, 0.34, 0.28];
const WIRE: [f32; 4] = [0.06, 0.08, 0.12, 0.65];
const BORDER: [f32; 4] = [1.0, 0.55, 0.05, 1.0];
/// How far lines are moved towards the viewer, as a part of the size of the scene.
const LINE_SHIFT: f64 = 1e-3;

fn uniforms(prepared: &Prepared, settings: &Settings, colors: &Colors, frame: &Frame) -> Uniforms {
    let aspect = f64::from(frame.size[0]) / f64::from(frame.size[1]);
    let arrays = &prepared.arrays;
    let columns = |matrix: DMat4| matrix.as_mat4().to_cols_array_2d();
    let place = match &prepared.values {
        Some(values) => settings.scale.place_of_share(values.extent, colors.range),
        None => [1.0, 0.0],
    };
    let is_gray_outside = settings.scale.outside == Outside::Gray;
    // In units of the scene, so that scenes of any size fit into the numbers of the GPU.
    let unit = frame.bounds.radius();
    let to_units = DMat4::from_scale(glam::DVec3::splat(1.0 / unit));
    // Clip space has no unit where it is divided by depth.
    let clip_unit = match frame.camera.projection {
        Projection::Perspective => 1.0 / unit,
        Projection::Orthographic => 1.0,
    };
    let clip_from_view = frame.camera.clip_from_view(aspect, frame.bounds)
        * DMat4::from_scale(glam::DVec3::splat(unit))
        * clip_unit;
    let back = match settings.back_faces {
        BackFaces::Tinted => 0.55,
        BackFaces::Same | BackFaces::Hidden => 0.0,
    };
    let reading = match (prepared.reading, colors.picture) {
        (Reading::Nothing, _) => 0,
        (Reading::Color, _) => 1,
        (Reading::Value, _) => 2,
        (Reading::TexCoord, None) => 3,
        (Reading::TexCoord, Some(_)) => 4,
    };
    Uniforms {
        clip_from_view: columns(clip_from_view),
        view_from_local: columns(
            to_units * frame.camera.view_from_local(arrays.center, arrays.scale),
        ),
        surface: SURFACE,
        back: [BACK[0], BACK[1], BACK[2], back],
        wire: WIRE,
        border: BORDER,
        numbers: [place[0], place[1], f32::from(is_gray_outside), LINE_SHIFT as f32],
        modes: [reading, u32::from(settings.shading == Shading::Flat), 0, 0],
    }
}
