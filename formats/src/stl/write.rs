//! From a mesh to the bytes of an STL file.

use std::io::{self, Write};

use glam::DVec3;
use mve_core::{Control, Enumeration};
use mve_mesh::data::{TriMesh, VertexId};

use super::{HEAD, RECORD};
use crate::pieces::write_pieces;

/// Triangles that a thread makes at once.
const CHUNK: usize = 1 << 12;

/// How numbers stand in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StlEncoding {
    /// In binary, 50 bytes a triangle.
    Binary,
    /// As text.
    Ascii,
}

impl Enumeration for StlEncoding {
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("Binary", "Small: 50 bytes a triangle."), ("Ascii", "Text that a person can read.")];
    const VALUES: &'static [Self] = &[Self::Binary, Self::Ascii];
}

/// Writes the triangles of a mesh, in floats of 32 bits, each with its normal. All else that the
/// mesh has is left out.
///
/// # Errors
/// `InvalidInput` when the mesh is not well formed, has too many faces for the format or a
/// coordinate that is no finite float; whatever the writer reports; `Other` when `control` ends it.
pub fn write_stl(
    mesh: &TriMesh,
    encoding: StlEncoding,
    out: &mut dyn Write,
    control: Control,
) -> io::Result<()> {
    let invalid = |message: String| io::Error::new(io::ErrorKind::InvalidInput, message);
    mesh.check().map_err(|fault| invalid(fault.to_string()))?;
    let Ok(n) = u32::try_from(mesh.faces.len()) else {
        return Err(invalid("STL counts to 4,294,967,295; the mesh has more faces".to_owned()));
    };
    let mut used = mesh.faces.iter().flatten();
    let is_float = |p: DVec3| p.as_vec3().is_finite();
    // Only those that a face has need to be floats.
    if !mesh.positions.iter().all(|p| is_float(*p))
        && let Some(v) = used.find(|v| !is_float(mesh.positions[v.idx()]))
    {
        let DVec3 { x, y, z } = mesh.positions[v.idx()];
        return Err(invalid(format!(
            "vertex {} is at {x} {y} {z}, which are no finite floats",
            v.0
        )));
    }
    match encoding {
        StlEncoding::Binary => {
            // Not `solid`, with which text begins.
            let mut head = [b' '; HEAD];
            head[..10].copy_from_slice(b"binary STL");
            head[HEAD - 4..].copy_from_slice(&n.to_le_bytes());
            out.write_all(&head)?;
        }
        StlEncoding::Ascii => out.write_all(b"solid mesh\n")?,
    }
    let corners = |face: &[VertexId; 3]| face.map(|v| mesh.positions[v.idx()]);
    write_pieces(mesh.faces.len(), CHUNK, out, control, |range, buffer| {
        let faces = &mesh.faces[range];
        match encoding {
            StlEncoding::Binary => {
                buffer.resize(faces.len() * RECORD, 0);
                let records = buffer.as_chunks_mut().0;
                for (record, face) in records.iter_mut().zip(faces) {
                    *record = binary_record(corners(face));
                }
            }
            StlEncoding::Ascii => faces.iter().for_each(|face| text_record(corners(face), buffer)),
        }
        Ok(())
    })?;
    match encoding {
        StlEncoding::Binary => Ok(()),
        StlEncoding::Ascii => out.write_all(b"endsolid mesh\n"),
    }
}

#[inline]
fn binary_record(corners: [DVec3; 3]) -> [u8; RECORD] {
    let [a, b, c] = corners;
    let points = [normal(corners), a, b, c].map(|p| p.as_vec3().to_array());
    let mut bytes = [0; RECORD];
    for (four, number) in bytes.as_chunks_mut().0.iter_mut().zip(points.as_flattened()) {
        *four = number.to_le_bytes();
    }
    bytes
}

fn text_record(corners: [DVec3; 3], buffer: &mut Vec<u8>) {
    text(buffer, "facet normal", normal(corners));
    buffer.extend(b"  outer loop\n");
    corners.iter().for_each(|p| text(buffer, "    vertex", *p));
    buffer.extend(b"  endloop\nendfacet\n");
}

#[inline]
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

fn text(buffer: &mut Vec<u8>, words: &str, point: DVec3) {
    buffer.extend(words.as_bytes());
    for number in point.as_vec3().to_array() {
        buffer.push(b' ');
        let mut digits = zmij::Buffer::new();
        let number = digits.format(number);
        buffer.extend(number.strip_suffix(".0").unwrap_or(number).as_bytes());
    }
    buffer.push(b'\n');
}
