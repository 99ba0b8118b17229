//! Running the steps that a store lacks: on a few threads, each step claimed before it is begun.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock};
use std::time::{Duration, Instant};

use indexmap::IndexMap;

use super::store::StepClaim;
use super::{
    Patience, Program, ProgramEvent, ProgramOptions, ProgramOutcome, Requirement, Retry, RunNote,
    Sharing, Step, StepRecord, StepStatus, Store, StoreError, tables,
};
use crate::cache::Cache;
use crate::cancel::CancelToken;
use crate::memory::{MemoryBudget, resident_bytes};
use crate::plan::OutputScope;
use crate::problem::Problem;
use crate::run::{Keep, NodeRecord, NodeStatus, RunOptions, RunOutcome, run};

/// A step that took so many processes along is not tried again.
pub(super) const MOST_CRASHES: u32 = 2;

/// Pause before a call that waits looks again at what other processes are at.
const LOOK_AGAIN: Duration = Duration::from_millis(500);

/// Runs the steps that the store does not have, and writes the tables.
pub fn run_program(
    program: &Program,
    store: &Store,
    options: &ProgramOptions,
) -> Result<ProgramOutcome, StoreError> {
    let start = Instant::now();
    let ids: HashSet<&str> = program.steps.iter().map(|step| step.id.as_str()).collect();
    store.belong_to(&program.name)?;
    let limit = options.time_limit.or(program.time_limit);
    let damaged = ids.iter().filter(|id| store.is_damaged(id)).count();
    for id in &ids {
        if store.record(id).is_some_and(|record| must_run_again(&record, options, limit)) {
            store.forget(id)?;
        }
    }
    let part = program.places(&options.part);
    let mut workers = Workers::new(program, store, options);
    let found = ids.iter().filter(|id| workers.requirement.is_in(store, id)).count();
    tell_what_is_there(program, store, &part, options);
    let mut note = (!workers.todo.is_empty()).then(|| RunNote::begin(options));
    program.write_plan(store, note.as_ref())?;
    workers.run_all()?;
    while options.patience == Patience::Wait && workers.look_again(&part) {
        workers.run_all()?;
    }
    if let Some(note) = &mut note {
        note.ran = workers.ran.load(Ordering::Relaxed);
        note.seconds = Some(start.elapsed().as_secs_f64());
        program.write_plan(store, Some(note))?;
    }
    for id in &ids {
        // A process that was killed may have finished a step and not come to this.
        store.record(id).map_or(Ok(()), |record| store.publish(&record))?;
    }
    store.drop_stale_outputs(&ids)?;
    tables::write(program, store)?;
    Ok(ProgramOutcome {
        ran: workers.ran.load(Ordering::Relaxed),
        found,
        damaged,
        others: store.count_others(&ids),
        seconds: start.elapsed().as_secs_f64(),
        is_stopped: options.cancel.is_cancelled(),
        ..counted(program, &part, &workers.requirement, &|id| store.record(id))
    })
}

/// What becomes of the steps by one reading of their records: other processes go on writing them,
/// and numbers of two readings would contradict each other.
fn counted(
    program: &Program,
    part: &[usize],
    requirement: &Requirement,
    read: &dyn Fn(&str) -> Option<Arc<StepRecord>>,
) -> ProgramOutcome {
    let ids: HashSet<&str> = program.steps.iter().map(|step| step.id.as_str()).collect();
    let records: HashMap<&str, Arc<StepRecord>> =
        ids.iter().filter_map(|id| Some((*id, read(id)?))).collect();
    let is_missing = |place: &&usize| {
        let record = records.get(program.steps[**place].id.as_str());
        !record.is_some_and(|record| requirement.is_met_by(record))
    };
    ProgramOutcome {
        steps: ids.len(),
        failed: records.values().filter(|record| record.status != StepStatus::Done).count(),
        missed: records.values().filter(|record| record.missed().next().is_some()).count(),
        missing: ids.len() - records.len(),
        missing_of_part: part.iter().filter(is_missing).count(),
        ..ProgramOutcome::default()
    }
}

