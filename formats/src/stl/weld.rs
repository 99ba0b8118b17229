//! Joins the corners of triangles that lie at one place, on all threads.
//!
//! Each chunk of triangles joins its own corners first, which mostly are near to each other in the
//! file. The places that are left are dealt out by a hash, so that each thread looks for equal ones
//! among few. Vertices are numbered in the order of their first corners, so threads change no bit.
//! O(n).

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::data::VertexId;
use rayon::prelude::*;

use super::RECORD;

/// Triangles of a chunk.
const CHUNK: usize = 1 << 13;
/// Places of a share, on average: they fit into the cache of a core.
const SHARE: usize = 1 << 14;

/// A place: the bits of its coordinates, and its number.
#[derive(Clone, Copy)]
struct Place {
    bits: [u32; 3],
    number: u32,
}

const EMPTY: Place = Place { bits: [0; 3], number: u32::MAX };

/// What the corners of a chunk come to.
struct Chunk {
    /// Each place once, in the order of the corners.
    places: Vec<[u32; 3]>,
    /// For each corner its place.
    corners: Vec<u32>,
}

/// The places of a chunk, those of each share together.
struct Dealt {
    places: Vec<Place>,
    /// Where each share starts, and the end of the last.
    starts: Vec<u32>,
}

/// Vertices, and the corners of each triangle.
pub(super) type Surface = (Vec<DVec3>, Vec<[VertexId; 3]>);

/// The vertices and faces of binary triangles.
pub(super) fn welded(records: &[[u8; RECORD]], control: Control) -> Result<Surface, Cancelled> {
    let parts: Vec<&[[u8; RECORD]]> = records.chunks(CHUNK).collect();
    let steps = control.part(0.0, 0.5).steps(parts.len());
    let chunk = |table: &mut Table, part: &&[[u8; RECORD]]| {
        steps.step()?;
        Ok(chunk_of(part, table))
    };
    let chunks: Vec<Chunk> =
        parts.par_iter().map_init(Table::default, chunk).collect::<Result<_, Cancelled>>()?;
    // The number of the first place of each chunk, and that of all.
    let mut offsets = vec![0];
    for chunk in &chunks {
        offsets.push(offsets[offsets.len() - 1] + chunk.places.len());
    }
    let n_places = offsets[chunks.len()];
    let n_shares = (n_places / SHARE).next_power_of_two().min(256);
    let firsts = first_places(&chunks, &offsets, n_shares, control.part(0.5, 0.8))?;
    let mut numbers: Vec<u32> = Vec::with_capacity(n_places);
    let mut positions = Vec::with_capacity(n_places);
    let all = chunks.iter().flat_map(|chunk| &chunk.places).zip(firsts.iter().flatten());
    for (bits, &first) in all {
        // What is not the first comes behind it.
        let number = numbers.get(first as usize).copied().unwrap_or_else(|| {
            positions.push(DVec3::from(bits.map(|bits| f64::from(f32::from_bits(bits)))));
            positions.len() as u32 - 1
        });
        numbers.push(number);
    }
    control.at(0.9)?;
    let face = |at: usize| {
        let (chunk, triangle) = (at / CHUNK, at % CHUNK);
        [0, 1, 2].map(|k| {
            let place = chunks[chunk].corners[3 * triangle + k] as usize;
            VertexId(numbers[offsets[chunk] + place])
        })
    };
    let faces = (0..records.len()).into_par_iter().with_min_len(CHUNK / 4).map(face).collect();
    Ok((positions, faces))
}

/// For each place of each chunk the number of the first that is equal to it.
fn first_places(
    chunks: &[Chunk],
    offsets: &[usize],
    n_shares: usize,
    control: Control,
) -> Result<Vec<Vec<u32>>, Cancelled> {
    let n_bits = n_shares.trailing_zeros();
    let dealt: Vec<Dealt> = chunks
        .par_iter()
        .zip(offsets)
        .map(|(chunk, &offset)| deal(&chunk.places, offset as u32, n_bits))
        .collect();
    let steps = control.steps(n_shares);
    let share = |table: &mut Table, share: usize| {
        steps.step()?;
        Ok(firsts_of(&dealt, share, table))
    };
    let firsts: Vec<Vec<u32>> = (0..n_shares)
        .into_par_iter()
        .map_init(Table::default, share)
        .collect::<Result<_, Cancelled>>()?;
    // Where what a share found of a chunk begins.
    let mut starts = vec![0_usize; n_shares];
    let mut begins = Vec::with_capacity(dealt.len());
    for chunk in &dealt {
        begins.push(starts.clone());
        for (start, ends) in starts.iter_mut().zip(chunk.starts.windows(2)) {
            *start += (ends[1] - ends[0]) as usize;
        }
    }
    let parts = dealt.par_iter().zip(&begins).zip(offsets);
    Ok(parts.map(|((chunk, begins), &start)| in_order(chunk, begins, &firsts, start)).collect())
}

