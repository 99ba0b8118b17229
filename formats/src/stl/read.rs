//! From the bytes of an STL file to a mesh.

use mve_core::Control;
use mve_mesh::data::{TriMesh, VertexId};

use super::points::{Points, hash_of, point_of};
use super::records::{Records, Trouble};
use super::weld::welded;
use super::{HEAD, RECORD};
use crate::ReadError;
use crate::raw_mesh::RawMesh;
use crate::warnings::Warning;
use crate::words::Words;

/// Triangles between two looks whether the work was cancelled.
const TRIANGLES: usize = 1 << 16;

/// Reads an STL file of either kind. A file is binary if its length is what the number in its head
/// asks for, whatever it begins with: many binary files begin with `solid`.
///
/// # Errors
/// What is wrong with it, with the line or the triangle; when `control` says so.
pub fn read_stl(bytes: &[u8], control: Control) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let n = match kind_of(bytes, bytes.len() as u64)? {
        Kind::Binary(n) => n,
        Kind::Ascii => return read_text(bytes, control),
    };
    let (triangles, rest) = bytes[HEAD..].split_at(n * RECORD);
    let records = Records::Memory(triangles.as_chunks().0);
    read_binary(records, rest.len() as u64, control).map_err(|trouble| match trouble {
        Trouble::Content(error) => error,
        Trouble::System(error) => ReadError::Wrong(error.to_string()),
    })
}

pub(super) enum Kind {
    Ascii,
    /// With so many triangles.
    Binary(usize),
}

/// Bytes at the beginning of a file that say of which kind it is.
pub(super) const BEGINNING: usize = 1024;

/// The kind of a file of so many bytes that begins with these.
pub(super) fn kind_of(bytes: &[u8], n_bytes: u64) -> Result<Kind, ReadError> {
    let wrong = |message: String| Err(ReadError::Wrong(message));
    let begins = bytes.trim_ascii_start();
    let is_solid = begins.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let Some(n) = bytes.get(HEAD - 4..HEAD).and_then(|n| n.first_chunk::<4>()) else {
        return match is_solid {
            true => Ok(Kind::Ascii),
            false => wrong(format!("{n_bytes} bytes are too few for an STL file")),
        };
    };
    let n = u32::from_le_bytes(*n);
    let rest = n_bytes - HEAD as u64;
    let (asked, n_there) = (u64::from(n) * RECORD as u64, rest / RECORD as u64);
    // Some programs write something behind the last triangle.
    if asked == rest || !is_solid && asked <= rest {
        return Ok(Kind::Binary(n as usize));
    }
    let is_text = || bytes.iter().take(BEGINNING).all(|byte| (9..128).contains(byte));
    if is_solid && is_text() {
        return Ok(Kind::Ascii);
    }
    wrong(format!(
        "its head promises {n} triangles, but there is room for {n_there} in the file; it is cut off, \
         or no STL file"
    ))
}

/// Reads binary triangles that so many bytes follow.
pub(super) fn read_binary(
    records: Records,
    n_more: u64,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), Trouble> {
    let mut mesh = RawMesh::default();
    let (positions, faces) = welded(records, control)?;
    mesh.positions = positions;
    mesh.polygons.push_all(faces);
    if n_more > 0 {
        mesh.warnings.add_general(format!("{n_more} bytes behind the last triangle are left out"));
    }
    Ok(mesh.finish(control)?)
}

fn read_text(bytes: &[u8], control: Control) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let mut mesh = RawMesh::default();
    let mut words = Words::new(bytes, 1, false);
    let mut points = Points::of_about(bytes.len() / 500);
    let (mut corners, mut hashes, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut n_triangles = 0;
    while let Some(word) = words.next() {
        match word.to_ascii_lowercase().as_slice() {
            // Names may hold any word.
            b"solid" | b"endsolid" => words.next_line(),
            b"facet" | b"outer" | b"endloop" => words.next_line(),
            b"vertex" => {
                let point = [words.number("x")?, words.number("y")?, words.number("z")?];
                corners.push(point_of(point.map(|number| number as f32)));
            }
            b"endfacet" => {
                if corners.len() < 3 {
                    let line = words.line();
                    mesh.leave_out(
                        || format!("line {line}"),
                        || format!("a facet has {} corners, fewer than 3", corners.len()),
                    );
                } else {
                    hashes.clear();
                    hashes.extend(corners.iter().map(|corner| hash_of(*corner)));
                    numbers.clear();
                    points.add(&corners, &hashes, &mut numbers);
                    let polygon: Vec<VertexId> = numbers.iter().map(|n| VertexId(*n)).collect();
                    mesh.polygons.push(&polygon);
                }
                corners.clear();
                n_triangles += 1;
                if n_triangles % TRIANGLES == 0 {
                    control.at(words.fraction())?;
                }
            }
            _ => {
                let line = words.line();
                let found = crate::obj::cursor::quoted(word);
                return Err(ReadError::Wrong(format!(
                    "line {line}: found {found}, expected `facet`, `vertex` or `endsolid`"
                )));
            }
        }
    }
    if !corners.is_empty() {
        return Err(ReadError::Wrong("the file ends within a facet".to_owned()));
    }
    control.at(1.0)?;
    mesh.positions = points.places;
    mesh.finish(control)
}
