//! One mesh in a view: its arrays in the making and on the GPU, and its picture.

use std::sync::Arc;

use eframe::{egui, wgpu};
use glam::DMat4;
use mve_modules::data::TriMesh;
use mve_modules::picture::color_map::Outside;

use super::arrays::{Arrays, Shading, Sharing, arrays};
use super::coarse::{Coarse, coarse};
use super::coloring::{Attribute, Reading, Source, Spacing, Values, attribute};
use super::edges::{Edges, edges};
use super::gpu::{Cursor, Drawing, FINE, Gpu, Lines, Texture, Uniforms};
use super::gpu_buffers::{AttributeBuffers, LineBuffers, SurfaceBuffers};
use super::gpu_target::Target;
use super::settings::{BackFaces, Settings};
use super::texture::{Pictures, TextureSource, pictures};
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
    attribute: AttributeBuffers,
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

/// What is to be uploaded.
struct Made {
    arrays: Arc<Arrays>,
    coarse: Arc<Option<Coarse>>,
    attribute: Attribute,
}

impl Made {
    /// What does not depend on colors.
    fn arrays(&self) -> (Arc<Arrays>, Arc<Option<Coarse>>) {
        (Arc::clone(&self.arrays), Arc::clone(&self.coarse))
    }
}

/// Textures on the GPU, and what is wrong with some of them; or why there are none.
type Textures = Result<(Texture, Option<String>), String>;

/// The colors that a picture uses; the numbers change with the content.
#[derive(Clone, Copy)]
pub struct Colors<'a> {
    /// Of values.
    pub table: (&'a Texture, u64),
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
    textures: Option<Same<Textures>>,
    table: u64,
    size: [u32; 2],
    is_culled: bool,
}

/// One mesh in a view.
///
/// What is made in the background is uploaded there, too, where the GPU can be shared by threads;
/// so a window does not wait for the bytes of a large mesh.
pub struct Item {
    /// The mesh.
    pub mesh: Arc<TriMesh>,
    /// `None` for a mesh without a face that can be drawn.
    made: Slot<Wanted, Option<Made>>,
    /// What was uploaded.
    prepared: Slot<Same<Option<Made>>, Preparation>,
    edges: Slot<Same<Arrays>, Edges>,
    /// `None` when they are more than the GPU takes.
    lines: Slot<Same<Edges>, Option<LineBuffers>>,
    pictures: Slot<TextureSource, Result<Pictures, String>>,
    textures: Slot<Same<Result<Pictures, String>>, Textures>,
    target: Option<Target>,
    drawn: Option<Drawn>,
    /// Samples a pixel that it was drawn with.
    samples: u32,
    /// Where the picture is to be drawn on; none when it is done.
    rest: Option<Cursor>,
    /// How often it was drawn.
    pub n_drawn: u64,
}

impl Item {
    /// A mesh of which nothing is prepared.
    pub fn new(mesh: Arc<TriMesh>) -> Self {
        Self {
            mesh,
            made: Slot::default(),
            prepared: Slot::default(),
            edges: Slot::default(),
            lines: Slot::default(),
            pictures: Slot::default(),
            textures: Slot::default(),
            target: None,
            drawn: None,
            samples: 0,
            rest: None,
            n_drawn: 0,
        }
    }

