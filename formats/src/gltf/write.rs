//! From a mesh to a binary glTF file.
//!
//! The same mesh gives the same bytes. Nothing in the file tells when it was written.

use std::io::{self, Write};
use std::path::Path;

use glam::{DVec2, DVec3};
use mve_core::{Control, ModuleError};
use mve_mesh::data::{Domain, FaceId, Layer, LayerValues, TriMesh};
use mve_mesh::split::split_corners;
use serde_json::{Value as Json, json};

use super::container::{BINARY_CHUNK, JSON_CHUNK, MAGIC};
use super::parts::{Part, parts};
use super::surfaces::Surfaces;
use super::transfer::light;
use crate::rounding::Rounding;
use crate::save_atomic;

/// Elements between two looks whether the work was cancelled.
const ELEMENTS: usize = 1 << 16;

/// Numbers of OpenGL that the format has for types and uses.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34_962;
const ELEMENT_ARRAY_BUFFER: u32 = 34_963;

/// Saves a mesh; what is changed or left out comes back in sentences.
///
/// # Errors
/// With the path, where the file cannot be written or the mesh cannot be said in the format (see
/// [`write_glb`]); that `control` ended it.
pub fn save(mesh: &TriMesh, path: &Path, control: Control) -> Result<Vec<String>, ModuleError> {
    let mut warnings = Vec::new();
    save_atomic(path, |out| {
        warnings = write_glb(mesh, out, control)?;
        Ok(())
    })?;
    Ok(warnings)
}

/// Writes a mesh as one binary glTF file with its materials and pictures in it; says what is
/// changed or left out.
///
/// Numbers are floats of 32 bits. Vertices with several normals, texture coordinates or colors are
/// split, and what a vertex lacks is the normal of a face at it, the texture coordinate (0, 0) or
/// white. Each object is a node, if no vertex belongs to two, and each material of a node a
/// primitive; faces come in that order. Surfaces are seen from both sides. A mesh far from the
/// origin is moved there, and its node moves it back.
///
/// # Errors
/// `InvalidInput` when the mesh is not well formed, has a coordinate that is not finite or is
/// larger than the format can have; whatever the writer reports; `Other` when `control` ends it.
pub fn write_glb(mesh: &TriMesh, out: &mut dyn Write, control: Control) -> io::Result<Vec<String>> {
    mesh.check().map_err(|fault| invalid(fault.to_string()))?;
    if let Some(v) = mesh.positions.iter().position(|p| !p.as_vec3().is_finite()) {
        let DVec3 { x, y, z } = mesh.positions[v];
        return Err(invalid(format!("vertex {v} is at {x} {y} {z}, which are no finite floats")));
    }
    let mut warnings = Vec::new();
    let (whole, control_parts) = (over_vertices(mesh, &mut warnings), control.part(0.1, 0.2));
    control.at(0.1).map_err(io::Error::other)?;
    let (whole, parts) = parts(whole, &mut warnings, control_parts).map_err(io::Error::other)?;
    let mut file = GlbFile { control: control.part(0.2, 0.9), ..GlbFile::new() };
    let mut attributes = file.attributes(&whole, &mut warnings)?;
    let surfaces = Surfaces::of(&whole, &mut warnings);
    // Where there are no texture coordinates, no picture can lie.
    let has_texcoords = attributes.iter().any(|attribute| attribute.name == "TEXCOORD_0");
    let materials = file.materials(&surfaces, has_texcoords, &mut warnings)?;
    file.document["materials"] = materials.into();
    file.nodes(&whole, &parts, &mut attributes, &surfaces)?;
    file.write(out)?;
    left_out(mesh, &mut warnings);
    control.at(1.0).map_err(io::Error::other)?;
    Ok(warnings)
}

fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

/// Says which layers have no place in the file.
fn left_out(mesh: &TriMesh, warnings: &mut Vec<String>) {
    for layer in &mesh.layers {
        let is_number = matches!(layer.values, LayerValues::Number(_));
        let name = layer.name.as_str();
        let has_place = match name {
            Layer::NORMAL | Layer::COLOR | Layer::MATERIAL | Layer::OBJECT => true,
            name => set_of(name).is_some() || is_number && layer.domain == Domain::Vertex,
        };
        if !has_place {
            warnings.push(format!("the layer \"{name}\" has no place in the file and is left out"));
        }
    }
}

/// The number of a set of texture coordinates by the name of its layer.
fn set_of(name: &str) -> Option<usize> {
    let rest = name.strip_prefix(Layer::TEXCOORD)?;
    match rest.strip_prefix('_') {
        None => rest.is_empty().then_some(0),
        Some(number) => number.parse().ok().filter(|number| (1..16).contains(number)),
    }
}