/// Tells how many steps there are, and which of them are done.
fn tell_what_is_there(program: &Program, store: &Store, part: &[usize], options: &ProgramOptions) {
    let records = part.iter().map(|place| (*place, program.record(store, *place)));
    let records: Vec<_> = records.collect();
    let found = records.iter().filter(|(_, record)| record.is_some()).count();
    (options.observer)(&ProgramEvent::Began { steps: part.len(), found });
    for (place, record) in &records {
        if let Some(record) = record {
            (options.observer)(&ProgramEvent::StepFound { place: *place, record });
        }
    }
}

/// Those of these steps that the store does not have.
fn missing_of(
    program: &Program,
    store: &Store,
    places: &[usize],
    requirement: &Requirement,
) -> Vec<usize> {
    let is_missing = |place: &usize| !requirement.is_in(store, &program.steps[*place].id);
    places.iter().copied().filter(is_missing).collect()
}

/// Whether a finished step does not answer what is asked now.
fn must_run_again(record: &StepRecord, options: &ProgramOptions, limit: Option<Duration>) -> bool {
    let may_take_longer = match &record.status {
        StepStatus::TimedOut { limit: old, .. } => limit.is_none_or(|new| new.as_secs_f64() > *old),
        _ => false,
    };
    // The seconds of a step that shared its work, or the machine, are no measure.
    let is_not_timed = options.sharing == Sharing::Timing && !record.is_timed;
    let is_failed = options.retry == Retry::Failed && record.status != StepStatus::Done;
    let is_of_files = matches!(record.status, StepStatus::Failed { is_of_files: true, .. });
    may_take_longer || is_not_timed || is_failed || is_of_files
}

pub(super) struct Workers<'a> {
    pub program: &'a Program,
    pub store: &'a Store,
    pub options: &'a ProgramOptions<'a>,
    cache: Option<Cache>,
    /// What the steps that run at once share.
    memory: MemoryBudget,
    /// What is asked of each step.
    pub requirement: Requirement<'a>,
    /// Places of the steps that are still to be looked at.
    pub todo: Vec<usize>,
    next: AtomicUsize,
    running: AtomicUsize,
    pub ran: AtomicUsize,
    /// Held by a step that took its process along before, against all others: should it do so
    /// again, it was that one.
    alone: RwLock<()>,
    /// When the tables were written last, and how long that took.
    tables: Mutex<(Instant, Duration)>,
    trouble: Mutex<Option<StoreError>>,
}

impl<'a> Workers<'a> {
    fn new(program: &'a Program, store: &'a Store, options: &'a ProgramOptions) -> Self {
        let timings = (options.sharing == Sharing::Timing).then_some(options.timings);
        let requirement = Requirement::of(program, timings);
        let mut todo = missing_of(program, store, &program.places(&options.part), &requirement);
        todo.sort_by_key(|place| store.attempts(&program.steps[*place].id) > 0);
        let cache = (options.sharing == Sharing::Shared).then(|| {
            let disk = options.disk_cache.clone();
            Cache::new(options.memory / 2, disk).only(program.shared.clone())
        });
        Self {
            program,
            store,
            options,
            cache,
            memory: MemoryBudget::new(options.memory),
            requirement,
            todo,
            next: AtomicUsize::new(0),
            running: AtomicUsize::new(0),
            ran: AtomicUsize::new(0),
            alone: RwLock::default(),
            tables: Mutex::new((Instant::now(), Duration::ZERO)),
            trouble: Mutex::default(),
        }
    }

    /// Waits a little for other processes; whether steps of the part are still missing.
    fn look_again(&mut self, part: &[usize]) -> bool {
        self.todo = missing_of(self.program, self.store, part, &self.requirement);
        self.next = AtomicUsize::new(0);
        let end = Instant::now() + LOOK_AGAIN;
        while !self.todo.is_empty() && Instant::now() < end && !self.options.cancel.is_cancelled() {
            std::thread::sleep(Duration::from_millis(20));
        }
        !self.todo.is_empty() && !self.options.cancel.is_cancelled()
    }

