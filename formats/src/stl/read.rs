//! From the bytes of an STL file to a mesh.

use glam::{DVec3, Vec3};
use mve_core::Control;
use mve_mesh::data::{TriMesh, VertexId};

use super::weld::{Surface, welded};
use super::{HEAD, RECORD};
use crate::ReadError;
use crate::raw_mesh::RawMesh;
use crate::warnings::Warning;
use crate::words::Words;

/// Triangles from which on the memory counts that threads take to share the work.
const MOST_ON_THREADS: usize = 1 << 25;
/// Triangles between two looks whether the work was cancelled.
const TRIANGLES: usize = 1 << 16;

/// Reads an STL file of either kind. A file is binary if its length is what the number in its head
/// asks for, whatever it begins with: many binary files begin with `solid`.
///
/// # Errors
/// What is wrong with it, with the line or the triangle; when `control` says so.
pub fn read_stl(bytes: &[u8], control: Control) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    match kind_of(bytes)? {
        Kind::Binary(n) => read_binary(bytes, n, control),
        Kind::Ascii => read_text(bytes, control),
    }
}

enum Kind {
    Ascii,
    /// With so many triangles.
    Binary(usize),
}

fn kind_of(bytes: &[u8]) -> Result<Kind, ReadError> {
    let wrong = |message: String| Err(ReadError::Wrong(message));
    let begins = bytes.trim_ascii_start();
    let is_solid = begins.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let Some(n) = bytes.get(HEAD - 4..HEAD).and_then(|n| n.first_chunk::<4>()) else {
        return match is_solid {
            true => Ok(Kind::Ascii),
            false => wrong(format!("{} bytes are too few for an STL file", bytes.len())),
        };
    };
    let n = u32::from_le_bytes(*n) as usize;
    let n_there = (bytes.len() - HEAD) / RECORD;
    // Some programs write something behind the last triangle.
    let rest = bytes.len() - HEAD;
    if n.checked_mul(RECORD) == Some(rest) || !is_solid && n <= n_there {
        return Ok(Kind::Binary(n));
    }
    let is_text = || bytes.iter().take(1024).all(|byte| (9..128).contains(byte));
    if is_solid && is_text() {
        return Ok(Kind::Ascii);
    }
    wrong(format!(
        "its head promises {n} triangles, but there is room for {n_there} in the file; it is cut off, \
         or no STL file"
    ))
}

fn read_binary(
    bytes: &[u8],
    n: usize,
    control: Control,
) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let mut mesh = RawMesh::default();
    let records = &bytes[HEAD..HEAD + n * RECORD];
    let records = records.as_chunks::<RECORD>().0;
    let (positions, faces) = match n {
        ..MOST_ON_THREADS => welded(records, control)?,
        _ => welded_in_turn(records, control)?,
    };
    mesh.positions = positions;
    mesh.polygons.push_all(faces);
    if bytes.len() > HEAD + n * RECORD {
        let n_more = bytes.len() - HEAD - n * RECORD;
        mesh.warnings.add_general(format!("{n_more} bytes behind the last triangle are left out"));
    }
    mesh.finish(control)
}

/// The vertices and faces of triangles, one after another.
fn welded_in_turn(records: &[[u8; RECORD]], control: Control) -> Result<Surface, ReadError> {
    let mut points = Points::of_about(records.len() / 2);
    let mut faces = Vec::with_capacity(records.len());
    for (number, record) in records.iter().enumerate() {
        if number.is_multiple_of(TRIANGLES) {
            control.at(number as f64 / records.len() as f64)?;
        }
        let number_at = |at: usize| {
            f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]])
        };
        let point = |k: usize| [0, 4, 8].map(|at| number_at(12 + 12 * k + at));
        faces.push([0, 1, 2].map(|k| points.number(Vec3::from(point(k)))));
    }
    Ok((points.places(control)?, faces))
}

