//! Programs: every combination of a map's parameters, run unattended into a store.

mod expand;
mod memory;
mod plan_file;
mod report_spec;
mod store;
mod tables;

pub use plan_file::{PlanFile, RunNote};
pub use report_spec::{Better, Measure, Question, ReportSpec, stands_for};
pub use store::{StepRecord, StepStatus, Store, StoreError};
pub use tables::{brief, brief_value, exact};

use std::collections::{BTreeMap, HashSet};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use store::StepClaim;

use crate::cache::Cache;
use crate::cancel::CancelToken;
use crate::disk_cache::DiskCache;
use crate::files::FileHashes;
use crate::fingerprint::Fingerprint;
use crate::map::{Map, ProgramSpec};
use crate::plan::{OutputScope, PlanOptions};
use crate::problem::Problem;
use crate::registry::Registry;
use crate::run::{Event, Keep, NodeStatus, RunOptions, RunOutcome, run};

/// A program whose steps are all known and checked.
pub struct Program {
    /// Its name in the map.
    pub name: String,
    /// Its steps, in the order of the results table. Two with one id are the same step.
    pub steps: Vec<Step>,
    /// The dotted paths of the parameters that it varies.
    pub varied: Vec<String>,
    /// What is odd about the map but does not stop it.
    pub warnings: Vec<Problem>,
    /// What it says of its report.
    pub report: ReportSpec,
    /// Name of the map's file, for the records; empty where there is none.
    pub map_file: String,
    map: Map,
    /// As the map says it.
    spec: ProgramSpec,
    map_folder: PathBuf,
    registry: Registry,
    files: FileHashes,
    time_limit: Option<Duration>,
    /// Keys of nodes that more than one step runs.
    shared: HashSet<Fingerprint>,
    /// Input files with the fingerprints of their content.
    inputs: IndexMap<PathBuf, Fingerprint>,
    /// Modules that some step runs, with their versions.
    modules: BTreeMap<&'static str, Fingerprint>,
    /// Names of the nodes, in running order.
    nodes: Vec<String>,
}

/// One assignment of parameters, and the id of its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Hash of all that determines the result, short.
    pub id: String,
    /// Number of the repeat, from 0.
    pub repeat: u32,
    /// The parameters that it sets.
    pub params: IndexMap<String, Json>,
}

/// One process's part of the steps: those whose place is `index` modulo `count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    pub index: usize,
    /// How many shards there are.
    pub count: usize,
}

/// Whether steps share what they have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sharing {
    /// A value that several steps need is made once.
    Shared,
    /// Every step runs every node, one at a time, so that the seconds can be compared.
    Timing,
}

/// How to run a program.
pub struct ProgramOptions<'a> {
    /// How many steps run at once.
    pub jobs: usize,
    /// Threads that modules share; only written down.
    pub threads: usize,
    /// Which steps are this process's.
    pub shard: Shard,
    /// Whether steps share what they have in common.
    pub sharing: Sharing,
    /// Bytes of memory beyond which no further step is started while another runs.
    pub memory: usize,
    /// Values that outlive the process.
    pub disk_cache: Option<DiskCache>,
    /// Seconds after which a step is stopped, in place of what the program says.
    pub time_limit: Option<Duration>,
    /// Whether steps that failed before run again.
    pub retry: Retry,
    /// Stops the program; a later one goes on where it was.
    pub cancel: &'a CancelToken,
    /// Hears what happens, from several threads.
    pub observer: &'a (dyn Fn(&ProgramEvent) + Sync),
}

/// What becomes of steps that failed before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retry {
    /// They stay as they are.
    Nothing,
    /// They run again.
    Failed,
}

/// Something that happened to a step; `place` is its place among the steps.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum ProgramEvent<'a> {
    /// It runs.
    StepStarted {
        /// Which.
        place: usize,
        /// Its id and parameters.
        step: &'a Step,
    },
    /// Something happened to one of its nodes.
    Node {
        /// Which step.
        place: usize,
        /// What happened.
        node_event: &'a Event<'a>,
    },
    /// It is in the store.
    StepEnded {
        /// Which.
        place: usize,
        /// What is kept of it.
        record: &'a StepRecord,
    },
}

