//! The seconds of what runs inside of maps and loops, for the nodes that stand for them: as
//! `mve run` has them.

use mve_core::{CacheUse, NodeRecord, NodeStatus};

use super::Runner;

/// What has run inside of a node that stands for a map or a loop.
#[derive(Clone, Copy, Default)]
pub(super) struct Inside {
    /// Seconds in this run; none where all was known.
    ran: Option<f64>,
    /// Seconds when what was known was made.
    then: f64,
    /// Where something was known from.
    cached: Option<CacheUse>,
}

impl Runner {
    /// Gives a node that stands for a map or a loop the seconds of what ran inside of it, and
    /// counts those of a node for all that it is inside of.
    pub(super) fn add_up(&mut self, node: &str, record: &mut NodeRecord) {
        let Some(job) = &mut self.job else { return };
        if record.status == NodeStatus::Done {
            let then = self.measured.get(&record.key).copied().unwrap_or(0.0);
            let stands_for_others = job.inside.contains_key(node);
            for (end, _) in node.match_indices('/') {
                let inside = job.inside.entry(node[..end].to_owned()).or_default();
                match record.cached {
                    Some(_) => {
                        inside.then += then;
                        inside.cached = record.cached;
                    }
                    None if stands_for_others => {}
                    None => *inside.ran.get_or_insert(0.0) += record.seconds.unwrap_or(0.0),
                }
            }
        }
        let Some(inside) = job.inside.get(node) else { return };
        record.seconds = inside.ran;
        if inside.ran.is_none() && inside.cached.is_some() {
            record.cached = inside.cached;
            self.measured.insert(record.key, inside.then);
        }
    }
}
