//! One mesh in a view: its arrays in the making and on the GPU, and its picture.

use std::sync::Arc;

use eframe::{egui, wgpu};
use mve_modules::data::TriMesh;

use super::arrays::coarse::{Coarse, coarse};
use super::arrays::edges::{Edges, edges};
use super::arrays::{Arrays, CornerSharing, arrays};
use super::gpu::buffers::{AttributeBuffers, LineBuffer, SurfaceBuffers};
use super::gpu::outline::{OutlineUniforms, SegmentBuffer};
use super::gpu::target::{FINE, Target};
use super::gpu::texture::GpuTexture;
use super::gpu::{Cursor, Drawing, Gpu, MOST_LINE_SETS, Uniforms};
use super::lines::{LineChoice, MeshLines};
use super::look::coloring::{Attribute, ColorSource, Reading, attribute};
use super::look::settings::{BackFaces, MeshSettings};
use super::look::texture::{Pictures, TextureSource, pictures};
use super::look::values::{Spacing, Values};
use super::outline::MeshOutline;
use super::section::Plane;
use super::viewport::{Colors, ShownOutline, Surface, Viewport};
use super::viewport::{outline_uniforms, uniforms, wire_share};
use crate::views::camera::Bounds;
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

impl GpuMesh {
    /// What the shader is told of it.
    fn drawn(&self, has_texture: bool) -> Surface<'_> {
        let Self { arrays, values, reading, .. } = self;
        Surface { arrays, values: values.as_deref(), reading: *reading, has_texture }
    }
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

/// What a picture was drawn from: drawn anew when it differs.
#[derive(PartialEq)]
struct DrawingKey {
    uniforms: Uniforms,
    prepared: Same<Preparation>,
    lines: Vec<(u32, Same<Option<LineBuffer>>)>,
    textures: Option<Same<Textures>>,
    outlines: Vec<(OutlineUniforms, Same<Option<SegmentBuffer>>)>,
    table: u64,
    size: [u32; 2],
    is_culled: bool,
    is_cut: bool,
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
    outline: MeshOutline,
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
            outline: MeshOutline::default(),
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

    /// Sees to it that the outline of a section is found and uploaded.
    pub fn prepare_outline(&mut self, context: &egui::Context, gpu: &Gpu, plane: &Plane) {
        if let Some(arrays) = self.arrays() {
            self.outline.prepare(context, gpu, (&self.mesh, &arrays), plane);
        }
    }

    /// The outline of the section, once it is on the GPU.
    pub fn outline(&self, color: [f32; 4]) -> Option<ShownOutline> {
        let arrays = self.arrays()?;
        let space = (arrays.center, arrays.scale);
        Some(ShownOutline { buffer: self.outline.latest()?, space, color })
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
            || self.outline.is_busy()
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

    /// What a picture is drawn from; `None` without a surface.
    fn drawing_key(
        &self,
        settings: &MeshSettings,
        colors: &Colors,
        viewport: &Viewport,
    ) -> Option<DrawingKey> {
        let shared = self.prepared()?;
        let prepared = shared.as_ref().as_ref().ok()?;
        let textures = self.textures.latest();
        let has_texture = textures.as_deref().is_some_and(Result::is_ok);
        let line_colors = self.line_colors(&prepared.arrays, viewport);
        let lines = self.shown_lines(&prepared.arrays).into_iter();
        let outline =
            |one: &ShownOutline| (outline_uniforms(one, viewport), Same(Arc::clone(&one.buffer)));
        Some(DrawingKey {
            uniforms: uniforms(
                &prepared.drawn(has_texture),
                line_colors,
                settings,
                (colors, viewport),
            ),
            prepared: Same(Arc::clone(&shared)),
            lines: lines.map(|(kind, lines)| (kind, Same(lines))).collect(),
            outlines: viewport.outlines.iter().map(outline).collect(),
            textures: textures.map(Same),
            table: colors.table.1,
            size: viewport.size,
            is_culled: settings.back_faces == BackFaces::Hidden,
            is_cut: viewport.plane.is_some(),
        })
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
        let key = self.drawing_key(settings, colors, viewport)?;
        let has_coarse = key.surface()?.coarse.is_some();
        let is_new = self.drawn.as_ref() != Some(&key);
        // While one change comes after the other, no fine picture would ever be done.
        let is_hurried = self.target.is_none() || (is_new && self.rest.is_some());
        let samples = match is_hurried && has_coarse && gpu.is_software() {
            true => 1,
            false => viewport.samples,
        };
        if is_new || samples != self.samples {
            (self.drawn, self.samples) = (Some(key), samples);
            self.rest = Some(Cursor::default());
            self.n_drawn += 1;
        }
        if let (Some(from), Some(key)) = (self.rest, &self.drawn) {
            let drawing = key.drawing(samples, colors.table.0, gpu.no_pictures())?;
            self.rest = gpu.draw(&mut self.target, viewport.size, samples, &drawing, from);
            if samples != viewport.samples {
                // The fine one follows.
                self.rest = Some(Cursor::default());
            }
        }
        self.target.as_ref()
    }
}

impl DrawingKey {
    fn prepared(&self) -> Option<&GpuMesh> {
        self.prepared.0.as_ref().as_ref().ok()
    }

    fn surface(&self) -> Option<&SurfaceBuffers> {
        self.prepared().map(|prepared| prepared.surface.as_ref())
    }

    /// What the GPU is told.
    fn drawing<'a>(
        &'a self,
        samples: u32,
        table: &'a GpuTexture,
        no_pictures: &GpuTexture,
    ) -> Option<Drawing<'a>> {
        let GpuMesh { surface, attribute, .. } = self.prepared()?;
        let coarse = surface.coarse.as_ref().zip(attribute.coarse.as_ref());
        let rough = coarse.filter(|_| samples < FINE);
        let (faces, attribute) = rough.unwrap_or((&surface.whole, &attribute.whole));
        // The rough version has no edges.
        let lines = self.lines.iter().filter(|_| rough.is_none());
        let lines = lines.filter_map(|(at, lines)| Some((*at, lines.0.as_ref().as_ref()?)));
        let outlines = self.outlines.iter();
        let outlines = outlines
            .filter_map(|(uniforms, buffer)| Some((*uniforms, buffer.0.as_ref().as_ref()?)));
        let texture = self.textures.as_ref().and_then(|textures| textures.0.as_ref().as_ref().ok());
        Some(Drawing {
            uniforms: self.uniforms,
            faces,
            is_coarse: rough.is_some(),
            attribute,
            lines: lines.collect(),
            outlines: outlines.collect(),
            table,
            pictures: texture.map_or(no_pictures, |(texture, _)| texture).clone(),
            is_culled: self.is_culled,
            is_cut: self.is_cut,
        })
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