/// What came of running a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ProgramOutcome {
    /// Steps of the program, each counted once.
    pub steps: usize,
    /// Steps that this call ran to their end.
    pub ran: usize,
    /// Steps that were in the store before.
    pub found: usize,
    /// Steps in the store whose result is a failure.
    pub failed: usize,
    /// Steps that are not in the store: stopped, of another shard, or with another process.
    pub missing: usize,
    /// Steps of earlier plans that the store keeps and the table leaves out.
    pub others: usize,
    /// Seconds that the call took.
    pub seconds: f64,
    /// Whether it was stopped.
    pub is_stopped: bool,
}

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
    for id in &ids {
        if store.record(id).is_some_and(|record| must_run_again(&record, options, limit)) {
            store.forget(id)?;
        }
    }
    let found = ids.iter().filter(|id| store.record(id).is_some()).count();
    let workers = Workers::new(program, store, options);
    let mut note = (!workers.todo.is_empty()).then(|| RunNote::begin(options));
    program.write_plan(store, note.as_ref())?;
    workers.run_all()?;
    if let Some(note) = &mut note {
        note.ran = workers.ran.load(Ordering::Relaxed);
        note.seconds = Some(start.elapsed().as_secs_f64());
        program.write_plan(store, Some(note))?;
    }
    let records: Vec<_> = ids.iter().filter_map(|id| store.record(id)).collect();
    // A process that was killed may have finished a step and not come to this.
    records.iter().try_for_each(|record| store.publish(record))?;
    tables::write(program, store)?;
    Ok(ProgramOutcome {
        steps: ids.len(),
        ran: workers.ran.load(Ordering::Relaxed),
        found,
        failed: records.iter().filter(|record| record.status != StepStatus::Done).count(),
        missing: ids.len() - records.len(),
        others: store.count_others(&ids),
        seconds: start.elapsed().as_secs_f64(),
        is_stopped: options.cancel.is_cancelled(),
    })
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
    may_take_longer || is_not_timed || is_failed
}

struct Workers<'a> {
    program: &'a Program,
    store: &'a Store,
    options: &'a ProgramOptions<'a>,
    cache: Option<Cache>,
    /// Places of the steps that are still to be looked at.
    todo: Vec<usize>,
    next: AtomicUsize,
    running: AtomicUsize,
    ran: AtomicUsize,
    /// When the tables were written last, and how long that took.
    tables: Mutex<(Instant, Duration)>,
    trouble: Mutex<Option<StoreError>>,
}

impl<'a> Workers<'a> {
    fn new(program: &'a Program, store: &'a Store, options: &'a ProgramOptions) -> Self {
        let Shard { index, count } = options.shard;
        let mut seen = HashSet::new();
        let todo = (0..program.steps.len())
            .filter(|place| seen.insert(&program.steps[*place].id))
            .filter(|place| place % count.max(1) == index)
            .filter(|place| store.record(&program.steps[*place].id).is_none());
        let cache = (options.sharing == Sharing::Shared).then(|| {
            let disk = options.disk_cache.clone();
            Cache::new(options.memory / 2, disk).only(program.shared.clone())
        });
        Self {
            program,
            store,
            options,
            cache,
            todo: todo.collect(),
            next: AtomicUsize::new(0),
            running: AtomicUsize::new(0),
            ran: AtomicUsize::new(0),
            tables: Mutex::new((Instant::now(), Duration::ZERO)),
            trouble: Mutex::default(),
        }
    }

    fn run_all(&self) -> Result<(), StoreError> {
        let jobs = match self.options.sharing {
            Sharing::Shared => self.options.jobs.clamp(1, self.todo.len().max(1)),
            Sharing::Timing => 1,
        };
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
        let is_full = || memory::resident_bytes().is_some_and(|bytes| bytes > self.options.memory);
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
        (self.options.observer)(&ProgramEvent::StepStarted { place, step });
        let Some(record) = self.run_step(place, &claim) else {
            self.store.abandon(&claim);
            return Ok(false);
        };
        let record = self.store.commit(claim, record)?;
        (self.options.observer)(&ProgramEvent::StepEnded { place, record: &record });
        Ok(true)
    }

