//! What a surface is colored by, and the arrays that carry it.
//!
//! Values go to the GPU as they are, scaled to their own range, and become colors there by a
//! table: so a change of range or scale costs nothing, and values, not colors, are interpolated
//! within a face.

use std::sync::Arc;

use glam::DVec2;
use mve_modules::data::{Domain, Field, Layer, LayerValues, NO_VALUE, TriMesh, bytes_of};
use mve_modules::picture::color_map::{
    ColorMap, ColorMapOptions, Outside, extent_of, range_of, share,
};
use mve_modules::picture::color_scale::Scale;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::views::field::vertices_in_faces;
use crate::views::mesh::arrays::textures::FaceTextures;
use crate::views::mesh::arrays::{Arrays, CornerSharing};
use crate::views::mesh::look::palette::{colors_of_labels, diffuse_of, label_layers};
use crate::views::mesh::look::values::{CLIP_PERCENTS, Spacing, Values};

/// What the user wants a surface to be colored by; names, so that it outlives values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum ColorBy {
    /// The field that was pinned last, else textures of materials, else colors, else the only layer
    /// of numbers, else plain.
    #[default]
    Auto,
    /// One color.
    Plain,
    /// The layer of colors.
    Colors,
    /// A layer of numbers, by name.
    Layer(String),
    /// A layer of names, by name: materials, groups.
    Labels(String),
    /// A field that is pinned too, by title.
    Field(String),
    /// Squares in texture space.
    Checker,
    /// The textures that the materials name.
    Materials,
    /// A pinned picture as a texture, by title.
    Picture(String),
}

/// A field that is pinned beside meshes.
#[derive(Clone, Debug)]
pub struct PinnedField {
    /// Where it comes from: `compare.distance`.
    pub title: String,
    /// The field.
    pub field: Arc<Field>,
}

/// What one mesh is colored by.
#[derive(Clone, Debug)]
pub enum ColorSource {
    /// One color.
    Plain,
    /// The layer of colors.
    Colors,
    /// A layer of numbers.
    Layer(String),
    /// A layer of names.
    Labels(String),
    /// A field.
    Field(Arc<Field>),
    /// Squares in texture space.
    Checker,
    /// The textures that the materials name.
    Materials,
    /// A pinned picture as a texture.
    Picture,
}

