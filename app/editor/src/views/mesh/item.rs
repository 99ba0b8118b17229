//! One mesh in a view: its arrays in the making and on the GPU, and its picture.

use std::sync::Arc;

use eframe::{egui, wgpu};
use glam::DMat4;
use mve_modules::data::TriMesh;
use mve_modules::picture::color_map::Outside;

use super::arrays::coarse::{Coarse, coarse};
use super::arrays::edges::{Edges, edges};
use super::arrays::{Arrays, CornerSharing, Shading, arrays};
use super::gpu::buffers::{AttributeBuffers, LineBuffer, SurfaceBuffers};
use super::gpu::target::{FINE, Target};
use super::gpu::texture::GpuTexture;
use super::gpu::{Cursor, Drawing, Gpu, MOST_LINE_SETS, Uniforms};
use super::lines::{LineChoice, MeshLines};
use super::look::coloring::{Attribute, ColorSource, Reading, attribute};
use super::look::settings::{BackFaces, MeshSettings};
use super::look::texture::{Pictures, TextureSource, pictures};
use super::look::values::{Spacing, Values};
use crate::views::camera::{Bounds, Camera, Projection};
use crate::views::memo::{Memo, Same};

/// What arrays are made for.
#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    crease_angle_rad: f32,
    sharing: CornerSharing,
    source: ColorSource,
    spacing: Spacing,
}

