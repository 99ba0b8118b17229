//! Joins the corners of a few triangles: most corners at a point follow each other closely in a
//! file, and a small table answers from the caches next to the core.

use super::points::{Point, hash_of};

/// Corners that are joined together, at most; the table has more slots.
pub(super) const MOST: usize = 3 << 12;
const SLOTS: usize = 1 << 14;
/// Bits of a hash that do not say where its slot is.
const SHIFT: u32 = 32 - SLOTS.trailing_zeros();

/// The points of some corners, each once.
pub(super) struct Near {
    pub points: Vec<Point>,
    /// Their hashes.
    pub hashes: Vec<u32>,
    /// The number of a point and 1, or 0.
    slots: Box<[u16; SLOTS]>,
}

impl Near {
    pub fn new() -> Self {
        let (points, hashes) = (Vec::with_capacity(MOST), Vec::with_capacity(MOST));
        Self { points, hashes, slots: Box::new([0; SLOTS]) }
    }

    /// Forgets all points.
    pub fn clear(&mut self) {
        self.slots.fill(0);
        self.points.clear();
        self.hashes.clear();
    }

    /// The number of a point, a new one if there was none like it.
    #[inline]
    pub fn number(&mut self, point: Point) -> u32 {
        let hash = hash_of(point);
        let mut at = (hash >> SHIFT) as usize;
        loop {
            let number = self.slots[at % SLOTS].wrapping_sub(1);
            match self.points.get(usize::from(number)) {
                None => break,
                Some(other) if *other == point => return u32::from(number),
                Some(_) => at += 1,
            }
        }
        let n = self.points.len();
        self.slots[at % SLOTS] = n as u16 + 1;
        self.points.push(point);
        self.hashes.push(hash);
        n as u32
    }
}
