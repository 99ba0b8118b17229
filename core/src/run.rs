//! Running a plan: nodes start as soon as their inputs are there, on a few threads.

mod audience;
mod listener;
mod options;
mod record;
mod state;

use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use audience::Audience;
use indexmap::IndexMap;
use listener::Listener;
pub use options::{Keep, RunOptions};
pub use record::{NodeRecord, NodeStatus};
use serde::Serialize;
use state::State;

use crate::cache::{Cache, CacheUse, Claim};
use crate::data::Value;
use crate::error::ModuleError;
use crate::files::{lying_at, refuse_links, refuse_special};
use crate::module::{Arrived, Io};
use crate::node_outputs::{LogLine, NodeOutputs};
use crate::panics::contained;
use crate::param::{Setting, Settings};
use crate::plan::{Plan, PlanNode};
use crate::stored::Stored;

/// Progress of one node is told at most this often.
const PROGRESS_PAUSE: Duration = Duration::from_millis(50);

/// Something that happened to a node.
#[derive(Clone, Debug, Serialize)]
pub struct Event<'a> {
    /// The node.
    pub node: &'a str,
    /// What happened.
    #[serde(flatten)]
    pub kind: EventKind<'a>,
}

/// What can happen to a node.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum EventKind<'a> {
    /// Its module was started.
    Started,
    /// Its module is this far, 0 to 1.
    Progress {
        /// How far.
        share: f64,
    },
    /// Its module says something.
    Log {
        /// What.
        text: &'a str,
    },
    /// Its module reports trouble, and goes on.
    Warning {
        /// What.
        text: &'a str,
    },
    /// It came to its end: done, failed, skipped or stopped.
    Ended {
        /// How, and what it gave.
        record: &'a NodeRecord,
        /// The values of its outputs, in the order of their declarations; none if it is not done.
        #[serde(skip)]
        outputs: &'a [Value],
    },
}

/// A node's record and, if they were to be kept, its outputs.
#[derive(Clone, Debug)]
pub struct NodeOutcome {
    /// What happened.
    pub record: NodeRecord,
    /// Outputs by name.
    pub outputs: IndexMap<&'static str, Value>,
}

/// What came of a run: every node of the plan, by name.
#[derive(Clone, Debug, Default)]
pub struct RunOutcome {
    /// In the order of the plan.
    pub nodes: IndexMap<String, NodeOutcome>,
}

impl RunOutcome {
    /// Whether every node is done.
    pub fn is_done(&self) -> bool {
        let is_done = |status: &NodeStatus| matches!(status, NodeStatus::Done | NodeStatus::Past);
        self.nodes.values().all(|node| is_done(&node.record.status))
    }

    /// The value of an output, where the run kept it.
    pub fn value(&self, node: &str, output: &str) -> Option<&Value> {
        self.nodes.get(node)?.outputs.get(output)
    }

    /// Whether some node was stopped.
    pub fn is_stopped(&self) -> bool {
        self.nodes.values().any(|node| node.record.status == NodeStatus::Stopped)
    }

    /// The nodes that failed, and why.
    pub fn failures(&self) -> impl Iterator<Item = (&str, &str)> {
        self.nodes.iter().filter_map(|(name, node)| match &node.record.status {
            NodeStatus::Failed { error, .. } => Some((name.as_str(), error.as_str())),
            _ => None,
        })
    }
}

/// Runs a plan to its end. Failures are part of the outcome.
///
/// Where a value that stays in a file was found damaged, all runs once more and it is made anew:
/// what is sound is taken from the cache where there is one, else every node runs again. The
/// observer hears once of each node that it starts and that it ends.
pub fn run(plan: &Plan, options: &RunOptions) -> RunOutcome {
    let audience = Audience::new(options.observer);
    let (mut outcome, is_damaged) = run_once(plan, options, &audience, Attempt::First);
    if is_damaged && !options.cancel.is_cancelled() {
        (outcome, _) = run_once(plan, options, &audience, Attempt::Last);
    }
    for (node, NodeOutcome { record, .. }) in &outcome.nodes {
        audience.tell(&Event { node, kind: EventKind::Ended { record, outputs: &[] } });
    }
    outcome
}

/// Which run of a plan it is: after the first another one follows if a value is damaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Attempt {
    First,
    Last,
}