impl PartialEq for ColorSource {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Plain, Self::Plain)
            | (Self::Colors, Self::Colors)
            | (Self::Checker, Self::Checker)
            | (Self::Materials, Self::Materials)
            | (Self::Picture, Self::Picture) => true,
            (Self::Layer(a), Self::Layer(b)) | (Self::Labels(a), Self::Labels(b)) => a == b,
            (Self::Field(a), Self::Field(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// The layers of numbers of a mesh.
pub fn number_layers(mesh: &TriMesh) -> impl Iterator<Item = &Layer> {
    mesh.layers.iter().filter(|layer| matches!(layer.values, LayerValues::Number(_)))
}

fn colors_of(mesh: &TriMesh) -> Option<&Layer> {
    mesh.layer(Layer::COLOR).filter(|layer| matches!(layer.values, LayerValues::Vec3(_)))
}

fn texcoords_of(mesh: &TriMesh) -> Option<&Layer> {
    mesh.layer(Layer::TEXCOORD).filter(|layer| matches!(layer.values, LayerValues::Vec2(_)))
}

fn has_textures(mesh: &TriMesh) -> bool {
    texcoords_of(mesh).is_some() && !FaceTextures::of(mesh).list.is_empty()
}

/// Whether a mesh has what a choice asks for, and what that is.
pub fn source_of(mesh: &TriMesh, by: &ColorBy, fields: &[PinnedField]) -> Option<ColorSource> {
    let fitting = || fields.iter().filter(|pinned| pinned.field.check_fits(mesh).is_ok());
    match by {
        ColorBy::Plain => Some(ColorSource::Plain),
        ColorBy::Colors => colors_of(mesh).map(|_| ColorSource::Colors),
        ColorBy::Checker => texcoords_of(mesh).map(|_| ColorSource::Checker),
        ColorBy::Picture(_) => texcoords_of(mesh).map(|_| ColorSource::Picture),
        ColorBy::Materials => has_textures(mesh).then_some(ColorSource::Materials),
        ColorBy::Layer(name) => {
            let layer = number_layers(mesh).find(|layer| layer.name == *name)?;
            Some(ColorSource::Layer(layer.name.clone()))
        }
        ColorBy::Labels(name) => {
            let layer = label_layers(mesh).find(|layer| layer.name == *name)?;
            Some(ColorSource::Labels(layer.name.clone()))
        }
        ColorBy::Field(title) => {
            let pinned = fitting().find(|pinned| pinned.title == *title)?;
            Some(ColorSource::Field(Arc::clone(&pinned.field)))
        }
        ColorBy::Auto => {
            if let Some(last) = fitting().next_back() {
                return Some(ColorSource::Field(Arc::clone(&last.field)));
            }
            if has_textures(mesh) {
                return Some(ColorSource::Materials);
            }
            if colors_of(mesh).is_some() {
                return Some(ColorSource::Colors);
            }
            let mut layers = number_layers(mesh);
            match (layers.next(), layers.next()) {
                (Some(one), None) => Some(ColorSource::Layer(one.name.clone())),
                _ => Some(ColorSource::Plain),
            }
        }
    }
}

impl ColorSource {
    /// What it belongs to; `None` for one color.
    fn domain(&self, mesh: &TriMesh) -> Option<Domain> {
        match self {
            Self::Plain => None,
            Self::Colors => colors_of(mesh).map(|layer| layer.domain),
            Self::Checker | Self::Picture => texcoords_of(mesh).map(|layer| layer.domain),
            // Materials are of faces.
            Self::Materials => texcoords_of(mesh).map(|_| Domain::Corner),
            Self::Layer(name) | Self::Labels(name) => mesh.layer(name).map(|layer| layer.domain),
            Self::Field(field) => Some(field.domain),
        }
    }

    /// Which corners may share a drawn vertex.
    pub fn sharing(&self, mesh: &TriMesh) -> CornerSharing {
        match self.domain(mesh) {
            None | Some(Domain::Vertex) => CornerSharing::Wedges,
            Some(Domain::Corner | Domain::Face) => CornerSharing::Corners,
        }
    }
}

/// How the eight bytes of a drawn vertex are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// Not at all.
    Nothing,
    /// A display color in four bytes, the last 0 where there is none.
    Color,
    /// Two numbers: a value with [`Values::extent`] as 0 to 1, and 0 where there is none, else 1.
    Value,
    /// Two numbers, texture coordinates, of squares.
    Checker,
    /// The same, of one picture.
    Picture,
    /// The same, of the picture of the face's material; a display color where it has none.
    Materials,
}

/// What the drawn vertices carry beside position and normal.
#[derive(Clone, Debug)]
pub struct Attribute {
    /// How to read the words.
    pub reading: Reading,
    /// Two a drawn vertex; none for [`Reading::Nothing`].
    pub words: Vec<[u32; 2]>,
    /// The numbers of a scalar source.
    pub values: Option<Arc<Values>>,
}

/// Makes the array for a source, O(n).
pub fn attribute(
    mesh: &TriMesh,
    drawn: &Arrays,
    source: &ColorSource,
    spacing: Spacing,
) -> Attribute {
    let nothing = || Attribute { reading: Reading::Nothing, words: Vec::new(), values: None };
    let Some(domain) = source.domain(mesh) else { return nothing() };
    let element = |corner: u32| match domain {
        Domain::Vertex => mesh.faces[corner as usize / 3][corner as usize % 3].idx(),
        Domain::Corner => corner as usize,
        Domain::Face => corner as usize / 3,
    };
    let words = |word: &(dyn Fn(usize) -> [u32; 2] + Sync)| -> Vec<[u32; 2]> {
        drawn.corners.par_iter().map(|&corner| word(element(corner))).collect()
    };
    match source {
        ColorSource::Plain => nothing(),
        ColorSource::Colors | ColorSource::Labels(_) => {
            let Some((colors, index)) = color_list(mesh, source) else { return nothing() };
            let word = |at: usize| {
                let color = index.get(at).and_then(|&value| colors.get(value as usize));
                [color.map_or(0, |color| color_word(*color)), 0]
            };
            Attribute { reading: Reading::Color, words: words(&word), values: None }
        }
        ColorSource::Checker | ColorSource::Picture => {
            let reading = match source {
                ColorSource::Checker => Reading::Checker,
                _ => Reading::Picture,
            };
            let coord = |at: usize| bits_of(texcoord(mesh, at));
            Attribute { reading, words: words(&coord), values: None }
        }
        ColorSource::Materials => Attribute {
            reading: Reading::Materials,
            words: words_of_materials(mesh, drawn),
            values: None,
        },
        ColorSource::Layer(_) | ColorSource::Field(_) => {
            let Some(values) = values_of(mesh, source, domain, spacing) else { return nothing() };
            let [low, high] = values.extent;
            let word = |at: usize| {
                let value = values.values.get(at).copied().unwrap_or(f64::NAN);
                let t = share(value, [low, high]).clamp(-1e6, 1e6) as f32;
                if t.is_nan() { [0, 0] } else { [t.to_bits(), 1f32.to_bits()] }
            };
            let words = words(&word);
            Attribute { reading: Reading::Value, words, values: Some(Arc::new(values)) }
        }
    }
}

/// The texture coordinates of an element; the origin where it has none.
fn texcoord(mesh: &TriMesh, element: usize) -> DVec2 {
    let value = match texcoords_of(mesh) {
        Some(Layer { values: LayerValues::Vec2(coords), index, .. }) => {
            index.get(element).and_then(|&at| coords.get(at as usize))
        }
        _ => None,
    };
    value.copied().unwrap_or_default()
}

fn bits_of(uv: DVec2) -> [u32; 2] {
    [(uv.x as f32).to_bits(), (uv.y as f32).to_bits()]
}

/// A display color with full opacity, as the GPU unpacks it.
fn color_word([r, g, b]: [u8; 3]) -> u32 {
    u32::from_le_bytes([r, g, b, 255])
}

/// Texture coordinates where a face's material has a texture, else the material's color.
fn words_of_materials(mesh: &TriMesh, drawn: &Arrays) -> Vec<[u32; 2]> {
    let textures = FaceTextures::of(mesh);
    let is_by_vertex = texcoords_of(mesh).is_some_and(|layer| layer.domain == Domain::Vertex);
    let (labels, of_faces): (&[String], &[u32]) = match mesh.layer(Layer::MATERIAL) {
        Some(Layer { values: LayerValues::Label(labels), index, .. }) => (labels, index),
        _ => (&[], &[]),
    };
    let colors: Vec<_> = labels.iter().map(|label| diffuse_of(mesh, label)).collect();
    let word = |&corner: &u32| {
        let (face, k) = (corner as usize / 3, corner as usize % 3);
        if textures.of_face(face).is_none() {
            let color = of_faces.get(face).and_then(|&label| *colors.get(label as usize)?);
            return [color_word(color.unwrap_or(UNCOLORED)), 0];
        }
        let element = if is_by_vertex { mesh.faces[face][k].idx() } else { corner as usize };
        bits_of(texcoord(mesh, element))
    };
    drawn.corners.par_iter().map(word).collect()
}

/// The color of a face whose material states none.
const UNCOLORED: [u8; 3] = [189, 189, 184];

/// The colors of a source, and which of them each element has.
fn color_list<'a>(mesh: &'a TriMesh, source: &ColorSource) -> Option<(Vec<[u8; 3]>, &'a [u32])> {
    let layer = match source {
        ColorSource::Labels(name) => mesh.layer(name)?,
        _ => colors_of(mesh)?,
    };
    let colors = match &layer.values {
        LayerValues::Vec3(colors) => colors.iter().map(|&color| bytes_of(color)).collect(),
        _ => colors_of_labels(mesh, layer),
    };
    Some((colors, &layer.index))
}

