//! Loops: a node that runs more than once, as a file says it.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::data::{Scalar, Value};

/// How often a node runs, and what goes from one round to the next.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// How many rounds there are, or are at most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub times: Option<u32>,
    /// Values of parameters, one a round: lists that are equally long, or what stands for many
    /// values as in the axes of programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub each: Option<IndexMap<String, Json>>,
    /// What the inputs of a round take from the outputs of the round before, `{"mesh": "mesh"}`.
    /// Where nothing is said, outputs go to inputs of the same name and type.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feed: Option<IndexMap<String, String>>,
    /// When the loop ends before that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<Until>,
}

/// The number of a round by which a loop ends.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Until {
    /// The output that gives it, `distance`, or one of the numbers that it gives, `numbers.rms`.
    pub output: String,
    /// The loop ends after a round whose number is below this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below: Option<f64>,
    /// The loop ends after a round whose number is above this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<f64>,
}

impl Until {
    /// The output, and which of its numbers where it gives several.
    pub(crate) fn port(&self) -> (&str, Option<&str>) {
        self.output.split_once('.').map_or((&*self.output, None), |(port, cell)| (port, Some(cell)))
    }

    /// Whether a round that gave this was the last. A value that is not a number ends the loop: no
    /// later round would know better.
    pub(crate) fn is_met(&self, value: &Value) -> bool {
        let cell = match self.port().1 {
            None => value.scalar(),
            Some(name) => {
                value.cells().into_iter().find(|(cell, _)| cell == name).map(|(_, cell)| cell)
            }
        };
        match cell {
            Some(Scalar::Number(number)) => {
                let is_below = self.below.is_some_and(|limit| number < limit);
                is_below || self.above.is_some_and(|limit| number > limit) || number.is_nan()
            }
            _ => true,
        }
    }
}
