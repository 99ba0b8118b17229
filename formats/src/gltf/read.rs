//! From the bytes of a glTF file to a mesh.

use std::collections::HashMap;
use std::path::PathBuf;

use glam::{DMat3, DMat4, DVec2, DVec3};
use mve_core::Control;
use mve_mesh::data::{NO_VALUE, TriMesh};

use super::Vertices;
use super::accessor::{count, indices, vectors};
use super::assembly::{Assembly, Attributes};
use super::buffers::{BufferSource, Buffers};
use super::container;
use super::document::{Primitive, Whole};
use super::materials::{self, Layout, Materials};
use super::scene::{Instance, instances};
use super::transfer::display;
use crate::ReadError;
use crate::obj::bounds::Bounds;
use crate::obj::textures::Pictures;
use crate::warnings::{Warning, Warnings};

/// Faces and values of vertices of which copies of a small file may consist.
const MOST_ELEMENTS: usize = 1 << 25;
/// And for a byte of the file.
const MOST_ELEMENTS_A_BYTE: usize = 64;

/// Extensions that say nothing of the surface where they are not known, or that are read.
const KNOWN: [&str; 4] = [
    "KHR_mesh_quantization",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_texture_transform",
];

/// Reads a glTF file that names no others, of either kind.
///
/// # Errors
/// What is wrong with it; when `control` says so.
pub fn read_gltf(
    bytes: &[u8],
    vertices: Vertices,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let mut none = |name: &str| Err(format!("is the file {name}, which is not beside it"));
    read_with(bytes, &mut none, None, vertices, control)
}

/// Reads a glTF file with the buffers of a source, and the pictures of a folder.
pub(super) fn read_with(
    bytes: &[u8],
    source: &mut BufferSource,
    folder: Option<(PathBuf, Bounds)>,
    vertices: Vertices,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let file = container::open(bytes)?;
    let document = &file.document;
    let mut assembly = Assembly::default();
    check_required(&document.extensions_required, &mut assembly.warnings)?;
    let buffers = Buffers::read(document, file.binary, source, control)?;
    let mut pictures = Pictures::default();
    let materials = materials::read(&buffers, &mut pictures, &mut assembly.warnings);
    let instances = instances(document, &mut assembly.warnings, control)?;
    let most = MOST_ELEMENTS.max(buffers.n_bytes().saturating_mul(MOST_ELEMENTS_A_BYTE));
    let most = most.min(u32::MAX as usize / 3);
    let n = instances.len() as f64;
    for (at, instance) in instances.iter().enumerate() {
        let control = control.part(at as f64 / n, (at + 1) as f64 / n);
        control.at(0.0)?;
        let reader = Reader { buffers: &buffers, materials: &materials, most, control };
        reader.add_mesh(instance, &mut assembly)?;
        assembly.settle(vertices, control.part(0.9, 1.0))?;
    }
    let (mut mesh, mut warnings) = assembly.finish(materials.list)?;
    if let Some((folder, bounds)) = folder {
        pictures.read_all(&mut mesh.materials, &[folder], &bounds, &mut warnings, control);
    }
    control.at(1.0)?;
    Ok((mesh, warnings.into_list()))
}

fn check_required(required: &[String], warnings: &mut Warnings) -> Result<(), ReadError> {
    for name in required {
        if name == "KHR_draco_mesh_compression" {
            return Err(draco());
        }
        // Materials and pictures do without.
        let is_look = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"];
        if !KNOWN.contains(&name.as_str()) && !is_look.iter().any(|look| name.starts_with(look)) {
            warnings.add_once(format!("the file asks for {name}, which is not known and left out"));
        }
    }
    Ok(())
}

#[cold]
fn draco() -> ReadError {
    ReadError::Wrong(
        "its meshes are packed by KHR_draco_mesh_compression, which is not read; unpack the file \
         first, for example with `gltf-transform copy in.glb out.glb`"
            .to_owned(),
    )
}

/// Reads the meshes of a file.
struct Reader<'a> {
    buffers: &'a Buffers<'a>,
    materials: &'a Materials,
    /// Faces and values of vertices that the mesh may have.
    most: usize,
    control: Control<'a>,
}

/// Vertices that primitives share, by how textures lie on them, and the number of the first.
type Shared = Vec<(Layout, u32)>;