fn values_of(
    mesh: &TriMesh,
    source: &ColorSource,
    domain: Domain,
    spacing: Spacing,
) -> Option<Values> {
    let (name, unit, mut values) = match source {
        ColorSource::Field(field) => {
            let values = field.values.iter().map(|&value| spacing.of(value)).collect();
            (field.name.clone(), field.unit.clone(), values)
        }
        ColorSource::Layer(name) => {
            let layer = mesh.layer(name)?;
            let LayerValues::Number(numbers) = &layer.values else { return None };
            let number = |&at: &u32| match numbers.get(at as usize) {
                Some(&number) if at != NO_VALUE => spacing.of(number),
                _ => f64::NAN,
            };
            (name.clone(), String::new(), layer.index.iter().map(number).collect::<Vec<_>>())
        }
        _ => return None,
    };
    if domain == Domain::Vertex {
        leave_out_isolated(mesh, &mut values);
    }
    Some(Values::new((name, unit), domain, values, spacing))
}

/// Takes the values from vertices that no face has: nobody sees them.
fn leave_out_isolated(mesh: &TriMesh, values: &mut [f64]) {
    for (value, is_seen) in values.iter_mut().zip(vertices_in_faces(mesh)) {
        if !is_seen {
            *value = f64::NAN;
        }
    }
}