    /// Sees to it that what is wanted is made and uploaded.
    pub fn prepare(
        &mut self,
        context: &egui::Context,
        gpu: &Gpu,
        (source, texture): (Source, Option<TextureSource>),
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
                let coarse = Arc::new(coarse(&arrays, wanted.sharing));
                Some((Arc::new(arrays), coarse))
            };
            let (arrays, coarse) = known.or_else(make)?;
            let attribute = attribute(&mesh, &arrays, &wanted.source, wanted.spacing);
            Some(Made { arrays, coarse, attribute })
        });
        if let Some(made) = self.made.latest().map(Same) {
            let job = (gpu.device().clone(), made.clone(), self.prepared.latest());
            let upload = move || {
                let (device, made, known) = job;
                let known = known.as_deref().and_then(|known| known.as_ref().ok());
                let made = made.0.as_ref().as_ref().ok_or(Undrawable::Empty)?;
                upload(&device, made, known)
            };
            in_place(&mut self.prepared, context, gpu, made, upload);
        }
        self.prepare_textures(context, gpu, texture);
        self.prepare_edges(context, gpu, settings);
    }

    fn prepare_edges(&mut self, context: &egui::Context, gpu: &Gpu, settings: &Settings) {
        let Some(arrays) = self.arrays() else { return };
        let job = (Arc::clone(&self.mesh), Arc::clone(&arrays));
        self.edges.want(context, Same(arrays), move || edges(&job.0, &job.1));
        if let Some(edges) = self.edges.latest().filter(|_| settings.lines != Lines::default()) {
            let (device, job) = (gpu.device().clone(), Arc::clone(&edges));
            let upload = move || LineBuffers::new(&device, &job).ok();
            in_place(&mut self.lines, context, gpu, Same(edges), upload);
        }
    }

    fn prepare_textures(
        &mut self,
        context: &egui::Context,
        gpu: &Gpu,
        source: Option<TextureSource>,
    ) {
        let Some(source) = source else {
            (self.pictures, self.textures) = (Slot::default(), Slot::default());
            return;
        };
        let (job, most) = (source.clone(), gpu.max_texture_side());
        self.pictures.want(context, source, move || pictures(&job, most));
        if let Some(pictures) = self.pictures.latest() {
            let job = (gpu.device().clone(), gpu.queue().clone(), Arc::clone(&pictures));
            let upload = move || {
                let (device, queue, pictures) = job;
                let pictures = pictures.as_ref().as_ref().map_err(String::clone)?;
                let texture = Texture::of_pictures(&device, &queue, pictures);
                Ok((texture, pictures.problem.clone()))
            };
            in_place(&mut self.textures, context, gpu, Same(pictures), upload);
        }
    }

    /// What is on the GPU: `None` while there is nothing yet, or after a loss.
    pub fn prepared(&self) -> Option<Arc<Preparation>> {
        self.prepared.latest()
    }

    fn arrays(&self) -> Option<Arc<Arrays>> {
        let prepared = self.prepared()?;
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
        self.made.is_busy()
            || self.prepared.is_busy()
            || self.edges.is_busy()
            || self.lines.is_busy()
            || self.pictures.is_busy()
            || self.textures.is_busy()
            || self.rest.is_some()
    }

    /// Whether the picture is to be drawn on in the next frame.
    pub fn is_drawing(&self) -> bool {
        self.rest.is_some()
    }

    /// What is wrong with the textures.
    pub fn texture_problem(&self) -> Option<String> {
        match self.textures.latest()?.as_ref() {
            Ok((_, problem)) => problem.clone(),
            Err(problem) => Some(problem.clone()),
        }
    }

    /// Whether the making failed in a way that nobody foresaw.
    pub fn is_lost(&self) -> bool {
        self.made.is_lost() || self.prepared.is_lost()
    }

    /// The picture, drawn anew if anything that it shows has changed. A large one that the
    /// processor draws comes about in several frames; until then the older one is seen, or at
    /// first a rough one.
    pub fn picture(
        &mut self,
        gpu: &mut Gpu,
        settings: &Settings,
        colors: &Colors,
        frame: &Frame,
    ) -> Option<&Target> {
        let shared = self.prepared()?;
        let prepared = shared.as_ref().as_ref().ok()?;
        let textures = self.textures.latest();
        let texture = textures.as_deref().and_then(|textures| textures.as_ref().ok());
        let uniforms = uniforms(prepared, texture.is_some(), settings, colors, frame);
        // Lines of earlier arrays do not fit.
        let fitting = self.edges.latest_with_key();
        let fitting = fitting.filter(|(key, _)| Arc::ptr_eq(&key.0, &prepared.arrays));
        let lines = self.lines.latest_with_key().filter(|(known, _)| {
            let is_latest = fitting.is_some_and(|(_, edges)| Arc::ptr_eq(edges, &known.0));
            is_latest && settings.lines != Lines::default()
        });
        let is_culled = settings.back_faces == BackFaces::Hidden;
        let coarse = prepared.surface.coarse.as_ref().zip(prepared.attribute.coarse.as_ref());
        let drawn = Drawn {
            uniforms,
            prepared: Same(Arc::clone(&shared)),
            lines: lines.map(|(edges, _)| (edges.clone(), settings.lines)),
            textures: textures.clone().map(Same),
            table: colors.table.1,
            size: frame.size,
            is_culled,
        };
        let is_new = self.drawn.as_ref() != Some(&drawn);
        // While one change comes after the other, no fine picture would ever be done.
        let is_hurried = self.target.is_none() || (is_new && self.rest.is_some());
        let samples = match is_hurried && coarse.is_some() && gpu.is_software() {
            true => 1,
            false => frame.samples,
        };
        if is_new || samples != self.samples {
            (self.drawn, self.samples) = (Some(drawn), samples);
            self.rest = Some(Cursor::default());
            self.n_drawn += 1;
        }
        if let Some(from) = self.rest {
            let whole = (&prepared.surface.whole, &prepared.attribute.whole);
            let rough = coarse.filter(|_| samples < FINE);
            let (faces, attribute) = rough.unwrap_or(whole);
            let lines = lines.and_then(|(_, buffers)| buffers.as_ref().as_ref());
            let drawing = Drawing {
                uniforms,
                faces,
                is_coarse: rough.is_some(),
                attribute,
                // The rough version has no edges.
                lines: lines.filter(|_| rough.is_none()).map(|lines| (lines, settings.lines)),
                table: colors.table.0,
                pictures: texture.map_or(gpu.no_pictures(), |(texture, _)| texture).clone(),
                is_culled,
            };
            self.rest = gpu.draw(&mut self.target, frame.size, samples, &drawing, from);
            if samples != frame.samples {
                // The fine one follows.
                self.rest = Some(Cursor::default());
            }
        }
        self.target.as_ref()
    }
}

