//! What was done, to be undone: snapshots of the map and of what was selected in it, with the label
//! of each step.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use indexmap::IndexSet;
use mve_core::Map;

use super::item::Item;

/// Steps that can be undone.
const LONGEST: usize = 300;

/// Edits of one thing that come within this time are one step.
const TOGETHER: Duration = Duration::from_secs(1);

/// A map, and what is selected in it.
#[derive(Clone, Debug)]
pub(super) struct Snapshot {
    pub map: Arc<Map>,
    pub selection: IndexSet<Item>,
}

/// One step: what it was, and what is on its other side.
#[derive(Clone, Debug)]
struct HistoryStep {
    label: String,
    other: Snapshot,
}

/// Steps back and steps forth.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    past: VecDeque<HistoryStep>,
    future: Vec<HistoryStep>,
    /// What the last step edits, and when it did so last.
    last: Option<(String, Instant)>,
}

impl History {
    /// Remembers that `before` became `after` at the time `now`. A step of the same `target` that
    /// follows closely joins the one before it.
    pub fn push(
        &mut self,
        label: String,
        target: Option<String>,
        now: Instant,
        (before, after): (&Snapshot, &Arc<Map>),
    ) {
        self.future.clear();
        let joins = match (&self.last, &target) {
            (Some((last, time)), Some(target)) => {
                last == target && now.saturating_duration_since(*time) < TOGETHER
            }
            _ => false,
        };
        self.last = target.map(|target| (target, now));
        match self.past.back() {
            // A slider that was dragged to where it was: nothing is left to undo.
            Some(step) if joins && step.other.map == *after => {
                self.past.pop_back();
                self.last = None;
            }
            Some(_) if joins => {}
            _ => self.past.push_back(HistoryStep { label, other: before.clone() }),
        }
        if self.past.len() > LONGEST {
            self.past.pop_front();
        }
    }

    /// Ends the step: what comes next is one of its own.
    pub fn seal(&mut self) {
        self.last = None;
    }

    /// Takes one step back from `now`.
    pub fn undo(&mut self, now: Snapshot) -> Option<Snapshot> {
        let step = self.past.pop_back()?;
        self.seal();
        self.future.push(HistoryStep { label: step.label, other: now });
        Some(step.other)
    }

    /// Takes one step forth from `now`.
    pub fn redo(&mut self, now: Snapshot) -> Option<Snapshot> {
        let step = self.future.pop()?;
        self.seal();
        self.past.push_back(HistoryStep { label: step.label, other: now });
        Some(step.other)
    }

    /// What the next step back would undo.
    pub fn undo_label(&self) -> Option<&str> {
        self.past.back().map(|step| step.label.as_str())
    }

    /// What the next step forth would do again.
    pub fn redo_label(&self) -> Option<&str> {
        self.future.last().map(|step| step.label.as_str())
    }
}