/// How values become colors: what the module `ColorMap` offers, and logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleSettings {
    /// The colors.
    pub scale: Scale,
    /// Value of the first color; `None`: from the data.
    pub low: Option<f64>,
    /// Value of the last color; `None`: from the data.
    pub high: Option<f64>,
    /// How many of the values may lie beyond each end that comes from the data: one of
    /// `CLIP_PERCENTS`.
    pub clip_percent: f64,
    /// Whether a range from the data lies evenly around 0.
    pub is_symmetric: bool,
    /// Values or logarithms.
    pub spacing: Spacing,
    /// What lies outside.
    pub outside: Outside,
    /// Whether the last color comes first.
    pub is_reversed: bool,
}

impl Default for ScaleSettings {
    fn default() -> Self {
        Self {
            scale: Scale::Viridis,
            low: None,
            high: None,
            clip_percent: CLIP_PERCENTS[1],
            is_symmetric: false,
            spacing: Spacing::Linear,
            outside: Outside::Clamp,
            is_reversed: false,
        }
    }
}

impl ScaleSettings {
    /// The same as the module `ColorMap` takes it.
    pub fn options(&self) -> ColorMapOptions {
        ColorMapOptions {
            scale: self.scale,
            low: self.low.map(|low| self.spacing.of(low)).filter(|low| low.is_finite()),
            high: self.high.map(|high| self.spacing.of(high)).filter(|high| high.is_finite()),
            clip: 0.0,
            is_symmetric: self.is_symmetric && self.spacing == Spacing::Linear,
            outside: self.outside,
            is_reversed: self.is_reversed,
        }
    }

    /// The ends of the colors, as the numbers that colors follow. An end that was not given is from
    /// the data without rare extremes; where that leaves nothing beside a given one, it is the
    /// extreme itself, and where that leaves nothing either, it lies as far away as the values
    /// reach, so that they have the color of the given end. Given ends of which the low one is not
    /// below the other are passed over.
    pub fn range<'a>(&self, all: impl IntoIterator<Item = &'a Values>) -> [f64; 2] {
        let all: Vec<&Values> = all.into_iter().collect();
        let clip = CLIP_PERCENTS.iter().position(|percent| *percent == self.clip_percent);
        let ends =
            |clip: usize| -> Vec<f64> { all.iter().flat_map(|one| one.clipped[clip]).collect() };
        let clipped = ends(clip.unwrap_or(0));
        let options = self.options();
        let of_data = ColorMapOptions { low: None, high: None, ..options };
        let given = match (options.low, options.high) {
            (Some(_), None) | (None, Some(_)) => options.low.or(options.high),
            _ => None,
        };
        let Some(given) = given else {
            let range = range_of(&clipped, &options).or_else(|_| range_of(&clipped, &of_data));
            return range.unwrap_or([0.0, 1.0]);
        };
        let extremes = ends(0);
        let ranges = [&clipped, &extremes].map(|ends| range_of(ends, &options).ok());
        let is_some_length = |[low, high]: &[f64; 2]| low < high;
        ranges.into_iter().flatten().find(is_some_length).unwrap_or_else(|| {
            let [low, high] = extent_of(&extremes);
            let length = if low < high { high - low } else { 1.0 };
            // So long that the ends differ, so short that both are numbers.
            let length = length.max(1e-6 * given.abs()).min(f64::MAX / 4.0);
            match options.low {
                Some(_) => [given, (given + length).min(f64::MAX)],
                None => [(given - length).max(-f64::MAX), given],
            }
        })
    }

    /// Factor and offset from a value as the GPU has it to its place in the table, 0 to 1.
    pub fn place_of_share(&self, extent: [f64; 2], range: [f64; 2]) -> [f32; 2] {
        let length = 0.5 * range[1] - 0.5 * range[0];
        if length <= 0.0 {
            return [0.0, self.options().share_without_length() as f32];
        }
        let factor = (0.5 * extent[1] - 0.5 * extent[0]) / length;
        [factor as f32, share(extent[0], range) as f32]
    }

    /// The colors from the first to the last in equal steps, as bytes with full opacity.
    pub fn table(&self) -> Vec<[u8; 4]> {
        let map = ColorMap::new([0.0, 1.0], &self.options());
        let last = (TABLE_LENGTH - 1) as f64;
        let color = |i: usize| {
            let [r, g, b] = bytes_of(map.color(i as f64 / last));
            [r, g, b, 255]
        };
        (0..TABLE_LENGTH).map(color).collect()
    }
}

/// Colors in a table: so many that neighbors hardly differ.
pub const TABLE_LENGTH: usize = 1024;

#[cfg(test)]
#[path = "coloring_tests.rs"]
mod tests;
