//! Points, those of the same coordinates as one.
//!
//! An open table, in which each slot holds a whole hash beside the number of its point, so that
//! other points are looked at only where they are almost certainly equal. Slots are in the order of
//! hashes, so that a larger table is filled from its beginning to its end. O(n).

use glam::DVec3;

/// Points of which the slots are asked for before the first is looked for: the memory brings many
/// of them in the time of one.
const AT_ONCE: usize = 96;

/// The bits of three coordinates. Both zeros are one place, so one of them is in no point.
pub(super) type Point = [u32; 3];

/// Points in the order in which they came, each once.
pub(super) struct Points {
    /// In the order of their numbers.
    pub places: Vec<DVec3>,
    /// The hash of a point, and its number plus 1 in the lower half; 0 where there is none.
    slots: Vec<u64>,
    /// Bits of a hash that do not say where its slot is.
    shift: u32,
}

#[inline]
pub(super) fn point_of(numbers: [f32; 3]) -> Point {
    // The sum with the other zero is this one.
    numbers.map(|number| (number + 0.0).to_bits())
}

#[inline]
fn place_of(point: Point) -> DVec3 {
    DVec3::from(point.map(|bits| f64::from(f32::from_bits(bits))))
}

/// Equal bits are one place, those of what is no number as well.
#[inline]
fn is_same(a: DVec3, b: DVec3) -> bool {
    a.to_array().map(f64::to_bits) == b.to_array().map(f64::to_bits)
}

/// The halves of a product of 128 bits, folded: each bit of the point reaches those above.
#[inline]
pub(super) fn hash_of(point: Point) -> u32 {
    let [x, y, z] = point.map(u64::from);
    let product = u128::from((x | y << 32) ^ 0x9e37_79b9_7f4a_7c15)
        * u128::from((z | z << 32) ^ 0xd1b5_4a32_d192_ed03);
    let folded = (product as u64) ^ (product >> 64) as u64;
    (folded.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
}

impl Points {
    /// With room for about so many.
    pub fn of_about(n: usize) -> Self {
        // As much as a file of 50 bytes a triangle can be longer than this one.
        let n_slots = (3 * n / 2).next_power_of_two().clamp(1 << 4, 1 << 31);
        let places = Vec::with_capacity(n);
        Self { places, slots: vec![0; n_slots], shift: 32 - n_slots.trailing_zeros() }
    }

    /// The numbers of points with these hashes, new ones of those that are new.
    pub fn add(&mut self, points: &[Point], hashes: &[u32], numbers: &mut Vec<u32>) {
        for (points, hashes) in points.chunks(AT_ONCE).zip(hashes.chunks(AT_ONCE)) {
            while 3 * (self.places.len() + points.len()) > 2 * self.slots.len() {
                self.grow();
            }
            let mut seen = [0; AT_ONCE];
            for (seen, hash) in seen.iter_mut().zip(hashes) {
                *seen = self.slots[(hash >> self.shift) as usize];
            }
            for ((point, &hash), slot) in points.iter().zip(hashes).zip(seen) {
                let place = place_of(*point);
                let known = self.number_at(slot, hash, place);
                numbers.push(known.unwrap_or_else(|| self.number(hash, place)));
            }
        }
    }

    /// The number of a point that is there.
    #[inline]
    pub fn find(&self, place: DVec3) -> Option<u32> {
        let point = place.to_array().map(|number| (number as f32).to_bits());
        self.slot(hash_of(point), place).ok()
    }

    /// The number in a slot, if it is that of this point.
    #[inline]
    fn number_at(&self, slot: u64, hash: u32, place: DVec3) -> Option<u32> {
        let number = (slot as u32).wrapping_sub(1);
        let is_there = (slot >> 32) as u32 == hash
            && self.places.get(number as usize).is_some_and(|other| is_same(*other, place));
        is_there.then_some(number)
    }

    /// The number of a point, or the empty slot where it would be.
    #[inline]
    fn slot(&self, hash: u32, place: DVec3) -> Result<u32, usize> {
        let mut at = (hash >> self.shift) as usize;
        loop {
            let slot = self.slots[at];
            if slot == 0 {
                return Err(at);
            }
            if let Some(number) = self.number_at(slot, hash, place) {
                return Ok(number);
            }
            at = (at + 1) & (self.slots.len() - 1);
        }
    }

    /// The number of a point, a new one if there was none like it; there is an empty slot.
    fn number(&mut self, hash: u32, place: DVec3) -> u32 {
        self.slot(hash, place).unwrap_or_else(|at| {
            let number = self.places.len() as u32;
            self.places.push(place);
            self.slots[at] = u64::from(hash) << 32 | u64::from(number + 1);
            number
        })
    }

    #[cold]
    fn grow(&mut self) {
        let n_slots = 2 * self.slots.len();
        let old = std::mem::replace(&mut self.slots, vec![0; n_slots]);
        self.shift -= 1;
        for slot in old.into_iter().filter(|slot| *slot != 0) {
            let mut at = (slot >> 32 >> self.shift) as usize;
            while self.slots[at] != 0 {
                at = (at + 1) & (n_slots - 1);
            }
            self.slots[at] = slot;
        }
    }
}
