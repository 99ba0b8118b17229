//! Which pixels a triangle covers, and how near it is there.
//!
//! A pixel belongs to a triangle if its center is inside; a center on an edge belongs to the
//! triangle for which the edge is a top or a left one, so of two triangles at an edge exactly one
//! has it (J. Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH 1988, with the
//! fill rule of graphics hardware). Corners are snapped to 1/256 of a pixel, and everything that
//! decides about a pixel is integer arithmetic: no pixel is missed or drawn twice, on any machine.

use wide::{f32x8, i32x8};

use super::Corner;
use super::project::STEPS;

/// Rows wider than this are cut by division, not pixel by pixel.
const WIDE: i32 = 12;

/// A rectangle of pixels: columns `x[0]..x[1]` of rows `y[0]..y[1]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// First column, and the one after the last.
    pub x: [i32; 2],
    /// First row, and the one after the last.
    pub y: [i32; 2],
}

impl Rect {
    /// A whole picture.
    pub fn whole(size: usize) -> Self {
        Self { x: [0, size as i32], y: [0, size as i32] }
    }

    /// No pixel; the start for [`Rect::include`].
    pub const NONE: Self = Self { x: [i32::MAX, i32::MIN], y: [i32::MAX, i32::MIN] };

    /// Whether there is no pixel in it.
    pub fn is_empty(&self) -> bool {
        self.x[0] >= self.x[1] || self.y[0] >= self.y[1]
    }

    /// Pixels in a row; 0 when empty.
    pub fn width(&self) -> usize {
        self.x[1].saturating_sub(self.x[0]).max(0) as usize
    }

    /// Rows; 0 when empty.
    pub fn height(&self) -> usize {
        self.y[1].saturating_sub(self.y[0]).max(0) as usize
    }

    /// Grows to hold every pixel whose center may be on or beside a corner.
    #[inline]
    pub fn include(&mut self, corner: Corner) {
        let [x, y] = [corner.x, corner.y].map(|at| (at + STEPS / 2 - 1).div_euclid(STEPS));
        self.x = [self.x[0].min(x), self.x[1].max(x + 1)];
        self.y = [self.y[0].min(y), self.y[1].max(y + 1)];
    }

    /// What is in both.
    #[inline]
    pub fn within(&self, other: &Self) -> Self {
        let both = |a: [i32; 2], b: [i32; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        Self { x: both(self.x, other.x), y: both(self.y, other.y) }
    }

    /// The rectangle with a margin on all sides.
    pub fn grown(&self, margin: i32) -> Self {
        let grow = |a: [i32; 2]| [a[0] - margin, a[1] + margin];
        Self { x: grow(self.x), y: grow(self.y) }
    }
}

/// Which sides of a face are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Sides {
    /// Only the front; back faces are culled.
    #[default]
    Front,
    /// Both.
    Both,
}

impl Sides {
    /// Whether this side of a face is drawn.
    #[inline]
    pub fn show(self, side: FaceSide) -> bool {
        self == Self::Both || side == FaceSide::Front
    }
}

/// Which side of a triangle is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceSide {
    /// Its corners are counter-clockwise.
    Front,
    /// Its corners are clockwise.
    Back,
}

/// A triangle on the grid, ready to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Which side is seen.
    pub side: FaceSide,
    /// The pixels that it may cover.
    pub bounds: Rect,
    /// `(step in x, step in y)` of the three edge functions, from pixel to pixel.
    steps: [[i64; 2]; 3],
    /// Their values at the center of the first pixel of the bounds, less 1 for an edge whose own
    /// points are not inside.
    start: [i64; 3],
    inv_depth: f32,
    /// What the second and third edge function add to `inv_depth`, a unit.
    slopes: [f32; 2],
}

/// Pixels that are worked on together, in lanes of vector instructions.
pub const LANES: usize = 8;

/// A triangle of a few pixels, for rows of [`LANES`] pixels at once.
#[derive(Clone, Copy, Debug)]
pub struct Small {
    /// `(step in x, step in y)` of the edge functions.
    steps: [[i32; 2]; 3],
    /// Their values at the first pixel of the bounds.
    start: [i32; 3],
    first: [i32; 2],
    inv_depth: f32,
    slopes: [f32; 2],
}

/// Blocks of pixels of a [`Small`] triangle, from left to right and row by row.
#[derive(Clone, Copy, Debug)]
pub struct Lanes {
    edges: [i32x8; 3],
    /// What edge functions gain to the next block, and to the next row.
    right: [i32x8; 3],
    down: [i32x8; 3],
    inv_depth: f32x8,
    slopes: [f32x8; 2],
}

