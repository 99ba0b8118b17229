//! From a mesh to the bytes of a PLY file.
//!
//! The same mesh gives the same bytes. Nothing in the file tells when or by what it was written.

use std::io::{self, Write};

use glam::{DVec2, DVec3};
use mve_core::{Control, Enumeration};
use mve_mesh::data::bytes_of;
use mve_mesh::data::{
    Domain, Field, Layer, LayerValues, TextureRole, TriMesh, VertexId, name_to_bytes,
};

use crate::pieces::write_pieces;

/// Rows that a thread makes at once.
const ROWS: usize = 1 << 12;

/// How numbers stand in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// In binary, the lowest byte first.
    Binary,
    /// As text.
    Ascii,
}

impl Enumeration for Encoding {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Binary", "Small and exact: binary, the lowest byte first."),
        ("Ascii", "Text that a person can read."),
    ];
    const VALUES: &'static [Self] = &[Self::Binary, Self::Ascii];
}

/// How exact positions, normals and the field are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits, 7 digits: what viewers expect.
    Float,
    /// 64 bits, nothing is lost.
    Double,
}

impl Enumeration for Precision {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("Float", "32 bits, 7 digits: what viewers expect."),
        ("Double", "64 bits: nothing is lost, but not every viewer reads it."),
    ];
    const VALUES: &'static [Self] = &[Self::Float, Self::Double];
}

/// How a mesh is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlyOptions {
    /// How numbers stand in the file.
    pub encoding: Encoding,
    /// How exact they are.
    pub precision: Precision,
}

/// Writes `mesh` as PLY.
///
/// Written are positions, faces, the layer normal over vertices (`nx ny nz`; 0 where there is
/// none), the layer color over vertices or faces (`red green blue`, bytes; white where there is
/// none), a field over vertices or faces as `quality`, layers of numbers over vertices or faces by
/// their names, texture coordinates of corners (`texcoord`; an empty list where a corner has none),
/// and the pictures of base colors that materials name (`TextureFile`, `texnumber`). All else has
/// no place that viewers agree on and is left out.
///
/// # Errors
/// `InvalidInput` when the mesh is not well formed, has a coordinate that is not finite or does not
/// fit the precision, or the field does not fit the mesh; whatever the writer reports; `Other`
/// when `control` ends it.
pub fn write_ply(
    mesh: &TriMesh,
    field: Option<&Field>,
    options: PlyOptions,
    out: &mut dyn Write,
    control: Control,
) -> io::Result<()> {
    mesh.check().map_err(|fault| invalid(fault.to_string()))?;
    if i32::try_from(mesh.positions.len()).is_err() || i32::try_from(mesh.faces.len()).is_err() {
        return Err(invalid("PLY viewers count to 2,147,483,647; the mesh is larger".to_owned()));
    }
    if let Some(field) = field {
        field.check_fits(mesh).map_err(invalid)?;
        if field.domain == Domain::Corner {
            return Err(invalid("PLY has no place for a field over corners".to_owned()));
        }
    }
    let over = |domain| field.filter(|field| field.domain == domain).map(|f| f.values.as_slice());
    let vertices = Extras {
        normals: vectors(mesh, Layer::NORMAL, Domain::Vertex),
        colors: vectors(mesh, Layer::COLOR, Domain::Vertex),
        quality: over(Domain::Vertex),
        numbers: numbers(mesh, Domain::Vertex, over(Domain::Vertex).is_some()),
        texcoords: None,
        pictures: None,
    };
    let textures = Textures::of(mesh);
    let faces = Extras {
        normals: None,
        colors: vectors(mesh, Layer::COLOR, Domain::Face),
        quality: over(Domain::Face),
        numbers: numbers(mesh, Domain::Face, over(Domain::Face).is_some()),
        texcoords: texcoords(mesh),
        pictures: textures.of_faces.as_deref(),
    };
    out.write_all(&header(mesh, (&vertices, &faces), &textures.names, options))?;
    let (n_vertices, n_faces) = (mesh.positions.len(), mesh.faces.len());
    let share = n_vertices as f64 / (n_vertices + n_faces).max(1) as f64;
    let vertex = |v: usize, rows: &mut Rows| {
        let position = mesh.positions[v].to_array();
        position.into_iter().try_for_each(|x| check_coordinate(v, x, options.precision))?;
        position.into_iter().for_each(|coordinate| rows.real(coordinate));
        vertices.write(v, rows);
        Ok(())
    };
    write_rows(n_vertices, options, out, control.part(0.0, share), vertex)?;
    let face = |f: usize, rows: &mut Rows| {
        rows.triangle(mesh.faces[f]);
        faces.write(f, rows);
        Ok(())
    };
    write_rows(n_faces, options, out, control.part(share, 1.0), face)
}