/// Runs a plan, and tells whether a node failed on a damaged value.
fn run_once(
    plan: &Plan,
    options: &RunOptions,
    audience: &Audience,
    attempt: Attempt,
) -> (RunOutcome, bool) {
    let (state, changed) = (Mutex::new(State::new(plan)), Condvar::new());
    let runner = Runner { plan, options, audience, attempt, state, changed };
    let threads = options.threads.clamp(1, plan.nodes.len().max(1));
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(|| runner.work());
        }
        runner.work();
    });
    let state = runner.state.into_inner().unwrap_or_else(PoisonError::into_inner);
    let names = plan.nodes.iter().map(|node| node.name.clone());
    let outcomes = state.outcomes.into_iter().flatten();
    let mut outcome = RunOutcome { nodes: names.zip(outcomes).collect() };
    outcome.add_up_what_is_inside();
    (outcome, state.is_damaged)
}

/// The files that values are handles to.
fn stored_in(inputs: &Arrived) -> Vec<Stored> {
    let many = inputs.many.iter().filter_map(|(_, value)| value.as_ref());
    inputs.one.iter().flatten().chain(many).flat_map(Value::stored).collect()
}

struct Runner<'a> {
    plan: &'a Plan,
    options: &'a RunOptions<'a>,
    audience: &'a Audience<'a>,
    attempt: Attempt,
    state: Mutex<State>,
    changed: Condvar,
}

