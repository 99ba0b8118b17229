//! Rows of a binary PLY file that all have the same length, read on all threads.
//!
//! Values come out in the order of the file, so threads change no bit.

use std::sync::atomic::{AtomicBool, Ordering};

use mve_core::{Cancelled, Control};
use mve_mesh::data::VertexId;
use rayon::prelude::*;

use super::header::{Element, Kind, Shape};

/// Rows between two looks whether the work was cancelled: some milliseconds.
const ROWS: usize = 1 << 20;
/// Rows that a thread takes at once.
const ROWS_AT_ONCE: usize = 1 << 14;

/// Rows, and where a number of this type stands in each.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub bytes: &'a [u8],
    /// Bytes of a row.
    pub stride: usize,
    /// Whether the highest byte of a number comes first.
    pub is_big: bool,
}

/// A number of each row.
pub(super) type Column = (usize, Kind);

/// The bytes before each property of an element, and those of a row, where the list of this number,
/// if any, has three items and there is no other list.
pub(super) fn layout(element: &Element, triangle: Option<usize>) -> Option<(Vec<Column>, usize)> {
    let mut columns = Vec::with_capacity(element.properties.len());
    let mut length = 0;
    for (at, property) in element.properties.iter().enumerate() {
        match property.shape {
            Shape::One(kind) => {
                columns.push((length, kind));
                length += kind.n_bytes();
            }
            Shape::List { n, item } if triangle == Some(at) => {
                columns.push((length, item));
                length += n.n_bytes() + 3 * item.n_bytes();
            }
            Shape::List { .. } => return None,
        }
    }
    Some((columns, length))
}

fn bytes_at<const N: usize, const BIG: bool>(row: &[u8], at: usize) -> [u8; N] {
    // A row is as long as its columns ask for.
    let mut bytes = row.get(at..).and_then(|rest| rest.first_chunk()).copied().unwrap_or([0; N]);
    if BIG {
        bytes.reverse();
    }
    bytes
}

#[inline]
fn number<const BIG: bool>(row: &[u8], (at, kind): Column) -> f64 {
    match kind {
        Kind::F32 => f64::from(f32::from_le_bytes(bytes_at::<4, BIG>(row, at))),
        Kind::F64 => f64::from_le_bytes(bytes_at::<8, BIG>(row, at)),
        Kind::I8 => f64::from(i8::from_le_bytes(bytes_at::<1, BIG>(row, at))),
        Kind::U8 => f64::from(u8::from_le_bytes(bytes_at::<1, BIG>(row, at))),
        Kind::I16 => f64::from(i16::from_le_bytes(bytes_at::<2, BIG>(row, at))),
        Kind::U16 => f64::from(u16::from_le_bytes(bytes_at::<2, BIG>(row, at))),
        Kind::I32 => f64::from(i32::from_le_bytes(bytes_at::<4, BIG>(row, at))),
        Kind::U32 => f64::from(u32::from_le_bytes(bytes_at::<4, BIG>(row, at))),
    }
}

impl Rows<'_> {
    /// What `read` makes of each row.
    fn each<T: Send>(
        self,
        read: impl Fn(&[u8]) -> T + Sync,
        control: Control,
    ) -> Result<Vec<T>, Cancelled> {
        let mut values = Vec::with_capacity(self.bytes.len() / self.stride);
        for (at, piece) in self.bytes.chunks(ROWS * self.stride).enumerate() {
            control.at((at * ROWS * self.stride) as f64 / self.bytes.len() as f64)?;
            let rows = piece.par_chunks_exact(self.stride).with_min_len(ROWS_AT_ONCE);
            values.par_extend(rows.map(&read));
        }
        Ok(values)
    }

    /// Some numbers of each row.
    pub fn vectors<const N: usize, T: From<[f64; N]> + Send>(
        self,
        columns: [Column; N],
        control: Control,
    ) -> Result<Vec<T>, Cancelled> {
        let is_plain = columns.iter().enumerate().all(|(k, (at, kind))| {
            *kind == Kind::F32 && *at == columns[0].0 + 4 * k && !self.is_big
        });
        let start = columns.first().map_or(0, |(at, _)| *at);
        match self.is_big {
            // What most files have.
            _ if is_plain => self.each(
                |row| {
                    let numbers = row.get(start..).unwrap_or_default().as_chunks::<4>().0;
                    let mut vector = [0.0; N];
                    for (number, bytes) in vector.iter_mut().zip(numbers) {
                        *number = f64::from(f32::from_le_bytes(*bytes));
                    }
                    T::from(vector)
                },
                control,
            ),
            false => self
                .each(|row| T::from(columns.map(|column| number::<false>(row, column))), control),
            true => {
                self.each(|row| T::from(columns.map(|column| number::<true>(row, column))), control)
            }
        }
    }

    /// One number of each row.
    pub fn numbers(self, column: Column, control: Control) -> Result<Vec<f64>, Cancelled> {
        match self.is_big {
            false => self.each(|row| number::<false>(row, column), control),
            true => self.each(|row| number::<true>(row, column), control),
        }
    }

    /// The corners of each row, where its list begins at this byte; `None` where a list has other
    /// than three items, or one that is no vertex.
    pub fn triangles(
        self,
        start: usize,
        (n, item): (Kind, Kind),
        n_vertices: u64,
        control: Control,
    ) -> Result<Option<Vec<[VertexId; 3]>>, Cancelled> {
        let is_whole = |kind: Kind| !matches!(kind, Kind::F32 | Kind::F64);
        // A negative number of 32 bits is none of so few vertices.
        let fits = is_whole(n)
            && matches!(item, Kind::I32 | Kind::U32)
            && n_vertices <= 1 << 31
            && self.bytes.len() >= self.stride;
        if !fits {
            return Ok(None);
        }
        let is_odd = AtomicBool::new(false);
        let row = |row: &[u8]| match self.is_big {
            false => triangle::<false>(row, start, n, n_vertices, &is_odd),
            true => triangle::<true>(row, start, n, n_vertices, &is_odd),
        };
        // Most files of other polygons show it at once.
        row(&self.bytes[..self.stride]);
        if is_odd.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let faces = self.each(row, control)?;
        Ok((!is_odd.load(Ordering::Relaxed)).then_some(faces))
    }
}

#[inline]
fn triangle<const BIG: bool>(
    row: &[u8],
    start: usize,
    n: Kind,
    n_vertices: u64,
    is_odd: &AtomicBool,
) -> [VertexId; 3] {
    let first = start + n.n_bytes();
    let corners = [0, 4, 8].map(|k| u32::from_le_bytes(bytes_at::<4, BIG>(row, first + k)));
    let is_good = corners.iter().all(|corner| u64::from(*corner) < n_vertices);
    if !is_good || number::<BIG>(row, (start, n)) != 3.0 {
        is_odd.store(true, Ordering::Relaxed);
    }
    corners.map(VertexId)
}
