//! What the window shows of a node's state.

use mve_core::NodeStatus;

use super::Runner;

/// The state of a node.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// It has not run yet.
    New,
    /// It takes part in a run, and has not started.
    Waiting,
    /// It runs, and is this far.
    Running(f64),
    /// Its outputs are those of the map as it stands; the seconds that it ran.
    Done(Option<f64>),
    /// The same, taken from an earlier run; the seconds that it ran then.
    Cached(Option<f64>),
    /// Its outputs are of an older state of the map.
    Dirty,
    /// It gave an error.
    Failed(String),
    /// A node that it takes a value from failed.
    Skipped(String),
    /// The run was stopped before it was done.
    Stopped,
    /// The map does not let it run.
    Refused(String),
    /// It is muted or bypassed, or needs a node that is muted; which.
    Off(String),
}

impl Status {
    /// The status in a word or two.
    pub fn label(&self) -> String {
        match self {
            Self::New => "not run".to_owned(),
            Self::Waiting => "waiting".to_owned(),
            Self::Running(share) => format!("{:.0} %", share * 100.0),
            Self::Done(Some(seconds)) => seconds_text(*seconds),
            Self::Done(None) => "done".to_owned(),
            Self::Cached(Some(seconds)) => format!("{}, cached", seconds_text(*seconds)),
            Self::Cached(None) => "cached".to_owned(),
            Self::Dirty => "changed".to_owned(),
            Self::Failed(_) => "failed".to_owned(),
            Self::Skipped(_) => "skipped".to_owned(),
            Self::Stopped => "stopped".to_owned(),
            Self::Refused(_) => "cannot run".to_owned(),
            Self::Off(_) => "does not run".to_owned(),
        }
    }

    /// The status in a sentence.
    pub fn explanation(&self) -> String {
        match self {
            Self::New => "has not run yet".to_owned(),
            Self::Waiting => "waits for the nodes that it takes values from".to_owned(),
            Self::Running(share) => format!("is running: {:.0} %", share * 100.0),
            Self::Done(Some(seconds)) => format!("done in {}", seconds_text(*seconds)),
            Self::Done(None) => "done".to_owned(),
            Self::Cached(seconds) => {
                let then = seconds.map(|seconds| format!(", of {}", seconds_text(seconds)));
                let then = then.unwrap_or_default();
                format!("done; its outputs were known from an earlier run{then}")
            }
            Self::Dirty => "was changed since it ran: its outputs are old".to_owned(),
            Self::Failed(error) => error.clone(),
            Self::Skipped(because_of) => format!("not run, because {because_of} failed"),
            Self::Stopped => "stopped before it was done".to_owned(),
            Self::Refused(why) => why.clone(),
            Self::Off(why) => format!("does not run: it {why}"),
        }
    }
}

/// Seconds as a person reads them.
pub fn seconds_text(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => "< 1 ms".to_owned(),
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s if s < 60.0 => format!("{s:.1} s"),
        s if s < 3600.0 => format!("{}:{:02} min", s as u64 / 60, s as u64 % 60),
        s => format!("{}:{:02} h", s as u64 / 3600, s as u64 / 60 % 60),
    }
}

impl Runner {
    /// The state of a node.
    pub fn status(&self, node: &str) -> Status {
        if let Some(known) = self.job.as_ref().and_then(|job| job.nodes.get(node)) {
            match known.share {
                None => {
                    let inside = self.job.as_ref().and_then(|job| job.share_inside(node));
                    return inside.map_or(Status::Waiting, Status::Running);
                }
                Some(share) if share < 1.0 => return Status::Running(share),
                Some(_) => {}
            }
        }
        if let Some(why) = self.checked.faults.get(node) {
            return Status::Refused(why.clone());
        }
        if let Some(why) = self.checked.left_out.get(node) {
            return Status::Refused(why.clone());
        }
        let key = self.checked.keys.get(node);
        if let (None, Some(why)) = (key, self.checked.off.get(node)) {
            return Status::Off(why.clone());
        }
        let Some(ended) = self.ended.get(node) else { return Status::New };
        if key.is_some_and(|key| *key != ended.record.key) {
            return Status::Dirty;
        }
        match &ended.record.status {
            NodeStatus::Done if ended.record.cached.is_some() => Status::Cached(self.seconds(node)),
            NodeStatus::Done => Status::Done(ended.record.seconds),
            NodeStatus::Failed { error, .. } => Status::Failed(error.clone()),
            NodeStatus::Skipped { because_of } => Status::Skipped(because_of.clone()),
            NodeStatus::Stopped => Status::Stopped,
            NodeStatus::Past => Status::Off("is of a round behind the end of its loop".to_owned()),
        }
    }
}
