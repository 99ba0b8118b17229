//! Ratios as changes in words: in percent, or in times.

use crate::labels;
use crate::stats::RatioEstimate;

/// How the changes of one answer are said, so that they compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeForm {
    /// `12 % lower`.
    Percent,
    /// `3.1 times higher`.
    Times,
}

impl ChangeForm {
    /// In percent where all of these ratios read well so.
    pub fn of(ratios: &[f64]) -> Self {
        match ratios.iter().all(|ratio| (0.1..=2.0).contains(ratio)) {
            true => Self::Percent,
            false => Self::Times,
        }
    }

    /// A ratio as a change.
    pub fn change(self, ratio: f64) -> String {
        let side = if ratio < 1.0 { "lower" } else { "higher" };
        match self.amount(ratio) {
            None => "no different".to_owned(),
            Some(amount) => format!("{amount} {side}"),
        }
    }

    /// How much a ratio differs from 1, with its unit; `None` where it hardly does.
    fn amount(self, ratio: f64) -> Option<String> {
        let is_off = (ratio - 1.0).abs() >= 5e-5;
        is_off.then(|| match self {
            Self::Percent => {
                format!("{}\u{a0}%", labels::rounded(100.0 * (ratio - 1.0).abs(), 2))
            }
            Self::Times => {
                // Two digits would make 1.04 and 1 the same.
                let factor = ratio.max(ratio.recip());
                let digits = if factor < 2.0 { 3 } else { 2 };
                format!("{} times", labels::rounded(factor, digits))
            }
        })
    }

    /// An interval of ratios.
    pub fn span(self, low: f64, high: f64) -> String {
        let side = |ratio: f64| ratio < 1.0;
        // From the smaller change to the larger one, where both go one way.
        let (first, last) = if side(high) { (high, low) } else { (low, high) };
        match (side(low) == side(high), self.amount(first), self.amount(last)) {
            (true, Some(first), Some(_)) => {
                let first = first.trim_end_matches(" times").trim_end_matches("\u{a0}%");
                format!("{first} to {}", self.change(last))
            }
            _ => format!("{} to {}", self.change(low), self.change(high)),
        }
    }

    /// That of means and their intervals, which one answer says.
    pub fn of_estimates(estimates: &[RatioEstimate]) -> Self {
        let all = estimates.iter().flat_map(|estimate| {
            let (low, high) = estimate.interval.unwrap_or((estimate.ratio, estimate.ratio));
            [low, estimate.ratio, high]
        });
        Self::of(&all.collect::<Vec<_>>())
    }
}