/// A mesh on the GPU.
pub struct GpuMesh {
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

type Preparation = Result<GpuMesh, Undrawable>;

/// What is to be uploaded.
struct Product {
    arrays: Arc<Arrays>,
    coarse: Arc<Option<Coarse>>,
    attribute: Attribute,
}

impl Product {
    /// What does not depend on colors.
    fn arrays(&self) -> (Arc<Arrays>, Arc<Option<Coarse>>) {
        (Arc::clone(&self.arrays), Arc::clone(&self.coarse))
    }
}

/// Textures on the GPU, and what is wrong with some of them; or why there are none.
type Textures = Result<(GpuTexture, Option<String>), String>;

/// The colors that a picture uses; the numbers change with the content.
#[derive(Clone, Copy)]
pub struct Colors<'a> {
    /// Of values.
    pub table: (&'a GpuTexture, u64),
    /// The range, in numbers that colors follow.
    pub range: [f64; 2],
}

/// How a picture is to be drawn.
#[derive(Clone, Copy)]
pub struct Viewport<'a> {
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
struct DrawingKey {
    uniforms: Uniforms,
    prepared: Same<Preparation>,
    lines: Vec<(u32, Same<Option<LineBuffer>>)>,
    textures: Option<Same<Textures>>,
    table: u64,
    size: [u32; 2],
    is_culled: bool,
}

/// One mesh in a view.
///
/// What is made in the background is uploaded there, too, where the GPU can be shared by threads;
/// so a window does not wait for the bytes of a large mesh.
pub struct MeshItem {
    /// The mesh.
    pub mesh: Arc<TriMesh>,
    /// `None` for a mesh without a face that can be drawn.
    products: Memo<Recipe, Option<Product>>,
    /// What was uploaded.
    prepared: Memo<Same<Option<Product>>, Preparation>,
    edges: Memo<Same<Arrays>, Edges>,
    /// Each kind of lines that there is, and whether it is shown.
    lines: Vec<(LineChoice, MeshLines)>,
    pictures: Memo<TextureSource, Result<Pictures, String>>,
    textures: Memo<Same<Result<Pictures, String>>, Textures>,
    target: Option<Target>,
    drawn: Option<DrawingKey>,
    /// Samples a pixel that it was drawn with.
    samples: u32,
    /// Where the picture is to be drawn on; none when it is done.
    rest: Option<Cursor>,
    /// How often it was drawn.
    pub n_drawn: u64,
}

impl MeshItem {
    /// A mesh of which nothing is prepared.
    pub fn new(mesh: Arc<TriMesh>) -> Self {
        Self {
            mesh,
            products: Memo::default(),
            prepared: Memo::default(),
            edges: Memo::default(),
            lines: Vec::new(),
            pictures: Memo::default(),
            textures: Memo::default(),
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
        (source, texture): (ColorSource, Option<TextureSource>),
        (settings, lines): (&MeshSettings, &[LineChoice]),
    ) {
        let wanted = Recipe {
            crease_angle_rad: settings.crease_angle_rad(),
            sharing: source.sharing(&self.mesh),
            source,
            spacing: settings.scale.spacing,
        };
        let same_arrays = |known: &Recipe| {
            (known.crease_angle_rad, known.sharing) == (wanted.crease_angle_rad, wanted.sharing)
        };
        let latest = self.products.latest_with_key().filter(|(key, _)| same_arrays(key));
        let known = latest.and_then(|(_, product)| product.as_ref().as_ref());
        let job = (Arc::clone(&self.mesh), wanted.clone(), known.map(Product::arrays));
        self.products.want(context, wanted, move || {
            let (mesh, wanted, known) = job;
            let make = || {
                let arrays = arrays(&mesh, wanted.crease_angle_rad, wanted.sharing)?;
                let coarse = Arc::new(coarse(&arrays, wanted.sharing));
                Some((Arc::new(arrays), coarse))
            };
            let (arrays, coarse) = known.or_else(make)?;
            let attribute = attribute(&mesh, &arrays, &wanted.source, wanted.spacing);
            Some(Product { arrays, coarse, attribute })
        });
        if let Some(product) = self.products.latest().map(Same) {
            let job = (gpu.device().clone(), product.clone(), self.prepared.latest());
            let upload = move || {
                let (device, product, known) = job;
                let known = known.as_deref().and_then(|known| known.as_ref().ok());
                let product = product.0.as_ref().as_ref().ok_or(Undrawable::Empty)?;
                upload(&device, product, known)
            };
            gpu.upload(&mut self.prepared, context, product, upload);
        }
        self.prepare_textures(context, gpu, texture);
        self.prepare_lines(context, gpu, lines);
    }

    fn prepare_lines(&mut self, context: &egui::Context, gpu: &Gpu, choices: &[LineChoice]) {
        let Some(arrays) = self.arrays() else { return };
        let job = (Arc::clone(&self.mesh), Arc::clone(&arrays));
        self.edges.want(context, Same(Arc::clone(&arrays)), move || edges(&job.0, &job.1));
        let n_known = self.lines.len();
        let new = choices.iter().skip(n_known).map(|choice| (*choice, MeshLines::default()));
        self.lines.extend(new);
        let edges = self.edges.latest_with_key();
        let edges = edges.filter(|(key, _)| Arc::ptr_eq(&key.0, &arrays)).map(|(_, edges)| edges);
        for ((known, lines), choice) in self.lines.iter_mut().zip(choices) {
            *known = *choice;
            if let Some(edges) = edges.filter(|_| choice.is_on) {
                lines.prepare(context, gpu, choice.set, (&self.mesh, &arrays, edges));
            }
        }
    }

    /// The lines that are shown and on the GPU, each with its place among the kinds. Lines of
    /// earlier arrays do not fit.
    fn shown_lines(&self, arrays: &Arc<Arrays>) -> Vec<(u32, Arc<Option<LineBuffer>>)> {
        let edges = self.edges.latest_with_key();
        let Some((_, edges)) = edges.filter(|(key, _)| Arc::ptr_eq(&key.0, arrays)) else {
            return Vec::new();
        };
        let shown = self.lines.iter().enumerate().take(MOST_LINE_SETS);
        let shown = shown.filter(|(_, (choice, _))| choice.is_on);
        shown.filter_map(|(at, (_, lines))| Some((at as u32, lines.of(edges)?))).collect()
    }

    fn prepare_textures(
        &mut self,
        context: &egui::Context,
        gpu: &Gpu,
        source: Option<TextureSource>,
    ) {
        let Some(source) = source else {
            (self.pictures, self.textures) = (Memo::default(), Memo::default());
            return;
        };
        let (job, most) = (source.clone(), gpu.max_texture_side());
        self.pictures.want(context, source, move || pictures(&job, most));
        if let Some(pictures) = self.pictures.latest() {
            let job = (gpu.device().clone(), gpu.queue().clone(), Arc::clone(&pictures));
            let upload = move || {
                let (device, queue, pictures) = job;
                let pictures = pictures.as_ref().as_ref().map_err(String::clone)?;
                let texture = GpuTexture::of_pictures(&device, &queue, pictures);
                Ok((texture, pictures.problem.clone()))
            };
            gpu.upload(&mut self.textures, context, Same(pictures), upload);
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

    /// The numbers that color it, when numbers do.
    pub fn values(&self) -> Option<Arc<Values>> {
        let prepared = self.prepared()?;
        prepared.as_ref().as_ref().ok()?.values.clone()
    }

    /// The box around what is drawn, once it is known.
    pub fn bounds(&self) -> Option<Bounds> {
        self.arrays().map(|arrays| arrays.bounds)
    }

    /// The edges, once they are known.
    pub fn edges(&self) -> Option<Arc<Edges>> {
        self.edges.latest()
    }

    /// The color of each kind of lines.
    fn line_colors(&self, arrays: &Arrays, viewport: &Viewport) -> [[f32; 4]; MOST_LINE_SETS] {
        let mut colors = [[0.0; 4]; MOST_LINE_SETS];
        for (color, (choice, _)) in colors.iter_mut().zip(&self.lines) {
            *color = choice.set.color;
            if choice.set.fades {
                color[3] *= wire_share(arrays, viewport);
            }
        }
        colors
    }

    /// Whether something is in the making.
    pub fn is_busy(&self) -> bool {
        self.products.is_busy()
            || self.prepared.is_busy()
            || self.edges.is_busy()
            || self.lines.iter().any(|(_, lines)| lines.is_busy())
            || self.pictures.is_busy()
            || self.textures.is_busy()
            || self.rest.is_some()
    }

    /// Whether the picture is to be drawn on in the next viewport.
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
        self.products.is_lost() || self.prepared.is_lost()
    }

    /// The picture, drawn anew if anything that it shows has changed. A large one that the
    /// processor draws comes about in several frames; until then the older one is seen, or at
    /// first a rough one.
    pub fn picture(
        &mut self,
        gpu: &mut Gpu,
        settings: &MeshSettings,
        colors: &Colors,
        viewport: &Viewport,
    ) -> Option<&Target> {
        let shared = self.prepared()?;
        let prepared = shared.as_ref().as_ref().ok()?;
        let textures = self.textures.latest();
        let texture = textures.as_deref().and_then(|textures| textures.as_ref().ok());
        let line_colors = self.line_colors(&prepared.arrays, viewport);
        let has_texture = texture.is_some();
        let uniforms = uniforms(prepared, has_texture, line_colors, settings, (colors, viewport));
        let lines = self.shown_lines(&prepared.arrays);
        let is_culled = settings.back_faces == BackFaces::Hidden;
        let coarse = prepared.surface.coarse.as_ref().zip(prepared.attribute.coarse.as_ref());
        let drawn = DrawingKey {
            uniforms,
            prepared: Same(Arc::clone(&shared)),
            lines: lines.iter().map(|(kind, lines)| (*kind, Same(Arc::clone(lines)))).collect(),
            textures: textures.clone().map(Same),
            table: colors.table.1,
            size: viewport.size,
            is_culled,
        };
        let is_new = self.drawn.as_ref() != Some(&drawn);
        // While one change comes after the other, no fine picture would ever be done.
        let is_hurried = self.target.is_none() || (is_new && self.rest.is_some());
        let samples = match is_hurried && coarse.is_some() && gpu.is_software() {
            true => 1,
            false => viewport.samples,
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
            // The rough version has no edges.
            let lines = lines.iter().filter(|_| rough.is_none());
            let lines = lines.filter_map(|(at, lines)| Some((*at, lines.as_ref().as_ref()?)));
            let drawing = Drawing {
                uniforms,
                faces,
                is_coarse: rough.is_some(),
                attribute,
                lines: lines.collect(),
                table: colors.table.0,
                pictures: texture.map_or(gpu.no_pictures(), |(texture, _)| texture).clone(),
                is_culled,
            };
            self.rest = gpu.draw(&mut self.target, viewport.size, samples, &drawing, from);
            if samples != viewport.samples {
                // The fine one follows.
                self.rest = Some(Cursor::default());
            }
        }
        self.target.as_ref()
    }
}

/// Uploads; positions stay on the GPU when they are those that are there.
fn upload(device: &wgpu::Device, product: &Product, known: Option<&GpuMesh>) -> Preparation {
    let known = known.filter(|known| Arc::ptr_eq(&known.arrays, &product.arrays));
    let coarse = product.coarse.as_ref().as_ref();
    let surface = match known {
        Some(known) => Arc::clone(&known.surface),
        None => {
            let surface = SurfaceBuffers::new(device, &product.arrays, coarse);
            Arc::new(surface.map_err(|_| Undrawable::TooLarge)?)
        }
    };
    let n_vertices = product.arrays.positions.len();
    let attribute = AttributeBuffers::new(device, &product.attribute, n_vertices, coarse);
    Ok(GpuMesh {
        arrays: Arc::clone(&product.arrays),
        values: product.attribute.values.clone(),
        surface,
        reading: product.attribute.reading,
        attribute: attribute.map_err(|_| Undrawable::TooLarge)?,
    })
}

/// A neutral gray, a little warm, that stands out from light and dark alike.
const SURFACE: [f32; 4] = [0.74, 0.74, 0.72, 1.0];
const BACK: [f32; 3] = [0.72, 0.34, 0.28];
/// How far lines are moved towards the viewer, as a part of the size of the scene.
const LINE_SHIFT: f64 = 1e-3;

/// How much of a wire is seen: where edges are shorter than a few pixels they would hide the
/// surface.
fn wire_share(arrays: &Arrays, viewport: &Viewport) -> f32 {
    // The edge of an equilateral triangle, if as many cover a square as large as the box.
    let n_faces = arrays.faces.len().max(1) as f64;
    let edge = 1.5 * 2.0 * arrays.bounds.radius() / n_faces.sqrt();
    let pixels = edge * viewport.camera.pixels_per_unit(viewport.size[1]);
    ((pixels / 5.0) as f32).clamp(0.12, 1.0)
}

fn uniforms(
    prepared: &GpuMesh,
    has_texture: bool,
    line_colors: [[f32; 4]; MOST_LINE_SETS],
    settings: &MeshSettings,
    (colors, viewport): (&Colors, &Viewport),
) -> Uniforms {
    let aspect = f64::from(viewport.size[0]) / f64::from(viewport.size[1]);
    let arrays = &prepared.arrays;
    let columns = |matrix: DMat4| matrix.as_mat4().to_cols_array_2d();
    let place = match &prepared.values {
        Some(values) => settings.scale.place_of_share(values.extent, colors.range),
        None => [1.0, 0.0],
    };
    let is_gray_outside = settings.scale.outside == Outside::Gray;
    // In units of the scene, so that scenes of any size fit into the numbers of the GPU.
    let unit = viewport.bounds.radius();
    let to_units = DMat4::from_scale(glam::DVec3::splat(1.0 / unit));
    // Clip space has no unit where it is divided by depth.
    let clip_unit = match viewport.camera.projection {
        Projection::Perspective => 1.0 / unit,
        Projection::Orthographic => 1.0,
    };
    let clip_from_view = viewport.camera.clip_from_view(aspect, viewport.bounds)
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
            to_units * viewport.camera.view_from_local(arrays.center, arrays.scale),
        ),
        surface: SURFACE,
        back: [BACK[0], BACK[1], BACK[2], back],
        line_colors,
        numbers: [place[0], place[1], f32::from(is_gray_outside), LINE_SHIFT as f32],
        modes: [reading, u32::from(settings.shading == Shading::Flat), 0, 0],
    }
}