impl Small {
    /// The blocks of row `y` from column `x` on. Columns from a block before the bounds to a block
    /// behind them may be asked for, and rows within the bounds.
    #[inline(always)]
    pub fn lanes(&self, x: i32, y: i32) -> Lanes {
        let (dx, dy) = (x - self.first[0], y - self.first[1]);
        let numbers = i32x8::new([0, 1, 2, 3, 4, 5, 6, 7]);
        let edge = |k: usize| {
            let [right, down] = self.steps[k];
            i32x8::splat(self.start[k] + dx * right + dy * down) + numbers * i32x8::splat(right)
        };
        let right = |k: usize| i32x8::splat(self.steps[k][0] * LANES as i32);
        let down = |k: usize| i32x8::splat(self.steps[k][1]);
        Lanes {
            edges: [edge(0), edge(1), edge(2)],
            right: [right(0), right(1), right(2)],
            down: [down(0), down(1), down(2)],
            inv_depth: f32x8::splat(self.inv_depth),
            slopes: [f32x8::splat(self.slopes[0]), f32x8::splat(self.slopes[1])],
        }
    }
}

impl Lanes {
    /// Which pixels of the next block are covered, as masks, and one over the depth of each: the
    /// values of [`Row::inv_depth`], to the last bit.
    #[inline(always)]
    pub fn next(&mut self) -> (i32x8, f32x8) {
        let [e0, e1, e2] = self.edges;
        let is_inside = (e0 | e1 | e2).simd_ge(i32x8::splat(0));
        let slope = |k: usize, edge: i32x8| f32x8::from_i32x8(edge) * self.slopes[k];
        let inv_depths = self.inv_depth + (slope(0, e1) + slope(1, e2));
        self.edges = [e0 + self.right[0], e1 + self.right[1], e2 + self.right[2]];
        (is_inside, inv_depths)
    }

    /// Goes to the block below. Below the last row of the bounds no block may be asked for.
    #[inline(always)]
    pub fn go_down(&mut self) {
        let [e0, e1, e2] = self.edges;
        self.edges = [e0 + self.down[0], e1 + self.down[1], e2 + self.down[2]];
    }
}

/// The pixels of a triangle in one row.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The row.
    pub y: i32,
    /// First column, and the one after the last.
    pub x: [i32; 2],
    edges: [i64; 2],
    steps: [i64; 2],
    inv_depth: f32,
    slopes: [f32; 2],
}

impl Row {
    /// One over the depth, `k` pixels from the first. A function of the triangle and of the pixel
    /// alone, between the least and the largest of the corners.
    #[inline(always)]
    pub fn inv_depth(&self, k: usize) -> f32 {
        let edge = |n: usize| (self.edges[n] + k as i64 * self.steps[n]) as f32;
        self.inv_depth + (edge(0) * self.slopes[0] + edge(1) * self.slopes[1])
    }

    /// [`Row::inv_depth`] to the last bit, in a form that processors without 64-bit integers in
    /// their vectors can compute for several pixels at once: an edge function is below 2^53, so
    /// doubles hold it exactly, and it is rounded once, on the way to single precision.
    #[inline(always)]
    pub fn inv_depth_at(&self, k: i32) -> f32 {
        let edge = |n: usize| {
            (self.edges[n] as f64 + f64::from(k) * self.steps[n] as f64) as f32 * self.slopes[n]
        };
        self.inv_depth + (edge(0) + edge(1))
    }
}

