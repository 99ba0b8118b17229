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

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{FaceId, Image, Layer, PixelKind, TriMesh};

use super::albedo::{Albedo, Attribute, FaceColor, MeshColors, vec3};
use super::facet::Facet;
use super::luminance::{cosine, gray, normal, to_byte};
use super::project::{Corner, Lens};
use super::raster::{FaceSide, Sides};
use super::visible::{NO_FACE, Visible, side_seen};
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

/// Normals at the corners.
enum Normals<'a> {
    Vertices(Vec<DVec3>),
    Layer(Attribute<'a, DVec3>),
}

/// A mesh with all that its pictures have in common.
pub struct Surface<'a> {
    mesh: &'a TriMesh,
    /// `None` where each face has one light.
    normals: Option<Normals<'a>>,
    /// `None` where all is white.
    colors: Option<MeshColors<'a>>,
    is_lit: bool,
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
        albedo: Albedo,
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
        let is_lit = shading != Shading::Unlit;
        Ok(Self { mesh, normals, colors: MeshColors::of(mesh, albedo), is_lit })
    }

    /// The same with one picture on all faces, by the layer [`Layer::TEXCOORD`]; white where that
    /// is not there.
    pub fn painted(self, picture: &'a Image) -> Self {
        Self { colors: MeshColors::of_picture(self.mesh, picture), ..self }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a TriMesh {
        self.mesh
    }

    /// Whether it has colors other than white.
    pub fn is_colored(&self) -> bool {
        self.colors.is_some()
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
        let (mut shown, mut facet) = (NO_FACE, Facet::NONE);
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
                if face != shown {
                    (shown, facet) = (face, self.facet(FaceId(face), lens, placed, sides));
                }
                self.pixel(&facet, || lens.ray([x, y]), out);
            }
        }
        Ok(image)
    }

    /// What the pixels of a face have in common.
    fn facet(&self, face: FaceId, lens: &Lens, placed: &[Corner], sides: Sides) -> Facet {
        let points = self.mesh.corners(face);
        let vertices = self.mesh.faces[face.idx()];
        let side = match sides {
            Sides::Front => FaceSide::Front,
            Sides::Both => side_seen(lens, vertices.map(|v| placed[v.idx()]), points),
        };
        let own = normal(points);
        let lights = match &self.normals {
            None => [if self.is_lit { light(own, lens, side) } else { 1.0 }; 3],
            Some(normals) => [0, 1, 2].map(|corner| {
                let found = match normals {
                    Normals::Vertices(normals) => normals.get(vertices[corner].idx()).copied(),
                    Normals::Layer(layer) => layer.at(self.mesh, face, corner),
                };
                // A corner without a normal takes that of its face.
                let is_normal = |n: &DVec3| n.is_finite() && *n != DVec3::ZERO;
                light(found.filter(is_normal).unwrap_or(own), lens, side)
            }),
        };
        match &self.colors {
            None if self.normals.is_none() => Facet::flat(lights),
            None => Facet::new(lens.camera.eye, points, lights, FaceColor::WHITE),
            Some(colors) => {
                let color = colors.of_face(self.mesh, face);
                Facet::new(lens.camera.eye, points, lights, color)
            }
        }
    }

    /// The bytes of a pixel.
    #[inline(always)]
    fn pixel(&self, facet: &Facet, ray: impl FnOnce() -> DVec3, out: &mut [u8]) {
        let is_flat = self.normals.is_none();
        let [l, m, n] = facet.lights;
        if is_flat && self.colors.is_none() {
            out.fill(to_byte(l));
            return;
        }
        let [u, v, w] = facet.weights(ray());
        let light = if is_flat { l } else { u * l + v * m + w * n };
        let Some(colors) = &self.colors else { return out.fill(to_byte(light)) };
        let color = colors.at(&facet.color, [u, v, w]);
        match out {
            [red, green, blue] => {
                (*red, *green, *blue) =
                    (to_byte(light * color.x), to_byte(light * color.y), to_byte(light * color.z));
            }
            _ => out.fill(gray(light, color)),
        }
    }
}

/// The light on a surface with this normal, 0 to 1.
#[inline]
pub fn light(normal: DVec3, lens: &Lens, side: FaceSide) -> f64 {
    cosine(normal, lens.camera.forward, side).clamp(0.0, 1.0)
}

#[cfg(test)]
#[path = "shade_tests.rs"]
mod tests;
