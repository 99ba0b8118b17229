//! What colors a surface, before light falls on it.
//!
//! A face is of one color, takes it from its corners, or from a picture by the texture coordinates
//! of its corners. Colors are display values as in a file, 0 to 1, and are interpolated as such.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use mve_mesh::data::{
    Domain, FaceId, FaceMaterials, Image, Layer, LayerValues, Material, TextureImage, TextureRole,
    TriMesh,
};

/// What colors a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Albedo {
    /// White everywhere.
    #[default]
    White,
    /// The layer [`Layer::COLOR`], over vertices, corners or faces; white where there is none.
    Colors,
    /// The base color of each face's material: its texture by the layer [`Layer::TEXCOORD`], else
    /// its diffuse color. Faces without either are as in [`Albedo::Colors`].
    Textures,
}

/// Where the color of a face comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum ColorSource {
    /// The layer [`Layer::COLOR`].
    #[default]
    Layer,
    /// One color.
    Plain(DVec3),
    /// The picture of this number.
    Picture(u32),
}

/// The color of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceColor {
    /// The same everywhere.
    Plain(DVec3),
    /// Those at its corners, interpolated between them.
    Corners([DVec3; 3]),
    /// That of the picture of this number, interpolated between its pixels and repeated beyond its
    /// sides, at the texture coordinates of the corners.
    Picture(u32, [DVec2; 3]),
}

impl FaceColor {
    /// White.
    pub const WHITE: Self = Self::Plain(DVec3::ONE);

    /// The color where there is so much of each corner.
    #[inline]
    pub fn at<'a>(&self, [u, v, w]: [f64; 3], picture: impl Fn(u32) -> Option<&'a Image>) -> DVec3 {
        match *self {
            Self::Plain(color) => color,
            Self::Corners([a, b, c]) => u * a + v * b + w * c,
            Self::Picture(number, [a, b, c]) => {
                picture(number).map_or(DVec3::ONE, |image| texel(image, u * a + v * b + w * c))
            }
        }
    }
}

/// Where the color of each face comes from.
#[derive(Clone, Debug, Default)]
pub struct ColorSources {
    /// For the faces of each material, by the place of its name.
    of_labels: Vec<ColorSource>,
    /// For each face the place of its material's name.
    of_faces: Vec<u32>,
    /// For all others.
    others: ColorSource,
}

impl ColorSources {
    /// Looks at the materials if they count.
    pub fn of(mesh: &TriMesh, albedo: Albedo) -> Self {
        match albedo {
            Albedo::White => Self { others: ColorSource::Plain(DVec3::ONE), ..Self::default() },
            Albedo::Colors => Self::default(),
            Albedo::Textures => {
                let materials = FaceMaterials::of(mesh);
                let source = |(number, material): (u32, &Option<&Material>)| {
                    let Some(material) = material else { return ColorSource::Layer };
                    match (texture(material), material.diffuse()) {
                        (Some(_), _) => ColorSource::Picture(number),
                        (None, Some(color)) => ColorSource::Plain(color),
                        (None, None) => ColorSource::Layer,
                    }
                };
                let of_labels = (0..).zip(&materials.of_labels).map(source).collect();
                Self { of_labels, of_faces: materials.of_faces.to_vec(), ..Self::default() }
            }
        }
    }

    /// Whether any face of a material takes its color from there.
    fn has_materials(&self) -> bool {
        self.of_labels.iter().any(|source| *source != ColorSource::Layer)
    }

    /// The color of a face, from what the layers of texture coordinates and of colors have at its
    /// corners.
    #[inline]
    pub fn color(
        &self,
        face: FaceId,
        texcoord: impl Fn(usize) -> Option<DVec2>,
        color: impl Fn(usize) -> Option<DVec3>,
    ) -> FaceColor {
        let label = self.of_faces.get(face.idx()).copied();
        let source = label.and_then(|label| self.of_labels.get(label as usize).copied());
        let by_corners = || FaceColor::Corners([0, 1, 2].map(|k| color(k).unwrap_or(DVec3::ONE)));
        match source.unwrap_or(self.others) {
            ColorSource::Plain(color) => FaceColor::Plain(color),
            ColorSource::Layer => by_corners(),
            ColorSource::Picture(number) => {
                let [a, b, c] = [0, 1, 2].map(texcoord);
                let all = a.zip(b).zip(c).map(|((a, b), c)| [a, b, c]);
                all.map_or_else(by_corners, |all| FaceColor::Picture(number, all))
            }
        }
    }
}

/// The picture of a material's base color.
fn texture(material: &Material) -> Option<&Arc<TextureImage>> {
    let image = material.texture(TextureRole::BaseColor)?.image.as_ref()?;
    image.pixels().filter(|pixels| has_pixels(pixels)).map(|_| image)
}

fn has_pixels(image: &Image) -> bool {
    image.width > 0 && image.height > 0
}

/// Whether a surface has colors other than white.
pub fn is_colored(mesh: &TriMesh, albedo: Albedo) -> bool {
    MeshColors::of(mesh, albedo).is_some()
}

/// The pictures that [`FaceColor::Picture`] names with [`Albedo::Textures`].
pub fn textures(mesh: &TriMesh) -> Vec<Option<&Arc<TextureImage>>> {
    let materials = FaceMaterials::of(mesh).of_labels;
    materials.into_iter().map(|material| texture(material?)).collect()
}