impl Reader<'_> {
    fn add_mesh(&self, instance: &Instance, assembly: &mut Assembly) -> Result<(), ReadError> {
        let Instance { mesh: number, name, transform } = instance;
        let mesh = self.buffers.document.meshes.get(number.0);
        let mesh =
            mesh.ok_or_else(|| ReadError::Wrong(format!("mesh {} is not there", number.0)))?;
        let object = assembly.add_object(*name);
        let mut shared: HashMap<Vec<(&str, Whole)>, Shared> = HashMap::new();
        for (at, primitive) in mesh.primitives.iter().enumerate() {
            let about = |error: ReadError| match error {
                ReadError::Wrong(message) => {
                    let number = number.0;
                    ReadError::Wrong(format!("mesh {number}, primitive {at}: {message}"))
                }
                cancelled => cancelled,
            };
            if primitive.extensions.draco.is_some() {
                return Err(draco());
            }
            let Some(&position) = primitive.attributes.get("POSITION") else {
                assembly.warnings.add_once("primitives without positions are left out".to_owned());
                continue;
            };
            let n_vertices = count(self.buffers, position).map_err(about)?;
            let layout = match primitive.material {
                Some(material) => self.materials.layouts.get(material.0).copied(),
                None => None,
            };
            let layout = layout.unwrap_or_default();
            let key: Vec<(&str, Whole)> =
                primitive.attributes.iter().map(|(name, at)| (name.as_str(), *at)).collect();
            let same = shared.entry(key).or_default();
            let first = match same.iter().find(|(other, _)| *other == layout) {
                Some((_, first)) => *first,
                None => {
                    let n_values = n_vertices.saturating_mul(primitive.attributes.len());
                    self.check_size(assembly, n_values).map_err(about)?;
                    let attributes = self.attributes(primitive, layout, transform);
                    let first = assembly.add_vertices(attributes.map_err(about)?);
                    same.push((layout, first));
                    first
                }
            };
            let faces = Faces { first, n_vertices, object, transform: *transform };
            self.add_faces(primitive, &faces, assembly).map_err(about)?;
        }
        Ok(())
    }

    fn check_size(&self, assembly: &Assembly, n_more: usize) -> Result<(), ReadError> {
        if assembly.size().saturating_add(n_more) <= self.most {
            return Ok(());
        }
        Err(ReadError::Wrong(format!(
            "the meshes of all nodes have more than {} faces and values of vertices; split the file",
            self.most
        )))
    }

    /// The vertices of a primitive, where its node puts them.
    fn attributes(
        &self,
        primitive: &Primitive,
        layout: Layout,
        transform: &DMat4,
    ) -> Result<Attributes, ReadError> {
        let mut attributes = Attributes::default();
        for (name, &number) in &primitive.attributes {
            self.control.at(0.0)?;
            let three = || vectors::<3>(self.buffers, number, self.control);
            if name == "POSITION" {
                let is_still = *transform == DMat4::IDENTITY;
                let place = |p: [f64; 3]| match is_still {
                    true => DVec3::from(p),
                    false => transform.transform_point3(DVec3::from(p)),
                };
                attributes.positions = three()?.into_iter().map(place).collect();
            } else if name == "NORMAL" {
                let turn = normal_turn(transform);
                let turned = |n| {
                    let normal = turn.map_or(DVec3::from(n), |turn| turn * DVec3::from(n));
                    if turn.is_some() { normal.normalize_or_zero() } else { normal }
                };
                attributes.normals = three()?.into_iter().map(turned).collect();
            } else if name == "COLOR_0" {
                let colors = three()?.into_iter().map(|color| display(DVec3::from(color)));
                attributes.colors = colors.collect();
            } else if let Some(set) = name.strip_prefix("TEXCOORD_") {
                let Ok(set) = set.parse::<usize>() else { continue };
                let uvs = vectors::<2>(self.buffers, number, self.control)?;
                // The set of the base color's picture is that of the mesh, and they change places.
                let (set, layout) = match set {
                    set if set == layout.set => (0, layout),
                    0 => (layout.set, Layout::default()),
                    set => (set, Layout::default()),
                };
                let uvs: Vec<DVec2> = uvs.into_iter().map(|uv| layout.place(uv)).collect();
                attributes.texcoords.push((set, uvs));
            } else if let Some(name) = name.strip_prefix('_').filter(|name| !name.is_empty())
                && self
                    .buffers
                    .document
                    .accessors
                    .get(number.0)
                    .is_some_and(|a| a.shape == "SCALAR")
            {
                let values = vectors::<1>(self.buffers, number, self.control)?;
                let values = values.into_iter().map(|[value]| value).collect();
                attributes.numbers.push((name.to_owned(), values));
            }
        }
        let n = attributes.positions.len();
        let lengths = [attributes.normals.len(), attributes.colors.len()].into_iter();
        let lengths = lengths.filter(|length| *length > 0);
        let lengths = lengths.chain(attributes.texcoords.iter().map(|(_, values)| values.len()));
        let mut lengths = lengths.chain(attributes.numbers.iter().map(|(_, v)| v.len()));
        if let Some(other) = lengths.find(|length| *length != n) {
            let message = format!("it has {n} positions and {other} values of another attribute");
            return Err(ReadError::Wrong(message));
        }
        Ok(attributes)
    }

    fn add_faces(
        &self,
        primitive: &Primitive,
        faces: &Faces,
        assembly: &mut Assembly,
    ) -> Result<(), ReadError> {
        let mode = primitive.mode.map_or(4, |mode| mode.0);
        if !(4..=6).contains(&mode) {
            let what = if mode < 4 { "points and lines" } else { "primitives of unknown kinds" };
            assembly.warnings.add_once(format!("{what} are left out, but for their vertices"));
            return Ok(());
        }
        let indices: Vec<u32> = match primitive.indices {
            None => (0..faces.n_vertices as u32).collect(),
            Some(number) => {
                self.check_size(assembly, count(self.buffers, number)? / 3)?;
                indices(self.buffers, number, self.control)?
            }
        };
        let material = primitive.material.and_then(|at| *self.materials.of_file.get(at.0)?);
        let material = material.unwrap_or(NO_VALUE);
        let n_triangles = match mode {
            4 => indices.len() / 3,
            _ => indices.len().saturating_sub(2),
        };
        self.check_size(assembly, n_triangles)?;
        if mode == 4 && !indices.len().is_multiple_of(3) {
            let text = "one or two corners at the end of a list of triangles are left out";
            assembly.warnings.add_once(text.to_owned());
        }
        assembly.reserve_faces(n_triangles);
        let is_mirrored = faces.transform.determinant() < 0.0;
        for at in 0..n_triangles {
            self.control.item(at, n_triangles)?;
            let places = match mode {
                4 => [3 * at, 3 * at + 1, 3 * at + 2],
                5 if at % 2 == 0 => [at, at + 1, at + 2],
                5 => [at, at + 2, at + 1],
                _ => [at + 1, at + 2, 0],
            };
            let [a, b, c] = places.map(|place| indices[place]);
            if let Some(bad) = [a, b, c].iter().find(|v| **v as usize >= faces.n_vertices) {
                let last = faces.n_vertices.saturating_sub(1);
                assembly.left_out.add(
                    || format!("triangle {at}"),
                    || format!("found vertex {bad}, expected 0 to {last}"),
                );
                continue;
            }
            // Strips repeat a vertex to turn a corner.
            if mode == 5 && (a == b || b == c || c == a) {
                continue;
            }
            let corners = if is_mirrored { [a, c, b] } else { [a, b, c] };
            assembly.add_face(corners.map(|v| faces.first + v), material, faces.object);
        }
        Ok(())
    }
}

/// Where the faces of a primitive belong.
struct Faces {
    /// The number of the first vertex.
    first: u32,
    n_vertices: usize,
    object: u32,
    transform: DMat4,
}

/// What turns normals where a transform turns the surface; `None` where nothing does.
fn normal_turn(transform: &DMat4) -> Option<DMat3> {
    let linear = DMat3::from_mat4(*transform);
    if linear == DMat3::IDENTITY {
        return None;
    }
    // The matrix of cofactors, the inverse transposed times the determinant, exists for flat
    // transforms too.
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    Some(if linear.determinant() < 0.0 { -cofactors } else { cofactors })
}
