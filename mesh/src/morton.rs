//! An order of points in which neighbors in space are mostly neighbors in the list.

use glam::DVec3;

use mve_core::{Cancelled, Control};

/// Bits an axis; three axes fill 63 bits.
const BITS: u32 = 21;
/// Points between two looks whether the work was cancelled.
const STRIDE: usize = 1 << 15;
/// Bits that one pass of the sort looks at.
const DIGIT: u32 = 11;

/// The indices of `points` along a Morton curve (Morton 1966) through their box, O(n).
///
/// Points that are not finite come last; equal codes keep the order of the list.
pub fn morton_order(points: &[DVec3], control: Control) -> Result<Vec<u32>, Cancelled> {
    order_by_cells(points, BITS, control)
}

/// The same through boxes of 1/1024 of its longest side, points of one box in the order of the
/// list: takes half the time.
pub fn coarse_order(points: &[DVec3], control: Control) -> Result<Vec<u32>, Cancelled> {
    order_by_cells(points, 10, control)
}

/// The code of each point in the order of [`coarse_order`], the largest number where it is not
/// finite.
pub fn coarse_codes(points: &[DVec3], control: Control) -> Result<Vec<u64>, Cancelled> {
    codes(points, 10, control)
}

fn order_by_cells(points: &[DVec3], bits: u32, control: Control) -> Result<Vec<u32>, Cancelled> {
    let mut keys: Vec<(u64, u32)> = codes(points, bits, control)?.into_iter().zip(0..).collect();
    sort_by_code(&mut keys, control)?;
    Ok(keys.into_iter().map(|(_, idx)| idx).collect())
}

fn codes(points: &[DVec3], bits: u32, control: Control) -> Result<Vec<u64>, Cancelled> {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for chunk in points.chunks(STRIDE) {
        control.at(0.0)?;
        for &point in chunk.iter().filter(|p| p.is_finite()) {
            low = low.min(point);
            high = high.max(point);
        }
    }
    let cells = f64::from(1u32 << bits);
    let extent = (high - low).max_element();
    let scale = if extent > 0.0 && extent.is_finite() { (cells - 1.0) / extent } else { 0.0 };
    let code = |p: &DVec3| if p.is_finite() { code((*p - low) * scale) } else { u64::MAX };
    let mut codes = Vec::with_capacity(points.len());
    for chunk in points.chunks(STRIDE) {
        control.at(0.0)?;
        codes.extend(chunk.iter().map(code));
    }
    Ok(codes)
}

/// Sorts by the first number, lowest digits first (Seward 1954), O(n); equal ones keep their order.
pub fn sort_by_code(keys: &mut Vec<(u64, u32)>, control: Control) -> Result<(), Cancelled> {
    let mut sorted = vec![(0, 0); keys.len()];
    for shift in (0..u64::BITS).step_by(DIGIT as usize) {
        let digit = |code: u64| (code >> shift) as usize & ((1 << DIGIT) - 1);
        let mut places = [0usize; 1 << DIGIT];
        for chunk in keys.chunks(STRIDE) {
            control.at(0.0)?;
            chunk.iter().for_each(|&(code, _)| places[digit(code)] += 1);
        }
        if places.contains(&keys.len()) {
            continue;
        }
        let mut before = 0;
        for place in &mut places {
            before += std::mem::replace(place, before);
        }
        for chunk in keys.chunks(STRIDE) {
            control.at(0.0)?;
            for &key in chunk {
                let place = &mut places[digit(key.0)];
                sorted[*place] = key;
                *place += 1;
            }
        }
        std::mem::swap(keys, &mut sorted);
    }
    Ok(())
}

/// The code of integer parts; `as` saturates what is out of range.
#[inline]
fn code(cell: DVec3) -> u64 {
    interleave(cell.to_array().map(|c| c as u64))
}

/// Interleaves the lowest 21 bits of three numbers, those of the first the lowest.
#[inline]
pub fn interleave(cell: [u64; 3]) -> u64 {
    let [x, y, z] = cell.map(spread);
    x | y << 1 | z << 2
}

/// Moves bit `i` to bit `3 i`, for the lowest 21 bits.
#[inline]
fn spread(value: u64) -> u64 {
    let mut v = value & 0x1f_ffff;
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octants_come_one_after_the_other_and_nan_last() {
        let corner = |i: u32| DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into());
        let mut points: Vec<DVec3> = (0..8).rev().map(corner).collect();
        points.insert(0, DVec3::NAN);
        let order = morton_order(&points, Control::none()).unwrap();
        assert_eq!(order, [8, 7, 6, 5, 4, 3, 2, 1, 0]);
    }

    #[test]
    fn bits_of_three_numbers_alternate() {
        assert_eq!(interleave([0b101, 0b011, 0b110]), 0b101_110_011);
        assert_eq!(interleave([u64::MAX; 3]), (1 << 63) - 1);
    }

    #[test]
    fn codes_are_sorted_by_all_their_bits_and_equal_ones_stay() {
        let codes = [u64::MAX, 5, 1 << 63, 5, 1 << 40, 0, u64::MAX, 1 << 40 | 5];
        let mut keys: Vec<(u64, u32)> = codes.into_iter().zip(0..).collect();
        let mut expected = keys.clone();
        expected.sort_unstable();
        sort_by_code(&mut keys, Control::none()).unwrap();
        assert_eq!(keys, expected);
    }
}
