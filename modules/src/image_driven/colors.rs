//! The colors of faces as they are and as a collapse would make them, and what a camera sees of
//! them.
//!
//! Pictures are of luminance here, too: P. Lindstrom and G. Turk compare the luminance of textured
//! surfaces. The attributes after a collapse are those that the engine would give the merged
//! vertex, to the last bit, and a pixel is what [`Surface`](crate::picture::render::Surface) makes
//! it.

use std::sync::Arc;

use mve_mesh::data::{FaceId, Layer, LayerValues, TextureImage, TriMesh};

use super::change::PatchFace;
use crate::geometry::simplify::collapse::{AttributeValue, LayerId, Proposal, WorkingMesh};
use crate::picture::render::{
    Albedo, ColorSources, FaceColor, FaceSide, Facet, LANES, Lens, gray, is_colored, light,
    luminance, textures,
};

/// The colors of a mesh, while it is simplified.
#[derive(Debug)]
pub(super) struct Colors {
    sources: ColorSources,
    textures: Vec<Option<Arc<TextureImage>>>,
    texcoords: Option<LayerId>,
    colors: Option<LayerId>,
}

impl Colors {
    /// `None` where all is white.
    pub fn of(mesh: &TriMesh, albedo: Albedo) -> Option<Self> {
        let layer = |name: &str, fits: fn(&LayerValues) -> bool| {
            let is_it = |layer: &&Layer| layer.name == name && fits(&layer.values);
            let at = mesh.layers.iter().position(|layer| is_it(&layer))?;
            Some(LayerId(at as u32))
        };
        is_colored(mesh, albedo).then(|| Self {
            sources: ColorSources::of(mesh, albedo),
            textures: textures(mesh).into_iter().map(|image| image.cloned()).collect(),
            texcoords: layer(Layer::TEXCOORD, |values| matches!(values, LayerValues::Vec2(_))),
            colors: layer(Layer::COLOR, |values| matches!(values, LayerValues::Vec3(_))),
        })
    }

    /// The color of a face of the mesh as it is.
    pub fn of_face(&self, mesh: &WorkingMesh, face: FaceId) -> FaceColor {
        let value = |k, layer: Option<LayerId>| mesh.corner_value(face, k, layer?);
        let texcoord = |k| value(k, self.texcoords).map(|value| value.truncate());
        self.sources.color(mesh.input_face(face), texcoord, |k| value(k, self.colors))
    }

    /// The colors that faces would have if a proposal were made, with the attribute values that
    /// come with it.
    pub fn proposed(
        &self,
        mesh: &WorkingMesh,
        Proposal { contraction, position, .. }: &Proposal,
        given: &[AttributeValue],
        faces: &[PatchFace],
    ) -> Vec<FaceColor> {
        let merging = |layer: Option<LayerId>| {
            layer.map(|layer| (layer, mesh.merging(layer, contraction, *position, given)))
        };
        let (texcoords, colors) = (merging(self.texcoords), merging(self.colors));
        let color = |face: &PatchFace| {
            let face = FaceId(face.face);
            let texcoord = |k| {
                let (layer, merging) = texcoords.as_ref()?;
                let value = mesh.corner_value_after(face, k, *layer, contraction, merging)?;
                Some(value.truncate())
            };
            let color = |k| {
                let (layer, merging) = colors.as_ref()?;
                mesh.corner_value_after(face, k, *layer, contraction, merging)
            };
            self.sources.color(mesh.input_face(face), texcoord, color)
        };
        faces.iter().map(color).collect()
    }
}

/// The luminance of the pixels of a face.
pub(super) trait Values: Copy {
    /// Of one pixel.
    fn of_pixel(&self, x: i32, y: i32) -> u8;

    /// Of a row of pixels from `x` on, a byte each, the first the lowest; those without a bit in
    /// `asked` do not matter.
    fn of_lanes(&self, x: i32, y: i32, asked: u32) -> u64;
}

/// One luminance for all.
impl Values for u8 {
    #[inline(always)]
    fn of_pixel(&self, _: i32, _: i32) -> u8 {
        *self
    }

    #[inline(always)]
    fn of_lanes(&self, _: i32, _: i32, _: u32) -> u64 {
        u64::from_le_bytes([*self; LANES])
    }
}

/// How a camera sees faces: whether light falls on them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shader {
    pub lens: Lens,
    pub is_lit: bool,
}

impl Shader {
    /// The luminance of a white face.
    #[inline(always)]
    pub fn white(&self, face: &PatchFace, side: FaceSide) -> u8 {
        if self.is_lit { luminance(face.normal, self.lens.camera.forward, side) } else { u8::MAX }
    }

    /// The luminance of a face of this color.
    pub fn colored<'a>(
        &'a self,
        face: &PatchFace,
        side: FaceSide,
        color: FaceColor,
        colors: &'a Colors,
    ) -> Colored<'a> {
        let light = if self.is_lit { light(face.normal, &self.lens, side) } else { 1.0 };
        let facet = Facet::new(self.lens.camera.eye, face.points, [light; 3], color);
        Colored { facet, lens: &self.lens, colors }
    }
}

/// A face whose luminance is another one at each pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colored<'a> {
    facet: Facet,
    lens: &'a Lens,
    colors: &'a Colors,
}

impl Values for Colored<'_> {
    fn of_pixel(&self, x: i32, y: i32) -> u8 {
        let weights = self.facet.weights(self.lens.ray([x as usize, y as usize]));
        let picture = |number: u32| self.colors.textures.get(number as usize)?.as_ref()?.pixels();
        gray(self.facet.lights[0], self.facet.color.at(weights, picture))
    }

    fn of_lanes(&self, x: i32, y: i32, asked: u32) -> u64 {
        let byte = |lane: usize| match asked >> lane & 1 {
            0 => 0,
            _ => self.of_pixel(x + lane as i32, y),
        };
        u64::from_le_bytes(std::array::from_fn(byte))
    }
}
