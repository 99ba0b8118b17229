//! From a mesh to the text of an Open Inventor file.
//!
//! The same mesh gives the same bytes.

use std::io::{self, Write};

use glam::DVec3;
use mve_core::Control;

use mve_mesh::data::{
    Domain, FaceMaterials, Layer, LayerValues, Material, NO_VALUE, TextureRole, TriMesh,
    name_to_bytes, shown_name,
};

/// Bytes that are gathered before they go to the writer.
const CHUNK: usize = 1 << 16;

/// Writes a mesh as text of Open Inventor 2.1, with all digits: positions, and normals, texture
/// coordinates and colors by indices of their own, so that no vertex is split; a part for each
/// material. `materials` are those of the mesh, whose textures are named as the file is to name
/// them. Says what is left out.
///
/// What a corner lacks is the normal (0, 0, 1), the texture coordinate (0, 0) or white.
///
/// # Errors
/// `InvalidInput` when the mesh is not well formed, has a number that is not finite or too many
/// vertices for the format; whatever the writer reports; `Other` when `control` ends it.
pub fn write_iv(
    mesh: &TriMesh,
    materials: &[Material],
    out: &mut dyn Write,
    control: Control,
) -> io::Result<Vec<String>> {
    mesh.check().map_err(|fault| invalid(fault.to_string()))?;
    if i32::try_from(mesh.positions.len().max(3 * mesh.faces.len())).is_err() {
        return Err(invalid("the format counts to 2,147,483,647; the mesh is larger".to_owned()));
    }
    let mut file = IvFile { out, buffer: Vec::new(), control };
    file.buffer.extend(b"#Inventor V2.1 ascii\n\nSeparator {\n");
    file.vectors("Coordinate3", "point", mesh.positions.iter().map(|p| p.to_array()))?;
    let mut warnings = Vec::new();
    let normals = file.layer(mesh, Layer::NORMAL, "Normal", "vector", [0.0, 0.0, 1.0])?;
    let texcoords = file.layer(mesh, Layer::TEXCOORD, "TextureCoordinate2", "point", [0.0; 3])?;
    let colors = file.layer(mesh, Layer::COLOR, "Material", "diffuseColor", [1.0; 3])?;
    let bindings = [
        ("NormalBinding", &normals),
        ("TextureCoordinateBinding", &texcoords),
        ("MaterialBinding", &colors),
    ];
    for (node, layer) in bindings.into_iter().filter_map(|(node, l)| Some((node, l.as_ref()?))) {
        let value = match layer.domain {
            Domain::Face => "PER_FACE_INDEXED",
            _ => "PER_VERTEX_INDEXED",
        };
        writeln!(file.buffer, "  {node} {{ value {value} }}")?;
    }
    let parts =
        [("normalIndex", normals), ("textureCoordIndex", texcoords), ("materialIndex", colors)];
    let parts: Vec<(&str, Indices)> =
        parts.into_iter().filter_map(|(field, layer)| Some((field, layer?))).collect();
    file.shapes(mesh, materials, &parts, &mut warnings)?;
    file.buffer.extend(b"}\n");
    file.flush(1.0)?;
    left_out(mesh, &mut warnings);
    Ok(warnings)
}

fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

fn left_out(mesh: &TriMesh, warnings: &mut Vec<String>) {
    let has_place = [Layer::NORMAL, Layer::TEXCOORD, Layer::COLOR, Layer::MATERIAL];
    for layer in mesh.layers.iter().filter(|layer| !has_place.contains(&layer.name.as_str())) {
        let name = &layer.name;
        warnings.push(format!("the layer \"{name}\" has no place in the file and is left out"));
    }
}

/// Which values of a layer corners or faces have.
struct Indices<'m> {
    domain: Domain,
    index: &'m [u32],
    /// The number of the value of what has none.
    none: u32,
}

impl Indices<'_> {
    fn get(&self, element: usize) -> u32 {
        let value = self.index.get(element).copied().unwrap_or(NO_VALUE);
        if value == NO_VALUE { self.none } else { value }
    }
}

struct IvFile<'w> {
    out: &'w mut dyn Write,
    buffer: Vec<u8>,
    control: Control<'w>,
}

