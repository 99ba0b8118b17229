//! What a call asks of each step, and whether the store has it.

use std::collections::HashMap;

use super::{Program, ProgramOptions, Sharing, StepRecord, Store};

/// What is asked of each step.
pub(super) struct Wanted<'a> {
    /// How often it is run for its times; `None` where times are not asked for.
    runs: Option<HashMap<&'a str, usize>>,
}

impl<'a> Wanted<'a> {
    pub fn of(program: &'a Program, options: &ProgramOptions) -> Self {
        let is_timed = options.sharing == Sharing::Timing;
        Self { runs: is_timed.then(|| program.runs_by_step(options.timings)) }
    }

    /// Whether the store has it.
    pub fn is_in(&self, store: &Store, id: &str) -> bool {
        store.record(id).is_some_and(|record| self.is_met_by(&record))
    }

    /// Whether this record of a step is all that is asked of it.
    pub fn is_met_by(&self, record: &StepRecord) -> bool {
        let times = |runs: &HashMap<&str, usize>| runs.get(record.id.as_str()).copied();
        let runs = self.runs.as_ref();
        runs.is_none_or(|runs| record.has_timings(times(runs).unwrap_or(1)))
    }
}
