//! What is kept of the run of a node.

use std::collections::HashMap;
use std::path::PathBuf;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::RunOutcome;
use crate::cache::CacheUse;
use crate::control::MissedTarget;
use crate::data::Scalar;
use crate::fingerprint::Fingerprint;
use crate::node_outputs::LogLine;
use crate::plan::PlanNode;

/// How a node ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum NodeStatus {
    /// Its outputs are there.
    Done,
    /// Its module gave an error or panicked.
    Failed {
        /// What a person should read.
        error: String,
        /// Whether the system refused a file.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_of_files: bool,
    },
    /// A node that it takes a value from did not get done.
    Skipped {
        /// The node that failed.
        because_of: String,
    },
    /// The run was stopped before it was done.
    Stopped,
    /// Its loop had ended before its round.
    Past,
}

/// What is kept of a node's run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NodeRecord {
    /// Id of its module.
    pub module: String,
    /// How it ended.
    #[serde(flatten)]
    pub status: NodeStatus,
    /// Hash of all that determines its outputs.
    pub key: Fingerprint,
    /// Seconds that its module ran, for a value from the disk when it was made; none if it did not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Seconds of parts of that, where the module says them.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub phases: IndexMap<String, f64>,
    /// Where its outputs came from, if not from running it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cached: Option<CacheUse>,
    /// Its outputs that fit table cells, by the name of the output or of the cell.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub scalars: IndexMap<String, Scalar>,
    /// Its other outputs, in a line each.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub values: IndexMap<String, String>,
    /// Files that it wrote, relative to the output folder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<PathBuf>,
    /// Bytes of each of them; empty where that is not known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub file_bytes: Vec<u64>,
    /// Targets that it was given and did not reach.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missed: Vec<MissedTarget>,
    /// What its module said.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub log: Vec<LogLine>,
}

impl RunOutcome {
    /// Gives nodes that stand for maps and loops the seconds of all that ran inside of them.
    pub(super) fn add_up_what_is_inside(&mut self) {
        let mut inside: HashMap<String, f64> = HashMap::new();
        for (name, node) in &self.nodes {
            for (end, _) in name.match_indices('/') {
                *inside.entry(name[..end].to_owned()).or_default() +=
                    node.record.seconds.unwrap_or(0.0);
            }
        }
        for (name, seconds) in inside {
            if let Some(node) = self.nodes.get_mut(&name) {
                node.record.seconds = Some(seconds);
            }
        }
    }
}

impl NodeRecord {
    /// Of a node that has given nothing.
    pub(super) fn blank(node: &PlanNode, status: NodeStatus) -> Self {
        Self {
            module: node.info.module.id.to_owned(),
            status,
            key: node.key,
            seconds: None,
            phases: IndexMap::new(),
            cached: None,
            scalars: IndexMap::new(),
            values: IndexMap::new(),
            files: Vec::new(),
            file_bytes: Vec::new(),
            missed: Vec::new(),
            log: Vec::new(),
        }
    }
}