fn read_text(bytes: &[u8], control: Control) -> Result<(TriMesh, Vec<Warning>), ReadError> {
    let mut mesh = RawMesh::default();
    let mut words = Words::new(bytes, 1, false);
    let mut points = Points::of_about(bytes.len() / 500);
    let (mut corners, mut n_triangles) = (Vec::new(), 0);
    while let Some(word) = words.next() {
        match word.to_ascii_lowercase().as_slice() {
            // Names may hold any word.
            b"solid" | b"endsolid" => words.next_line(),
            b"facet" | b"outer" | b"endloop" => words.next_line(),
            b"vertex" => {
                let [x, y, z] = [words.number("x")?, words.number("y")?, words.number("z")?];
                corners.push(points.number(Vec3::new(x as f32, y as f32, z as f32)));
            }
            b"endfacet" => {
                if corners.len() < 3 {
                    let line = words.line();
                    mesh.leave_out(
                        || format!("line {line}"),
                        || format!("a facet has {} corners, fewer than 3", corners.len()),
                    );
                } else {
                    mesh.polygons.push(&corners);
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
    mesh.positions = points.places(control)?;
    mesh.finish(control)
}

/// Points, those of the same coordinates as one: an open table over them.
struct Points {
    points: Vec<Vec3>,
    /// Numbers of points, or `EMPTY`; its length is a power of two.
    slots: Vec<u32>,
}

const EMPTY: u32 = u32::MAX;

impl Points {
    fn of_about(n: usize) -> Self {
        let n_slots = (2 * n).next_power_of_two().clamp(1 << 4, 1 << 26);
        Self { points: Vec::with_capacity(n.min(1 << 25)), slots: vec![EMPTY; n_slots] }
    }

    /// The number of a point, a new one if there was none like it.
    #[inline]
    fn number(&mut self, point: Vec3) -> VertexId {
        // Both zeros are one place.
        let bits = (point + Vec3::ZERO).to_array().map(f32::to_bits);
        let mut slot = self.slot(bits);
        loop {
            match self.slots[slot] {
                EMPTY => break,
                number if bits_of(self.points[number as usize]) == bits => {
                    return VertexId(number);
                }
                _ => slot = (slot + 1) & (self.slots.len() - 1),
            }
        }
        let number = self.points.len() as u32;
        self.slots[slot] = number;
        self.points.push(point + Vec3::ZERO);
        if 3 * self.points.len() > 2 * self.slots.len() {
            self.grow();
        }
        VertexId(number)
    }

    #[inline]
    fn slot(&self, bits: [u32; 3]) -> usize {
        let mix = |hash: u64, bits: u32| {
            (hash ^ u64::from(bits)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
        };
        let hash = bits.into_iter().fold(0, mix);
        (hash ^ hash >> 32) as usize & (self.slots.len() - 1)
    }

    #[cold]
    fn grow(&mut self) {
        self.slots = vec![EMPTY; 2 * self.slots.len()];
        for (number, &point) in (0u32..).zip(&self.points) {
            let mut slot = self.slot(bits_of(point));
            while self.slots[slot] != EMPTY {
                slot = (slot + 1) & (self.slots.len() - 1);
            }
            self.slots[slot] = number;
        }
    }

    fn places(self, control: Control) -> Result<Vec<DVec3>, ReadError> {
        control.at(1.0)?;
        Ok(self.points.into_iter().map(Vec3::as_dvec3).collect())
    }
}

fn bits_of(point: Vec3) -> [u32; 3] {
    point.to_array().map(f32::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles of a grid that turns and repeats, with both zeros and a place that is nowhere.
    fn records(n: usize) -> Vec<[u8; RECORD]> {
        let number = |at: usize| match at % 13 {
            0 => -0.0,
            1 => 0.0,
            2 if at > 5000 => f32::NAN,
            k => (k * (at / 97 % 31)) as f32 / 3.0,
        };
        let record = |at: usize| {
            let mut record = [0; RECORD];
            let numbers = record[12..].as_chunks_mut::<4>().0.iter_mut();
            for (k, bytes) in numbers.enumerate() {
                *bytes = number(at * 7 + k * k).to_le_bytes();
            }
            record
        };
        (0..n).map(record).collect()
    }

    #[test]
    fn threads_find_what_one_finds_alone() {
        let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        for n in [0, 1, 5, 20_000, 40_001] {
            let records = records(n);
            let (places, faces) = welded_in_turn(&records, Control::none()).unwrap();
            let bits = |places: &[DVec3]| -> Vec<[u64; 3]> {
                places.iter().map(|p| p.to_array().map(f64::to_bits)).collect()
            };
            for n_threads in [1, 3] {
                let found = pool(n_threads).install(|| welded(&records, Control::none()).unwrap());
                assert_eq!((bits(&found.0), &found.1), (bits(&places), &faces), "{n}");
            }
        }
    }
}
