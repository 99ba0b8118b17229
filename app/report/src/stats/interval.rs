//! Means with 95 % confidence intervals by Student's t.
//!
//! Source: Student, *The probable error of a mean*, Biometrika 6, 1908. The interval of a geometric
//! mean is the one of the mean of the logarithms.

use super::distributions::t_quantile;

/// The mean of a few values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// How many there are.
    pub n: usize,
    /// Their mean.
    pub mean: f64,
    /// Half of the width of the 95 % confidence interval; none of a single value.
    pub half_width: Option<f64>,
}

/// The geometric mean of a few ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioEstimate {
    /// How many there are.
    pub n: usize,
    /// Their geometric mean.
    pub ratio: f64,
    /// The ends of its 95 % confidence interval; none of a single ratio.
    pub interval: Option<(f64, f64)>,
}

/// The mean and its interval; `None` of no values.
pub fn estimate(values: &[f64]) -> Option<Estimate> {
    let n = values.len();
    let first = *values.first()?;
    // Distances from the first value lose no digits where all are alike.
    let mean = first + values.iter().map(|value| value - first).sum::<f64>() / n as f64;
    let half_width = quantile(n).map(|t| {
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        t * (squares / (n - 1) as f64 / n as f64).sqrt()
    });
    Some(Estimate { n, mean, half_width })
}

/// The geometric mean and its interval; `None` of no values, or where one is not above 0.
pub fn geometric_mean(values: &[f64]) -> Option<RatioEstimate> {
    let logarithms: Vec<f64> = values.iter().map(|value| value.ln()).collect();
    if !logarithms.iter().all(|log| log.is_finite()) {
        return None;
    }
    let Estimate { n, mean, half_width } = estimate(&logarithms)?;
    let interval = half_width.map(|half| ((mean - half).exp(), (mean + half).exp()));
    Some(RatioEstimate { n, ratio: mean.exp(), interval })
}

/// The number of standard errors of the mean of `n` values on either side of a 95 % interval.
fn quantile(n: usize) -> Option<f64> {
    let freedom = n.checked_sub(1).filter(|freedom| *freedom > 0)?;
    Some(t_quantile(0.95, freedom))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_agree_with_scipy() {
        // scipy.stats.t.ppf(0.975, n - 1)
        assert!((quantile(2).unwrap() - 12.706204736174694).abs() < 1e-6);
        assert!((quantile(10).unwrap() - 2.262157162798205).abs() < 1e-6);
        assert_eq!(quantile(1), None);
    }

    #[test]
    fn intervals_agree_with_scipy() {
        // scipy.stats.t.interval(0.95, 4, mean, scipy.stats.sem(v)) = (3.83799585, 4.56200415)
        let found = estimate(&[4.1, 3.9, 4.4, 4.0, 4.6]).unwrap();
        assert!((found.mean - 4.2).abs() < 1e-12);
        assert!((found.half_width.unwrap() - 0.3620041521543717).abs() < 1e-7);
        // The same of np.log(r), and np.exp of it.
        let found = geometric_mean(&[0.8, 0.9, 1.1, 0.7]).unwrap();
        assert!((found.ratio - 0.8628907339631429).abs() < 1e-12);
        let (low, high) = found.interval.unwrap();
        assert!((low - 0.63606658).abs() < 1e-6 && (high - 1.17060139).abs() < 1e-6);
    }

    #[test]
    fn few_and_impossible_values() {
        assert_eq!(estimate(&[]), None);
        assert_eq!(estimate(&[3.0]).unwrap().half_width, None);
        assert_eq!(estimate(&[0.1; 3]).unwrap().half_width, Some(0.0));
        assert_eq!(geometric_mean(&[1.0, 0.0]), None);
        assert_eq!(geometric_mean(&[1.0, -2.0]), None);
    }
}
