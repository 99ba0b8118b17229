//! Values that suggest themselves from what is known of a node's inputs.

use mve_core::ParamSpec;
use serde_json::Value as Json;

/// How many of a unit there are in the inputs of a node: `("faces", 69451)`.
pub type Counts = Vec<(&'static str, usize)>;

/// How many there are of what a parameter counts.
pub fn known_count(spec: &ParamSpec, counts: &[(&str, usize)]) -> Option<usize> {
    let known = counts.iter().find(|(unit, _)| !spec.unit.is_empty() && *unit == spec.unit);
    known.map(|(_, n)| *n).filter(|n| *n > 1)
}

/// Half of what there is of what a parameter counts, half of that, and so on: so many values, or
/// as many as differ; none where that is not known.
pub fn halves(spec: &ParamSpec, counts: &[(&str, usize)], n_values: usize) -> Vec<Json> {
    let (Some(n), Some(range)) = (known_count(spec, counts), spec.range()) else {
        return Vec::new();
    };
    let half = |times: i32| range.nearest((n as f64 * 0.5f64.powi(times)).round());
    let mut values: Vec<Json> = (1..).take(n_values).map(half).collect();
    values.dedup();
    values
}

#[cfg(test)]
mod tests {
    use mve_core::Param;

    use super::*;

    #[test]
    fn a_count_suggests_its_half_within_what_is_allowed() {
        let spec = Param::<i64>::integer("target", "", 500);
        let spec = spec.between((100, 1_000_000)).unit("faces").spec();
        let counts = [("vertices", 500), ("faces", 1000)];
        assert_eq!(halves(&spec, &counts, 1), [500]);
        assert_eq!(halves(&spec, &counts, 6), [500, 250, 125, 100]);
        assert_eq!(halves(&spec, &counts[..1], 2), [0; 0]);
        assert_eq!(halves(&spec, &[("faces", 1)], 2), [0; 0]);
        let plain = Param::<f64>::number("x", "", 0.5).spec();
        assert_eq!(halves(&plain, &[("", 1000)], 2), [0; 0]);
    }
}