/// The bits of a corner's coordinates; both zeros are one place.
#[inline]
fn bits_of(record: &[u8; RECORD], k: usize) -> [u32; 3] {
    // Behind the normal.
    let (numbers, _) = record[12 + 12 * k..].as_chunks::<4>();
    let mut bits = [0; 3];
    for (bits, bytes) in bits.iter_mut().zip(numbers) {
        *bits = (f32::from_le_bytes(*bytes) + 0.0).to_bits();
    }
    bits
}

#[inline]
fn hash_of(bits: [u32; 3]) -> u64 {
    let mix = |hash: u64, bits: u32| {
        (hash ^ u64::from(bits)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    };
    bits.into_iter().fold(0, mix).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// The share of a hash: its highest bits.
#[inline]
fn share_of(hash: u64, n_bits: u32) -> usize {
    hash.checked_shr(64 - n_bits).unwrap_or(0) as usize
}

/// Places that are known, by their hash. It keeps its memory.
#[derive(Default)]
struct Table {
    slots: Vec<Place>,
    n: usize,
}

impl Table {
    /// Forgets all places, with room for about so many.
    fn clear(&mut self, n: usize) {
        let n_slots = (2 * n).next_power_of_two().max(16);
        self.slots.clear();
        self.slots.resize(n_slots, EMPTY);
        self.n = 0;
    }

    /// The slot of a place, or the empty one where it would be.
    #[inline]
    fn slot(&self, hash: u64, bits: [u32; 3]) -> usize {
        let mask = self.slots.len() - 1;
        // The highest bits are those of the share.
        let mut slot = (hash >> 20) as usize & mask;
        while self.slots[slot].number != u32::MAX && self.slots[slot].bits != bits {
            slot = (slot + 1) & mask;
        }
        slot
    }

    /// The number of a place, this one if it is new.
    #[inline]
    fn number(&mut self, bits: [u32; 3], number: u32) -> u32 {
        let slot = self.slot(hash_of(bits), bits);
        if self.slots[slot].number != u32::MAX {
            return self.slots[slot].number;
        }
        self.slots[slot] = Place { bits, number };
        self.n += 1;
        if 2 * self.n > self.slots.len() {
            self.grow();
        }
        number
    }

    #[cold]
    fn grow(&mut self) {
        let n_slots = 2 * self.slots.len();
        let old = std::mem::replace(&mut self.slots, vec![EMPTY; n_slots]);
        for place in old.into_iter().filter(|place| place.number != u32::MAX) {
            let slot = self.slot(hash_of(place.bits), place.bits);
            self.slots[slot] = place;
        }
    }
}

/// Joins the corners of a chunk.
fn chunk_of(records: &[[u8; RECORD]], table: &mut Table) -> Chunk {
    // A chunk has a place for a triangle or so, since many of its triangles end at others.
    table.clear(3 * records.len() / 2);
    let mut places = Vec::with_capacity(records.len());
    let mut corners = Vec::with_capacity(3 * records.len());
    for record in records {
        for k in 0..3 {
            let bits = bits_of(record, k);
            let number = table.number(bits, places.len() as u32);
            if number as usize == places.len() {
                places.push(bits);
            }
            corners.push(number);
        }
    }
    Chunk { places, corners }
}

/// Sorts the places of a chunk by share, in each in their order.
fn deal(all: &[[u32; 3]], first: u32, n_bits: u32) -> Dealt {
    let n_shares = 1 << n_bits;
    let share = |bits: &[u32; 3]| share_of(hash_of(*bits), n_bits);
    let mut starts = vec![0_u32; n_shares + 1];
    all.iter().for_each(|bits| starts[share(bits) + 1] += 1);
    for share in 0..n_shares {
        starts[share + 1] += starts[share];
    }
    let mut next = starts.clone();
    let mut places = vec![EMPTY; all.len()];
    for (number, bits) in (first..).zip(all) {
        let next = &mut next[share(bits)];
        places[*next as usize] = Place { bits: *bits, number };
        *next += 1;
    }
    Dealt { places, starts }
}

/// For each place of a share the number of the first that is equal to it, chunk by chunk.
fn firsts_of(dealt: &[Dealt], share: usize, table: &mut Table) -> Vec<u32> {
    let of_chunk = |chunk: &Dealt| chunk.starts[share] as usize..chunk.starts[share + 1] as usize;
    let n: usize = dealt.iter().map(|chunk| of_chunk(chunk).len()).sum();
    table.clear(n);
    let places = dealt.iter().flat_map(|chunk| &chunk.places[of_chunk(chunk)]);
    places.map(|place| table.number(place.bits, place.number)).collect()
}

/// What the shares found of a chunk, in the order of its places.
fn in_order(chunk: &Dealt, begins: &[usize], firsts: &[Vec<u32>], start: usize) -> Vec<u32> {
    let mut all = vec![0; chunk.places.len()];
    for ((ends, begin), firsts) in chunk.starts.windows(2).zip(begins).zip(firsts) {
        let places = &chunk.places[ends[0] as usize..ends[1] as usize];
        for (place, first) in places.iter().zip(&firsts[*begin..]) {
            all[place.number as usize - start] = *first;
        }
    }
    all
}