impl Triangle {
    /// Of three corners that have a place; `None` if no center of a pixel can be in it, or if it
    /// shows a side that is not drawn.
    #[inline(always)]
    pub fn new([a, mut b, mut c]: [Corner; 3], sides: Sides) -> Option<Self> {
        let across = |from: Corner, to: Corner, at: [i32; 2]| {
            let along = [i64::from(to.x - from.x), i64::from(to.y - from.y)];
            let there = [i64::from(at[0] - from.x), i64::from(at[1] - from.y)];
            along[0] * there[1] - along[1] * there[0]
        };
        // Rows count downward, so what is counter-clockwise for the eye is negative here.
        let mut area = -across(a, b, [c.x, c.y]);
        let side = if area > 0 { FaceSide::Front } else { FaceSide::Back };
        if area == 0 || !sides.show(side) {
            return None;
        }
        if area > 0 {
            (b, c) = (c, b);
        } else {
            area = -area;
        }
        let [x, y] = [[a.x, b.x, c.x], [a.y, b.y, c.y]];
        let least = |at: [i32; 3]| (at[0].min(at[1]).min(at[2]) + STEPS / 2 - 1) >> 8;
        let most = |at: [i32; 3]| (at[0].max(at[1]).max(at[2]) + STEPS / 2) >> 8;
        let bounds = Rect { x: [least(x), most(x)], y: [least(y), most(y)] };
        if bounds.is_empty() {
            return None;
        }
        let center = |pixel: i32| pixel * STEPS + STEPS / 2;
        let first = [center(bounds.x[0]), center(bounds.y[0])];
        // The edge opposite to each corner: its function is the area at that corner, 0 at the
        // others. Written out: a map over an array is not always inlined, and this is where time
        // goes.
        let start = |from: Corner, to: Corner| {
            let (dx, dy) = (to.x - from.x, to.y - from.y);
            let owns_its_points = dy < 0 || (dy == 0 && dx > 0);
            across(from, to, first) - i64::from(!owns_its_points)
        };
        let step = |from: Corner, to: Corner| {
            let per_pixel = |d: i32| i64::from(d) * i64::from(STEPS);
            [per_pixel(from.y - to.y), per_pixel(to.x - from.x)]
        };
        let start = [start(b, c), start(c, a), start(a, b)];
        let steps = [step(b, c), step(c, a), step(a, b)];
        let per_area = (area as f32).recip();
        let slope = |corner: Corner| (corner.inv_depth - a.inv_depth) * per_area;
        let slopes = [slope(b), slope(c)];
        Some(Self { side, bounds, steps, start, inv_depth: a.inv_depth, slopes })
    }

    /// The triangle in small numbers, if it is small enough for them.
    #[inline(always)]
    pub fn small(&self) -> Option<Small> {
        // An edge is at most 120 × 2⁸ steps long, and rows and columns up to 128 away are asked
        // for: two such products stay below 2³¹.
        const MOST: usize = 120;
        let fits = self.bounds.width() <= MOST && self.bounds.height() <= MOST;
        fits.then(|| Small {
            steps: self.steps.map(|step| step.map(|d| d as i32)),
            start: self.start.map(|value| value as i32),
            first: [self.bounds.x[0], self.bounds.y[0]],
            inv_depth: self.inv_depth,
            slopes: self.slopes,
        })
    }

    /// Calls `each` with every row in `clip` of which a pixel is covered.
    #[inline(always)]
    pub fn rows(&self, clip: &Rect, mut each: impl FnMut(Row)) {
        let area = self.bounds.within(clip);
        if area.is_empty() {
            return;
        }
        let skip = [area.x[0] - self.bounds.x[0], area.y[0] - self.bounds.y[0]].map(i64::from);
        let mut at = self.start;
        for (value, step) in at.iter_mut().zip(self.steps) {
            *value += skip[0] * step[0] + skip[1] * step[1];
        }
        let width = area.x[1] - area.x[0];
        for y in area.y[0]..area.y[1] {
            let [from, to] =
                if width > WIDE { self.cut_row(at, width) } else { self.scan_row(at, width) };
            if from < to {
                each(Row {
                    y,
                    x: [area.x[0] + from, area.x[0] + to],
                    edges: [1, 2].map(|k| at[k] + i64::from(from) * self.steps[k][0]),
                    steps: [self.steps[1][0], self.steps[2][0]],
                    inv_depth: self.inv_depth,
                    slopes: self.slopes,
                });
            }
            for (value, step) in at.iter_mut().zip(self.steps) {
                *value += step[1];
            }
        }
    }

    /// The covered part of a row of `width` pixels, found pixel by pixel.
    #[inline(always)]
    fn scan_row(&self, mut at: [i64; 3], width: i32) -> [i32; 2] {
        let mut from = 0;
        let advance = |at: &mut [i64; 3]| {
            for (value, step) in at.iter_mut().zip(self.steps) {
                *value += step[0];
            }
        };
        while from < width && (at[0] | at[1] | at[2]) < 0 {
            advance(&mut at);
            from += 1;
        }
        let mut to = from;
        while to < width && (at[0] | at[1] | at[2]) >= 0 {
            advance(&mut at);
            to += 1;
        }
        [from, to]
    }

    /// The covered part of a row of `width` pixels, found by division.
    #[inline(always)]
    fn cut_row(&self, at: [i64; 3], width: i32) -> [i32; 2] {
        let mut range = [0, i64::from(width)];
        for (value, [step, _]) in at.into_iter().zip(self.steps) {
            if step > 0 {
                // The first k with value + k step ≥ 0.
                range[0] = range[0].max(-value.div_euclid(step));
            } else if step < 0 {
                // One more than the last k with value + k step ≥ 0.
                range[1] = range[1].min(value.div_euclid(-step) + 1);
            } else if value < 0 {
                return [0, 0];
            }
        }
        [range[0].min(i64::from(width)) as i32, range[1].max(0) as i32]
    }
}