impl Runner<'_> {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes nodes that are ready until all have ended.
    fn work(&self) {
        let mut state = self.lock();
        while state.n_ended < self.plan.nodes.len() {
            let Some(place) = state.ready.pop() else {
                state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let node = &self.plan.nodes[place];
            let inputs = Arrived {
                one: node.inputs.iter().map(|s| s.and_then(|s| state.fetch(s))).collect(),
                many: node.many.iter().map(|(p, s)| (*p, state.fetch(*s))).collect(),
            };
            let linked = node.linked.iter().map(|(p, s)| (*p, state.fetch(*s))).collect();
            let mut said = node.gates.iter().map(|gate| (gate, state.fetch(gate.source)));
            // All of them are fetched, so that none is kept for a node that is past.
            let is_past = said.by_ref().fold(false, |past, (gate, value)| {
                past | value.is_none_or(|value| gate.until.is_met(&value))
            });
            if is_past {
                self.pass_by(&mut state, place);
                self.changed.notify_all();
                continue;
            }
            drop(state);
            let files: Vec<Stored> = stored_in(&inputs);
            let (outcome, outputs) = self.run_node(node, inputs, linked);
            state = self.lock();
            let is_failed = matches!(outcome.record.status, NodeStatus::Failed { .. });
            state.is_damaged |= is_failed && files.iter().any(|file| !file.is_sound());
            if outputs.is_none() {
                self.tell_of_failure(&state, node, &outcome);
            }
            self.end(&mut state, place, outcome, outputs);
            self.changed.notify_all();
        }
    }

    /// Enters what came of a node; consumers become ready, or are skipped.
    fn end(
        &self,
        state: &mut State,
        place: usize,
        outcome: NodeOutcome,
        outputs: Option<Vec<Value>>,
    ) {
        let node = &self.plan.nodes[place];
        state.outcomes[place] = Some(outcome);
        state.n_ended += 1;
        if let Some(outputs) = outputs {
            for ((slot, needed), value) in state.values[place].iter_mut().zip(outputs) {
                *slot = (*needed > 0).then_some(value);
            }
            state.release(&node.consumers);
            return;
        }
        let status = self.status_behind(state, place);
        let mut lost = node.consumers.clone();
        while let Some(place) = lost.pop() {
            if state.outcomes[place].is_none() {
                let node = &self.plan.nodes[place];
                let outcome = not_run(node, status.clone(), Vec::new());
                self.tell_of_failure(state, node, &outcome);
                state.outcomes[place] = Some(outcome);
                state.n_ended += 1;
                lost.extend(&node.consumers);
            }
        }
    }

    /// Enters that a node of a later round is past: its loop ended before. Its consumers go on
    /// without a value of it.
    fn pass_by(&self, state: &mut State, place: usize) {
        let node = &self.plan.nodes[place];
        let outcome = not_run(node, NodeStatus::Past, Vec::new());
        self.tell(node, EventKind::Ended { record: &outcome.record, outputs: &[] });
        state.outcomes[place] = Some(outcome);
        state.n_ended += 1;
        state.release(&node.consumers);
    }

    /// The status of the nodes that hang on one without outputs.
    fn status_behind(&self, state: &State, place: usize) -> NodeStatus {
        match state.outcomes[place].as_ref().map(|outcome| &outcome.record.status) {
            Some(NodeStatus::Failed { .. }) => {
                NodeStatus::Skipped { because_of: self.plan.nodes[place].name.clone() }
            }
            _ => NodeStatus::Stopped,
        }
    }

    /// Tells that a node ended without outputs, unless all will run once more.
    fn tell_of_failure(&self, state: &State, node: &PlanNode, outcome: &NodeOutcome) {
        if !(state.is_damaged && self.attempt == Attempt::First) {
            self.tell(node, EventKind::Ended { record: &outcome.record, outputs: &[] });
        }
    }

    fn tell(&self, node: &PlanNode, kind: EventKind) {
        self.audience.tell(&Event { node: &node.name, kind });
    }

    /// Runs one node, or finds its outputs in the cache.
    fn run_node(
        &self,
        node: &PlanNode,
        inputs: Arrived,
        linked: Vec<(usize, Option<Value>)>,
    ) -> (NodeOutcome, Option<Vec<Value>>) {
        // Files are not in the cache: a node that writes some runs even where its outputs are
        // known.
        let cache = self.options.cache.filter(|_| node.writes.is_empty());
        let claim = cache.map(|c| c.claim(node.key, node.info.module, self.options.cancel));
        let (results, cached) = match claim {
            Some(Claim::Hit(results, cached)) => (Ok(results), Some(cached)),
            Some(Claim::Stopped) => (Err((ModuleError::Cancelled, Vec::new())), None),
            Some(Claim::Mine(ticket)) => {
                let results = self.make(node, inputs, linked).map(Arc::new);
                if let Ok(results) = &results {
                    ticket.fulfill(results);
                }
                (results, None)
            }
            None => (self.make(node, inputs, linked).map(Arc::new), None),
        };
        let results = match results {
            Ok(results) => results,
            Err((error, log)) => {
                let status = match error {
                    ModuleError::Cancelled => NodeStatus::Stopped,
                    error => {
                        let is_of_files = error.is_of_the_system();
                        NodeStatus::Failed { error: error.to_string(), is_of_files }
                    }
                };
                return (not_run(node, status, log), None);
            }
        };
        let record = self.record(node, &results, cached);
        self.tell(node, EventKind::Ended { record: &record, outputs: &results.outputs });
        let outputs =
            Arc::try_unwrap(results).map_or_else(|results| results.outputs.clone(), |m| m.outputs);
        let names = node.info.module.outputs.iter().map(|output| output.name);
        let kept = match self.options.keep {
            Keep::All => names.zip(outputs.iter().cloned()).collect(),
            Keep::Scalars => IndexMap::new(),
        };
        (NodeOutcome { record, outputs: kept }, Some(outputs))
    }

    fn record(
        &self,
        node: &PlanNode,
        results: &NodeOutputs,
        cached: Option<CacheUse>,
    ) -> NodeRecord {
        let mut record = NodeRecord::blank(node, NodeStatus::Done);
        for (spec, value) in node.info.module.outputs.iter().zip(&results.outputs) {
            let cells = value.cells();
            if let Some(scalar) = value.scalar() {
                record.scalars.insert(spec.name.to_owned(), scalar);
            } else if cells.is_empty() {
                record.values.insert(spec.name.to_owned(), value.summary());
            } else {
                record.scalars.extend(cells);
            }
        }
        if cached != Some(CacheUse::Memory) {
            record.seconds = Some(results.seconds);
            record.phases.clone_from(&results.phases);
        }
        record.cached = cached;
        let base = self.options.output_folder;
        let written = node.writes.iter().flat_map(|path| lying_at(base, path));
        let found = written.filter_map(|path| {
            let about = base.join(&path).metadata().ok().filter(|about| about.is_file())?;
            Some((path, about.len()))
        });
        (record.files, record.file_bytes) = found.unzip();
        record.missed.clone_from(&results.missed);
        record.log.clone_from(&results.log);
        record
    }

    /// Runs the module, and turns a panic into an error. An error comes with the log so far.
    fn make(
        &self,
        node: &PlanNode,
        inputs: Arrived,
        linked: Vec<(usize, Option<Value>)>,
    ) -> Result<NodeOutputs, (ModuleError, Vec<LogLine>)> {
        if self.options.cancel.is_cancelled() {
            return Err((ModuleError::Cancelled, Vec::new()));
        }
        self.refuse_links_of(node).map_err(|error| (error, Vec::new()))?;
        let settings = self.settle(node, linked).map_err(|error| (error, Vec::new()))?;
        self.tell(node, EventKind::Started);
        let module = node.info.module;
        let listener = Listener {
            runner: self,
            node,
            log: Mutex::default(),
            phases: Mutex::default(),
            missed: Mutex::default(),
            told: Mutex::default(),
        };
        let start = Instant::now();
        let folder = self.options.cache.and_then(Cache::folder);
        let mut io = Io::new(module, &settings, inputs, self.options.cancel, &listener, folder);
        io.memory = self.options.memory;
        let ended = contained(|| (module.run)(&mut io));
        let waited = io.waited;
        let outputs = ended.and_then(|()| io.finish());
        let seconds = start.elapsed().saturating_sub(waited).as_secs_f64();
        let log = listener.log.into_inner().unwrap_or_else(PoisonError::into_inner);
        match outputs {
            Ok(outputs) => {
                let phases = listener.phases.into_inner().unwrap_or_else(PoisonError::into_inner);
                let missed = listener.missed.into_inner().unwrap_or_else(PoisonError::into_inner);
                Ok(NodeOutputs { outputs, log, missed, seconds, phases })
            }
            Err(error) => Err((error, log)),
        }
    }

    /// Refuses links, devices and pipes at all that the node writes, and in a folder that it
    /// writes; and links on the way there, unless files may lie anywhere.
    fn refuse_links_of(&self, node: &PlanNode) -> Result<(), ModuleError> {
        let base = self.options.output_folder;
        let paths = node.writes.iter().flat_map(|path| [vec![path.clone()], lying_at(base, path)]);
        paths.flatten().try_for_each(|path| {
            if self.options.output_scope.is_bounded() {
                refuse_links(base, &path).map_err(|why| ModuleError::io(&path, why))?;
            }
            refuse_special(&base.join(&path)).map_err(|why| ModuleError::io(&path, why))
        })
    }

    /// The node's parameters, with those that come by link and with the files in their folder.
    fn settle(
        &self,
        node: &PlanNode,
        linked: Vec<(usize, Option<Value>)>,
    ) -> Result<Settings, ModuleError> {
        let mut settings = node.settings.clone();
        for (place, value) in linked {
            if let Some(scalar) = value.and_then(|value| value.scalar()) {
                settings.0[place].1 = node.info.module.params[place].parse_linked(&scalar)?;
            }
        }
        let mut fault = None;
        settings.each_mut(node.info.module.params, &mut |_, spec, setting| {
            if let Setting::File { resolved, .. } = setting
                && spec.output_file().is_some()
                && fault.is_none()
            {
                fault = self.place(resolved).err();
            }
        });
        if let Some(fault) = fault {
            return Err(fault);
        }
        Ok(settings)
    }

    /// Puts the path of an output file into the output folder, and makes its folder.
    fn place(&self, path: &mut PathBuf) -> Result<(), ModuleError> {
        let base = self.options.output_folder;
        if self.options.output_scope.is_bounded() {
            refuse_links(base, path).map_err(|why| ModuleError::io(path, why))?;
        }
        *path = base.join(&*path);
        let Some(folder) = path.parent() else { return Ok(()) };
        std::fs::create_dir_all(folder)
            .map_err(|error| ModuleError::io(folder, format!("cannot make this folder: {error}")))
    }
}

/// What came of a node that gave no outputs.
fn not_run(node: &PlanNode, status: NodeStatus, log: Vec<LogLine>) -> NodeOutcome {
    let record = NodeRecord { log, ..NodeRecord::blank(node, status) };
    NodeOutcome { record, outputs: IndexMap::new() }
}
