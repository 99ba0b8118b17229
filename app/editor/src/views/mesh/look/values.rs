//! The numbers that color a surface, and the ends that a range of colors may take from them.

use mve_modules::data::Domain;
use mve_modules::picture::color_map::{extent_of, quantile};
use serde::{Deserialize, Serialize};

/// The numbers of a scalar source, by element.
#[derive(Clone, Debug)]
pub struct Values {
    /// What is measured.
    pub name: String,
    /// Its unit, or empty.
    pub unit: String,
    /// What the values belong to.
    pub domain: Domain,
    /// One for each element; not a number where there is none. Logarithms where they are wanted.
    pub values: Vec<f64>,
    /// Lowest and highest finite value; 0 and 1 without one.
    pub extent: [f64; 2],
    /// The ends without each of [`CLIP_PERCENTS`] of the values; the extent where those are one.
    pub clipped: [[f64; 2]; CLIP_PERCENTS.len()],
    /// Whether they are logarithms.
    pub spacing: Spacing,
}

/// How many of the values may lie beyond each end of a range that comes from the data, as the
/// module `ColorMap` has it.
pub const CLIP_PERCENTS: [f64; 4] = [0.0, 1.0, 2.0, 5.0];

impl Values {
    /// Looks at all values, O(n).
    pub fn new(
        (name, unit): (String, String),
        domain: Domain,
        values: Vec<f64>,
        spacing: Spacing,
    ) -> Self {
        let extent = extent_of(&values);
        let mut finite: Vec<f64> =
            values.iter().copied().filter(|value| value.is_finite()).collect();
        let clipped = CLIP_PERCENTS.map(|percent| {
            // A whole number of values, so that of a few none is left out.
            let n_beyond = (percent / 100.0 * finite.len() as f64).floor();
            let part = n_beyond / (finite.len().max(2) - 1) as f64;
            let ends = [part, 1.0 - part].map(|part| quantile(&mut finite, part));
            match ends {
                [Some(low), Some(high)] if low < high => [low, high],
                // Nearly all have one value: what is rare is what is to be seen.
                _ => extent,
            }
        });
        Self { name, unit, domain, values, extent, clipped, spacing }
    }
}

/// Whether colors follow values or their decimal logarithms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Spacing {
    /// Values.
    #[default]
    Linear,
    /// Logarithms; what is not above 0 has none.
    Logarithmic,
}

impl Spacing {
    /// The number that colors follow.
    pub fn of(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic if value > 0.0 => value.log10(),
            Self::Logarithmic => f64::NAN,
        }
    }

    /// The value of such a number.
    pub fn back(self, number: f64) -> f64 {
        match self {
            Self::Linear => number,
            Self::Logarithmic => 10f64.powf(number),
        }
    }
}
