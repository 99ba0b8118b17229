//! What a step takes when it runs by itself: seconds, time of the processors, memory.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::run::NodeRecord;

/// What one run of a step took, with nothing shared and nothing beside it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Seconds from its start to its end.
    pub seconds: f64,
    /// Seconds of all processors together; none where the system does not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_seconds: Option<f64>,
    /// The most memory that the process held meanwhile; none where the system does not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_bytes: Option<u64>,
    /// Seconds of each node, and of parts of its work as `node.part`.
    #[serde(default)]
    pub parts: IndexMap<String, f64>,
}

impl Timing {
    /// Enters the seconds of nodes.
    pub(super) fn enter(&mut self, nodes: &IndexMap<String, NodeRecord>) {
        for (name, node) in nodes {
            self.parts.extend(node.seconds.map(|seconds| (name.clone(), seconds)));
            let phases = node.phases.iter();
            self.parts.extend(phases.map(|(part, seconds)| (format!("{name}.{part}"), *seconds)));
        }
    }
}

/// The middle of some numbers, the mean of the two middle ones of an even count; `None` of none.
pub fn median(numbers: &[f64]) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (low, high) = (sorted.get((sorted.len().max(1) - 1) / 2)?, sorted.get(sorted.len() / 2)?);
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[9.0, 1.0, 2.0, 3.0]), Some(2.5));
    }
}
