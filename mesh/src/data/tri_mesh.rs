//! The triangle mesh: positions, faces, attribute layers and materials.
//!
//! Any list of triangles is a mesh here: open, non-manifold, degenerate and in several components.
//! Only two things hold for every [`TriMesh`] that a loader or a module puts out, and
//! [`TriMesh::check`] tests them: indices are in range, and layers fit their domain. Coordinates
//! are finite when they come from a loader; no algorithm panics on other numbers.

use glam::DVec3;
use mve_core::{Data, DataType};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::material::{self, Material, Texture};
use super::{Domain, Layer, NO_VALUE};

/// Index of a vertex in [`TriMesh::positions`].
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[repr(transparent)]
pub struct VertexId(pub u32);

/// Index of a face in [`TriMesh::faces`].
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[repr(transparent)]
pub struct FaceId(pub u32);

impl VertexId {
    /// The position of the vertex in an array over vertices.
    #[inline]
    pub fn idx(self) -> usize {
        self.0 as usize
    }
}

impl FaceId {
    /// The position of the face in an array over faces.
    #[inline]
    pub fn idx(self) -> usize {
        self.0 as usize
    }
}

/// A triangle mesh with attributes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TriMesh {
    /// One point a vertex, in model units.
    pub positions: Vec<DVec3>,
    /// `[VertexId; 3]` × n_faces, counter-clockwise seen from outside.
    pub faces: Vec<[VertexId; 3]>,
    /// Values beside the positions; names are unique.
    pub layers: Vec<Layer>,
    /// Definitions for the names in the layer [`Layer::MATERIAL`].
    #[serde(with = "super::material::serial")]
    pub materials: Vec<Material>,
}

/// Why a [`TriMesh`] is not well formed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MeshFault {
    /// A face names a vertex that is not there.
    #[error("face {face} names vertex {vertex}, but the mesh has {n_vertices} vertices")]
    VertexOutOfRange {
        /// The face, from 0.
        face: usize,
        /// The vertex that it names.
        vertex: u32,
        /// How many there are.
        n_vertices: usize,
    },
    /// A layer has too few or too many elements for its domain.
    #[error("layer \"{layer}\" has {found} elements where the mesh has {expected}")]
    LayerLength {
        /// Name of the layer.
        layer: String,
        /// Elements of the layer.
        found: usize,
        /// Elements of the mesh.
        expected: usize,
    },
    /// A layer's index names a value that is not there.
    #[error("layer \"{layer}\", element {element}, names value {value} of {n_values}")]
    ValueOutOfRange {
        /// Name of the layer.
        layer: String,
        /// The element, from 0.
        element: usize,
        /// The value that it names.
        value: u32,
        /// How many there are.
        n_values: usize,
    },
    /// A texture has too few or too many bytes for its size.
    #[error("texture \"{texture}\" is {width} × {height} but has {n_bytes} bytes")]
    TextureSize {
        /// Name of the texture.
        texture: String,
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes that there are.
        n_bytes: usize,
    },
}

impl TriMesh {
    /// About the bytes that a face of a mesh without layers takes while it is made: 12 for its
    /// corners and 12 for its half of a vertex, twice where a list grows.
    pub const BYTES_A_FACE: usize = 48;

    /// A mesh without attributes.
    pub fn new(positions: Vec<DVec3>, faces: Vec<[VertexId; 3]>) -> Self {
        Self { positions, faces, ..Self::default() }
    }

    /// The three corner points of a face, in its order.
    ///
    /// # Panics
    /// When the face or one of its vertices is out of range; see [`TriMesh::check`].
    #[inline]
    pub fn corners(&self, face: FaceId) -> [DVec3; 3] {
        self.faces[face.idx()].map(|v| self.positions[v.idx()])
    }

    /// The layer of this name.
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// Puts a layer in, in place of the one of the same name if there is one.
    pub fn set_layer(&mut self, layer: Layer) {
        match self.layers.iter_mut().find(|old| old.name == layer.name) {
            Some(old) => *old = layer,
            None => self.layers.push(layer),
        }
    }

    /// How many elements a layer over this domain has.
    #[inline]
    pub fn n_elements(&self, domain: Domain) -> usize {
        match domain {
            Domain::Vertex => self.positions.len(),
            Domain::Corner => 3 * self.faces.len(),
            Domain::Face => self.faces.len(),
        }
    }

