//! The reporter of one run of a module: keeps its log and times, and tells the observer.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use indexmap::IndexMap;

use super::{EventKind, PROGRESS_PAUSE, Runner};
use crate::control::{MissedTarget, Reporter};
use crate::node_outputs::LogLine;
use crate::plan::PlanNode;

/// Hears of one run of a module.
pub(super) struct Listener<'a> {
    pub(super) runner: &'a Runner<'a>,
    pub(super) node: &'a PlanNode,
    pub(super) log: Mutex<Vec<LogLine>>,
    pub(super) phases: Mutex<IndexMap<String, f64>>,
    pub(super) missed: Mutex<Vec<MissedTarget>>,
    pub(super) told: Mutex<Option<Instant>>,
}

impl Reporter for Listener<'_> {
    fn progress(&self, share: f64) {
        // A thread that finds another one telling has nothing newer to tell.
        let Ok(mut told) = self.told.try_lock() else { return };
        let now = Instant::now();
        if told.is_none_or(|told| now - told >= PROGRESS_PAUSE) {
            *told = Some(now);
            drop(told);
            self.runner.tell(self.node, EventKind::Progress { share: share.clamp(0.0, 1.0) });
        }
    }

    fn log(&self, line: &str) {
        self.keep(false, line);
        self.runner.tell(self.node, EventKind::Log { text: line });
    }

    fn warn(&self, line: &str) {
        self.keep(true, line);
        self.runner.tell(self.node, EventKind::Warning { text: line });
    }

    fn missed(&self, missed: MissedTarget, line: &str) {
        self.missed.lock().unwrap_or_else(PoisonError::into_inner).push(missed);
        self.warn(line);
    }

    fn phase(&self, name: &'static str, seconds: f64) {
        let mut phases = self.phases.lock().unwrap_or_else(PoisonError::into_inner);
        phases.insert(name.to_owned(), seconds);
    }
}

impl Listener<'_> {
    fn keep(&self, is_warning: bool, line: &str) {
        let mut log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        log.push(LogLine { is_warning, text: line.to_owned() });
    }
}
