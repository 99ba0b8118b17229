//! What is drawn of a change, before it is compared with what is there: in blocks of lanes.

use crate::geometry::render::{LANES, Rect, Triangle};

/// Pixels that are worked on together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// One over the depth; 0 where nothing is drawn.
    pub inv_depths: [f32; LANES],
    /// The face that is drawn.
    pub faces: [u32; LANES],
    /// Its luminance.
    pub values: [u32; LANES],
}

const EMPTY: Block = Block { inv_depths: [0.0; LANES], faces: [0; LANES], values: [0; LANES] };

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
    pub fn draw(&mut self, face: u32, triangle: &Triangle, value: u8) {
        let Some(small) = triangle.small() else { return self.draw_large(face, triangle, value) };
        let seen = triangle.bounds.within(&self.area);
        if seen.is_empty() {
            return;
        }
        let [first, last] =
            [seen.x[0], seen.x[1] - 1].map(|x| (x - self.area.x[0]) as usize / LANES);
        for y in seen.y[0]..seen.y[1] {
            let row = (y - self.area.y[0]) as usize * self.n_across;
            for at in first..=last {
                let (is_inside, inv_depths) = small.lanes(self.area.x[0] + (at * LANES) as i32, y);
                let Block { inv_depths: there, faces, values } = &mut self.blocks[row + at];
                for lane in 0..LANES {
                    let is_seen = is_inside[lane] & (inv_depths[lane] > there[lane]);
                    there[lane] = if is_seen { inv_depths[lane] } else { there[lane] };
                    faces[lane] = if is_seen { face } else { faces[lane] };
                    values[lane] = if is_seen { u32::from(value) } else { values[lane] };
                }
            }
        }
    }

    fn draw_large(&mut self, face: u32, triangle: &Triangle, value: u8) {
        triangle.rows(&self.area, |row| {
            let start = (row.y - self.area.y[0]) as usize * self.n_across;
            for (k, x) in (row.x[0]..row.x[1]).enumerate() {
                let at = (x - self.area.x[0]) as usize;
                let (block, lane) = (&mut self.blocks[start + at / LANES], at % LANES);
                let inv_depth = row.inv_depth(k);
                if inv_depth > block.inv_depths[lane] {
                    block.inv_depths[lane] = inv_depth;
                    block.faces[lane] = face;
                    block.values[lane] = u32::from(value);
                }
            }
        });
    }
}