    /// Runs one step; `None` if it was stopped by hand.
    fn run_step(&self, place: usize, claim: &StepClaim) -> Option<StepRecord> {
        let start = Instant::now();
        let step = &self.program.steps[place];
        let limit = self.options.time_limit.or(self.program.time_limit);
        let cancel = self.options.cancel.child(limit.map(|limit| start + limit));
        let outcome = match self.program.plan(&step.params, step.repeat) {
            // An input file was changed or removed since the program was checked.
            Err(problems) => Err(problems.iter().map(Problem::to_string).collect::<Vec<_>>()),
            Ok(plan) if plan.id.short() != step.id => {
                Err(vec!["an input file was changed while the program ran".to_owned()])
            }
            Ok(plan) => Ok(run(
                &plan,
                &RunOptions {
                    output_folder: &claim.outputs(),
                    threads: 1,
                    cache: self.cache.as_ref(),
                    cancel: &cancel,
                    observer: &|event| {
                        let event = ProgramEvent::Node { place, node_event: event };
                        (self.options.observer)(&event);
                    },
                    keep: Keep::Scalars,
                    output_scope: OutputScope::Folder,
                },
            )),
        };
        let (status, nodes) = match outcome {
            Err(complaints) => {
                (StepStatus::Failed { reason: complaints.join("; ") }, IndexMap::new())
            }
            Ok(outcome) => {
                let status = step_status(&outcome, &cancel, limit)?;
                let nodes = outcome.nodes.into_iter().map(|(name, node)| (name, node.record));
                (status, nodes.collect())
            }
        };
        Some(StepRecord {
            id: step.id.clone(),
            repeat: step.repeat,
            params: step.params.clone(),
            status,
            seconds: start.elapsed().as_secs_f64(),
            is_timed: self.options.sharing == Sharing::Timing,
            version: crate::VERSION.to_owned(),
            nodes,
        })
    }

    /// Brings the tables up to date now and then, so that a long program can be looked at. Takes
    /// at most a twentieth of the time.
    fn refresh_tables(&self) -> Result<(), StoreError> {
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
        return Some(StepStatus::Failed { reason: failures.join("; ") });
    }
    if !outcome.is_stopped() {
        return Some(StepStatus::Done);
    }
    let at = outcome.nodes.iter().find(|(_, node)| node.record.status == NodeStatus::Stopped);
    let (at, limit) = (at.map_or("", |(name, _)| name.as_str()), limit?.as_secs_f64());
    let reason = format!("{at}: not done within the time limit of {limit} s");
    cancel.is_overdue().then_some(StepStatus::TimedOut { reason, limit })
}

impl Program {
    /// Writes `plan.json`, with a note of this call, if it runs anything, beside those of others.
    fn write_plan(&self, store: &Store, note: Option<&RunNote>) -> Result<(), StoreError> {
        store.with_lock(|| {
            let mut runs = store.plan().map(|plan| plan.runs).unwrap_or_default();
            if let Some(note) = note {
                note.add_to(&mut runs);
            }
            // Plain data, which JSON can always say.
            let file = PlanFile::of(self, runs);
            let text = serde_json::to_string_pretty(&file).unwrap_or_default() + "\n";
            store.write("plan.json", text.as_bytes())
        })
    }

    fn plan_options(&self, repeat: u32) -> PlanOptions<'_> {
        PlanOptions {
            map_folder: &self.map_folder,
            output_folder: None,
            output_scope: OutputScope::Folder,
            repeat,
            files: &self.files,
        }
    }

    /// The map whose parameters it varies.
    pub fn map(&self) -> &Map {
        &self.map
    }

    /// The results so far as a table: a header, then a row a step in the order of the program.
    pub fn table(&self, store: &Store) -> (Vec<String>, Vec<Vec<String>>) {
        tables::table(self, store)
    }

    /// [`Program::table`] for reading: without ids, reasons, the seconds of single nodes and
    /// columns that say nothing new, numbers cut to five significant digits and times to
    /// milliseconds.
    pub fn brief_table(&self, store: &Store) -> (Vec<String>, Vec<Vec<String>>) {
        let (header, rows) = self.table(store);
        tables::brief_table(self, &header, &rows)
    }

    /// The record of a step, if the store has it.
    pub fn record(&self, store: &Store, place: usize) -> Option<Arc<StepRecord>> {
        store.record(&self.steps.get(place)?.id)
    }
}