/// Writes rows, which all threads make.
fn write_rows(
    n: usize,
    options: PlyOptions,
    out: &mut dyn Write,
    control: Control,
    row: impl Fn(usize, &mut Rows) -> io::Result<()> + Sync,
) -> io::Result<()> {
    write_pieces(n, ROWS, out, control, |range, buffer| {
        buffer.reserve(16 * ROWS);
        let mut rows = Rows { buffer, options };
        for number in range {
            row(number, &mut rows)?;
            rows.end();
        }
        Ok(())
    })
}

fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

fn check_coordinate(vertex: usize, value: f64, precision: Precision) -> io::Result<()> {
    if !value.is_finite() {
        return Err(invalid(format!(
            "vertex {vertex} has the coordinate {value}; viewers need finite numbers"
        )));
    }
    match precision {
        Precision::Float if !(value as f32).is_finite() => Err(invalid(format!(
            "vertex {vertex} has the coordinate {value:e}, too large for a float; choose Double"
        ))),
        _ => Ok(()),
    }
}

fn vectors<'m>(mesh: &'m TriMesh, name: &str, domain: Domain) -> Option<Vectors<'m>> {
    match mesh.layer(name) {
        Some(Layer { values: LayerValues::Vec3(values), domain: of, index, .. })
            if *of == domain =>
        {
            Some(Vectors { values, index })
        }
        _ => None,
    }
}

/// The values of a layer over vertices or faces.
struct Vectors<'m> {
    values: &'m [DVec3],
    index: &'m [u32],
}

impl Vectors<'_> {
    /// The mesh is checked: an index is that of a value, or `NO_VALUE`, which is beyond all.
    fn get(&self, element: usize) -> Option<DVec3> {
        self.values.get(self.index[element] as usize).copied()
    }
}

/// What stands behind the positions, or behind the corners of faces.
struct Extras<'m> {
    normals: Option<Vectors<'m>>,
    colors: Option<Vectors<'m>>,
    quality: Option<&'m [f64]>,
    /// Other numbers: name, values and which of them each element has.
    numbers: Vec<(&'m str, &'m [f64], &'m [u32])>,
    /// Of corners: values, and which of them each has.
    texcoords: Option<(&'m [DVec2], &'m [u32])>,
    /// The number of each face's picture.
    pictures: Option<&'m [i32]>,
}

/// The layers of numbers whose names are a word that no other property has.
fn numbers(mesh: &TriMesh, domain: Domain, has_quality: bool) -> Vec<(&str, &[f64], &[u32])> {
    const TAKEN: [&str; 14] = [
        "x",
        "y",
        "z",
        "nx",
        "ny",
        "nz",
        "red",
        "green",
        "blue",
        "vertex_indices",
        "vertex_index",
        "texcoord",
        "texnumber",
        "texture_index",
    ];
    let is_word = |name: &str| !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_graphic());
    let of = |layer: &'_ Layer| {
        is_word(&layer.name)
            && layer.domain == domain
            && !TAKEN.contains(&layer.name.as_str())
            && !(has_quality && layer.name == "quality")
    };
    let layers = mesh.layers.iter().filter(|layer| of(layer));
    let numbers = layers.filter_map(|layer| match &layer.values {
        LayerValues::Number(values) => {
            Some((layer.name.as_str(), values.as_slice(), layer.index.as_slice()))
        }
        _ => None,
    });
    numbers.collect()
}