/// Makes what is to be on the GPU: aside where threads can share it, else here and now.
fn in_place<K: PartialEq, T: Send + 'static>(
    slot: &mut Slot<K, T>,
    context: &egui::Context,
    gpu: &Gpu,
    key: K,
    upload: impl FnOnce() -> T + Send + 'static,
) {
    match gpu.is_shared() {
        true => slot.want(context, key, upload),
        false => slot.make(key, upload),
    }
}

/// Uploads; positions stay on the GPU when they are those that are there.
fn upload(device: &wgpu::Device, made: &Made, known: Option<&Prepared>) -> Preparation {
    let known = known.filter(|known| Arc::ptr_eq(&known.arrays, &made.arrays));
    let coarse = made.coarse.as_ref().as_ref();
    let surface = match known {
        Some(known) => Arc::clone(&known.surface),
        None => {
            let surface = SurfaceBuffers::new(device, &made.arrays, coarse);
            Arc::new(surface.map_err(|_| Undrawable::TooLarge)?)
        }
    };
    let n_vertices = made.arrays.positions.len();
    let attribute = AttributeBuffers::new(device, &made.attribute, n_vertices, coarse);
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

/// How much of a wire is seen: where edges are shorter than a few pixels they would hide the surface.
fn wire_share(arrays: &Arrays, frame: &Frame) -> f32 {
    // The edge of an equilateral triangle, if as many cover a square as large as the box.
    let n_faces = arrays.faces.len().max(1) as f64;
    let edge = 1.5 * 2.0 * arrays.bounds.radius() / n_faces.sqrt();
    let pixels = edge * frame.camera.pixels_per_unit(frame.size[1]);
    ((pixels / 5.0) as f32).clamp(0.12, 1.0)
}

fn uniforms(
    prepared: &Prepared,
    has_texture: bool,
    settings: &Settings,
    colors: &Colors,
    frame: &Frame,
) -> Uniforms {
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
    let reading = match prepared.reading {
        Reading::Nothing => 0,
        Reading::Color => 1,
        Reading::Value => 2,
        Reading::Checker => 3,
        Reading::Picture if has_texture => 4,
        Reading::Materials if has_texture => 5,
        // There is no picture, or not yet.
        Reading::Picture | Reading::Materials => 0,
    };
    Uniforms {
        clip_from_view: columns(clip_from_view),
        view_from_local: columns(
            to_units * frame.camera.view_from_local(arrays.center, arrays.scale),
        ),
        surface: SURFACE,
        back: [BACK[0], BACK[1], BACK[2], back],
        wire: [WIRE[0], WIRE[1], WIRE[2], WIRE[3] * wire_share(arrays, frame)],
        border: BORDER,
        numbers: [place[0], place[1], f32::from(is_gray_outside), LINE_SHIFT as f32],
        modes: [reading, u32::from(settings.shading == Shading::Flat), 0, 0],
    }
}
