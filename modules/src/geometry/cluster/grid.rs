//! A grid of cubes over a mesh, and the numbers of the cells that vertices lie in.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::{TriMesh, VertexId};
use rayon::prelude::*;

/// Most cells along an axis: three of their numbers are one key.
pub const MOST_CELLS: u64 = 1 << BITS;
const BITS: u32 = 21;
/// Set in the key of a vertex that is in no cell: it is a cluster of its own.
const ALONE: u64 = 1 << 63;
/// Vertices or faces of a piece of work; what threads there are changes no piece.
pub(super) const PIECE: usize = 1 << 15;

/// Cubes of one size that begin at the low corner of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    low: DVec3,
    edge: f64,
    cells_a_unit: f64,
}

impl Grid {
    /// A grid over the box of a mesh with cells of this edge, over 0. `None` where it would have
    /// more than [`MOST_CELLS`] along an axis.
    pub fn new((low, high): (DVec3, DVec3), edge: f64) -> Option<Self> {
        let n_cells = ((high - low).max_element() / edge).floor() + 1.0;
        let grid = Self { low, edge, cells_a_unit: 1.0 / edge };
        (edge > 0.0 && n_cells <= MOST_CELLS as f64).then_some(grid)
    }

    /// Length of a cell's edge.
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// The numbers of the cell along the axes, from 0. Points outside of the box are in the cells
    /// at its sides.
    #[inline]
    pub fn cell(&self, point: DVec3) -> [u64; 3] {
        // Casts saturate, and what is not a number is in the first cell.
        self.place(point).to_array().map(|at| (at as u64).min(MOST_CELLS - 1))
    }

    /// The point in cells along the axes.
    #[inline]
    pub fn place(&self, point: DVec3) -> DVec3 {
        (point - self.low) * self.cells_a_unit
    }

    /// The numbers of the cell in one.
    #[inline]
    pub fn key(&self, point: DVec3) -> u64 {
        key(self.cell(point))
    }

    /// The key of each vertex; those with a coordinate that is not finite have one of their own.
    pub fn keys(&self, positions: &[DVec3], control: Control) -> Result<Vec<u64>, Cancelled> {
        let mut keys = vec![0; positions.len()];
        let pieces = keys.par_chunks_mut(PIECE).zip(positions.par_chunks(PIECE)).enumerate();
        pieces.try_for_each(|(piece, (keys, positions))| {
            control.at(0.0)?;
            let first = (piece * PIECE) as u64;
            for ((key, &point), vertex) in keys.iter_mut().zip(positions).zip(first..) {
                *key = if point.is_finite() { self.key(point) } else { ALONE | vertex };
            }
            Ok(())
        })?;
        Ok(keys)
    }
}

/// The numbers of a cell in one.
#[inline]
pub(super) fn key([x, y, z]: [u64; 3]) -> u64 {
    x | y << BITS | z << (2 * BITS)
}

/// How many faces have their corners in three cells or clusters.
pub fn n_faces_left(
    mesh: &TriMesh,
    cells: &[impl Copy + Eq + Sync],
    control: Control,
) -> Result<usize, Cancelled> {
    let counts = mesh.faces.par_chunks(PIECE).map(|faces| {
        control.at(0.0)?;
        Ok(faces.iter().filter(|face| is_left(face, cells)).count())
    });
    counts.try_reduce(|| 0, |a, b| Ok(a + b))
}

/// Whether the corners of a face are in three cells or clusters.
#[inline]
pub fn is_left<T: Copy + Eq>(face: &[VertexId; 3], cells: &[T]) -> bool {
    let [a, b, c] = face.map(|vertex| cells[vertex.idx()]);
    a != b && b != c && c != a
}

/// A number for each key that occurs, in the order in which they first do.
pub fn numbered(keys: &[u64], control: Control) -> Result<(Vec<u32>, usize), Cancelled> {
    // Each piece numbers its own keys; then these are put together.
    let pieces = keys.par_chunks(PIECE).map(|keys| {
        control.at(0.0)?;
        let mut known = Numbers::default();
        let own: Vec<u32> = keys.iter().map(|&key| known.number(key)).collect();
        Ok((own, known.keys))
    });
    let mut pieces = pieces.collect::<Result<Vec<_>, Cancelled>>()?;
    let mut all = Numbers::default();
    for (_, keys) in &mut pieces {
        control.at(0.5)?;
        keys.iter_mut().for_each(|key| *key = u64::from(all.number(*key)));
    }
    let mut numbers = vec![0; keys.len()];
    numbers.par_chunks_mut(PIECE).zip(&pieces).for_each(|(numbers, (own, global))| {
        for (number, &own) in numbers.iter_mut().zip(own) {
            *number = global[own as usize] as u32;
        }
    });
    Ok((numbers, all.keys.len()))
}

/// Keys and their numbers: a table with open addressing, twice as large as what it holds.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    /// The number of a key and one, at the first free place from that of its hash; 0 if free.
    table: Vec<u32>,
    /// The keys by number.
    pub keys: Vec<u64>,
}

impl Numbers {
    /// The number of a key, a new one if it has none.
    #[inline]
    pub fn number(&mut self, key: u64) -> u32 {
        if self.keys.len() * 2 >= self.table.len() {
            self.grow();
        }
        let place = self.place(key);
        if self.table[place] == 0 {
            self.keys.push(key);
            self.table[place] = self.keys.len() as u32;
        }
        self.table[place] - 1
    }

    /// The number of a key that has one.
    #[inline]
    pub fn get(&self, key: u64) -> Option<u32> {
        if self.table.is_empty() {
            return None;
        }
        self.table[self.place(key)].checked_sub(1)
    }

    #[inline]
    fn place(&self, key: u64) -> usize {
        let mask = self.table.len() - 1;
        // The middle bits of a product depend on all bits of the key.
        let mut place = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.table[place] != 0 && self.keys[self.table[place] as usize - 1] != key {
            place = (place + 1) & mask;
        }
        place
    }

    fn grow(&mut self) {
        self.table = vec![0; (self.table.len() * 2).max(64)];
        for number in 1..=self.keys.len() as u32 {
            let place = self.place(self.keys[number as usize - 1]);
            self.table[place] = number;
        }
    }
}
