//! Steps run for their times: one at a time, in rounds.
//!
//! Each round runs every step once, in an order of its own, so that whatever slows the machine for
//! a while slows all steps alike. Orders are hashes of the round and the steps: the same in every
//! call. One run before the first round is not counted; it brings files and code into memory.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

use super::record::{StepRecord, StepStatus};
use super::store::StoreError;
use super::timing::Timing;
use super::work::{MOST_CRASHES, Workers};
use super::{ProgramEvent, usage};
use crate::fingerprint::FingerprintBuilder;

/// How often a step is timed where nobody says.
pub const TIMINGS: usize = 3;

impl StepRecord {
    fn add(&mut self, timing: Timing) {
        self.timings.push(timing);
        let timings = &self.timings;
        let mean = |value: &dyn Fn(&Timing) -> Option<f64>| {
            let known: Vec<f64> = timings.iter().filter_map(value).collect();
            (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
        };
        self.seconds = mean(&|timing| Some(timing.seconds)).unwrap_or(self.seconds);
        for (name, node) in &mut self.nodes {
            node.seconds = mean(&|timing| timing.parts.get(name).copied());
            for (part, seconds) in &mut node.phases {
                let place = format!("{name}.{part}");
                *seconds = mean(&|timing| timing.parts.get(&place).copied()).unwrap_or(*seconds);
            }
        }
    }
}

impl Workers<'_> {
    /// Runs all steps that have too few times.
    pub(super) fn time_all(&self) -> Result<(), StoreError> {
        let is_stopped = || self.options.cancel.is_cancelled();
        let mut is_warm = false;
        for round in 0..self.requirement.most_runs() {
            for place in self.order(round) {
                let step = &self.program.steps[place];
                let known = self.store.record(&step.id);
                let n_known = known.as_ref().map_or(0, |record| record.timings.len());
                let is_enough =
                    known.as_ref().is_some_and(|record| self.requirement.is_met_by(record));
                if n_known > round || is_enough || is_stopped() {
                    continue;
                }
                if !std::mem::replace(&mut is_warm, true) {
                    self.apart(place, &mut |folder| drop(self.run_step(place, folder)))?;
                }
                self.time(place)?;
            }
        }
        Ok(())
    }

    /// The steps of a round.
    fn order(&self, round: usize) -> Vec<usize> {
        let hash = |place: &usize| {
            let mut hash = FingerprintBuilder::new("round");
            hash.part(&round.to_le_bytes());
            hash.text(&self.program.steps[*place].id);
            hash.finish().to_string()
        };
        let mut order = self.todo.clone();
        order.sort_by_cached_key(hash);
        order
    }

    /// Runs a step once more for its times, and keeps its outputs if it is the first time.
    fn time(&self, place: usize) -> Result<(), StoreError> {
        let step = &self.program.steps[place];
        (self.options.observer)(&ProgramEvent::StepStarted { place, step });
        let Some(known) = self.store.record(&step.id) else {
            let Some(claim) = self.store.claim(&step.id)? else { return Ok(()) };
            if let Some(record) = self.crashed(step, &claim) {
                let record = self.store.commit(claim, record)?;
                return self.tell(place, &record);
            }
            self.store.begin(&step.id, claim.n_crashes)?;
            let Some((mut record, timing)) = self.timed(place, &claim.outputs()) else {
                self.store.abandon(&claim);
                return Ok(());
            };
            record.add(timing);
            let record = self.store.commit(claim, record)?;
            return self.tell(place, &record);
        };
        let mut found = None;
        self.apart(place, &mut |folder| found = self.timed(place, folder))?;
        let Some((again, timing)) = found.filter(|(again, _)| again.status == StepStatus::Done)
        else {
            return Ok(());
        };
        let mut record = StepRecord { nodes: again.nodes, ..(*known).clone() };
        for (name, node) in &mut record.nodes {
            // What it wrote lies where the first run left it.
            let first = known.nodes.get(name);
            let lying = first.map(|first| (first.files.clone(), first.file_bytes.clone()));
            (node.files, node.file_bytes) = lying.unwrap_or_default();
        }
        record.add(timing);
        let record = self.store.amend(record)?;
        self.tell(place, &record)
    }

    fn tell(&self, place: usize, record: &StepRecord) -> Result<(), StoreError> {
        if self.requirement.is_met_by(record) {
            self.ran.fetch_add(1, Ordering::Relaxed);
            (self.options.observer)(&ProgramEvent::StepEnded { place, record });
        }
        self.refresh_tables()
    }

    /// Runs a step and measures what it takes; `None` if it was stopped by hand.
    fn timed(&self, place: usize, outputs: &Path) -> Option<(StepRecord, Timing)> {
        usage::forget_peak();
        let (start, cpu) = (Instant::now(), usage::cpu_seconds());
        let record = self.run_step(place, outputs)?;
        let mut timing = Timing {
            seconds: start.elapsed().as_secs_f64(),
            cpu_seconds: usage::cpu_seconds().zip(cpu).map(|(end, start)| end - start),
            peak_bytes: usage::peak_bytes(),
            ..Timing::default()
        };
        timing.enter(&record.nodes);
        Some((record, timing))
    }

    /// Runs a step whose outputs nobody keeps, in a folder of its own; not one that took processes
    /// along too often.
    fn apart(&self, place: usize, run: &mut dyn FnMut(&Path)) -> Result<(), StoreError> {
        let id = &self.program.steps[place].id;
        let n_crashes = self.store.attempts(id);
        if n_crashes >= MOST_CRASHES {
            return Ok(());
        }
        let folder = self.store.scratch(id)?;
        self.store.begin(id, n_crashes)?;
        run(&folder);
        self.store.end(id);
        // What cannot be removed is in nobody's way: it is never read.
        let _ = std::fs::remove_dir_all(&folder);
        Ok(())
    }
}
