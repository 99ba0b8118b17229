//! What is drawn of a change, before it is compared with what is there: eight pixels at a time.

use wide::bytemuck::cast;
use wide::{f32x8, i32x8};

use super::colors::Values;
use crate::picture::render::{LANES, Rect, Triangle};

/// Pixels that are worked on together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// One over the depth; 0 where nothing is drawn.
    pub inv_depths: f32x8,
    /// The face that is drawn.
    pub faces: i32x8,
    /// Its luminance, a byte a pixel, the first pixel the lowest.
    pub values: u64,
}

const EMPTY: Block = Block { inv_depths: f32x8::splat(0.0), faces: i32x8::splat(0), values: 0 };

/// A byte of ones for each bit.
pub(super) const BYTES: [u64; 256] = {
    let mut bytes = [0u64; 256];
    let mut bits = 0;
    while bits < 256 {
        let mut lane = 0;
        while lane < LANES {
            if bits >> lane & 1 != 0 {
                bytes[bits] |= 0xFF << (8 * lane);
            }
            lane += 1;
        }
        bits += 1;
    }
    bytes
};

/// The same byte for all pixels.
#[inline(always)]
pub(super) fn all(value: u8) -> u64 {
    u64::from_le_bytes([value; LANES])
}

/// A rectangle of a picture on which faces are drawn. Its rows begin at the first column of its
/// area and are filled up to whole blocks.
#[derive(Debug)]
pub(super) struct Canvas {
    area: Rect,
    /// Blocks in a row.
    pub n_across: usize,
    pub blocks: Vec<Block>,
}

impl Default for Canvas {
    fn default() -> Self {
        Self { area: Rect::NONE, n_across: 0, blocks: Vec::new() }
    }
}

impl Canvas {
    #[inline(always)]
    pub fn clear(&mut self, area: &Rect) {
        self.area = *area;
        self.n_across = area.width().div_ceil(LANES);
        self.blocks.clear();
        self.blocks.resize(self.n_across * area.height(), EMPTY);
    }

    /// Draws a face of a larger number than those before.
    #[inline(always)]
    pub fn draw(&mut self, face: u32, triangle: &Triangle, values: impl Values) {
        let Some(small) = triangle.small() else { return self.draw_large(face, triangle, values) };
        let seen = triangle.bounds.within(&self.area);
        if seen.is_empty() {
            return;
        }
        let face = i32x8::splat(face as i32);
        let first = (seen.x[0] - self.area.x[0]) as usize / LANES;
        let last = (seen.x[1] - 1 - self.area.x[0]) as usize / LANES;
        let left = self.area.x[0] + (first * LANES) as i32;
        let mut start = small.lanes(left, seen.y[0]);
        let n_skipped = (seen.y[0] - self.area.y[0]) as usize;
        let rows = self.blocks.chunks_exact_mut(self.n_across).skip(n_skipped);
        for (row, y) in rows.take(seen.height()).zip(seen.y[0]..) {
            let mut lanes = start;
            start.go_down();
            for (there, block) in row[first..=last].iter_mut().zip(0..) {
                let (is_inside, inv_depths) = lanes.next();
                let is_seen = inv_depths.simd_gt(there.inv_depths) & cast::<_, f32x8>(is_inside);
                there.inv_depths = is_seen.bitselect(inv_depths, there.inv_depths);
                there.faces = cast::<_, i32x8>(is_seen).bitselect(face, there.faces);
                let seen = is_seen.to_bitmask() & 0xFF;
                let bytes = BYTES[seen as usize];
                let values = values.of_lanes(left + block * LANES as i32, y, seen);
                there.values = (values & bytes) | (there.values & !bytes);
            }
        }
    }

    fn draw_large(&mut self, face: u32, triangle: &Triangle, values: impl Values) {
        triangle.rows(&self.area, |row| {
            let start = (row.y - self.area.y[0]) as usize * self.n_across;
            for (k, x) in (row.x[0]..row.x[1]).enumerate() {
                let at = (x - self.area.x[0]) as usize;
                let (block, lane) = (&mut self.blocks[start + at / LANES], at % LANES);
                let inv_depth = row.inv_depth(k);
                if inv_depth > block.inv_depths.as_array()[lane] {
                    block.inv_depths.as_mut_array()[lane] = inv_depth;
                    block.faces.as_mut_array()[lane] = face as i32;
                    let bytes = BYTES[1 << lane];
                    let value = all(values.of_pixel(x, row.y));
                    block.values = (value & bytes) | (block.values & !bytes);
                }
            }
        });
    }
}
