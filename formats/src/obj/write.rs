//! From a mesh to the text of an OBJ file and an MTL file.
//!
//! Numbers are written with the fewest digits that read back as the same number; -0 keeps its
//! sign. The same mesh gives the same bytes. Nothing in the text tells when or by what it was
//! written.

use std::io::{self, Write};

use glam::{DVec2, DVec3};
use mve_mesh::data::{
    Domain, Layer, LayerValues, Material, NO_VALUE, Texture, TriMesh, name_to_bytes,
};

use super::cursor::is_blank_char;

/// Bytes that are gathered before they go to the writer.
const CHUNK: usize = 1 << 16;

/// Writes `mesh` as OBJ text that names `mtl_name` as its material file.
///
/// Written are positions, faces and, where they have the usual kind and domain, the layers
/// texcoord, normal (corner or vertex), color, object, group, material and smoothing. What was read
/// from an OBJ file reads back equal: positions, faces, layers and their indices, and the bytes of
/// names. Layers of other names have no place in the format and are left out. Names cannot hold
/// line ends, for which `_` stands, nor blanks or a backslash after a blank at the end, which are
/// left out.
///
/// # Errors
/// `InvalidInput` when the mesh is not well formed or a written number is not finite; whatever the
/// writer reports.
pub fn write_obj(mesh: &TriMesh, out: &mut dyn Write, mtl_name: Option<&str>) -> io::Result<()> {
    mesh.check().map_err(|fault| invalid(fault.to_string()))?;
    let mut text = Text { out, buffer: Vec::with_capacity(CHUNK + 256), digits: Digits::default() };
    if let Some(name) = mtl_name {
        text.statement("mtllib", &path_text(name))?;
    }
    let texcoords = vec2_layer(mesh, Layer::TEXCOORD);
    let normals = vec3_layer(mesh, Layer::NORMAL, Domain::Corner)
        .or_else(|| vec3_layer(mesh, Layer::NORMAL, Domain::Vertex));
    write_vertices(mesh, &mut text)?;
    for (i, value) in texcoords.iter().flat_map(|(_, values)| values.iter().enumerate()) {
        text.numbers("vt", &value.to_array(), i)?;
    }
    for (i, value) in normals.iter().flat_map(|(_, values)| values.iter().enumerate()) {
        text.numbers("vn", &value.to_array(), i)?;
    }
    let lists = [texcoords.map(|(layer, _)| layer), normals.map(|(layer, _)| layer)];
    write_faces(mesh, lists, &mut text)?;
    text.flush()
}

/// A relative path as a statement can say it: what begins an option or a comment, and a blank,
/// would not be taken for a part of it at its start.
pub(super) fn path_text(path: &str) -> String {
    let is_plain = !path.starts_with(|c: char| matches!(c, '-' | '#') || c.is_whitespace());
    if is_plain { path.to_owned() } else { format!("./{path}") }
}

/// Writes materials as MTL text, their statements word for word and textures by their names.
///
/// # Errors
/// Whatever the writer reports.
pub fn write_mtl(materials: &[Material], out: &mut dyn Write) -> io::Result<()> {
    let mut text = Text { out, buffer: Vec::new(), digits: Digits::default() };
    for (i, material) in materials.iter().enumerate() {
        if i > 0 {
            text.buffer.push(b'\n');
        }
        text.name_line("newmtl", &material.name)?;
        let n_statements = material.statements.len();
        for place in 0..=n_statements {
            let is_here = |texture: &&Texture| texture.place.min(n_statements) == place;
            for texture in material.textures.iter().filter(is_here) {
                let Texture { keyword, options, name, .. } = texture;
                text.statement(keyword, &format!("{options}{name}"))?;
            }
            if let Some((keyword, arguments)) = material.statements.get(place) {
                text.statement(keyword, arguments.trim_end_matches(['\\', ' ']))?;
            }
        }
    }
    text.flush()
}

fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

fn vec2_layer<'m>(mesh: &'m TriMesh, name: &str) -> Option<(&'m Layer, &'m [DVec2])> {
    match mesh.layer(name) {
        Some(layer @ Layer { domain: Domain::Corner, values: LayerValues::Vec2(v), .. }) => {
            Some((layer, v))
        }
        _ => None,
    }
}

fn vec3_layer<'m>(
    mesh: &'m TriMesh,
    name: &str,
    domain: Domain,
) -> Option<(&'m Layer, &'m [DVec3])> {
    match mesh.layer(name) {
        Some(layer @ Layer { values: LayerValues::Vec3(v), .. }) if layer.domain == domain => {
            Some((layer, v))
        }
        _ => None,
    }
}

fn write_vertices(mesh: &TriMesh, text: &mut Text) -> io::Result<()> {
    let colors = vec3_layer(mesh, Layer::COLOR, Domain::Vertex);
    for (i, position) in mesh.positions.iter().enumerate() {
        // The mesh is checked: an index is that of a value or `NO_VALUE`, which is beyond all.
        let color = colors.and_then(|(layer, values)| values.get(layer.index[i] as usize));
        match color {
            Some(c) => {
                let p = position;
                text.numbers("v", &[p.x, p.y, p.z, c.x, c.y, c.z], i)?;
            }
            None => text.numbers("v", &position.to_array(), i)?,
        }
    }
    Ok(())
}

