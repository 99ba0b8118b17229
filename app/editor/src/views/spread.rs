//! How values are spread over their range.

use egui_plot::{Bar, BarChart};

/// Parts of a range as a chart shows them.
const N_BARS: usize = 40;

/// How often values are in each of some equal parts of their range.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    low: f64,
    /// Of a part.
    width: f64,
    counts: Vec<usize>,
}

impl Spread {
    /// Counts the finite values, O(n).
    pub fn of(values: &[f64]) -> Self {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let low = finite().fold(f64::INFINITY, f64::min);
        Self::within(values, [low, finite().fold(f64::NEG_INFINITY, f64::max)])
    }

    /// Counts the values within a range, O(n).
    pub fn within(values: &[f64], [low, high]: [f64; 2]) -> Self {
        // Values that are all the same make one bar of some width.
        let pad = if low < high { 0.0 } else { 0.5 * low.abs().max(1.0) };
        let [low, high] = [low - pad, high + pad];
        let width = (high - low) / N_BARS as f64;
        let counts = match width.is_finite() {
            true => histogram(values, [low, high], N_BARS),
            false => Vec::new(),
        };
        Self { low, width, counts }
    }

    /// The counts as bars.
    pub fn chart(&self, name: &str) -> BarChart {
        let bar = |(k, &count): (usize, &usize)| {
            let middle = self.low + (k as f64 + 0.5) * self.width;
            Bar::new(middle, count as f64).width(self.width)
        };
        BarChart::new(name, self.counts.iter().enumerate().map(bar).collect())
    }
}

/// How many of the values lie in each of so many equal parts of a range.
pub fn histogram(values: &[f64], [low, high]: [f64; 2], n_parts: usize) -> Vec<usize> {
    let mut counts = vec![0; n_parts];
    let span = 0.5 * high - 0.5 * low;
    if n_parts == 0 || span.is_nan() || span <= 0.0 {
        return counts;
    }
    for &value in values.iter().filter(|value| **value >= low && **value <= high) {
        let part = ((0.5 * value - 0.5 * low) / span * n_parts as f64) as usize;
        counts[part.min(n_parts - 1)] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_counts_each_value_within_the_range_once() {
        let values = [0.0, 0.1, 0.5, 0.99, 1.0, 1.01, f64::NAN, -1.0];
        assert_eq!(histogram(&values, [0.0, 1.0], 4), [2, 0, 1, 2]);
        assert_eq!(histogram(&values, [1.0, 1.0], 2), [0, 0]);
        assert_eq!(histogram(&[0.0], [-1e308, 1e308], 2), [0, 1]);
    }

    #[test]
    fn a_spread_holds_every_finite_value_once() {
        for values in [vec![1.0, 2.0, 3.0], vec![5.0; 4], vec![0.0, f64::NAN], vec![]] {
            let n_finite = values.iter().filter(|value: &&f64| value.is_finite()).count();
            assert_eq!(Spread::of(&values).counts.iter().sum::<usize>(), n_finite);
        }
    }
}
