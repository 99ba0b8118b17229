//! How a picture of one mesh is to be drawn, and the numbers that the shaders read for it.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use mve_modules::picture::color_map::Outside;

use super::arrays::{Arrays, Shading};
use super::gpu::outline::{OutlineUniforms, SegmentBuffer};
use super::gpu::texture::GpuTexture;
use super::gpu::{MOST_LINE_SETS, Uniforms};
use super::look::coloring::Reading;
use super::look::settings::{BackFaces, MeshSettings};
use super::look::values::Values;
use super::section::Plane;
use crate::views::camera::{Bounds, Camera, Projection};

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
    /// Pixels in a point.
    pub pixels_per_point: f32,
    /// What is before it is cut away.
    pub plane: Option<Plane>,
    /// Outlines of sections, the last one over the others.
    pub outlines: &'a [ShownOutline],
}

/// An outline that is drawn in a picture, perhaps in that of another mesh.
#[derive(Clone)]
pub struct ShownOutline {
    /// Its pieces.
    pub buffer: Arc<Option<SegmentBuffer>>,
    /// Middle and unit of the space that they are in.
    pub space: (DVec3, f64),
    /// Red, green, blue and opacity.
    pub color: [f32; 4],
}

/// What is drawn of a mesh.
pub struct Surface<'a> {
    /// The arrays.
    pub arrays: &'a Arrays,
    /// The numbers that color it, when numbers do.
    pub values: Option<&'a Values>,
    /// How what its vertices carry is read.
    pub reading: Reading,
    /// Whether there is a picture on the GPU for what reads one.
    pub has_texture: bool,
}

/// A neutral gray, a little warm, that stands out from light and dark alike.
const SURFACE: [f32; 4] = [0.74, 0.74, 0.72, 1.0];
const BACK: [f32; 3] = [0.72, 0.34, 0.28];
/// How far lines are moved towards the viewer, as a part of the size of the scene.
const LINE_SHIFT: f64 = 1e-3;
/// Width of outlines in points.
const OUTLINE_WIDTH: f32 = 2.5;

/// How much of a wire is seen: where edges are shorter than a few pixels they would hide the
/// surface.
pub fn wire_share(arrays: &Arrays, viewport: &Viewport) -> f32 {
    // The edge of an equilateral triangle, if as many cover a square as large as the box.
    let n_faces = arrays.faces.len().max(1) as f64;
    let edge = 1.5 * 2.0 * arrays.bounds.radius() / n_faces.sqrt();
    let pixels = edge * viewport.camera.pixels_per_unit(viewport.size[1]);
    ((pixels / 5.0) as f32).clamp(0.12, 1.0)
}

/// The numbers for the surface and the lines on it.
pub fn uniforms(
    surface: &Surface,
    line_colors: [[f32; 4]; MOST_LINE_SETS],
    settings: &MeshSettings,
    (colors, viewport): (&Colors, &Viewport),
) -> Uniforms {
    let Surface { arrays, has_texture, .. } = *surface;
    let place = match surface.values {
        Some(values) => settings.scale.place_of_share(values.extent, colors.range),
        None => [1.0, 0.0],
    };
    let is_gray_outside = settings.scale.outside == Outside::Gray;
    let back = match settings.back_faces {
        // Inside of a cut mesh there is nothing to be read from colors.
        BackFaces::Tinted if viewport.plane.is_some() => 0.9,
        BackFaces::Tinted => 0.55,
        BackFaces::Same | BackFaces::Hidden => 0.0,
    };
    let reading = match surface.reading {
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
        clip_from_view: clip_from_view(viewport),
        view_from_local: view_from_local(viewport, (arrays.center, arrays.scale)),
        surface: SURFACE,
        back: [BACK[0], BACK[1], BACK[2], back],
        line_colors,
        numbers: [place[0], place[1], f32::from(is_gray_outside), LINE_SHIFT as f32],
        modes: [reading, u32::from(settings.shading == Shading::Flat), 0, 0],
        section: section(viewport),
    }
}

/// The numbers for an outline.
pub fn outline_uniforms(outline: &ShownOutline, viewport: &Viewport) -> OutlineUniforms {
    let [width, height] = viewport.size.map(|side| side as f32);
    let half = 0.5 * OUTLINE_WIDTH * viewport.pixels_per_point;
    OutlineUniforms {
        clip_from_view: clip_from_view(viewport),
        view_from_local: view_from_local(viewport, outline.space),
        color: outline.color,
        numbers: [width, height, half, LINE_SHIFT as f32],
    }
}

fn columns(matrix: DMat4) -> [[f32; 4]; 4] {
    matrix.as_mat4().to_cols_array_2d()
}

/// From a space with this middle and unit to view space, in units of the scene, so that scenes of
/// any size fit into the numbers of the GPU.
fn view_from_local(viewport: &Viewport, (center, scale): (DVec3, f64)) -> [[f32; 4]; 4] {
    let to_units = DMat4::from_scale(DVec3::splat(1.0 / viewport.bounds.radius()));
    columns(to_units * viewport.camera.view_from_local(center, scale))
}

fn clip_from_view(viewport: &Viewport) -> [[f32; 4]; 4] {
    let aspect = f64::from(viewport.size[0]) / f64::from(viewport.size[1]);
    let unit = viewport.bounds.radius();
    // Clip space has no unit where it is divided by depth.
    let clip_unit = match viewport.camera.projection {
        Projection::Perspective => 1.0 / unit,
        Projection::Orthographic => 1.0,
    };
    let clip_from_view = viewport.camera.clip_from_view(aspect, viewport.bounds);
    columns(clip_from_view * DMat4::from_scale(DVec3::splat(unit)) * clip_unit)
}

/// The plane in view space: its normal, and the way from the eye to it along that.
fn section(viewport: &Viewport) -> [f32; 4] {
    let Some(plane) = &viewport.plane else { return [0.0; 4] };
    let axes = viewport.camera.axes();
    let normal = [axes.right, axes.up, axes.back].map(|axis| axis.dot(plane.normal) as f32);
    let way = -plane.height(viewport.camera.eye()) / viewport.bounds.radius();
    [normal[0], normal[1], normal[2], way as f32]
}
