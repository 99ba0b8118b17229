//! Student's t for whole degrees of freedom, and the normal distribution.
//!
//! Sources: M. Abramowitz & I. Stegun, *Handbook of Mathematical Functions*, 1964, 26.7.3 and
//! 26.7.4: with whole degrees of freedom the distribution of t is a finite sum. G. Marsaglia,
//! *Evaluating the normal distribution*, Journal of Statistical Software 11 (4), 2004: the series.

use std::f64::consts::{FRAC_PI_2, PI};

/// Halvings of an angle until no bit of a quantile changes.
const HALVINGS: usize = 60;

/// The t that |t| stays below with this probability, for `freedom` ≥ 1. Costs a term for every two
/// degrees of freedom.
pub fn t_quantile(probability: f64, freedom: usize) -> f64 {
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if within(middle, freedom) < probability { low = middle } else { high = middle }
    }
    (freedom as f64).sqrt() * low.tan()
}

/// The probability that |t| is below `sqrt(freedom) * tan(angle)`.
fn within(angle: f64, freedom: usize) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let is_odd = freedom % 2 == 1;
    let mut term = if is_odd { cos } else { 1.0 };
    let mut sum = 0.0;
    let mut power = if is_odd { 1 } else { 0 };
    // The last power of the cosine is `freedom` − 2.
    while power + 2 <= freedom {
        sum += term;
        power += 2;
        term *= cos * cos * (power - 1) as f64 / power as f64;
    }
    if is_odd { 2.0 / PI * (angle + sin * sum) } else { sin * sum }
}

/// The probability that a standard normal number is at least this far from 0, on either side, to
/// 1e-15.
pub fn normal_tails(distance: f64) -> f64 {
    let z = distance.abs();
    if z > 8.0 {
        return 0.0;
    }
    let (mut sum, mut term, mut odd) = (z, z, 1.0);
    while term > 1e-17 * sum {
        odd += 2.0;
        term *= z * z / odd;
        sum += term;
    }
    (1.0 - 2.0 * sum * (-0.5 * z * z).exp() / (2.0 * PI).sqrt()).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_scipy() {
        // scipy.stats.t.ppf(0.975, freedom)
        let quantiles = [
            (1, 12.706204736174694),
            (2, 4.302652729749462),
            (3, 3.182446305283709),
            (4, 2.7764451051977934),
            (9, 2.262157162798205),
            (50, 2.008559112100761),
            (999, 1.9623414611334493),
        ];
        for (freedom, expected) in quantiles {
            let found = t_quantile(0.95, freedom);
            assert!((found - expected).abs() < 1e-9 * expected, "{freedom}: {found}");
        }
        // 2 * scipy.stats.norm.cdf(-z)
        let tails = [(0.0, 1.0), (1.0, 0.31731050786291415), (3.3, 0.0009668482847675549)];
        for (z, expected) in tails {
            assert!((normal_tails(z) - expected).abs() < 1e-14, "{z}: {}", normal_tails(z));
        }
        assert_eq!(normal_tails(f64::INFINITY), 0.0);
    }
}
