//! From what is seen at each pixel to bytes: light, colors, and one rounding.
//!
//! Shading is deferred: only what is seen is lit. The light is a number from 0 to 1, the cosine
//! between the surface's normal and the rays of the light; the byte of a pixel is that number times
//! the surface's color (white: 1), times 255, rounded to the nearest whole number, once. The gray
//! of a color is its luminance by the NTSC weights. Nothing is gamma-corrected; see `luminance`.
//!
//! `Flat` gives a face one light, `Unlit` every face a light of 1. `Gouraud` lights the corners and
//! interpolates between them (H. Gouraud, "Continuous shading of curved surfaces", IEEE
//! Transactions on Computers C-20(6), 1971), in space rather than in the picture as he does: the
//! three weights of a pixel are the volumes that its ray spans with the edges of the face, as seen
//! from the eye. This holds for faces that are cut at the border of the picture too, needs no
//! division by depth, and a pixel whose center misses the face by the rounding of the grid takes
//! the nearest color, as weights are kept from being negative.

use glam::{DVec2, DVec3};
use mve_core::{Cancelled, Control};

use super::luminance::{NTSC, cosine, normal, to_byte};
use super::project::{Corner, Lens};
use super::raster::{FaceSide, Sides};
use super::visible::{NO_FACE, Visible, side_seen};
use crate::data::{Domain, FaceId, Image, Layer, LayerValues, PixelKind, TriMesh};
use crate::geometry::surface::normals::{NormalWeight, vertex_normals};

/// How a surface is lit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Shading {
    /// One luminance a face, by the face's own normal.
    #[default]
    Flat,
    /// Luminance at the corners, by normals there, and interpolated.
    Gouraud,
    /// No light: colors as they are, to be read by a color bar.
    Unlit,
}

/// Where the normals of `Gouraud` come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NormalSource {
    /// Vertex normals from the faces, each weighted by its area: no angle, so that no library's arc
    /// tangent enters a picture.
    #[default]
    Faces,
    /// The layer [`Layer::NORMAL`], over vertices or corners; as `Faces` where there is none.
    Layer,
}

/// What colors a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Paint<'a> {
    /// White everywhere.
    #[default]
    White,
    /// The layer [`Layer::COLOR`], over vertices, corners or faces; white where there is none.
    Layer,
    /// A picture, by the layer [`Layer::TEXCOORD`], interpolated between its pixels and repeated
    /// beyond its sides; white where there are no coordinates.
    Texture(&'a Image),
}

/// Values at the corners of faces.
struct Attribute<'a, T> {
    domain: Domain,
    index: &'a [u32],
    values: &'a [T],
}

