//! What the run of a node gave, as caches keep it.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::control::MissedTarget;
use crate::data::Value;

/// All that a node's run gave.
#[derive(Clone, Debug)]
pub(crate) struct NodeOutputs {
    pub outputs: Vec<Value>,
    pub log: Vec<LogLine>,
    pub missed: Vec<MissedTarget>,
    pub seconds: f64,
    /// Seconds of parts of the work, where the module says them.
    pub phases: IndexMap<String, f64>,
}

impl NodeOutputs {
    /// Whether no file of these values was found damaged so far.
    pub fn is_sound(&self) -> bool {
        self.outputs.iter().flat_map(Value::stored).all(|file| file.is_sound())
    }
}

/// A line that a module wrote.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogLine {
    /// Whether it reports trouble.
    pub is_warning: bool,
    /// What it says.
    pub text: String,
}
