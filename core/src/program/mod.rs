//! Programs: every combination of a map's parameters, run unattended into a store.

mod columns;
mod expand;
mod plan_file;
mod record;
mod report_reader;
mod report_spec;
mod requirement;
mod rounds;
mod steps;
mod store;
mod tables;
mod timing;
mod unneeded;
mod usage;
mod work;

pub use columns::{ColumnRecord, Columns, are_alike};
pub use plan_file::{PlanFile, RunNote};
pub use record::{StepRecord, StepStatus};
pub use report_spec::{Measure, Question, ReportFault, ReportSpec, TIMES, meant};
pub use requirement::Requirement;
pub use rounds::TIMINGS;
pub use store::{Store, StoreError};
pub use tables::{brief, brief_value, csv_table, exact};
pub use timing::{Timing, median};
pub use unneeded::Unneeded;
pub use work::run_program;

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use crate::cancel::CancelToken;
use crate::disk_cache::DiskCache;
use crate::files::FileHashes;
use crate::fingerprint::Fingerprint;
use crate::map::{Map, ProgramSpec};
use crate::problem::Problem;
use crate::registry::Registry;
use crate::run::Event;

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
    /// The outside programs that its steps run: the node, and the command as a person reads it.
    pub command_lines: BTreeSet<(String, String)>,
    /// What it says of its report.
    pub report: ReportSpec,
    /// The columns of its results, as modules declare them.
    pub columns: Columns,
    /// Name of the map's file, for the records; empty where there is none.
    pub map_file: String,
    /// Where that file is, to tell two of one name apart; empty where there is none.
    pub map_path: PathBuf,
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

/// The steps that a call is for.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// This process's share of them.
    pub shard: Shard,
    /// Only those that set these parameters so, by the value or by the id of an entry.
    pub only: Vec<(String, Json)>,
}

impl Default for Part {
    /// All of them.
    fn default() -> Self {
        Self { shard: Shard { index: 0, count: 1 }, only: Vec::new() }
    }
}

/// Whether steps share what they have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sharing {
    /// A value that several steps need is made once.
    Shared,
    /// Every step runs every node, one at a time and several times, so that the seconds can be
    /// compared.
    Timing,
}

/// How to run a program.
pub struct ProgramOptions<'a> {
    /// How many steps run at once.
    pub jobs: usize,
    /// Threads that modules share; only written down.
    pub threads: usize,
    /// Which steps it runs.
    pub part: Part,
    /// Whether steps share what they have in common.
    pub sharing: Sharing,
    /// How often each step is timed, where its program has no repeats.
    pub timings: usize,
    /// Bytes of memory beyond which no further step is started while another runs.
    pub memory: usize,
    /// Values that outlive the process.
    pub disk_cache: Option<DiskCache>,
    /// Seconds after which a step is stopped, in place of what the program says.
    pub time_limit: Option<Duration>,
    /// Whether steps that failed before run again.
    pub retry: Retry,
    /// Whether it ends while other processes are at steps of its part.
    pub patience: Patience,
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

/// What a call does while other processes are at the steps that it lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// It ends.
    None,
    /// It waits for them, and runs what they leave.
    Wait,
}

/// Something that happened to a step; `place` is its place among the steps.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum ProgramEvent<'a> {
    /// It is known what there is to do.
    Began {
        /// Steps of the part that is run, each counted once.
        steps: usize,
        /// Of these, steps that the store has.
        found: usize,
    },
    /// It is in the store from an earlier call.
    StepFound {
        /// Which.
        place: usize,
        /// What is kept of it.
        record: &'a StepRecord,
    },
    /// It runs.
    StepStarted {
        /// Which.
        place: usize,
        /// Its id and parameters.
        step: &'a Step,
    },
    /// It is in the store.
    StepEnded {
        /// Which.
        place: usize,
        /// What is kept of it.
        record: &'a StepRecord,
    },
    /// Something happened to one of its nodes; written as an event of a run, with the place.
    #[serde(untagged)]
    Node {
        /// Which step.
        place: usize,
        /// What happened.
        #[serde(flatten)]
        node_event: &'a Event<'a>,
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
    /// Steps in the store that did not reach their target.
    pub missed: usize,
    /// Steps that are not in the store: stopped, of another part, or with another process.
    pub missing: usize,
    /// Of these, steps of the part that was to run.
    pub missing_of_part: usize,
    /// Steps whose records could not be read or were changed by hand, and that ran again.
    pub damaged: usize,
    /// Steps of earlier plans that the store keeps and the table leaves out.
    pub others: usize,
    /// Seconds that the call took.
    pub seconds: f64,
    /// Whether it was stopped.
    pub is_stopped: bool,
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

    /// Makes columns of parameters that somebody set for this call, in every step, and takes the
    /// steps of earlier calls in that set the same ones otherwise and are still what they were.
    pub fn set_apart(&mut self, settings: &[(String, Json)], store: Option<&Store>) {
        let is_varied = |path: &String| self.varied.contains(path);
        let own = settings.iter().filter(|(path, _)| !is_varied(path));
        let own: IndexMap<String, Json> = own.cloned().collect();
        if own.is_empty() {
            return;
        }
        for step in &mut self.steps {
            step.params = own.clone().into_iter().chain(step.params.drain(..)).collect();
        }
        self.varied = own.keys().cloned().chain(self.varied.drain(..)).collect();
        let Some((store, plan)) = store.and_then(|store| Some((store, store.plan().ok()?))) else {
            return;
        };
        let mut known: HashSet<String> = self.steps.iter().map(|step| step.id.clone()).collect();
        let mut series = self.series();
        let mut inputs = Vec::new();
        let mut is_same = |step: &Step| {
            let is_candidate = own.keys().all(|path| step.params.contains_key(path))
                && step.params.keys().all(|path| self.varied.contains(path))
                && store.record(&step.id).is_some();
            let planned =
                is_candidate.then(|| series.plan(&step.params, step.repeat).ok()).flatten();
            planned.filter(|planned| planned.plan.id.short() == step.id).is_some_and(|planned| {
                inputs.extend(planned.plan.nodes.iter().flat_map(|node| &node.reads).cloned());
                true
            })
        };
        let earlier = plan.steps.into_iter();
        let earlier = earlier.filter(|step| !known.contains(&step.id) && is_same(step));
        let mut earlier: Vec<Step> = earlier.collect();
        earlier.retain(|step| known.insert(step.id.clone()));
        self.inputs.extend(inputs);
        self.steps.splice(0..0, earlier);
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

    /// Places of the steps of a part, each step once.
    pub fn places(&self, part: &Part) -> Vec<usize> {
        let Shard { index, count } = part.shard;
        let meant_of = |(path, side): &'_ (String, Json)| {
            let values = self.steps.iter().filter_map(|step: &Step| step.params.get(path));
            (path.clone(), meant(side, values))
        };
        let only: Vec<(String, Vec<&Json>)> = part.only.iter().map(meant_of).collect();
        let is_meant = |step: &Step| {
            only.iter().all(|(path, values)| {
                step.params.get(path).is_some_and(|value| values.contains(&value))
            })
        };
        let mut seen = HashSet::new();
        (0..self.steps.len())
            .filter(|place| seen.insert(&self.steps[*place].id))
            .filter(|place| is_meant(&self.steps[*place]))
            .enumerate()
            .filter(|(n, _)| n % count.max(1) == index)
            .map(|(_, place)| place)
            .collect()
    }

    /// The record of a step, if the store has it.
    pub fn record(&self, store: &Store, place: usize) -> Option<Arc<StepRecord>> {
        store.record(&self.steps.get(place)?.id)
    }
}
