//! One mesh in a view: its arrays in the making and on the GPU, and its picture.

use std::sync::Arc;

use eframe::{egui, wgpu};
use glam::DMat4;
use mve_modules::data::TriMesh;
use mve_modules::geometry::color_map::Outside;

use super::arrays::{Arrays, Shading, Sharing, arrays};
use super::coloring::{Reading, Source, Spacing, Values, attribute};
use super::edges::edges;
use super::gpu::{Drawing, Gpu, Lines, Target, Texture, Uniforms};
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

/// The edges of a mesh, counted and on the GPU.
pub struct PreparedEdges {
    /// Edges of one face.
    pub n_border: usize,
    /// Edges of more than two.
    pub n_non_manifold: usize,
    /// `None` when they are more than the GPU takes.
    buffers: Option<LineBuffers>,
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
    lines: Option<(Same<PreparedEdges>, Lines)>,
    colors: [u64; 2],
    size: [u32; 2],
    samples: u32,
    is_culled: bool,
}

/// One mesh in a view.
pub struct Item {
    /// The mesh.
    pub mesh: Arc<TriMesh>,
    prepared: Slot<Wanted, Preparation>,
    edges: Slot<Same<Arrays>, PreparedEdges>,
    target: Option<Target>,
    drawn: Option<Drawn>,
    /// How often it was drawn.
    pub n_drawn: u64,
}

impl Item {
    /// A mesh of which nothing is prepared.
    pub fn new(mesh: Arc<TriMesh>) -> Self {
        let (prepared, edges) = (Slot::default(), Slot::default());
        Self { mesh, prepared, edges, target: None, drawn: None, n_drawn: 0 }
    }

    /// Sees to it that what is wanted is prepared, in the background.
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
        let latest = self.prepared.latest_with_key().filter(|(key, _)| same_arrays(key));
        let known = latest.map(|(_, made)| Arc::clone(made));
        let job = (Arc::clone(&self.mesh), device.clone(), wanted.clone());
        self.prepared.want(context, wanted, move || {
            let (mesh, device, wanted) = job;
            let known = known.as_deref().and_then(|known| known.as_ref().ok());
            prepare(&mesh, &device, &wanted, known)
        });
        let Some(arrays) = self.arrays() else { return };
        let job = (Arc::clone(&self.mesh), device.clone(), Arc::clone(&arrays));
        self.edges.want(context, Same(arrays), move || {
            let (mesh, device, arrays) = job;
            let edges = edges(&mesh, &arrays);
            let buffers = LineBuffers::new(&device, &edges).ok();
            PreparedEdges {
                n_border: edges.n_border,
                n_non_manifold: edges.n_non_manifold,
                buffers,
            }
        });
    }

    /// What is on the GPU: `None` while there is nothing yet, or after a loss.
    pub fn prepared(&self) -> Option<Arc<Preparation>> {
        self.prepared.latest()
    }

    fn arrays(&self) -> Option<Arc<Arrays>> {
        let prepared = self.prepared.latest()?;
        prepared.as_ref().as_ref().ok().map(|prepared| Arc::clone(&prepared.arrays))
    }

    /// The box around what is drawn, once it is known.
    pub fn bounds(&self) -> Option<Bounds> {
        self.arrays().map(|arrays| arrays.bounds)
    }

    /// The edges, once they are known.
    pub fn edges(&self) -> Option<Arc<PreparedEdges>> {
        self.edges.latest()
    }

    /// Whether something is in the making.
    pub fn is_busy(&self) -> bool {
        self.prepared.is_busy() || self.edges.is_busy()
    }

    /// Whether the making failed in a way that nobody foresaw.
    pub fn is_lost(&self) -> bool {
        self.prepared.is_lost()
    }

    /// The picture, drawn anew if anything that it shows has changed.
    pub fn picture(
        &mut self,
        gpu: &mut Gpu,
        settings: &Settings,
        colors: &Colors,
        frame: &Frame,
    ) -> Option<&Target> {
        let shared = self.prepared.latest()?;
        let prepared = shared.as_ref().as_ref().ok()?;
        let uniforms = uniforms(prepared, settings, colors, frame);
        let edges = self.edges.latest_with_key().filter(|(key, _)| {
            settings.lines != Lines::default() && Arc::ptr_eq(&key.0, &prepared.arrays)
        });
        let edges = edges.map(|(_, edges)| Arc::clone(edges));
        let is_culled = settings.back_faces == BackFaces::Hidden;
        let picture = colors.picture.unwrap_or(colors.table);
        let drawn = Drawn {
            uniforms,
            prepared: Same(Arc::clone(&shared)),
            lines: edges.clone().map(|edges| (Same(edges), settings.lines)),
            colors: [colors.table.1, picture.1],
            size: frame.size,
            samples: frame.samples,
            is_culled,
        };
        if self.drawn.as_ref() != Some(&drawn) {
            let lines = edges.as_deref().and_then(|edges| edges.buffers.as_ref());
            let drawing = Drawing {
                uniforms,
                surface: Some((&prepared.surface, &prepared.attribute)),
                lines: lines.map(|lines| (lines, settings.lines)),
                table: colors.table.0,
                picture: picture.0,
                is_culled,
            };
            gpu.draw(&mut self.target, frame.size, frame.samples, &drawing);
            self.drawn = Some(drawn);
            self.n_drawn += 1;
        }
        self.target.as_ref()
    }
}

fn prepare(
    mesh: &Arc<TriMesh>,
    device: &wgpu::Device,
    wanted: &Wanted,
    known: Option<&Prepared>,
) -> Preparation {
    let (drawn, surface) = match known {
        Some(known) => (Arc::clone(&known.arrays), Arc::clone(&known.surface)),
        None => {
            let made = arrays(mesh, wanted.crease_angle_rad, wanted.sharing);
            let made = made.ok_or(Undrawable::Empty)?;
            let surface = SurfaceBuffers::new(device, &made).map_err(|_| Undrawable::TooLarge)?;
            (Arc::new(made), Arc::new(surface))
        }
    };
    let made = attribute(mesh, &drawn, &wanted.source, wanted.spacing);
    let buffer = attribute_buffer(device, &made, drawn.positions.len());
    Ok(Prepared {
        values: made.values,
        surface,
        reading: made.reading,
        attribute: buffer.map_err(|_| Undrawable::TooLarge)?,
        arrays: drawn,
    })
}

/// A neutral gray, a little warm, that stands out from light and dark alike.
const SURFACE: [f32; 4] = [0.74, 0.74, 0.72, 1.0];
const BACK: [f32; 3] = [0.72, 0.34, 0.28];
const WIRE: [f32; 4] = [0.06, 0.08, 0.12, 0.75];
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