fn texcoords(mesh: &TriMesh) -> Option<(&[DVec2], &[u32])> {
    match mesh.layer(Layer::TEXCOORD) {
        Some(Layer {
            domain: Domain::Corner, values: LayerValues::Vec2(values), index, ..
        }) => Some((values, index)),
        _ => None,
    }
}

/// The pictures of base colors.
struct Textures {
    names: Vec<String>,
    /// The number of each face's picture, if there is one; -1 of a face that has none.
    of_faces: Option<Vec<i32>>,
}

impl Textures {
    fn of(mesh: &TriMesh) -> Self {
        let textured = mesh.materials.iter().filter_map(|material| {
            Some((&material.name, material.texture(TextureRole::BaseColor)?.name.clone()))
        });
        let (materials, names): (Vec<&String>, Vec<String>) = textured.unzip();
        let of_faces = match mesh.layer(Layer::MATERIAL) {
            Some(Layer {
                domain: Domain::Face, values: LayerValues::Label(labels), index, ..
            }) if !names.is_empty() => {
                let place = |label| materials.iter().position(|name| *name == label);
                let places: Vec<i32> =
                    labels.iter().map(|label| place(label).map_or(-1, |at| at as i32)).collect();
                let number = |at: &u32| places.get(*at as usize).copied().unwrap_or(-1);
                Some(index.iter().map(number).collect())
            }
            _ => None,
        };
        Self { names, of_faces }
    }
}

impl Extras<'_> {
    fn declare(&self, real: &str, header: &mut String) {
        let mut property =
            |kind: &str, name: &str| header.push_str(&format!("property {kind} {name}\n"));
        if self.normals.is_some() {
            ["nx", "ny", "nz"].into_iter().for_each(|name| property(real, name));
        }
        if self.colors.is_some() {
            ["red", "green", "blue"].into_iter().for_each(|name| property("uchar", name));
        }
        if self.quality.is_some() {
            property(real, "quality");
        }
        if self.pictures.is_some() {
            property("int", "texnumber");
        }
        self.numbers.iter().for_each(|(name, ..)| property(real, name));
        if self.texcoords.is_some() {
            property("list uchar float", "texcoord");
        }
    }

    fn write(&self, element: usize, rows: &mut Rows) {
        if let Some(normals) = &self.normals {
            let normal = normals.get(element).unwrap_or(DVec3::ZERO);
            normal.to_array().into_iter().for_each(|number| rows.real(number));
        }
        if let Some(colors) = &self.colors {
            let color = colors.get(element).unwrap_or(DVec3::ONE);
            bytes_of(color).into_iter().for_each(|byte| rows.byte(byte));
        }
        if let Some(quality) = self.quality {
            rows.real(quality[element]);
        }
        if let Some(pictures) = self.pictures {
            rows.index(pictures[element] as u32);
        }
        for (_, values, index) in &self.numbers {
            rows.real(values.get(index[element] as usize).copied().unwrap_or(f64::NAN));
        }
        if let Some((values, index)) = self.texcoords {
            let corners = index[3 * element..].first_chunk::<3>();
            let corners = corners.map(|at| at.map(|at| values.get(at as usize).copied()));
            match corners {
                Some([Some(a), Some(b), Some(c)]) => {
                    rows.byte(6);
                    [a, b, c].iter().flat_map(|uv| uv.to_array()).for_each(|x| rows.float(x));
                }
                _ => rows.byte(0),
            }
        }
    }
}

