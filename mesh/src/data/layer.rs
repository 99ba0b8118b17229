//! Attribute layers: values beside a mesh's positions, each layer with an index of its own.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// The index of an element that carries no value, such as a corner without a texture coordinate.
pub const NO_VALUE: u32 = u32::MAX;

/// What the elements of a layer are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Domain {
    /// One element a vertex.
    Vertex,
    /// One element a corner: corner `k` of face `f` is element `3 f + k`. A vertex whose corners
    /// name different values lies on a seam; the groups of its corners that share a value are its
    /// wedges (Hoppe 1998).
    Corner,
    /// One element a face.
    Face,
}

/// The values of a layer, by kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum LayerValues {
    /// One number each: a scalar field.
    Number(Vec<f64>),
    /// Two numbers each: texture coordinates.
    Vec2(Vec<DVec2>),
    /// Three numbers each: normals (unit length) or colors (red, green, blue in 0 to 1).
    Vec3(Vec<DVec3>),
    /// A name each: materials, groups. Bytes that are not UTF-8 are kept in it
    /// ([`name_from_bytes`](super::name_from_bytes)).
    Label(Vec<String>),
}

impl LayerValues {
    /// How many values there are.
    #[inline]
    pub fn len(&self) -> usize {
        match self {
            Self::Number(v) => v.len(),
            Self::Vec2(v) => v.len(),
            Self::Vec3(v) => v.len(),
            Self::Label(v) => v.len(),
        }
    }

    /// Whether there is no value.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A named set of values over one domain of a mesh.
///
/// `index` holds one entry an element of the domain (vertices, 3 × faces, or faces), each an
/// index into `values` or [`NO_VALUE`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Unique in its mesh; see the constants for the names that modules agree on.
    pub name: String,
    /// What the elements are.
    pub domain: Domain,
    /// The values, shared by the elements that name them.
    pub values: LayerValues,
    /// Which value each element has.
    pub index: Vec<u32>,
}

impl Layer {
    /// Normals, `Vec3`, vertex or corner domain.
    pub const NORMAL: &str = "normal";
    /// Texture coordinates, `Vec2`, corner domain, origin at the lower left.
    pub const TEXCOORD: &str = "texcoord";
    /// Display colors (as in an sRGB file), `Vec3` in 0 to 1; files have them over vertices,
    /// `ColorMap` over any domain.
    pub const COLOR: &str = "color";
    /// Name of the material, `Label`, face domain.
    pub const MATERIAL: &str = "material";
    /// Name of the group, `Label`, face domain.
    pub const GROUP: &str = "group";
    /// Name of the object, `Label`, face domain.
    pub const OBJECT: &str = "object";
    /// Name of the smoothing group, `Label`, face domain; faces without one are flat.
    pub const SMOOTHING: &str = "smoothing";

    /// Bytes that the layer holds on the heap.
    pub fn byte_size(&self) -> usize {
        let values = match &self.values {
            LayerValues::Number(v) => size_of_val(v.as_slice()),
            LayerValues::Vec2(v) => size_of_val(v.as_slice()),
            LayerValues::Vec3(v) => size_of_val(v.as_slice()),
            LayerValues::Label(v) => v.iter().map(|s| size_of::<String>() + s.len()).sum(),
        };
        values + size_of_val(self.index.as_slice())
    }
}
