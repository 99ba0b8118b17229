//! Random numbers that are counted, not drawn: any part of a list can be made on any thread.

/// A source of random numbers by index: SplitMix64 (Steele, Lea & Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014) as a function of seed and index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IndexedRandom {
    base: u64,
}

impl IndexedRandom {
    /// The numbers of this seed.
    pub fn new(seed: u64) -> Self {
        Self { base: mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)) }
    }

    /// The number at `index`: 64 random bits.
    #[inline]
    pub fn bits(self, index: u64) -> u64 {
        mix(self.base.wrapping_add(index.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// The number at `index` from 0 up to, but not, 1.
    #[inline]
    pub fn unit(self, index: u64) -> f64 {
        (self.bits(index) >> 11) as i64 as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

/// The output function of SplitMix64: a bijection of 64 bits, of which each depends on all.
#[inline]
pub fn mix(value: u64) -> u64 {
    let z = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
