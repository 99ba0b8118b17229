//! When a run ends.

/// When to stop: at the first of these that holds. With none, when no collapse is left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop {
    /// At this many faces or fewer.
    pub faces: Option<usize>,
    /// At this share of the input's faces, rounded to the nearest number.
    pub ratio: Option<f64>,
    /// Before a collapse that costs more than this, in the unit of the cost.
    pub cost: Option<f64>,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The number of faces was reached.
    TargetReached,
    /// The next collapse would have cost more than allowed.
    CostReached,
    /// Every collapse that is left would change the topology, turn a face or break the boundary
    /// policy.
    Exhausted,
}

impl Stop {
    /// The number of faces at which to stop, for an input of `n_faces`: the larger of the two
    /// that are set. A ratio that is not a number counts as not set.
    pub fn target_faces(&self, n_faces: usize) -> Option<usize> {
        let by_ratio = self
            .ratio
            .filter(|ratio| !ratio.is_nan())
            .map(|ratio| (ratio.clamp(0.0, 1.0) * n_faces as f64).round() as usize);
        self.faces.max(by_ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_stop_wins() {
        let stop = Stop { faces: Some(10), ratio: Some(0.25), cost: None };
        assert_eq!(stop.target_faces(100), Some(25));
        assert_eq!(stop.target_faces(20), Some(10));
        assert_eq!(Stop::default().target_faces(20), None);
        assert_eq!(Stop { ratio: Some(f64::NAN), ..stop }.target_faces(20), Some(10));
    }
}
