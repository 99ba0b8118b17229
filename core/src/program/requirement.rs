//! What a call asks of the record of each step.

use std::collections::HashMap;

use super::{Program, StepRecord, StepStatus, Store};

/// What is asked of the record of each step of a program: that there is one, and with `--timing` as
/// many times.
pub struct Requirement<'a> {
    /// How often each step is run for its times; `None` where times are not asked for.
    runs: Option<HashMap<&'a str, usize>>,
}

impl<'a> Requirement<'a> {
    /// That each step has a record, of so many timings where some are asked for. Repeats that are
    /// the same step give as many runs; repeats with seeds of their own are steps that run once.
    pub fn of(program: &'a Program, timings: Option<usize>) -> Self {
        let has_repeats = program.steps.iter().any(|step| step.repeat > 0);
        let runs = timings.map(|timings| {
            let mut runs: HashMap<&str, usize> = HashMap::new();
            program.steps.iter().for_each(|step| *runs.entry(&step.id).or_default() += 1);
            if !has_repeats {
                runs.values_mut().for_each(|n| *n = timings.max(1));
            }
            runs
        });
        Self { runs }
    }

    /// How often a step is run at least.
    pub(super) fn runs_of(&self, id: &str) -> usize {
        self.runs.as_ref().and_then(|runs| runs.get(id).copied()).unwrap_or(1)
    }

    /// The most that any step is run.
    pub(super) fn most_runs(&self) -> usize {
        self.runs.iter().flat_map(|runs| runs.values().copied()).max().unwrap_or(1)
    }

    /// Whether the store has it.
    pub(super) fn is_in(&self, store: &Store, id: &str) -> bool {
        store.record(id).is_some_and(|record| self.is_met_by(&record))
    }

    /// Whether this record of a step is all that is asked of it. What failed is not run for its
    /// times again.
    pub fn is_met_by(&self, record: &StepRecord) -> bool {
        let has_times = || {
            let is_enough = record.timings.len() >= self.runs_of(&record.id);
            record.is_timed && (is_enough || record.status != StepStatus::Done)
        };
        self.runs.is_none() || has_times()
    }
}
