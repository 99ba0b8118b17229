//! Collects the parts of a mesh while a file is read; layers cost nothing until they are used.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use mve_mesh::data::{Domain, Layer, LayerValues, NO_VALUE, TriMesh, VertexId};

/// An index over elements that is only filled once an element has a value.
#[derive(Default)]
pub(super) struct LazyIndex {
    index: Vec<u32>,
}

impl LazyIndex {
    /// Sets the value of the next element, where `n_before` elements came before it.
    #[inline]
    pub fn push(&mut self, n_before: usize, value: u32) {
        if value != NO_VALUE || !self.index.is_empty() {
            self.index.resize(n_before, NO_VALUE);
            self.index.push(value);
        }
    }

    /// The index over all elements.
    fn finish(mut self, n_elements: usize) -> Vec<u32> {
        self.index.resize(n_elements, NO_VALUE);
        self.index
    }
}

/// A face layer of names, set by statements that hold until the next one.
pub(super) struct LabelTrack {
    labels: Vec<String>,
    /// Only for looking up; the order of the labels is that of `labels`.
    ids: HashMap<String, u32>,
    pending: Option<String>,
    current: u32,
    index: LazyIndex,
}

impl Default for LabelTrack {
    fn default() -> Self {
        let (labels, ids) = (Vec::new(), HashMap::new());
        Self { labels, ids, pending: None, current: NO_VALUE, index: LazyIndex::default() }
    }
}

impl LabelTrack {
    /// The faces from here on have this name; none when it is empty.
    pub fn set(&mut self, name: String) {
        self.current = NO_VALUE;
        self.pending = (!name.is_empty()).then_some(name);
    }

    /// Gives the next face the name that holds. A name counts from its first face on, so that the
    /// values of the layer are in the order of their use and each is used.
    #[inline]
    fn push(&mut self, n_before: usize) {
        if let Some(name) = self.pending.take() {
            self.current = self.id_of(name);
        }
        self.index.push(n_before, self.current);
    }

    fn id_of(&mut self, name: String) -> u32 {
        if let Some(&id) = self.ids.get(&name) {
            return id;
        }
        let id = self.labels.len() as u32;
        self.labels.push(name.clone());
        self.ids.insert(name, id);
        id
    }

    /// Gives names that `new_name` knows a new one, which may be that of other faces.
    pub fn rename(&mut self, new_name: impl Fn(&str) -> Option<String>) {
        self.ids.clear();
        let old = std::mem::take(&mut self.labels);
        let renamed = old.into_iter().map(|name| new_name(&name).unwrap_or(name));
        let ids: Vec<u32> = renamed.map(|name| self.id_of(name)).collect();
        for value in self.index.index.iter_mut().filter(|value| **value != NO_VALUE) {
            *value = ids[*value as usize];
        }
    }

    /// The names in the order of their first face.
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    fn finish(self, name: &str, n_faces: usize) -> Option<Layer> {
        let (values, index) = (LayerValues::Label(self.labels), self.index.finish(n_faces));
        let layer = Layer { name: name.to_owned(), domain: Domain::Face, values, index };
        (!layer.values.is_empty()).then_some(layer)
    }
}

/// A corner of a face: vertex, texture coordinate, normal; [`NO_VALUE`] for what it lacks.
pub(super) type Corner = [u32; 3];

/// The parts of a mesh.
#[derive(Default)]
pub(super) struct MeshBuilder {
    pub positions: Vec<DVec3>,
    pub texcoords: Vec<DVec2>,
    pub normals: Vec<DVec3>,
    pub colors: Vec<DVec3>,
    pub color_index: LazyIndex,
    pub object: LabelTrack,
    pub group: LabelTrack,
    pub material: LabelTrack,
    pub smoothing: LabelTrack,
    faces: Vec<[VertexId; 3]>,
    corner_texcoords: LazyIndex,
    corner_normals: LazyIndex,
}

impl MeshBuilder {
    /// The triangles so far.
    pub fn faces(&self) -> &[[VertexId; 3]] {
        &self.faces
    }

    /// Adds a triangle with the names that hold.
    #[inline]
    pub fn push_triangle(&mut self, corners: [Corner; 3]) {
        let n_before = self.faces.len();
        self.object.push(n_before);
        self.group.push(n_before);
        self.material.push(n_before);
        self.smoothing.push(n_before);
        for (k, [_, texcoord, normal]) in corners.into_iter().enumerate() {
            self.corner_texcoords.push(3 * n_before + k, texcoord);
            self.corner_normals.push(3 * n_before + k, normal);
        }
        self.faces.push(corners.map(|[vertex, _, _]| VertexId(vertex)));
    }

    /// The mesh. A layer is there when the file has a value for it.
    pub fn finish(self) -> TriMesh {
        let (n_vertices, n_faces) = (self.positions.len(), self.faces.len());
        let mut mesh = TriMesh::new(self.positions, self.faces);
        let mut set = |name: &str, domain, values: LayerValues, index: LazyIndex, n_elements| {
            if !values.is_empty() {
                let index = index.finish(n_elements);
                mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
            }
        };
        let (texcoords, normals) = (self.corner_texcoords, self.corner_normals);
        let (corner, n_corners) = (Domain::Corner, 3 * n_faces);
        set(Layer::TEXCOORD, corner, LayerValues::Vec2(self.texcoords), texcoords, n_corners);
        set(Layer::NORMAL, corner, LayerValues::Vec3(self.normals), normals, n_corners);
        let (colors, index) = (LayerValues::Vec3(self.colors), self.color_index);
        set(Layer::COLOR, Domain::Vertex, colors, index, n_vertices);
        let labels = [
            self.object.finish(Layer::OBJECT, n_faces),
            self.group.finish(Layer::GROUP, n_faces),
            self.material.finish(Layer::MATERIAL, n_faces),
            self.smoothing.finish(Layer::SMOOTHING, n_faces),
        ];
        mesh.layers.extend(labels.into_iter().flatten());
        mesh
    }
}
