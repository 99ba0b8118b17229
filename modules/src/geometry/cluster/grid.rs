//! A grid of cubes over a mesh, and the numbers of the cells that vertices lie in.

use glam::DVec3;
use mve_core::{Cancelled, Control};
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
    /// Along the axes.
    n_cells: [u64; 3],
    edge: f64,
    cells_a_unit: f64,
}

impl Grid {
    /// A grid over the box of a mesh with cells of this edge, over 0. `None` where it would have
    /// more than [`MOST_CELLS`] along an axis.
    pub fn new((low, high): (DVec3, DVec3), edge: f64) -> Option<Self> {
        let n_cells = ((high - low) / edge).to_array().map(|n| n.floor() + 1.0);
        let is_fine = edge > 0.0 && n_cells.iter().all(|&n| n <= MOST_CELLS as f64);
        let n_cells = n_cells.map(|n| n as u64);
        is_fine.then_some(Self { low, n_cells, edge, cells_a_unit: 1.0 / edge })
    }

    /// Length of a cell's edge.
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// The numbers of the cell along the axes, from 0. Points outside of the box are in the cells
    /// at its sides.
    #[inline]
    pub fn cell(&self, point: DVec3) -> [u64; 3] {
        // Added to this number, another one has its whole part in these bits.
        const SHIFT: f64 = (1_u64 << (52 - BITS)) as f64;
        let place = (point - self.low) * self.cells_a_unit;
        place.to_array().map(|at| {
            // What is not a number is in the first cell.
            let at = at.max(0.0).min((MOST_CELLS - 1) as f64);
            (at + SHIFT).to_bits() >> BITS & (MOST_CELLS - 1)
        })
    }

    /// The numbers of the cell in one.
    #[inline]
    pub fn key(&self, point: DVec3) -> u64 {
        let [x, y, z] = self.cell(point);
        x | y << BITS | z << (2 * BITS)
    }

    /// The cell of each vertex; those with a coordinate that is not finite have one of their own.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn cells(&self, positions: &[DVec3], control: Control) -> Result<Keys, Cancelled> {
        let [nx, ny, nz] = self.n_cells.map(|n| n as usize);
        let n_cells = nx * ny.max(1) * nz;
        let key = |point: DVec3| {
            let [x, y, z] = self.cell(point).map(|at| at as usize);
            (x.min(nx - 1) + nx * (y.min(ny - 1) + ny * z.min(nz - 1))) as u32
        };
        if n_cells <= u32::MAX as usize
            && let Some(keys) = each(positions, |point, _| key(point), true, control)?
        {
            return Ok(Keys::Few(keys, n_cells));
        }
        let key = |point: DVec3, vertex| {
            if point.is_finite() { self.key(point) } else { ALONE | vertex }
        };
        Ok(Keys::Many(each(positions, key, false, control)?.unwrap_or_default()))
    }
}

/// What `of` says of each point; `None` where one is not finite but has to be.
fn each<T: Copy + Default + Send>(
    positions: &[DVec3],
    of: impl Fn(DVec3, u64) -> T + Sync,
    is_finite: bool,
    control: Control,
) -> Result<Option<Vec<T>>, Cancelled> {
    let mut found = vec![T::default(); positions.len()];
    let pieces = found.par_chunks_mut(PIECE).zip(positions.par_chunks(PIECE)).enumerate();
    let are_so = pieces.map(|(piece, (found, positions))| {
        control.at(0.0)?;
        let first = (piece * PIECE) as u64;
        let mut sum = DVec3::ZERO;
        for ((found, &point), vertex) in found.iter_mut().zip(positions).zip(first..) {
            *found = of(point, vertex);
            sum += 0.0 * point;
        }
        Ok(!is_finite || sum.is_finite())
    });
    let are_so = are_so.try_reduce(|| true, |a, b| Ok(a && b))?;
    Ok(are_so.then_some(found))
}

/// The cells that vertices lie in, by numbers of theirs.
pub enum Keys {
    /// In a grid of so many cells.
    Few(Vec<u32>, usize),
    /// In a larger one, or where vertices have cells of their own.
    Many(Vec<u64>),
}

impl Keys {
    /// A number from 0 for each cell that has a vertex, in the order in which they first occur, and
    /// how many there are.
    ///
    /// # Errors
    /// [`Cancelled`] when `control` says so.
    pub fn numbered(self, control: Control) -> Result<(Vec<u32>, usize), Cancelled> {
        /// Cells a vertex up to which a list of all of them is faster than a table.
        const SPARSE: usize = 16;
        match self {
            Self::Few(mut keys, n_cells) if n_cells / SPARSE <= keys.len() => {
                let (mut numbers, mut n) = (vec![0; n_cells], 0);
                for (place, key) in keys.iter_mut().enumerate() {
                    control.item(place, n_cells)?;
                    let number = &mut numbers[*key as usize];
                    if *number == 0 {
                        n += 1;
                        *number = n;
                    }
                    *key = *number - 1;
                }
                Ok((keys, n as usize))
            }
            Self::Few(keys, _) => numbered(&keys, control),
            Self::Many(keys) => numbered(&keys, control),
        }
    }
}

/// A number for each key that occurs, in the order in which they first do.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn numbered<T: Copy + Eq + Into<u64> + Sync>(
    keys: &[T],
    control: Control,
) -> Result<(Vec<u32>, usize), Cancelled> {
    // Each piece numbers its own keys; then these are put together.
    let pieces = keys.par_chunks(PIECE).map(|keys| {
        control.at(0.0)?;
        let mut known = Numbers::default();
        // Neighbors in the list are often in one cell.
        let mut last = (keys[0], known.number(keys[0].into()));
        let number = |&key: &T| {
            if key != last.0 {
                last = (key, known.number(key.into()));
            }
            last.1
        };
        let own: Vec<u32> = keys.iter().map(number).collect();
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
    /// A key, and its number and one, at the first free place from that of its hash; 0 if free.
    table: Vec<(u64, u32)>,
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
        if self.table[place].1 == 0 {
            self.keys.push(key);
            self.table[place] = (key, self.keys.len() as u32);
        }
        self.table[place].1 - 1
    }

    /// The number of a key that has one.
    #[inline]
    pub fn get(&self, key: u64) -> Option<u32> {
        if self.table.is_empty() {
            return None;
        }
        self.table[self.place(key)].1.checked_sub(1)
    }

    #[inline]
    fn place(&self, key: u64) -> usize {
        let mask = self.table.len() - 1;
        // The middle bits of a product depend on all bits of the key.
        let mut place = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.table[place].1 != 0 && self.table[place].0 != key {
            place = (place + 1) & mask;
        }
        place
    }

    #[cold]
    fn grow(&mut self) {
        self.table = vec![(0, 0); (self.table.len() * 4).max(1024)];
        for (&key, number) in self.keys.iter().zip(1..) {
            let place = self.place(key);
            self.table[place] = (key, number);
        }
    }
}