    fn run_all(&self) -> Result<(), StoreError> {
        if self.options.sharing == Sharing::Timing {
            return self.time_all();
        }
        let jobs = self.options.jobs.clamp(1, self.todo.len().max(1));
        std::thread::scope(|scope| {
            for _ in 0..jobs {
                scope.spawn(|| {
                    if let Err(error) = self.work() {
                        let mut trouble = self.lock_trouble();
                        trouble.get_or_insert(error);
                    }
                });
            }
        });
        self.lock_trouble().take().map_or(Ok(()), Err)
    }

    fn lock_trouble(&self) -> std::sync::MutexGuard<'_, Option<StoreError>> {
        self.trouble.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes steps until none is left, somebody stops the program, or the store gives trouble.
    fn work(&self) -> Result<(), StoreError> {
        while !self.options.cancel.is_cancelled() && self.lock_trouble().is_none() {
            let Some(&place) = self.todo.get(self.next.fetch_add(1, Ordering::Relaxed)) else {
                return Ok(());
            };
            self.wait_for_memory();
            self.running.fetch_add(1, Ordering::Relaxed);
            let result = self.work_on(place);
            self.running.fetch_sub(1, Ordering::Relaxed);
            if result? {
                self.ran.fetch_add(1, Ordering::Relaxed);
                self.refresh_tables()?;
            }
        }
        Ok(())
    }