/// Values at the corners of faces.
pub(super) struct Attribute<'a, T> {
    domain: Domain,
    index: &'a [u32],
    values: &'a [T],
}

impl<'a, T: Copy> Attribute<'a, T> {
    /// A layer of the mesh, if its values are of this kind.
    pub fn of(
        mesh: &'a TriMesh,
        name: &str,
        values: impl Fn(&'a LayerValues) -> Option<&'a [T]>,
    ) -> Option<Self> {
        let layer = mesh.layer(name)?;
        Some(Self { domain: layer.domain, index: &layer.index, values: values(&layer.values)? })
    }

    /// The value at a corner of a face. [`mve_mesh::data::NO_VALUE`] is beyond all values.
    #[inline]
    pub fn at(&self, mesh: &TriMesh, face: FaceId, corner: usize) -> Option<T> {
        let element = match self.domain {
            Domain::Vertex => mesh.faces[face.idx()][corner].idx(),
            Domain::Corner => 3 * face.idx() + corner,
            Domain::Face => face.idx(),
        };
        self.values.get(*self.index.get(element)? as usize).copied()
    }
}

pub(super) fn vec3(values: &LayerValues) -> Option<&[DVec3]> {
    match values {
        LayerValues::Vec3(values) => Some(values),
        _ => None,
    }
}

fn vec2(values: &LayerValues) -> Option<&[DVec2]> {
    match values {
        LayerValues::Vec2(values) => Some(values),
        _ => None,
    }
}

/// The layer of texture coordinates.
fn texcoords(mesh: &TriMesh) -> Option<Attribute<'_, DVec2>> {
    Attribute::of(mesh, Layer::TEXCOORD, vec2)
}

/// The colors of a mesh.
pub(super) struct MeshColors<'a> {
    sources: ColorSources,
    pictures: Vec<Option<&'a Image>>,
    texcoords: Option<Attribute<'a, DVec2>>,
    colors: Option<Attribute<'a, DVec3>>,
}

impl<'a> MeshColors<'a> {
    /// `None` where all is white.
    pub fn of(mesh: &'a TriMesh, albedo: Albedo) -> Option<Self> {
        let colors = || Attribute::of(mesh, Layer::COLOR, vec3);
        let (pictures, texcoords, colors) = match albedo {
            Albedo::White => return None,
            Albedo::Colors => (Vec::new(), None, Some(colors()?)),
            Albedo::Textures => {
                let pixels = |image: Option<&'a Arc<TextureImage>>| image?.pixels();
                (textures(mesh).into_iter().map(pixels).collect(), texcoords(mesh), colors())
            }
        };
        let sources = ColorSources::of(mesh, albedo);
        let is_colored = colors.is_some() || sources.has_materials();
        is_colored.then_some(Self { sources, pictures, texcoords, colors })
    }

    /// One picture on all faces, by the layer [`Layer::TEXCOORD`]; `None` where that is not there
    /// or the picture has no pixels.
    pub fn of_picture(mesh: &'a TriMesh, image: &'a Image) -> Option<Self> {
        let texcoords = Some(texcoords(mesh).filter(|_| has_pixels(image))?);
        let sources = ColorSources { others: ColorSource::Picture(0), ..ColorSources::default() };
        Some(Self { sources, pictures: vec![Some(image)], texcoords, colors: None })
    }

    /// The color of a face.
    pub fn of_face(&self, mesh: &TriMesh, face: FaceId) -> FaceColor {
        let texcoord = |k| self.texcoords.as_ref()?.at(mesh, face, k);
        let color = |k| self.colors.as_ref()?.at(mesh, face, k);
        self.sources.color(face, texcoord, color)
    }

    /// A color where there is so much of each corner.
    #[inline]
    pub fn at(&self, color: &FaceColor, weights: [f64; 3]) -> DVec3 {
        color.at(weights, |number| *self.pictures.get(number as usize)?)
    }
}

/// The color of a picture at a texture coordinate, its origin at the lower left: bilinear between
/// the centers of four pixels, repeated beyond the sides. White where the coordinate is no number.
fn texel(image: &Image, at: DVec2) -> DVec3 {
    let size = DVec2::new(image.width as f64, image.height as f64);
    let place = (at - at.floor()) * size;
    if !place.is_finite() {
        return DVec3::ONE;
    }
    // From the center of the first pixel, rows from the top.
    let place = DVec2::new(place.x - 0.5, size.y - place.y - 0.5);
    let low = place.floor();
    let part = place - low;
    let wrap = |at: f64, n: usize| (at as i64).rem_euclid(n as i64) as usize;
    let [x0, x1] = [low.x, low.x + 1.0].map(|x| wrap(x, image.width));
    let [y0, y1] = [low.y, low.y + 1.0].map(|y| wrap(y, image.height));
    let color = |x, y| match *image.pixel(x, y) {
        [red, green, blue] => DVec3::new(red.into(), green.into(), blue.into()),
        [gray, ..] => DVec3::splat(gray.into()),
        [] => DVec3::ZERO,
    };
    let mix = |a: DVec3, b: DVec3, part: f64| a * (1.0 - part) + b * part;
    let upper = mix(color(x0, y0), color(x1, y0), part.x);
    let lower = mix(color(x0, y1), color(x1, y1), part.x);
    mix(upper, lower, part.y) / 255.0
}

#[cfg(test)]
#[path = "albedo_tests.rs"]
mod tests;
