//! Correlation of two lists: Pearson's r, and Spearman's ρ as Pearson's r of the ranks, with the
//! mean rank for ties.
//!
//! Source: C. Spearman, *The proof and measurement of association between two things*, 1904.

/// Fewer pairs have no correlation worth a number: two are always on a line.
const FEWEST: usize = 3;

/// Pearson's correlation; `None` for fewer than three pairs or where a list is constant.
pub fn pearson(x: &[f64], y: &[f64]) -> Option<f64> {
    if x.len() != y.len() || x.len() < FEWEST || is_constant(x) || is_constant(y) {
        return None;
    }
    let (x, y) = (centered(x), centered(y));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let r = dot(&x, &y) / (dot(&x, &x).sqrt() * dot(&y, &y).sqrt());
    r.is_finite().then_some(r.clamp(-1.0, 1.0))
}

/// Spearman's rank correlation; `None` where [`pearson`] has none.
pub fn spearman(x: &[f64], y: &[f64]) -> Option<f64> {
    pearson(&ranks(x), &ranks(y))
}

/// Ranks from 1; equal values share the mean of theirs.
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    for tied in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let mean = before as f64 + (tied.len() as f64 + 1.0) / 2.0;
        tied.iter().for_each(|place| ranks[*place] = mean);
        before += tied.len();
    }
    ranks
}

fn is_constant(values: &[f64]) -> bool {
    values.iter().all(|value| *value == values[0])
}

/// Distances from the mean in units of the largest, so that no square leaves the range.
fn centered(values: &[f64]) -> Vec<f64> {
    let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let scaled: Vec<f64> = values.iter().map(|value| value / largest).collect();
    let mean = scaled.iter().sum::<f64>() / scaled.len() as f64;
    scaled.iter().map(|value| value - mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_scipy() {
        // scipy.stats.pearsonr(x, y).statistic and spearmanr(x, y).statistic
        let (x, y) = ([1., 2., 3., 4., 5., 6., 7.], [2., 1., 4., 3., 7., 8., 5.]);
        assert!((pearson(&x, &y).unwrap() - 0.7825080450574998).abs() < 1e-12);
        assert!((spearman(&x, &y).unwrap() - 0.8214285714285715).abs() < 1e-12);
        let (x, y) = ([1., 2., 2., 3., 5.], [3., 1., 1., 4., 4.]);
        assert!((pearson(&x, &y).unwrap() - 0.5652173913043479).abs() < 1e-12);
        assert!((spearman(&x, &y).unwrap() - 0.6488856845230502).abs() < 1e-12);
    }

    #[test]
    fn ties_share_their_mean_rank() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0, 3.0]), [4.0, 1.0, 4.0, 2.0, 4.0]);
    }

    #[test]
    fn lines_are_one_and_constants_have_none() {
        let (x, down) = ([1e-200, 2e-200, 3e-200], [3e200, 2e200, 1e200]);
        assert!((pearson(&x, &down).unwrap() + 1.0).abs() < 1e-12);
        assert_eq!(pearson(&x, &[5.0; 3]), None);
        assert_eq!(pearson(&x[..2], &down[..2]), None);
        assert_eq!(pearson(&[], &[]), None);
        assert_eq!(spearman(&x, &[0.0; 3]), None);
    }
}