    /// Waits until the process is within its budget or no step runs.
    fn wait_for_memory(&self) {
        let is_full = || resident_bytes().is_some_and(|bytes| bytes > self.options.memory);
        while self.running.load(Ordering::Relaxed) > 0
            && is_full()
            && !self.options.cancel.is_cancelled()
        {
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Runs one step, unless it is done or another process has it. Whether it came to its end.
    fn work_on(&self, place: usize) -> Result<bool, StoreError> {
        let step = &self.program.steps[place];
        let Some(claim) = self.store.claim(&step.id)? else { return Ok(false) };
        let is_suspect = claim.n_crashes > 0;
        let _others = (!is_suspect).then(|| self.alone.read());
        let _alone = is_suspect.then(|| self.alone.write());
        (self.options.observer)(&ProgramEvent::StepStarted { place, step });
        if let Some(record) = self.crashed(step, &claim) {
            let record = self.store.commit(claim, record)?;
            (self.options.observer)(&ProgramEvent::StepEnded { place, record: &record });
            return Ok(true);
        }
        self.store.begin(&step.id, claim.n_crashes)?;
        let Some(record) = self.run_step(place, &claim.outputs()) else {
            self.store.abandon(&claim);
            return Ok(false);
        };
        let record = self.store.commit(claim, record)?;
        (self.options.observer)(&ProgramEvent::StepEnded { place, record: &record });
        Ok(true)
    }

    /// Runs one step; `None` if it was stopped by hand.
    pub(super) fn run_step(&self, place: usize, outputs: &Path) -> Option<StepRecord> {
        let start = Instant::now();
        let step = &self.program.steps[place];
        let limit = self.options.time_limit.or(self.program.time_limit);
        let cancel = self.options.cancel.child(limit.and_then(|limit| start.checked_add(limit)));
        let outcome = match self.program.plan(&step.params, step.repeat) {
            // An input file was changed or removed since the program was checked.
            Err(problems) => Err(problems.iter().map(Problem::to_string).collect::<Vec<_>>()),
            Ok(plan) if plan.id.short() != step.id => {
                Err(vec!["an input file was changed while the program ran".to_owned()])
            }
            Ok(plan) => Ok(run(
                &plan,
                &RunOptions {
                    output_folder: outputs,
                    threads: 1,
                    cache: self.cache.as_ref(),
                    cancel: &cancel,
                    observer: &|event| {
                        let event = ProgramEvent::Node { place, node_event: event };
                        (self.options.observer)(&event);
                    },
                    keep: Keep::Scalars,
                    memory: Some(&self.memory),
                    output_scope: OutputScope::Folder,
                },
            )),
        };
        let (status, nodes) = match outcome {
            Err(complaints) => {
                let reason = complaints.join("; ");
                (StepStatus::Failed { reason, is_of_files: true }, IndexMap::new())
            }
            Ok(outcome) => {
                let status = step_status(&outcome, &cancel, limit)?;
                let nodes = outcome.nodes.into_iter().map(|(name, node)| (name, node.record));
                (status, nodes.collect())
            }
        };
        Some(self.record_of(step, status, start, nodes))
    }

    /// The record of a step that took processes along too often to be tried again, unless that is
    /// asked for.
    pub(super) fn crashed(&self, step: &Step, claim: &StepClaim) -> Option<StepRecord> {
        let n = claim.n_crashes;
        let reason = format!(
            "{n} processes ended while they ran this step: out of memory, a crash, or killed"
        );
        let status = StepStatus::Crashed { reason };
        let record = || self.record_of(step, status, Instant::now(), IndexMap::new());
        let may_try = self.options.retry == Retry::Failed;
        (n >= MOST_CRASHES && !may_try).then(record)
    }

    fn record_of(
        &self,
        step: &Step,
        status: StepStatus,
        start: Instant,
        nodes: IndexMap<String, NodeRecord>,
    ) -> StepRecord {
        StepRecord {
            id: step.id.clone(),
            repeat: step.repeat,
            params: step.params.clone(),
            status,
            seconds: start.elapsed().as_secs_f64(),
            is_timed: self.options.sharing == Sharing::Timing,
            timings: Vec::new(),
            version: crate::VERSION.to_owned(),
            nodes,
        }
    }

    /// Brings the tables up to date now and then, so that a long program can be looked at. Takes
    /// at most a twentieth of the time.
    pub(super) fn refresh_tables(&self) -> Result<(), StoreError> {
        let Ok(mut last) = self.tables.try_lock() else { return Ok(()) };
        if last.0.elapsed() > Duration::from_secs(1).max(last.1 * 20) {
            let start = Instant::now();
            tables::write(self.program, self.store)?;
            *last = (Instant::now(), start.elapsed());
        }
        Ok(())
    }
}

/// How a step ended; `None` if it was stopped by hand.
fn step_status(
    outcome: &RunOutcome,
    cancel: &CancelToken,
    limit: Option<Duration>,
) -> Option<StepStatus> {
    let failures: Vec<_> =
        outcome.failures().map(|(name, error)| format!("{name}: {error}")).collect();
    if !failures.is_empty() {
        let is_of_files = outcome
            .nodes
            .values()
            .any(|node| matches!(node.record.status, NodeStatus::Failed { is_of_files: true, .. }));
        return Some(StepStatus::Failed { reason: failures.join("; "), is_of_files });
    }
    if !outcome.is_stopped() {
        return Some(StepStatus::Done);
    }
    let at = outcome.nodes.iter().find(|(_, node)| node.record.status == NodeStatus::Stopped);
    let (at, limit) = (at.map_or("", |(name, _)| name.as_str()), limit?.as_secs_f64());
    let reason = format!("{at}: not done within the time limit of {limit} s");
    cancel.is_overdue().then_some(StepStatus::TimedOut { reason, limit })
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::map::Map;
    use crate::testing::registry;

    const MAP: &str = r#"{"mve": 1, "nodes": {"add": {"module": "Add"}},
        "programs": {"p": {"axes": [{"add.amount": [1, 2, 3]}]}}}"#;

    /// Another process ends a step between any two readings.
    #[test]
    fn numbers_of_the_end_are_of_one_reading() {
        let map = Map::parse(MAP).unwrap();
        let program = Program::new(&map, "p", &registry(), Path::new("/")).map_err(|_| ()).unwrap();
        let n_readings = Cell::new(0);
        let read = |id: &str| {
            n_readings.set(n_readings.get() + 1);
            (n_readings.get() > 1).then(|| {
                Arc::new(StepRecord {
                    id: id.to_owned(),
                    repeat: 0,
                    params: IndexMap::new(),
                    status: StepStatus::Done,
                    seconds: 1.0,
                    is_timed: false,
                    timings: Vec::new(),
                    version: String::new(),
                    nodes: IndexMap::new(),
                })
            })
        };
        let requirement = Requirement::of(&program, None);
        let outcome = counted(&program, &[0, 1, 2], &requirement, &read);
        assert_eq!((outcome.steps, outcome.missing, outcome.missing_of_part), (3, 1, 1));
        assert_eq!(n_readings.get(), 3);
    }
}