impl<'a, T: Copy> Attribute<'a, T> {
    /// A layer of the mesh, if its values are of this kind.
    fn of(
        mesh: &'a TriMesh,
        name: &str,
        values: impl Fn(&'a LayerValues) -> Option<&'a [T]>,
    ) -> Option<Self> {
        let layer = mesh.layer(name)?;
        Some(Self { domain: layer.domain, index: &layer.index, values: values(&layer.values)? })
    }

    /// The value at a corner of a face. [`crate::data::NO_VALUE`] is beyond all values.
    #[inline]
    fn at(&self, mesh: &TriMesh, face: usize, corner: usize) -> Option<T> {
        let element = match self.domain {
            Domain::Vertex => mesh.faces[face][corner].idx(),
            Domain::Corner => 3 * face + corner,
            Domain::Face => face,
        };
        self.values.get(*self.index.get(element)? as usize).copied()
    }
}

fn vec3(values: &LayerValues) -> Option<&[DVec3]> {
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

/// Normals at the corners.
enum Normals<'a> {
    Vertices(Vec<DVec3>),
    Layer(Attribute<'a, DVec3>),
}

/// Colors at the corners.
enum Colors<'a> {
    White,
    Layer(Attribute<'a, DVec3>),
    Texture(Attribute<'a, DVec2>, &'a Image),
}

/// A mesh with all that its pictures have in common.
pub struct Surface<'a> {
    mesh: &'a TriMesh,
    /// `None` where each face has one light.
    normals: Option<Normals<'a>>,
    colors: Colors<'a>,
    is_lit: bool,
}

/// What the pixels of one face have in common.
struct Facet {
    face: u32,
    /// The weight of each corner for a ray is the product of the ray with these.
    across: [DVec3; 3],
    lights: [f64; 3],
    colors: [DVec3; 3],
    texcoords: Option<[DVec2; 3]>,
}

impl<'a> Surface<'a> {
    /// Prepares a mesh.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn new(
        mesh: &'a TriMesh,
        shading: Shading,
        source: NormalSource,
        paint: Paint<'a>,
        control: Control,
    ) -> Result<Self, Cancelled> {
        let layer = || Attribute::of(mesh, Layer::NORMAL, vec3);
        let normals = match (shading, source) {
            (Shading::Flat | Shading::Unlit, _) => None,
            (Shading::Gouraud, NormalSource::Layer) => layer().map(Normals::Layer),
            (Shading::Gouraud, NormalSource::Faces) => None,
        };
        let normals = match normals {
            None if shading == Shading::Gouraud => {
                Some(Normals::Vertices(vertex_normals(mesh, NormalWeight::Area, control)?))
            }
            other => other,
        };
        let colors = match paint {
            Paint::White => None,
            Paint::Layer => Attribute::of(mesh, Layer::COLOR, vec3).map(Colors::Layer),
            Paint::Texture(image) if image.width == 0 || image.height == 0 => None,
            Paint::Texture(image) => Attribute::of(mesh, Layer::TEXCOORD, vec2)
                .map(|texcoords| Colors::Texture(texcoords, image)),
        };
        let is_lit = shading != Shading::Unlit;
        Ok(Self { mesh, normals, colors: colors.unwrap_or(Colors::White), is_lit })
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a TriMesh {
        self.mesh
    }

    /// Whether it has colors other than white.
    pub fn is_colored(&self) -> bool {
        !matches!(self.colors, Colors::White)
    }

    /// Lights what is seen: a picture named `name`, gray or in color, `background` where no face
    /// is. `placed` are the corners of the vertices.
    ///
    /// # Errors
    /// [`Cancelled`] when `check`, called every few rows, says so.
    pub fn light(
        &self,
        seen: &Visible,
        (lens, placed, sides): (&Lens, &[Corner], Sides),
        (name, kind, background): (&str, PixelKind, u8),
        check: impl Fn() -> Result<(), Cancelled>,
    ) -> Result<Image, Cancelled> {
        let size = [seen.size, seen.size];
        let mut image = Image::filled(name, size, kind, background);
        if seen.size == 0 {
            return Ok(image);
        }
        let rows = seen.faces.chunks_exact(seen.size);
        let mut facet = Facet::NONE;
        let n_bytes = kind.n_bytes();
        for (y, (faces, bytes)) in
            rows.zip(image.bytes.chunks_exact_mut(seen.size * n_bytes)).enumerate()
        {
            if y % 16 == 0 {
                check()?;
            }
            for (x, (&face, out)) in faces.iter().zip(bytes.chunks_exact_mut(n_bytes)).enumerate() {
                if face == NO_FACE {
                    continue;
                }
                if face != facet.face {
                    facet = self.facet(face, lens, placed, sides);
                }
                self.pixel(&facet, || lens.ray([x, y]), out);
            }
        }
        Ok(image)
    }

    /// What the pixels of a face have in common.
    fn facet(&self, face: u32, lens: &Lens, placed: &[Corner], sides: Sides) -> Facet {
        let id = FaceId(face);
        let points = self.mesh.corners(id);
        let side = match sides {
            Sides::Front => FaceSide::Front,
            Sides::Both => {
                side_seen(lens, self.mesh.faces[id.idx()].map(|v| placed[v.idx()]), points)
            }
        };
        let own = normal(points);
        let mut facet = Facet { face, ..Facet::NONE };
        let Some(normals) = &self.normals else {
            facet.lights = [if self.is_lit { lit(own, lens, side) } else { 1.0 }; 3];
            if self.is_colored() {
                self.color(&mut facet, lens.camera.eye, points);
            }
            return facet;
        };
        for (corner, light) in facet.lights.iter_mut().enumerate() {
            let found = match normals {
                Normals::Vertices(normals) => {
                    normals.get(self.mesh.faces[id.idx()][corner].idx()).copied()
                }
                Normals::Layer(layer) => layer.at(self.mesh, id.idx(), corner),
            };
            // A corner without a normal takes that of its face.
            let is_normal = |n: &DVec3| n.is_finite() && *n != DVec3::ZERO;
            *light = lit(found.filter(is_normal).unwrap_or(own), lens, side);
        }
        self.color(&mut facet, lens.camera.eye, points);
        facet
    }

    /// Adds the weights and colors to a facet.
    fn color(&self, facet: &mut Facet, eye: DVec3, points: [DVec3; 3]) {
        let (a, b, c) = (points[0] - eye, points[1] - eye, points[2] - eye);
        facet.across = [b.cross(c), c.cross(a), a.cross(b)];
        let face = facet.face as usize;
        match &self.colors {
            Colors::White => {}
            Colors::Layer(layer) => {
                let color = |corner| layer.at(self.mesh, face, corner).unwrap_or(DVec3::ONE);
                facet.colors = [0, 1, 2].map(color);
            }
            Colors::Texture(layer, _) => {
                let [a, b, c] = [0, 1, 2].map(|corner| layer.at(self.mesh, face, corner));
                facet.texcoords = a.zip(b).zip(c).map(|((a, b), c)| [a, b, c]);
            }
        }
    }

    /// The bytes of a pixel.
    #[inline(always)]
    fn pixel(&self, facet: &Facet, ray: impl FnOnce() -> DVec3, out: &mut [u8]) {
        let is_flat = self.normals.is_none();
        if is_flat && !self.is_colored() {
            out.fill(to_byte(facet.lights[0]));
            return;
        }
        let [u, v, w] = facet.weights(ray());
        let [l, m, n] = facet.lights;
        let light = if is_flat { l } else { u * l + v * m + w * n };
        let color = match (&self.colors, facet.texcoords) {
            (Colors::White, _) => return out.fill(to_byte(light)),
            (Colors::Texture(_, image), Some([a, b, c])) => texel(image, u * a + v * b + w * c),
            _ => {
                let [a, b, c] = facet.colors;
                u * a + v * b + w * c
            }
        };
        match out {
            [red, green, blue] => {
                (*red, *green, *blue) =
                    (to_byte(light * color.x), to_byte(light * color.y), to_byte(light * color.z));
            }
            _ => out.fill(to_byte(light * NTSC.dot(color))),
        }
    }
}

/// The light on a surface with this normal, 0 to 1.
#[inline]
fn lit(normal: DVec3, lens: &Lens, side: FaceSide) -> f64 {
    cosine(normal, lens.camera.forward, side).clamp(0.0, 1.0)
}

impl Facet {
    const NONE: Self = Self {
        face: NO_FACE,
        across: [DVec3::ZERO; 3],
        lights: [0.0; 3],
        colors: [DVec3::ONE; 3],
        texcoords: None,
    };

    /// How much of each corner is where a ray meets the face, or next to it; they add up to 1.
    #[inline]
    fn weights(&self, ray: DVec3) -> [f64; 3] {
        let [u, v, w] = &self.across;
        let (u, v, w) = (u.dot(ray), v.dot(ray), w.dot(ray));
        // A face that is seen from behind has all three negative.
        let sign = if u + v + w < 0.0 { -1.0 } else { 1.0 };
        let (u, v, w) = ((sign * u).max(0.0), (sign * v).max(0.0), (sign * w).max(0.0));
        let sum = u + v + w;
        if sum > 0.0 && sum.is_finite() { [u / sum, v / sum, w / sum] } else { [1.0 / 3.0; 3] }
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
#[path = "shade_tests.rs"]
mod tests;