fn write_faces(mesh: &TriMesh, lists: [Option<&Layer>; 2], text: &mut Text) -> io::Result<()> {
    const STATEMENTS: [(&str, &str, &str); 4] = [
        ("o", Layer::OBJECT, ""),
        ("g", Layer::GROUP, ""),
        ("usemtl", Layer::MATERIAL, ""),
        ("s", Layer::SMOOTHING, "off"),
    ];
    let labels = STATEMENTS.map(|(keyword, name, none)| match mesh.layer(name) {
        Some(Layer { domain: Domain::Face, values: LayerValues::Label(v), index, .. }) => {
            Some((keyword, none, v.as_slice(), index.as_slice()))
        }
        _ => None,
    });
    let mut current = [None; STATEMENTS.len()];
    for (f, face) in mesh.faces.iter().enumerate() {
        for (label, current) in labels.iter().zip(&mut current) {
            let Some((keyword, none, values, index)) = label else { continue };
            let name = values.get(index[f] as usize).map(String::as_str);
            if name != *current {
                text.name_line(keyword, name.unwrap_or(none))?;
                *current = name;
            }
        }
        text.buffer.push(b'f');
        for (k, vertex) in face.iter().enumerate() {
            let value = |layer: Option<&Layer>| match layer {
                Some(layer) if layer.domain == Domain::Vertex => layer.index[vertex.idx()],
                Some(layer) => layer.index[3 * f + k],
                None => NO_VALUE,
            };
            text.corner(vertex.0, value(lists[0]), value(lists[1]));
        }
        text.end_line()?;
    }
    Ok(())
}

/// A character as it may stand in a name.
fn plain_char(c: char) -> char {
    if matches!(c, '\n' | '\r' | '\0') { '_' } else { c }
}

/// A statement without what would join the next line on: blanks and backslashes at its end, but
/// not the backslash of a name.
fn line_that_ends(line: &str) -> &str {
    let mut line = line.trim_end_matches(is_blank_char);
    while let Some(shorter) = line.strip_suffix('\\').filter(|rest| rest.ends_with(is_blank_char)) {
        line = shorter.trim_end_matches(is_blank_char);
    }
    line
}

/// The text on its way to the writer.
struct Text<'w> {
    out: &'w mut dyn Write,
    buffer: Vec<u8>,
    digits: Digits,
}

impl Text<'_> {
    fn end_line(&mut self) -> io::Result<()> {
        self.buffer.push(b'\n');
        if self.buffer.len() >= CHUNK { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }

    fn statement(&mut self, keyword: &str, arguments: &str) -> io::Result<()> {
        let line: String = format!("{keyword} {arguments}").chars().map(plain_char).collect();
        self.buffer.extend_from_slice(&name_to_bytes(line_that_ends(&line)));
        self.end_line()
    }

    fn name_line(&mut self, keyword: &str, name: &str) -> io::Result<()> {
        let name = name.trim_matches(is_blank_char);
        // Alone, or before a blank, it would begin a comment.
        let is_comment = |rest: &str| rest.is_empty() || rest.starts_with(is_blank_char);
        match name.strip_prefix('#').filter(|rest| is_comment(rest)) {
            Some(rest) => self.statement(keyword, &format!("_{rest}")),
            None => self.statement(keyword, name),
        }
    }

    fn numbers(&mut self, keyword: &str, values: &[f64], element: usize) -> io::Result<()> {
        self.buffer.extend_from_slice(keyword.as_bytes());
        for &value in values {
            if !value.is_finite() {
                let message = format!("`{keyword}` {} holds {value}", element + 1);
                return Err(invalid(format!("{message}, but OBJ has finite numbers only")));
            }
            self.buffer.push(b' ');
            let digits = self.digits.number.format_finite(value).as_bytes();
            let digits = digits.strip_suffix(b".0").unwrap_or(digits);
            self.buffer.extend_from_slice(digits);
        }
        self.end_line()
    }

    fn corner(&mut self, vertex: u32, texcoord: u32, normal: u32) {
        self.buffer.push(b' ');
        self.index(vertex);
        if texcoord != NO_VALUE || normal != NO_VALUE {
            self.buffer.push(b'/');
        }
        if texcoord != NO_VALUE {
            self.index(texcoord);
        }
        if normal != NO_VALUE {
            self.buffer.push(b'/');
            self.index(normal);
        }
    }

    /// Writes an index from 0 as the number from 1 that the file has for it.
    fn index(&mut self, idx: u32) {
        let mut left = u64::from(idx) + 1;
        let mut start = self.digits.whole.len();
        while left > 0 {
            start -= 1;
            self.digits.whole[start] = b'0' + (left % 10) as u8;
            left /= 10;
        }
        self.buffer.extend_from_slice(&self.digits.whole[start..]);
    }
}

/// Room for the digits of one number.
#[derive(Default)]
struct Digits {
    number: zmij::Buffer,
    /// A `u32` plus one has at most ten digits.
    whole: [u8; 10],
}
