//! Splitting the items of a node of [`Bvh`](super::bvh::Bvh) in two: by the surface area heuristic
//! over binned centers, by count, or along a curve.

use mve_core::{Cancelled, Control};

use super::items::{Bounds, Item};

/// Bins along the longest axis.
const N_BINS: usize = 16;
/// Below this depth parts are halved by count, which bounds the depth of the tree.
const SAH_DEPTH: u32 = 40;
/// Items of a long loop between two looks whether the work was cancelled: a millisecond or so.
const STRIDE: usize = 1 << 15;

/// A run of items that becomes one child.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub start: usize,
    pub end: usize,
    pub bounds: Bounds,
}

impl Part {
    pub fn len(&self) -> usize {
        self.end - self.start
    }
}

/// The box around the items.
pub(super) fn bounds_of(items: &[Item], control: Control) -> Result<Bounds, Cancelled> {
    let mut bounds = Bounds::EMPTY;
    for chunk in items.chunks(STRIDE) {
        report_long(chunk, control)?;
        for item in chunk {
            bounds.add(item.low, item.high);
        }
    }
    Ok(bounds)
}

/// The box around twice the centers of the items.
pub(super) fn centers_of(items: &[Item], control: Control) -> Result<Bounds, Cancelled> {
    let mut centers = Bounds::EMPTY;
    for chunk in items.chunks(STRIDE) {
        report_long(chunk, control)?;
        for item in chunk {
            centers.add(item.center(), item.center());
        }
    }
    Ok(centers)
}

/// Splits a part of at least two items in two that are not empty.
pub(super) fn split(
    items: &mut [Item],
    part: Part,
    centers: Bounds,
    depth: u32,
    control: Control,
) -> Result<[Part; 2], Cancelled> {
    let slice = &mut items[part.start..part.end];
    let extent = centers.high - centers.low;
    let axis = extent.max_position();
    let by_bins = if extent[axis] > 0.0 && depth < SAH_DEPTH {
        split_by_area(slice, axis, centers.low[axis], extent[axis], control)?
    } else {
        None
    };
    let (count, bounds) = match by_bins {
        Some(found) => found,
        None => split_by_count(slice, axis, control)?,
    };
    let cut = part.start + count;
    let [below, above] = bounds;
    Ok([
        Part { start: part.start, end: cut, bounds: below },
        Part { start: cut, end: part.end, bounds: above },
    ])
}

/// Looks whether the work was cancelled, if the chunk of a loop is a whole one.
fn report_long(chunk: &[Item], control: Control) -> Result<(), Cancelled> {
    if chunk.len() == STRIDE { control.at(0.0) } else { Ok(()) }
}

/// Reorders the items by the median of their centers; returns as [`split_by_area`] does.
fn split_by_count(
    slice: &mut [Item],
    axis: usize,
    control: Control,
) -> Result<(usize, [Bounds; 2]), Cancelled> {
    let half = slice.len() / 2;
    slice.select_nth_unstable_by(half, |a, b| {
        a.center()[axis].total_cmp(&b.center()[axis]).then(a.number.cmp(&b.number))
    });
    let (below, above) = slice.split_at(half);
    Ok((half, [bounds_of(below, control)?, bounds_of(above, control)?]))
}

/// Reorders the items by the cheapest plane between bins; returns how many lie before it, and the
/// boxes of both sides.
fn split_by_area(
    slice: &mut [Item],
    axis: usize,
    low: f32,
    extent: f32,
    control: Control,
) -> Result<Option<(usize, [Bounds; 2])>, Cancelled> {
    let n_bins = if slice.len() < 2 * N_BINS { N_BINS / 2 } else { N_BINS };
    let per_extent = n_bins as f32 * (1.0 - 1e-6) / extent;
    let bin_of =
        |item: &Item| (((item.center()[axis] - low) * per_extent) as i32 as usize).min(n_bins - 1);
    let mut bins = [(Bounds::EMPTY, 0usize); N_BINS];
    for chunk in slice.chunks(STRIDE) {
        report_long(chunk, control)?;
        for item in chunk {
            let (bounds, count) = &mut bins[bin_of(item)];
            bounds.add(item.low, item.high);
            *count += 1;
        }
    }
    let mut above = [(Bounds::EMPTY, 0); N_BINS];
    for cut in (1..n_bins).rev() {
        let mut sum = if cut + 1 < n_bins { above[cut + 1] } else { (Bounds::EMPTY, 0) };
        sum.0.add(bins[cut].0.low, bins[cut].0.high);
        sum.1 += bins[cut].1;
        above[cut] = sum;
    }
    let cost = |(bounds, count): (Bounds, usize)| bounds.half_area() * count as f32;
    let mut below = (Bounds::EMPTY, 0);
    let mut best: Option<(f32, usize, [Bounds; 2])> = None;
    for cut in 1..n_bins {
        below.0.add(bins[cut - 1].0.low, bins[cut - 1].0.high);
        below.1 += bins[cut - 1].1;
        let total = cost(below) + cost(above[cut]);
        let is_cut = below.1 > 0 && below.1 < slice.len();
        if is_cut && best.is_none_or(|(least, ..)| total < least) {
            best = Some((total, cut, [below.0, above[cut].0]));
        }
    }
    let Some((_, cut, bounds)) = best else { return Ok(None) };
    let mut n_before = 0;
    for k in 0..slice.len() {
        if k % STRIDE == STRIDE - 1 {
            control.at(0.0)?;
        }
        if bin_of(&slice[k]) < cut {
            slice.swap(n_before, k);
            n_before += 1;
        }
    }
    Ok(Some((n_before, bounds)))
}
