//! What is kept of a finished step: `record.json`, which begins with a hash of the rest of it, and
//! `log.txt`.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::timing::Timing;
use crate::control::MissedTarget;
use crate::fingerprint::Fingerprint;
use crate::problem::printable;
use crate::run::{NodeRecord, NodeStatus};

/// How a record begins: a hash of the rest of the file.
const CHECKSUM: &str = "{\n  \"checksum\": \"";

/// What is kept of a finished step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// Hash of what determines its result, short.
    pub id: String,
    /// Number of the repeat, from 0.
    pub repeat: u32,
    /// The parameters that the program set.
    pub params: IndexMap<String, Json>,
    /// How it ended.
    #[serde(flatten)]
    pub status: StepStatus,
    /// Seconds from its start to its end.
    pub seconds: f64,
    /// Whether it ran alone, with nothing shared, so that its seconds can be compared.
    #[serde(default)]
    pub is_timed: bool,
    /// What each of its runs took, where it did.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub timings: Vec<Timing>,
    /// Version of mve.
    pub version: String,
    /// Its nodes by name.
    pub nodes: IndexMap<String, NodeRecord>,
}

impl StepRecord {
    /// The targets that its nodes did not reach, with their nodes.
    pub fn missed(&self) -> impl Iterator<Item = (&str, &MissedTarget)> {
        let nodes = self.nodes.iter();
        nodes.flat_map(|(name, node)| node.missed.iter().map(move |missed| (name.as_str(), missed)))
    }

    /// The same in a line: `simplify: 144 of 126 faces`; empty where all were reached.
    pub fn missed_in_words(&self) -> String {
        let missed = self.missed().map(|(node, missed)| format!("{node}: {missed}"));
        missed.collect::<Vec<_>>().join("; ")
    }

    /// What its nodes warned of, with their names.
    pub fn warnings(&self) -> impl Iterator<Item = (&str, &str)> {
        let lines = self
            .nodes
            .iter()
            .flat_map(|(name, node)| node.log.iter().map(move |line| (name.as_str(), line)));
        lines.filter(|(_, line)| line.is_warning).map(|(name, line)| (name, line.text.as_str()))
    }
}

/// How a step ended. A step that was stopped by hand has not ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum StepStatus {
    /// Every node is done.
    Done,
    /// A node failed.
    Failed {
        /// Which, and why.
        reason: String,
        /// Whether it was for want of space, a permission or a file: no finding about the step,
        /// which is tried again.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_of_files: bool,
    },
    /// The process ended while it ran, more than once.
    Crashed {
        /// What is known of it.
        reason: String,
    },
    /// It took longer than the time limit.
    TimedOut {
        /// What it was at, and the limit.
        reason: String,
        /// The limit in seconds.
        limit: f64,
    },
}

impl StepStatus {
    /// The word for a table.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed { .. } => "failed",
            Self::Crashed { .. } => "crashed",
            Self::TimedOut { .. } => "timed out",
        }
    }

    /// Why it is not done.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Done => None,
            Self::Failed { reason, .. }
            | Self::Crashed { reason }
            | Self::TimedOut { reason, .. } => Some(reason),
        }
    }
}

/// The text of a record, which begins with a hash of what follows it.
pub(super) fn with_checksum(record: &str) -> String {
    let rest = record.strip_prefix("{\n").unwrap_or(record);
    format!("{CHECKSUM}{}\",\n{rest}", Fingerprint::of(rest.as_bytes()))
}

/// Whether a record is as it was written. Those of older versions do not tell.
pub(super) fn is_sound(text: &str) -> bool {
    let Some(rest) = text.strip_prefix(CHECKSUM) else { return !text.contains("\"checksum\"") };
    let parts = rest.split_once("\",\n");
    parts.is_some_and(|(hash, rest)| hash == Fingerprint::of(rest.as_bytes()).to_string())
}

/// `log.txt`, for steps that have something to say.
pub(super) fn log_of(record: &StepRecord) -> String {
    let mut text = String::new();
    for (name, node) in &record.nodes {
        for line in &node.log {
            let mark = if line.is_warning { "warning: " } else { "" };
            text.push_str(&format!("{name}: {mark}{}\n", printable(&line.text)));
        }
        if let NodeStatus::Failed { error, .. } = &node.status {
            text.push_str(&format!("{name}: error: {}\n", printable(error)));
        }
    }
    text
}
