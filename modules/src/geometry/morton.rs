//! An order of points in which neighbors in space are mostly neighbors in the list.

use glam::DVec3;

/// Bits an axis; three axes fill 63 bits.
const BITS: u32 = 21;

/// The indices of `points` along a Morton curve (Morton 1966) through their box.
///
/// Points that are not finite come last; equal codes keep the order of the list.
pub fn morton_order(points: &[DVec3]) -> Vec<u32> {
    let finite = || points.iter().filter(|p| p.is_finite());
    let low = finite().fold(DVec3::INFINITY, |low, &p| low.min(p));
    let high = finite().fold(DVec3::NEG_INFINITY, |high, &p| high.max(p));
    let cells = f64::from(1u32 << BITS);
    let extent = (high - low).max_element();
    let scale = if extent > 0.0 && extent.is_finite() { (cells - 1.0) / extent } else { 0.0 };
    let mut keys: Vec<(u64, u32)> = points
        .iter()
        .enumerate()
        .map(|(idx, &p)| {
            let code = if p.is_finite() { code((p - low) * scale) } else { u64::MAX };
            (code, idx as u32)
        })
        .collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, idx)| idx).collect()
}

/// Interleaves the bits of the integer parts; `as` saturates what is out of range.
fn code(cell: DVec3) -> u64 {
    spread(cell.x as u64) | spread(cell.y as u64) << 1 | spread(cell.z as u64) << 2
}

/// Moves bit `i` to bit `3 i`, for the lowest 21 bits.
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
        assert_eq!(morton_order(&points), [8, 7, 6, 5, 4, 3, 2, 1, 0]);
    }
}