/// The mesh with all values over vertices that the format has there.
fn over_vertices(mesh: &TriMesh, warnings: &mut Vec<String>) -> TriMesh {
    let mut whole = mesh.clone();
    for layer in whole.layers.iter_mut().filter(|layer| layer.domain == Domain::Face) {
        if layer.name == Layer::COLOR {
            layer.domain = Domain::Corner;
            layer.index = layer.index.iter().flat_map(|&at| [at; 3]).collect();
        }
    }
    let is_split = |layer: &&Layer| {
        let name = layer.name.as_str();
        let is_known = matches!(name, Layer::NORMAL | Layer::COLOR) || set_of(name).is_some();
        layer.domain == Domain::Corner && is_known
    };
    let names: Vec<String> = whole.layers.iter().filter(is_split).map(|l| l.name.clone()).collect();
    if names.is_empty() {
        return whole;
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let split = split_corners(&whole, &names).mesh;
    let (n_before, n_after) = (mesh.positions.len(), split.positions.len());
    if n_after > n_before {
        warnings.push(format!(
            "{n_after} vertices are written for {n_before}, since vertices have several values of {}",
            names.join(" and ")
        ));
    }
    split
}

/// An attribute of all vertices.
struct Attribute {
    name: String,
    shape: &'static str,
    view: usize,
    /// Bytes of a vertex.
    stride: usize,
}

/// A file that grows.
struct GlbFile<'a> {
    document: Json,
    binary: Vec<u8>,
    views: Vec<Json>,
    accessors: Vec<Json>,
    /// What positions are moved by.
    offset: DVec3,
    control: Control<'a>,
}