impl IvFile<'_> {
    /// Writes a node with a list of vectors.
    fn vectors<const N: usize>(
        &mut self,
        node: &str,
        field: &str,
        vectors: impl ExactSizeIterator<Item = [f64; N]>,
    ) -> io::Result<()> {
        write!(self.buffer, "  {node} {{ {field} [")?;
        let n = vectors.len();
        let mut digits = zmij::Buffer::new();
        for (at, vector) in vectors.enumerate() {
            for (k, number) in vector.into_iter().enumerate() {
                if !number.is_finite() {
                    let message = format!("{node} {at} holds {number}; the format has finite ones");
                    return Err(invalid(message));
                }
                self.buffer.push(if k == 0 { b'\n' } else { b' ' });
                let number = digits.format_finite(number);
                self.buffer.extend(number.strip_suffix(".0").unwrap_or(number).as_bytes());
            }
            self.buffer.push(b',');
            if self.buffer.len() >= CHUNK {
                self.flush(0.4 * at as f64 / n as f64)?;
            }
        }
        self.buffer.extend(b"\n  ] }\n");
        Ok(())
    }

    /// Writes the values of a layer, and one for what has none.
    fn layer<'m>(
        &mut self,
        mesh: &'m TriMesh,
        name: &str,
        node: &str,
        field: &str,
        none: [f64; 3],
    ) -> io::Result<Option<Indices<'m>>> {
        let Some(layer) = mesh.layer(name) else { return Ok(None) };
        let n = layer.values.len();
        let extra = usize::from(layer.index.contains(&NO_VALUE));
        match &layer.values {
            LayerValues::Vec3(values) if name != Layer::TEXCOORD => {
                let value = |at: usize| values.get(at).map_or(none, |value| value.to_array());
                self.vectors(node, field, (0..n + extra).map(value))?;
            }
            LayerValues::Vec2(values) if name == Layer::TEXCOORD => {
                let value = |at: usize| values.get(at).map_or([0.0; 2], |value| value.to_array());
                self.vectors(node, field, (0..n + extra).map(value))?;
            }
            _ => return Ok(None),
        }
        Ok(Some(Indices { domain: layer.domain, index: &layer.index, none: n as u32 }))
    }

    /// Writes the faces of each material.
    fn shapes(
        &mut self,
        mesh: &TriMesh,
        materials: &[Material],
        parts: &[(&str, Indices)],
        warnings: &mut Vec<String>,
    ) -> io::Result<()> {
        let (labels, index): (&[String], &[u32]) = match mesh.layer(Layer::MATERIAL) {
            Some(Layer {
                values: LayerValues::Label(labels), domain: Domain::Face, index, ..
            }) => (labels, index),
            _ => (&[], &[]),
        };
        let has_colors = parts.iter().any(|(field, _)| *field == "materialIndex");
        let defined = FaceMaterials::of(mesh).of_labels;
        if has_colors && defined.iter().flatten().any(|material| !material.statements.is_empty()) {
            let text = "where faces or vertices have colors, those of materials are left out";
            warnings.push(text.to_owned());
        }
        let mut of_labels: Vec<Vec<u32>> = vec![Vec::new(); labels.len() + 1];
        for face in 0..mesh.faces.len() {
            let label = index.get(face).map_or(labels.len(), |at| *at as usize).min(labels.len());
            of_labels[label].push(face as u32);
        }
        let mut n_done = 0;
        for (number, faces) in of_labels.iter().enumerate().filter(|(_, faces)| !faces.is_empty()) {
            self.buffer.extend(b"  Separator {\n");
            if let Some(label) = labels.get(number) {
                let material = materials.iter().find(|material| material.name == *label);
                self.material(label, material, has_colors, warnings)?;
            }
            self.buffer.extend(b"    IndexedFaceSet {\n      coordIndex [");
            let corner = |face: u32, k: usize| mesh.faces[face as usize][k].0;
            self.indices(faces, &corner, (n_done, mesh.faces.len()))?;
            for (field, indices) in parts {
                write!(self.buffer, "      {field} [")?;
                match indices.domain {
                    Domain::Face => {
                        for (at, &face) in faces.iter().enumerate() {
                            self.buffer.extend(if at % 16 == 0 { b"\n" } else { b" " });
                            write!(self.buffer, "{},", indices.get(face as usize))?;
                            self.flush_full(n_done as f64 / mesh.faces.len() as f64)?;
                        }
                        self.buffer.extend(b" ]\n");
                    }
                    Domain::Corner => {
                        let corner = |face: u32, k: usize| indices.get(3 * face as usize + k);
                        self.indices(faces, &corner, (n_done, mesh.faces.len()))?;
                    }
                    Domain::Vertex => {
                        let corner =
                            |face: u32, k: usize| indices.get(mesh.faces[face as usize][k].idx());
                        self.indices(faces, &corner, (n_done, mesh.faces.len()))?;
                    }
                }
            }
            self.buffer.extend(b"    }\n  }\n");
            n_done += faces.len();
        }
        Ok(())
    }

    /// Writes a list with three numbers and -1 for each face.
    fn indices(
        &mut self,
        faces: &[u32],
        corner: &dyn Fn(u32, usize) -> u32,
        (n_before, n): (usize, usize),
    ) -> io::Result<()> {
        for (at, &face) in faces.iter().enumerate() {
            let [a, b, c] = [0, 1, 2].map(|k| corner(face, k));
            write!(self.buffer, "\n{a}, {b}, {c}, -1,")?;
            self.flush_full(0.4 + 0.6 * (n_before + at) as f64 / n as f64)?;
        }
        self.buffer.extend(b"\n      ]\n");
        Ok(())
    }

    fn material(
        &mut self,
        name: &str,
        material: Option<&Material>,
        has_colors: bool,
        warnings: &mut Vec<String>,
    ) -> io::Result<()> {
        let name = identifier(name);
        let texture = material.and_then(|material| material.texture(TextureRole::BaseColor));
        if !has_colors {
            writeln!(self.buffer, "    DEF {name} Material {{")?;
            for (keyword, text) in material.iter().flat_map(|material| &material.statements) {
                let mut numbers = text.split_whitespace().map_while(|w| w.parse::<f64>().ok());
                let field = match keyword.as_str() {
                    "Kd" => "diffuseColor",
                    "Ka" => "ambientColor",
                    "Ks" => "specularColor",
                    "Ke" => "emissiveColor",
                    "Ns" => "shininess",
                    "d" => "transparency",
                    _ => continue,
                };
                let first = numbers.next().filter(|number| number.is_finite());
                let text = match (keyword.as_str(), first, numbers.next(), numbers.next()) {
                    ("Ns", Some(number), ..) => (number / 128.0).clamp(0.0, 1.0).to_string(),
                    ("d", Some(number), ..) => (1.0 - number).clamp(0.0, 1.0).to_string(),
                    ("Ns" | "d", ..) => continue,
                    (_, Some(x), Some(y), Some(z)) if DVec3::new(x, y, z).is_finite() => {
                        format!("{x} {y} {z}")
                    }
                    _ => continue,
                };
                writeln!(self.buffer, "      {field} {text}")?;
            }
            self.buffer.extend(b"    }\n");
        }
        if let Some(texture) = texture {
            let def = if has_colors { format!("DEF {name} ") } else { String::new() };
            let file = name_to_bytes(&texture.name);
            let mut quoted = Vec::with_capacity(file.len());
            for byte in file.iter() {
                if matches!(byte, b'"' | b'\\') {
                    quoted.push(b'\\');
                }
                quoted.push(*byte);
            }
            write!(self.buffer, "    {def}Texture2 {{ filename \"")?;
            self.buffer.extend(quoted);
            let is_clamped = texture.options.contains("-clamp on");
            let wrap = if is_clamped { " wrapS CLAMP wrapT CLAMP" } else { "" };
            writeln!(self.buffer, "\"{wrap} }}")?;
        }
        if let Some(material) = material
            && material.textures.iter().any(|texture| texture.role != TextureRole::BaseColor)
        {
            let name = shown_name(&material.name);
            warnings.push(format!("of the pictures of {name} that of the base color has a place"));
        }
        Ok(())
    }

    fn flush_full(&mut self, share: f64) -> io::Result<()> {
        if self.buffer.len() >= CHUNK { self.flush(share) } else { Ok(()) }
    }

    fn flush(&mut self, share: f64) -> io::Result<()> {
        self.control.at(share).map_err(io::Error::other)?;
        self.out.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }
}

/// A name as the format takes it: letters, digits and `_`, a digit not first.
fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    let is_whole = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if is_whole { name } else { format!("_{name}") }
}