    /// Volume within the surface in cubed model units, by the divergence theorem: positive for a
    /// closed mesh that is counter-clockwise from outside. For an open mesh the number depends on
    /// the origin.
    pub fn signed_volume(&self) -> f64 {
        let six_volumes: f64 = (0..self.faces.len())
            .map(|f| {
                let [a, b, c] = self.corners(FaceId(f as u32));
                a.dot(b.cross(c))
            })
            .sum();
        six_volumes / 6.0
    }

    /// Sum of the areas of the faces, in squared model units.
    pub fn area(&self) -> f64 {
        (0..self.faces.len())
            .map(|f| {
                let [a, b, c] = self.corners(FaceId(f as u32));
                0.5 * (b - a).cross(c - a).length()
            })
            .sum()
    }

    /// Smallest box, as `(lowest, highest)` corner, around the vertices that faces use, or around
    /// all of them when there is no face; `None` without vertices. Coordinates that are not
    /// numbers are left out.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let around = |points: &mut dyn Iterator<Item = DVec3>| {
            let first = points.next()?;
            Some(points.fold((first, first), |(low, high), p| (low.min(p), high.max(p))))
        };
        if self.faces.is_empty() {
            around(&mut self.positions.iter().copied())
        } else {
            around(&mut self.faces.iter().flatten().map(|v| self.positions[v.idx()]))
        }
    }

    /// Length of the diagonal of [`TriMesh::bounds`]; 0 without vertices.
    pub fn diagonal(&self) -> f64 {
        self.bounds().map_or(0.0, |(low, high)| (high - low).length())
    }

    /// Tests what must hold for every mesh: indices in range, layers as long as their domain,
    /// textures with a byte for each value of each pixel.
    pub fn check(&self) -> Result<(), MeshFault> {
        let n_vertices = self.positions.len();
        for (face, corners) in self.faces.iter().enumerate() {
            if let Some(v) = corners.iter().find(|v| v.idx() >= n_vertices) {
                return Err(MeshFault::VertexOutOfRange { face, vertex: v.0, n_vertices });
            }
        }
        self.layers.iter().try_for_each(|layer| self.check_layer(layer))?;
        self.materials.iter().flat_map(|material| &material.textures).try_for_each(check_texture)
    }

    fn check_layer(&self, layer: &Layer) -> Result<(), MeshFault> {
        let expected = self.n_elements(layer.domain);
        if layer.index.len() != expected {
            let (layer, found) = (layer.name.clone(), layer.index.len());
            return Err(MeshFault::LayerLength { layer, found, expected });
        }
        let n_values = layer.values.len();
        let is_bad = |value: u32| value != NO_VALUE && value as usize >= n_values;
        match layer.index.iter().position(|&value| is_bad(value)) {
            Some(element) => Err(MeshFault::ValueOutOfRange {
                layer: layer.name.clone(),
                element,
                value: layer.index[element],
                n_values,
            }),
            None => Ok(()),
        }
    }
}

fn check_texture(texture: &Texture) -> Result<(), MeshFault> {
    match texture
        .image
        .as_ref()
        .and_then(|image| image.pixels())
        .filter(|pixels| !pixels.is_whole())
    {
        None => Ok(()),
        Some(pixels) => Err(MeshFault::TextureSize {
            texture: texture.name.clone(),
            width: pixels.width,
            height: pixels.height,
            n_bytes: pixels.bytes.len(),
        }),
    }
}

impl Data for TriMesh {
    const TYPE: DataType = DataType {
        id: "TriMesh",
        doc: "A triangle mesh with attribute layers and materials.",
        color: [90, 190, 130],
    };

    fn byte_size(&self) -> usize {
        let layers: usize = self.layers.iter().map(Layer::byte_size).sum();
        size_of::<Self>()
            + size_of_val(self.positions.as_slice())
            + size_of_val(self.faces.as_slice())
            + layers
            + material::byte_size(&self.materials)
    }

    fn summary(&self) -> String {
        format!("{} faces, {} vertices", self.faces.len(), self.positions.len())
    }

    fn check(&self) -> Result<(), String> {
        Self::check(self).map_err(|fault| fault.to_string())
    }
}

/// The mesh itself.
pub(super) fn sample(mesh: &TriMesh) -> TriMesh {
    mesh.clone()
}