impl GlbFile<'_> {
    fn new() -> GlbFile<'static> {
        GlbFile {
            document: json!({ "asset": { "version": "2.0", "generator": "mve" } }),
            binary: Vec::new(),
            views: Vec::new(),
            accessors: Vec::new(),
            offset: DVec3::ZERO,
            control: Control::none(),
        }
    }

    /// Ends a view that began at this byte; its number.
    fn end_view(&mut self, start: usize, target: Option<u32>, stride: Option<usize>) -> usize {
        let mut view = json!({
            "buffer": 0, "byteOffset": start, "byteLength": self.binary.len() - start
        });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.views.push(view);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    /// Writes some numbers of each vertex.
    fn attribute<const N: usize>(
        &mut self,
        name: String,
        shape: &'static str,
        n: usize,
        value: impl Fn(usize) -> [f64; N],
    ) -> io::Result<Attribute> {
        let start = self.binary.len();
        self.binary.reserve(4 * N * n);
        for vertex in 0..n {
            if vertex.is_multiple_of(ELEMENTS) {
                self.control.at(0.5).map_err(io::Error::other)?;
            }
            for number in value(vertex) {
                self.binary.extend((number as f32).to_le_bytes());
            }
        }
        let stride = 4 * N;
        let view = self.end_view(start, Some(ARRAY_BUFFER), Some(stride));
        Ok(Attribute { name, shape, view, stride })
    }

    /// Writes what vertices have, positions first.
    fn attributes(
        &mut self,
        mesh: &TriMesh,
        warnings: &mut Vec<String>,
    ) -> io::Result<Vec<Attribute>> {
        let n = mesh.positions.len();
        if n == 0 {
            return Ok(Vec::new());
        }
        if let (Some(rounding), Some((low, high))) = (Rounding::of_floats(mesh), mesh.bounds()) {
            match rounding.is_of_all() {
                true => self.offset = low.midpoint(high),
                false => warnings.push(rounding.to_string()),
            }
        }
        let offset = self.offset;
        let place = |v: usize| (mesh.positions[v] - offset).to_array();
        let mut all = vec![self.attribute("POSITION".to_owned(), "VEC3", n, place)?];
        for layer in mesh.layers.iter().filter(|layer| layer.domain == Domain::Vertex) {
            let index = &layer.index;
            match (&layer.values, layer.name.as_str()) {
                (LayerValues::Vec3(values), Layer::NORMAL) => {
                    let normals = unit_normals(mesh, values, index);
                    let value = |v: usize| normals[v].to_array();
                    all.push(self.attribute("NORMAL".to_owned(), "VEC3", n, value)?);
                }
                (LayerValues::Vec3(values), Layer::COLOR) => {
                    let is_bright = |c: &DVec3| c.min_element() < 0.0 || c.max_element() > 1.0;
                    if values.iter().any(is_bright) {
                        warnings.push("colors outside 0 to 1 are cut to that range".to_owned());
                    }
                    let value = |v: usize| {
                        let color = values.get(index[v] as usize).copied().unwrap_or(DVec3::ONE);
                        // What is no number becomes 0.
                        light(color.max(DVec3::ZERO).min(DVec3::ONE)).to_array()
                    };
                    all.push(self.attribute("COLOR_0".to_owned(), "VEC3", n, value)?);
                }
                (LayerValues::Number(values), name) => {
                    let value = |v: usize| values.get(index[v] as usize).copied();
                    let is_float = |v| value(v).is_some_and(|x| (x as f32).is_finite());
                    let is_word = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
                    if is_word && !name.is_empty() && (0..n).all(is_float) {
                        let value = |v: usize| [value(v).unwrap_or(0.0)];
                        all.push(self.attribute(format!("_{name}"), "SCALAR", n, value)?);
                    } else {
                        warnings.push(format!(
                            "the layer \"{name}\" is left out: its name is no word, or not all of \
                             its values are finite floats"
                        ));
                    }
                }
                _ => {}
            }
        }
        self.texcoords(mesh, &mut all)?;
        Ok(all)
    }

    /// Writes the sets of texture coordinates, without a gap, in the order of their numbers.
    fn texcoords(&mut self, mesh: &TriMesh, all: &mut Vec<Attribute>) -> io::Result<()> {
        let n = mesh.positions.len();
        let mut sets: Vec<(usize, &Layer)> = mesh
            .layers
            .iter()
            .filter(|layer| layer.domain == Domain::Vertex)
            .filter_map(|layer| Some((set_of(&layer.name)?, layer)))
            .collect();
        sets.sort_by_key(|(set, _)| *set);
        for (number, (_, layer)) in sets.into_iter().enumerate() {
            let LayerValues::Vec2(values) = &layer.values else { continue };
            let value = |v: usize| {
                let uv = values.get(layer.index[v] as usize).copied();
                let uv = uv.filter(|uv| uv.as_vec2().is_finite()).unwrap_or(DVec2::ZERO);
                [uv.x, 1.0 - uv.y]
            };
            all.push(self.attribute(format!("TEXCOORD_{number}"), "VEC2", n, value)?);
        }
        Ok(())
    }

    fn materials(
        &mut self,
        surfaces: &Surfaces,
        has_texcoords: bool,
        warnings: &mut Vec<String>,
    ) -> io::Result<Vec<Json>> {
        let has_pictures = !surfaces.pictures.is_empty();
        if has_pictures && !has_texcoords {
            let text = "pictures are left out, since the mesh has no texture coordinates";
            warnings.push(text.to_owned());
        }
        let is_kept = has_pictures && has_texcoords;
        if is_kept {
            let mut images = Vec::new();
            for (name, mime_type, bytes) in &surfaces.pictures {
                self.control.at(0.7).map_err(io::Error::other)?;
                let start = self.binary.len();
                self.binary.extend(bytes.as_ref());
                let view = self.end_view(start, None, None);
                images.push(json!({ "name": name, "mimeType": mime_type, "bufferView": view }));
            }
            self.document["images"] = images.into();
            self.document["samplers"] = surfaces.samplers.clone().into();
            self.document["textures"] = surfaces.textures.clone().into();
        }
        Ok(surfaces.materials(is_kept))
    }

    /// Writes the faces, and the nodes that they are in.
    fn nodes(
        &mut self,
        mesh: &TriMesh,
        parts: &[Part],
        attributes: &mut [Attribute],
        surfaces: &Surfaces,
    ) -> io::Result<()> {
        let n_corners = 3 * mesh.faces.len();
        let start = self.binary.len();
        self.binary.reserve(4 * n_corners);
        let mut lists: Vec<Vec<(usize, usize, usize)>> = Vec::new();
        for part in parts {
            let mut list = Vec::new();
            for (material, faces) in &part.materials {
                let at = self.binary.len();
                for (number, &face) in faces.iter().enumerate() {
                    if number.is_multiple_of(ELEMENTS) {
                        self.control.at(0.8).map_err(io::Error::other)?;
                    }
                    for vertex in mesh.faces[face as usize] {
                        self.binary.extend((vertex.0 - part.vertices.start).to_le_bytes());
                    }
                }
                list.push((surfaces.number(*material), at - start, 3 * faces.len()));
            }
            lists.push(list);
        }
        let view = match n_corners {
            0 => None,
            _ => Some(self.end_view(start, Some(ELEMENT_ARRAY_BUFFER), None)),
        };
        let (mut nodes, mut meshes) = (Vec::new(), Vec::new());
        for (part, list) in parts.iter().zip(lists) {
            let shared = self.part_attributes(mesh, part, attributes);
            let mut primitives = Vec::new();
            for (material, at, n) in list {
                self.accessors.push(json!({
                    "bufferView": view, "byteOffset": at, "componentType": UNSIGNED_INT,
                    "count": n, "type": "SCALAR"
                }));
                let indices = self.accessors.len() - 1;
                primitives.push(json!({
                    "attributes": shared, "indices": indices, "material": material
                }));
            }
            if primitives.is_empty() {
                primitives.push(json!({ "attributes": shared, "mode": 0 }));
            }
            let mut node = json!({ "mesh": meshes.len() });
            if let Some(name) = &part.name {
                node["name"] = name.as_str().into();
            }
            if self.offset != DVec3::ZERO {
                node["translation"] = json!(self.offset.to_array());
            }
            nodes.push(node);
            meshes.push(json!({ "primitives": primitives }));
        }
        let numbers: Vec<usize> = (0..nodes.len()).collect();
        self.document["scene"] = 0.into();
        let is_empty = nodes.is_empty();
        self.document["scenes"] =
            if is_empty { json!([{}]) } else { json!([{ "nodes": numbers }]) };
        self.document["nodes"] = nodes.into();
        self.document["meshes"] = meshes.into();
        Ok(())
    }

    /// The accessors of the vertices of a part, by attribute.
    fn part_attributes(&mut self, mesh: &TriMesh, part: &Part, attributes: &[Attribute]) -> Json {
        let (start, end) = (part.vertices.start as usize, part.vertices.end as usize);
        let mut all = json!({});
        for attribute in attributes {
            let mut accessor = json!({
                "bufferView": attribute.view, "byteOffset": start * attribute.stride,
                "componentType": FLOAT, "count": end - start, "type": attribute.shape
            });
            if attribute.name == "POSITION" {
                let points = mesh.positions[start..end].iter();
                let points = points.map(|point| (*point - self.offset).as_vec3());
                let bounds = points.fold(None, |bounds: Option<[glam::Vec3; 2]>, point| {
                    let [low, high] = bounds.unwrap_or([point; 2]);
                    Some([low.min(point), high.max(point)])
                });
                let bounds = bounds.unwrap_or_default().map(|point| point.as_dvec3().to_array());
                accessor["min"] = json!(bounds[0]);
                accessor["max"] = json!(bounds[1]);
            }
            self.accessors.push(accessor);
            all[attribute.name.as_str()] = (self.accessors.len() - 1).into();
        }
        all
    }

    fn write(mut self, out: &mut dyn Write) -> io::Result<()> {
        self.document["accessors"] = self.accessors.into();
        self.document["bufferViews"] = self.views.into();
        if !self.binary.is_empty() {
            self.document["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        }
        if let Some(fields) = self.document.as_object_mut() {
            // The format knows no empty lists.
            fields.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
        }
        let mut text = serde_json::to_vec(&self.document)?;
        text.resize(text.len().next_multiple_of(4), b' ');
        let is_binary = !self.binary.is_empty();
        let length = 20 + text.len() + if is_binary { 8 + self.binary.len() } else { 0 };
        let Ok(length) = u32::try_from(length) else {
            return Err(invalid("a .glb file has at most 4 GiB; save the mesh as PLY".to_owned()));
        };
        out.write_all(&[MAGIC, &2_u32.to_le_bytes(), &length.to_le_bytes()].concat())?;
        out.write_all(&[&(text.len() as u32).to_le_bytes(), JSON_CHUNK].concat())?;
        out.write_all(&text)?;
        if is_binary {
            out.write_all(&[&(self.binary.len() as u32).to_le_bytes(), BINARY_CHUNK].concat())?;
        }
        for piece in self.binary.chunks(1 << 20) {
            self.control.at(1.0).map_err(io::Error::other)?;
            out.write_all(piece)?;
        }
        Ok(())
    }
}

/// Normals of length 1; that of a face where a vertex has none.
fn unit_normals(mesh: &TriMesh, values: &[DVec3], index: &[u32]) -> Vec<DVec3> {
    let unit = |at: &u32| values.get(*at as usize).and_then(|normal| normal.try_normalize());
    let mut normals: Vec<Option<DVec3>> = index.iter().map(unit).collect();
    if normals.iter().any(Option::is_none) {
        for (number, face) in mesh.faces.iter().enumerate() {
            let [a, b, c] = mesh.corners(FaceId(number as u32));
            let normal = (b - a).cross(c - a).try_normalize();
            for vertex in face {
                normals[vertex.idx()] = normals[vertex.idx()].or(normal);
            }
        }
    }
    normals.into_iter().map(|normal| normal.unwrap_or(DVec3::Z)).collect()
}
