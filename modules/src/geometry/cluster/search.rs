//! The size of cells that gives what was asked for.

use mve_core::Cancelled;

/// How far from its goal the size of a result may be, as a part of it.
pub const TOLERANCE: f64 = 0.01;
/// Sizes that are tried at most.
const MOST_TRIES: usize = 32;

/// A size whose measure is as near to the goal as a part of it, or else the one that comes nearest,
/// and what was made to measure it.
///
/// The measure goes about as a power of the size, in steps, and is asked once for each size that is
/// tried: the secant through the logarithms of the two tries around the goal, or of the last one
/// with the power, says where to look next.
///
/// # Errors
/// What `measure` gives.
pub fn size_for<T>(
    (goal, tolerance): (f64, f64),
    power: f64,
    (first, largest): (f64, f64),
    mut measure: impl FnMut(f64) -> Result<(f64, T), Cancelled>,
) -> Result<(f64, Option<T>), Cancelled> {
    // Logarithms of a size and of its measure over the goal, below and above the goal.
    let (mut below, mut above) = (None::<(f64, f64)>, None::<(f64, f64)>);
    let (mut best, mut least, mut at) = ((first, None), f64::INFINITY, first.min(largest).ln());
    for _ in 0..MOST_TRIES {
        let size = at.exp().min(largest);
        let (measured, made) = measure(size)?;
        let off = (measured.max(1e-9 * goal) / goal).ln();
        if off.abs() < least {
            (least, best) = (off.abs(), (size, Some(made)));
        }
        if off.abs() <= tolerance.ln_1p() {
            break;
        }
        let side = if off < 0.0 { &mut below } else { &mut above };
        *side = Some((at, off));
        let next = match (below, above) {
            (Some((low, low_off)), Some((high, high_off))) => {
                let share = (low_off / (low_off - high_off)).clamp(0.1, 0.9);
                low + (high - low) * share
            }
            _ => (at - off / power).min(largest.ln()),
        };
        // No size is between these, or none is larger.
        if (next - at).abs() < 1e-9 {
            break;
        }
        at = next;
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_with_steps_is_met_and_what_cannot_be_met_is_come_near() {
        let mut n_tries = 0;
        let size = size_for((1000.0, TOLERANCE), -2.0, (1.0, 100.0), |size| {
            n_tries += 1;
            Ok(((3e4 * size.powf(-1.7)).floor(), size))
        });
        let (size, made) = size.unwrap();
        let found = (3e4 * size.powf(-1.7)).floor();
        assert_eq!(made, Some(size));
        assert!((found - 1000.0).abs() <= 10.0 && n_tries < 8, "{found} {n_tries}");
        // A goal beyond the largest size ends there.
        let size =
            size_for((5.0, TOLERANCE), -2.0, (1.0, 8.0), |size| Ok((1e4 / size, ()))).unwrap();
        assert!((size.0 - 8.0).abs() < 1e-12);
        // A measure of one step.
        let step = |size: f64| Ok((if size < 2.0 { 90.0 } else { 130.0 }, ()));
        assert!(size_for((100.0, TOLERANCE), 1.0, (1.0, 50.0), step).unwrap().0 < 2.0);
    }
}
