//! From a mesh to the bytes of an OFF file.

use std::io::{self, Write};

use glam::DVec3;
use mve_core::Control;

use mve_mesh::data::bytes_of;
use mve_mesh::data::{Domain, Layer, LayerValues, TriMesh};

/// Lines that are gathered before they go to the writer.
const LINES: usize = 1 << 11;

/// Writes the faces of a mesh as text, with all digits of its positions, and the colors of vertices
/// (`COFF`) or faces, as bytes. All else that the mesh has is left out.
///
/// # Errors
/// `InvalidInput` when the mesh is not well formed or has a coordinate that is not finite; whatever
/// the writer reports; `Other` when `control` ends it.
pub fn write_off(mesh: &TriMesh, out: &mut dyn Write, control: Control) -> io::Result<()> {
    let invalid = |message: String| io::Error::new(io::ErrorKind::InvalidInput, message);
    mesh.check().map_err(|fault| invalid(fault.to_string()))?;
    if let Some(v) = mesh.positions.iter().position(|p| !p.is_finite()) {
        let DVec3 { x, y, z } = mesh.positions[v];
        return Err(invalid(format!("vertex {v} is at {x} {y} {z}, which are no finite numbers")));
    }
    let colors = |domain| match mesh.layer(Layer::COLOR) {
        Some(Layer { values: LayerValues::Vec3(values), domain: of, index, .. })
            if *of == domain =>
        {
            Some((values, index))
        }
        _ => None,
    };
    let (of_vertices, of_faces) = (colors(Domain::Vertex), colors(Domain::Face));
    let color = |(values, index): (&Vec<DVec3>, &Vec<u32>), at: usize| {
        bytes_of(values.get(index[at] as usize).copied().unwrap_or(DVec3::ONE))
    };
    let (n_vertices, n_faces) = (mesh.positions.len(), mesh.faces.len());
    let keyword = if of_vertices.is_some() { "COFF" } else { "OFF" };
    let mut buffer = format!("{keyword}\n{n_vertices} {n_faces} 0\n").into_bytes();
    let mut numbers = zmij::Buffer::new();
    let mut flush = |buffer: &mut Vec<u8>, done: usize| {
        control.at(done as f64 / (n_vertices + n_faces) as f64).map_err(io::Error::other)?;
        out.write_all(buffer)?;
        buffer.clear();
        Ok::<(), io::Error>(())
    };
    for (at, p) in mesh.positions.iter().enumerate() {
        for (k, x) in p.to_array().into_iter().enumerate() {
            if k > 0 {
                buffer.push(b' ');
            }
            let number = numbers.format(x);
            buffer.extend(number.strip_suffix(".0").unwrap_or(number).as_bytes());
        }
        if let Some(colors) = of_vertices {
            let [red, green, blue] = color(colors, at);
            write!(buffer, " {red} {green} {blue} 255")?;
        }
        buffer.push(b'\n');
        if at % LINES == 0 {
            flush(&mut buffer, at)?;
        }
    }
    for (at, face) in mesh.faces.iter().enumerate() {
        let [a, b, c] = face.map(|v| v.0);
        write!(buffer, "3 {a} {b} {c}")?;
        if let Some(colors) = of_faces {
            let [red, green, blue] = color(colors, at);
            write!(buffer, " {red} {green} {blue}")?;
        }
        buffer.push(b'\n');
        if at % LINES == 0 {
            flush(&mut buffer, n_vertices + at)?;
        }
    }
    flush(&mut buffer, n_vertices + n_faces)
}
