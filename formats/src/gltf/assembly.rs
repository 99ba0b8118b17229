//! A mesh on its way from primitives, each with vertices of its own, to one with shared vertices.

use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;

use glam::{DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{Domain, Layer, LayerValues, Material, NO_VALUE, TriMesh, VertexId};
use mve_mesh::weld::same_places;

use super::Vertices;
use crate::ReadError;
use crate::raw_mesh::{LeftOut, settle_points};
use crate::warnings::Warnings;

/// What a primitive's vertices have; lists are as long as that of positions, or empty.
#[derive(Default)]
pub(super) struct Attributes {
    pub positions: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    pub colors: Vec<DVec3>,
    /// By the number of the set, as the mesh has it.
    pub texcoords: Vec<(usize, Vec<DVec2>)>,
    pub numbers: Vec<(String, Vec<f64>)>,
}

/// The vertices and faces of all primitives.
#[derive(Default)]
pub(super) struct Assembly {
    all: Attributes,
    texcoords: BTreeMap<usize, Vec<DVec2>>,
    numbers: BTreeMap<String, Vec<f64>>,
    faces: Vec<[u32; 3]>,
    materials: Vec<u32>,
    objects: Vec<u32>,
    object_names: Vec<String>,
    /// For each vertex of a file the one that it becomes.
    vertices: Vec<u32>,
    positions: Vec<DVec3>,
    pub left_out: LeftOut,
    pub warnings: Warnings,
}

impl Assembly {
    /// Faces, and values of vertices, so far.
    pub fn size(&self) -> usize {
        let lists = [self.all.positions.len(), self.all.normals.len(), self.all.colors.len()];
        let texcoords = self.texcoords.values().map(Vec::len);
        let numbers = self.numbers.values().map(Vec::len);
        self.faces.len() + lists.into_iter().chain(texcoords).chain(numbers).sum::<usize>()
    }

    /// Adds vertices; the number of the first.
    pub fn add_vertices(&mut self, more: Attributes) -> u32 {
        fn put<T: Copy>(list: &mut Vec<T>, n_before: usize, none: T, more: &[T]) {
            if !more.is_empty() {
                list.resize(n_before, none);
                list.extend(more);
            }
        }
        let n = self.all.positions.len();
        match n {
            0 => self.all.positions = more.positions,
            _ => self.all.positions.extend(&more.positions),
        }
        put(&mut self.all.normals, n, DVec3::NAN, &more.normals);
        put(&mut self.all.colors, n, DVec3::NAN, &more.colors);
        for (set, values) in more.texcoords {
            put(self.texcoords.entry(set).or_default(), n, DVec2::NAN, &values);
        }
        for (name, values) in more.numbers {
            put(self.numbers.entry(name).or_default(), n, f64::NAN, &values);
        }
        n as u32
    }

    /// The number of an object, a new one.
    pub fn add_object(&mut self, name: Option<&str>) -> u32 {
        let Some(name) = name else { return NO_VALUE };
        self.object_names.push(name.to_owned());
        self.object_names.len() as u32 - 1
    }

    /// Makes room for so many more faces.
    pub fn reserve_faces(&mut self, n: usize) {
        self.faces.reserve(n);
        self.materials.reserve(n);
        self.objects.reserve(n);
    }

    pub fn add_face(&mut self, corners: [u32; 3], material: u32, object: u32) {
        self.faces.push(corners);
        self.materials.push(material);
        self.objects.push(object);
    }

    /// Gives the vertices since the last call their place in the mesh, those at one place as one if
    /// they are to be welded.
    pub fn settle(&mut self, vertices: Vertices, control: Control) -> Result<(), ReadError> {
        let start = self.vertices.len();
        let more = &self.all.positions[start..];
        let first = self.positions.len() as u32;
        self.vertices.reserve(more.len());
        self.positions.reserve(more.len());
        match vertices {
            Vertices::AsInFile => {
                self.vertices.extend((0..more.len() as u32).map(|v| first + v));
                self.positions.extend(more);
            }
            Vertices::Welded => {
                for (at, place) in same_places(more, control)?.into_iter().enumerate() {
                    let is_new = place as usize == at;
                    let number = match is_new {
                        true => self.positions.len() as u32,
                        false => self.vertices[start + place as usize],
                    };
                    if is_new {
                        self.positions.push(more[at]);
                    }
                    self.vertices.push(number);
                }
            }
        }
        Ok(())
    }

    /// The mesh, without pictures that are in other files.
    pub fn finish(mut self, materials: Vec<Material>) -> Result<(TriMesh, Warnings), ReadError> {
        self.left_out.tell(self.faces.len(), &mut self.warnings)?;
        let vertex = |source: u32| VertexId(self.vertices[source as usize]);
        let has_values = [self.all.normals.len(), self.all.colors.len()] != [0; 2]
            || !self.texcoords.is_empty()
            || !self.numbers.is_empty();
        // What has no values needs no sources of its corners; their memory is that of the faces.
        let sources = match has_values {
            true => self.faces.clone(),
            false => std::mem::take(&mut self.faces),
        };
        let faces: Vec<_> = sources.into_iter().map(|face| face.map(vertex)).collect();
        settle_points(&mut self.positions, &faces, &mut self.warnings)?;
        let mut mesh = TriMesh::new(std::mem::take(&mut self.positions), faces);
        let n = self.vertices.len();
        for (set, mut values) in std::mem::take(&mut self.texcoords) {
            values.resize(n, DVec2::NAN);
            let (kept, index) = joined(values, |uv| bits(uv.to_array()));
            let name = match set {
                0 => Layer::TEXCOORD.to_owned(),
                set => format!("{}_{set}", Layer::TEXCOORD),
            };
            let index = self.of_corners(&index);
            let (domain, values) = (Domain::Corner, LayerValues::Vec2(kept));
            mesh.set_layer(Layer { name, domain, values, index });
        }
        let vectors = [
            (Layer::NORMAL, std::mem::take(&mut self.all.normals)),
            (Layer::COLOR, std::mem::take(&mut self.all.colors)),
        ];
        for (name, mut values) in vectors.into_iter().filter(|(_, values)| !values.is_empty()) {
            values.resize(n, DVec3::NAN);
            let (kept, index) = joined(values, |value| bits(value.to_array()));
            self.put(&mut mesh, name, LayerValues::Vec3(kept), &index);
        }
        for (name, mut values) in std::mem::take(&mut self.numbers) {
            values.resize(n, f64::NAN);
            let (kept, index) = joined(values, |value| bits([*value]));
            self.put(&mut mesh, &name, LayerValues::Number(kept), &index);
        }
        let material_names = materials.iter().map(|material| material.name.clone()).collect();
        put_labels(&mut mesh, Layer::MATERIAL, material_names, self.materials);
        put_labels(&mut mesh, Layer::OBJECT, self.object_names, self.objects);
        mesh.materials = materials;
        Ok((mesh, self.warnings))
    }

    /// Puts values over vertices if each has one, else over corners.
    fn put(&self, mesh: &mut TriMesh, name: &str, values: LayerValues, index: &[u32]) {
        let mut of_vertices = vec![NO_VALUE; mesh.positions.len()];
        let mut is_known = vec![false; mesh.positions.len()];
        let is_single = self.vertices.iter().zip(index).all(|(&vertex, &value)| {
            let known = std::mem::replace(&mut is_known[vertex as usize], true);
            let before = std::mem::replace(&mut of_vertices[vertex as usize], value);
            !known || before == value
        });
        let (domain, index) = match is_single {
            true => (Domain::Vertex, of_vertices),
            false => (Domain::Corner, self.of_corners(index)),
        };
        mesh.set_layer(Layer { name: name.to_owned(), domain, values, index });
    }

    fn of_corners(&self, index: &[u32]) -> Vec<u32> {
        self.faces.iter().flatten().map(|&source| index[source as usize]).collect()
    }
}

/// A layer of the names that faces have, each once, in the order of the list.
fn put_labels(mesh: &mut TriMesh, name: &str, names: Vec<String>, mut index: Vec<u32>) {
    let mut is_used = vec![false; names.len()];
    for &at in &index {
        if let Some(is_used) = is_used.get_mut(at as usize) {
            *is_used = true;
        }
    }
    let mut known: HashMap<String, u32> = HashMap::new();
    let mut labels = Vec::new();
    let mut places = Vec::with_capacity(names.len());
    for (label, is_used) in names.into_iter().zip(is_used) {
        places.push(match is_used {
            false => NO_VALUE,
            true => *known.entry(label.clone()).or_insert_with(|| {
                labels.push(label);
                labels.len() as u32 - 1
            }),
        });
    }
    for at in &mut index {
        *at = places.get(*at as usize).copied().unwrap_or(NO_VALUE);
    }
    if !labels.is_empty() {
        let (name, domain, values) = (name.to_owned(), Domain::Face, LayerValues::Label(labels));
        mesh.set_layer(Layer { name, domain, values, index });
    }
}

fn bits<const N: usize>(values: [f64; N]) -> Option<[u64; N]> {
    values.iter().all(|value| !value.is_nan()).then(|| values.map(f64::to_bits))
}

/// Each value once, and which of them each element has; what has no key has none.
fn joined<T, K: Hash + Eq>(values: Vec<T>, key: impl Fn(&T) -> Option<K>) -> (Vec<T>, Vec<u32>) {
    let mut known: HashMap<K, u32> = HashMap::new();
    let (mut kept, mut index) = (Vec::new(), Vec::with_capacity(values.len()));
    for value in values {
        index.push(match key(&value) {
            None => NO_VALUE,
            Some(key) => *known.entry(key).or_insert_with(|| {
                kept.push(value);
                kept.len() as u32 - 1
            }),
        });
    }
    (kept, index)
}
