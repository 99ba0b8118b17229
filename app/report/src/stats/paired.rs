//! Tests of paired differences against "no difference", two-sided.
//!
//! Sources: the sign test is the binomial test of wins against losses, ties left out. F. Wilcoxon,
//! *Individual comparisons by ranking methods*, Biometrics Bulletin 1, 1945: zeros are left out,
//! ties share the mean rank. The distribution of the rank sum is exact, ties included, by counting
//! all signs; above [`MOST_EXACT`] differences the normal approximation with the variance of the
//! ranks at hand takes its place.

use super::correlation::ranks;
use super::distributions::normal_tails;

/// Most differences whose rank sums are counted out.
const MOST_EXACT: usize = 200;

/// The probability of a split at least as uneven as this one, if both were equally likely.
pub fn sign_test(wins: usize, losses: usize) -> f64 {
    let (n, fewer) = (wins + losses, wins.min(losses));
    let mut log_term = -(n as f64) * std::f64::consts::LN_2;
    let mut tail = 0.0;
    for k in 0..=fewer {
        tail += log_term.exp();
        log_term += ((n - k) as f64 / (k + 1) as f64).ln();
    }
    (2.0 * tail).min(1.0)
}

/// The probability of a rank sum at least as far from the middle, if each difference could as well
/// have the other sign; `None` where all are zero.
pub fn wilcoxon(differences: &[f64]) -> Option<f64> {
    let kept: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0).collect();
    if kept.is_empty() {
        return None;
    }
    let sizes: Vec<f64> = kept.iter().map(|d| d.abs()).collect();
    let ranks = ranks(&sizes);
    let positive: f64 = ranks.iter().zip(&kept).filter(|(_, d)| **d > 0.0).map(|(r, _)| r).sum();
    let from_middle = (positive - ranks.iter().sum::<f64>() / 2.0).abs();
    if kept.len() > MOST_EXACT {
        let deviation = (ranks.iter().map(|rank| rank * rank).sum::<f64>() / 4.0).sqrt();
        return Some(normal_tails(from_middle / deviation));
    }
    // Twice a mean rank is a whole number.
    let doubled: Vec<usize> = ranks.iter().map(|rank| (2.0 * rank).round() as usize).collect();
    let total: usize = doubled.iter().sum();
    let mut probability = vec![0.0; total + 1];
    probability[0] = 1.0;
    for rank in doubled {
        for sum in (0..=total).rev() {
            let with = if sum >= rank { probability[sum - rank] } else { 0.0 };
            probability[sum] = 0.5 * (probability[sum] + with);
        }
    }
    let is_as_far =
        |sum: usize| (sum as f64 - total as f64 / 2.0).abs() >= 2.0 * from_middle - 1e-9;
    let tails = (0..=total).filter(|sum| is_as_far(*sum)).map(|sum| probability[sum]);
    Some(tails.sum::<f64>().min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_agree_with_scipy() {
        // scipy.stats.binomtest(wins, n).pvalue
        for (wins, n, p) in [(6, 8, 0.2890625), (11, 14, 0.057373046875), (3, 5, 1.0)] {
            assert!((sign_test(wins, n - wins) - p).abs() < 1e-12, "{wins} of {n}");
        }
        assert_eq!(sign_test(0, 0), 1.0);
        assert!(sign_test(0, 5000) < 1e-300);
    }

    #[test]
    fn ranks_agree_with_scipy() {
        // scipy.stats.wilcoxon(d, method="exact").pvalue
        let d = [0.3, -0.1, 0.5, 0.7, 0.2, -0.4, 0.9, 1.1];
        assert!((wilcoxon(&d).unwrap() - 0.078125).abs() < 1e-12);
        // With ties, all 32 signs counted out: 8 are as far from the middle.
        assert!((wilcoxon(&[1.0, 1.0, -1.0, 2.0, 3.0, 0.0]).unwrap() - 0.25).abs() < 1e-12);
        assert_eq!(wilcoxon(&[0.0, 0.0]), None);
        assert_eq!(wilcoxon(&[1.0]), Some(1.0));
    }

    #[test]
    fn many_differences_are_close_to_the_exact_count() {
        let d: Vec<f64> =
            (1..=200).map(|i| if i % 5 < 3 { 1.0 } else { -1.0 } * i as f64).collect();
        let exact = wilcoxon(&d).unwrap();
        let more: Vec<f64> = d.iter().copied().chain([0.5]).collect();
        let approximate = wilcoxon(&more).unwrap();
        assert!((exact - approximate).abs() < 0.05 * exact, "{exact} {approximate}");
    }
}