fn header(
    mesh: &TriMesh,
    (vertices, faces): (&Extras, &Extras),
    textures: &[String],
    options: PlyOptions,
) -> Vec<u8> {
    let format = match options.encoding {
        Encoding::Binary => "binary_little_endian",
        Encoding::Ascii => "ascii",
    };
    let real = match options.precision {
        Precision::Float => "float",
        Precision::Double => "double",
    };
    let mut head = format!("ply\nformat {format} 1.0\n").into_bytes();
    for name in textures {
        // A name is one line.
        let name = name.replace(['\n', '\r'], " ");
        head.extend([b"comment TextureFile ", &name_to_bytes(&name)[..], b"\n"].concat());
    }
    let mut text = format!("element vertex {}\n", mesh.positions.len());
    for name in ["x", "y", "z"] {
        text.push_str(&format!("property {real} {name}\n"));
    }
    vertices.declare(real, &mut text);
    text.push_str(&format!("element face {}\n", mesh.faces.len()));
    text.push_str("property list uchar int vertex_indices\n");
    faces.declare(real, &mut text);
    text.push_str("end_header\n");
    head.extend(text.as_bytes());
    head
}

/// Rows of numbers on their way to the writer.
struct Rows<'b> {
    buffer: &'b mut Vec<u8>,
    options: PlyOptions,
}

impl Rows<'_> {
    /// The corners of a face.
    fn triangle(&mut self, corners: [VertexId; 3]) {
        match self.options.encoding {
            Encoding::Binary => {
                let mut bytes = [3; 13];
                for (four, corner) in bytes[1..].as_chunks_mut::<4>().0.iter_mut().zip(corners) {
                    *four = corner.0.to_le_bytes();
                }
                self.buffer.extend_from_slice(&bytes);
            }
            Encoding::Ascii => {
                self.byte(3);
                corners.into_iter().for_each(|corner| self.index(corner.0));
            }
        }
    }

    fn real(&mut self, value: f64) {
        use Precision::{Double, Float};
        match (self.options.encoding, self.options.precision) {
            (Encoding::Binary, Float) => {
                self.buffer.extend_from_slice(&(value as f32).to_le_bytes());
            }
            (Encoding::Binary, Double) => self.buffer.extend_from_slice(&value.to_le_bytes()),
            (Encoding::Ascii, Float) => self.text(zmij::Buffer::new().format(value as f32)),
            (Encoding::Ascii, Double) => self.text(zmij::Buffer::new().format(value)),
        }
    }

    /// A number of 32 bits in either precision.
    fn float(&mut self, value: f64) {
        match self.options.encoding {
            Encoding::Binary => self.buffer.extend_from_slice(&(value as f32).to_le_bytes()),
            Encoding::Ascii => self.text(zmij::Buffer::new().format(value as f32)),
        }
    }

    fn byte(&mut self, value: u8) {
        match self.options.encoding {
            Encoding::Binary => self.buffer.push(value),
            Encoding::Ascii => self.text(&value.to_string()),
        }
    }

    fn index(&mut self, value: u32) {
        match self.options.encoding {
            Encoding::Binary => self.buffer.extend_from_slice(&value.to_le_bytes()),
            // -1 is that of a face without a picture.
            Encoding::Ascii => self.text(&(value as i32).to_string()),
        }
    }

    /// A word and a blank; what is not finite is `nan` or `inf`, as readers in C know it.
    fn text(&mut self, word: &str) {
        let word = match word {
            "NaN" => "nan",
            other => other.strip_suffix(".0").unwrap_or(other),
        };
        self.buffer.extend_from_slice(word.as_bytes());
        self.buffer.push(b' ');
    }

    fn end(&mut self) {
        let is_text = self.options.encoding == Encoding::Ascii;
        if let Some(last) = self.buffer.last_mut().filter(|_| is_text) {
            *last = b'\n';
        }
    }
}
