//! Runs a map beside the window, which never waits: checks and runs happen on threads of their own,
//! and what they find arrives as messages that the window takes in once a frame.

mod check;
mod inside;
mod job;
mod log;
mod status;

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use indexmap::IndexMap;
use mve_core::{
    Cache, CancelToken, FileHashes, Fingerprint, Map, NodeRecord, NodeStatus, PortRef, Problem,
    Registry, Value,
};

pub use check::{MapCheck, Part};
use inside::Inside;
pub use log::{Line, Log, Loudness};
pub use status::{Status, seconds_text};

/// Nodes that were removed, and whose results are kept for the case of an undo.
const MOST_GONE: usize = 64;

/// What is said of a map that does not run by itself.
pub const PART_OF_ANOTHER: &str = "This is a part of another map, which gives it its values and \
                                   runs it: press Run there.";

/// What all runs of the window share.
pub struct Shared {
    /// The modules.
    pub registry: Registry,
    /// Values made before, by any tab.
    pub cache: Cache,
    /// Fingerprints of input files.
    pub files: FileHashes,
    /// The folder that savers write to, as `mve run` has it.
    pub output_folder: PathBuf,
    /// Asks the window to draw itself again; called from any thread.
    pub wake: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    /// What runs share, with a cache of at most `cache_bytes`; savers write to `mve-out` where no
    /// folder is named.
    pub fn new(
        registry: Registry,
        cache_bytes: usize,
        wake: Box<dyn Fn() + Send + Sync>,
        output_folder: Option<PathBuf>,
    ) -> Arc<Self> {
        Arc::new(Self {
            registry,
            cache: Cache::new(cache_bytes, None),
            files: FileHashes::new(),
            output_folder: output_folder.unwrap_or_else(|| PathBuf::from("mve-out")),
            wake,
        })
    }
}

/// A map as the runner takes it.
#[derive(Clone)]
pub struct Subject {
    /// The map.
    pub map: Arc<Map>,
    /// Number of its state, as [`crate::document::Document::revision`] counts them.
    pub revision: u64,
    /// The folder that its input paths are relative to.
    pub folder: PathBuf,
    /// The modules, with the maps that it names.
    pub registry: Registry,
    /// Outside programs that a person has seen and allowed.
    pub allowed: Arc<BTreeSet<String>>,
    /// Whether a person is asked for leave to run others; else their nodes are left out.
    pub asks: bool,
}

/// What the threads tell.
enum Message {
    Checked(Box<MapCheck>),
    /// A run of this part needs leave for these outside programs, and has not begun.
    Asks(BTreeSet<(String, String)>, Part),
    /// A run begins, with the keys of the nodes that take part.
    Planned(IndexMap<String, Fingerprint>),
    Started(String),
    Progress(String, f64),
    Said(Line),
    Ended(String, Box<NodeResult>),
    Finished,
}

/// What came of a node.
pub struct NodeResult {
    /// How it ended.
    pub record: NodeRecord,
    /// Values of its outputs, in the order of their declarations.
    pub outputs: Vec<Value>,
    /// Their names; none where the node gave nothing.
    pub names: Vec<&'static str>,
}

/// A run under way.
struct Job {
    part: Part,
    cancel: CancelToken,
    started: Instant,
    /// Nodes that take part.
    nodes: IndexMap<String, NodeProgress>,
    /// What has run inside of maps and loops, by the nodes that stand for them.
    inside: HashMap<String, Inside>,
}

/// How far a node is in a run.
struct NodeProgress {
    /// What its outputs will be those of.
    key: Fingerprint,
    /// None before it starts, 1 when it has ended.
    share: Option<f64>,
}

/// How far a run is.
#[derive(Clone, Debug, PartialEq)]
pub struct RunProgress {
    /// The node that works, and how far it is, 0 to 1; of several the one that is least far.
    pub working: Option<(String, f64)>,
    /// Nodes that have ended.
    pub n_ended: usize,
    /// Nodes that take part.
    pub n_nodes: usize,
    /// For how long it has been under way.
    pub elapsed: Duration,
}

/// Runs one map, and knows what became of each of its nodes.
pub struct Runner {
    shared: Arc<Shared>,
    /// The modules, with the maps that the map names.
    registry: Registry,
    inbox: Receiver<Message>,
    outbox: Sender<Message>,
    job: Option<Job>,
    /// The state that is asked to be checked, and whether a thread is at it.
    to_check: Option<Subject>,
    is_checking: bool,
    checked: MapCheck,
    ended: IndexMap<String, NodeResult>,
    /// Seconds that nodes ran when their values were made, by key: they hold for values that are
    /// taken from there later, too.
    measured: HashMap<Fingerprint, f64>,
    /// Seconds that the last run took.
    last_run: Option<Duration>,
    /// Everything that was said.
    pub log: Log,
    /// Outside programs that somebody must allow before a part of the map runs.
    question: Option<(BTreeSet<(String, String)>, Part)>,
}

impl Runner {
    /// A runner that has not run anything.
    pub fn new(shared: &Arc<Shared>) -> Self {
        let (outbox, inbox) = channel();
        Self {
            shared: Arc::clone(shared),
            registry: shared.registry.clone(),
            inbox,
            outbox,
            job: None,
            to_check: None,
            is_checking: false,
            checked: MapCheck::default(),
            ended: IndexMap::new(),
            measured: HashMap::new(),
            last_run: None,
            log: Log::default(),
            question: None,
        }
    }

    /// The outside programs, each with its node, for which a run of this part wants leave, once.
    pub fn take_question(&mut self) -> Option<(BTreeSet<(String, String)>, Part)> {
        self.question.take()
    }

    /// Checks a map soon, in place of one that still waits to be checked.
    pub fn check(&mut self, subject: Subject) {
        self.to_check = Some(subject);
        self.check_next();
    }

    fn check_next(&mut self) {
        if self.is_checking {
            return;
        }
        let Some(subject) = self.to_check.take() else { return };
        self.is_checking = true;
        let (shared, outbox) = (Arc::clone(&self.shared), self.outbox.clone());
        std::thread::spawn(move || {
            let (checked, _) = check::check(&subject, Part::All, &shared);
            // The window may be gone; then nobody needs to know.
            let _ = outbox.send(Message::Checked(Box::new(checked)));
            (shared.wake)();
        });
    }

    /// Runs a part of a map. What runs already is stopped first.
    pub fn run(&mut self, subject: Subject, part: Part) {
        self.stop();
        let cancel = CancelToken::new();
        let (started, nodes) = (Instant::now(), IndexMap::new());
        let (part_of, inside) = (part.clone(), HashMap::new());
        let job = Job { part: part_of, cancel: cancel.clone(), started, nodes, inside };
        // What an older run still has to say goes nowhere.
        let (outbox, inbox) = channel();
        self.drain();
        (self.outbox, self.inbox) = (outbox.clone(), inbox);
        self.is_checking = false;
        self.job = Some(job);
        let shared = Arc::clone(&self.shared);
        std::thread::spawn(move || job::run_job(&subject, &part, &shared, &outbox, &cancel));
    }

    /// Asks the run to stop; it ends within a moment.
    pub fn stop(&mut self) {
        if let Some(job) = &self.job {
            job.cancel.cancel();
        }
    }

    /// Whether something runs.
    pub fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Whether what runs was not asked for by a person, and makes something that is no longer what
    /// the map asks for.
    pub fn is_overtaken(&self) -> bool {
        let Some(job) = self.job.as_ref().filter(|job| job.part == Part::Quiet) else {
            return false;
        };
        let keys = &self.checked.keys;
        job.nodes.iter().any(|(name, node)| keys.get(name).is_none_or(|key| *key != node.key))
    }

    /// How far the run is.
    pub fn progress(&self) -> Option<RunProgress> {
        let job = self.job.as_ref()?;
        let at_work = |(name, node): (&String, &NodeProgress)| {
            let share = node.share.filter(|share| *share < 1.0)?;
            Some((name.clone(), share))
        };
        let at_work = job.nodes.iter().filter_map(at_work);
        Some(RunProgress {
            working: at_work.min_by(|(_, a), (_, b)| a.total_cmp(b)),
            n_ended: job.n_ended(),
            n_nodes: job.nodes.len(),
            elapsed: job.started.elapsed(),
        })
    }

    /// How long the last run took.
    pub fn last_run(&self) -> Option<Duration> {
        self.last_run
    }

    /// The modules, with the maps that the map names.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Takes over which maps there are.
    pub fn set_registry(&mut self, registry: Registry) {
        self.registry = registry;
    }

    /// What the last check found.
    pub fn checked(&self) -> &MapCheck {
        &self.checked
    }

    /// What is wrong with the map.
    pub fn problems(&self) -> &[Problem] {
        &self.checked.problems
    }

    /// What became of a node when it ran last.
    pub fn ended(&self, node: &str) -> Option<&NodeResult> {
        self.ended.get(node)
    }

    /// Seconds that a node took when what it gave last was made.
    pub fn seconds(&self, node: &str) -> Option<f64> {
        let record = &self.ended.get(node)?.record;
        record.seconds.or_else(|| self.measured.get(&record.key).copied())
    }

    /// What a node warned of when it ran last.
    pub fn warning(&self, node: &str) -> Option<&str> {
        let log = &self.ended.get(node)?.record.log;
        log.iter().find(|line| line.is_warning).map(|line| line.text.as_str())
    }

    /// What became of all nodes that ran, in the order in which they ended.
    pub fn all_ended(&self) -> impl Iterator<Item = (&str, &NodeResult)> {
        self.ended.iter().map(|(name, ended)| (name.as_str(), ended))
    }

    /// The value of an output, from the last run of its node.
    pub fn value(&self, node: &str, output: &str) -> Option<Value> {
        let ended = self.ended.get(node)?;
        let place = ended.names.iter().position(|name| *name == output)?;
        ended.outputs.get(place).cloned()
    }

    /// The output whose value is that of this one: another where its node is bypassed, none where
    /// it is muted.
    pub fn source(&self, map: &Map, port: &PortRef) -> Option<PortRef> {
        let is_active = map.nodes.get(&port.node).is_none_or(|node| node.mode.is_active());
        match is_active {
            true => Some(port.clone()),
            false => mve_core::passed_on(map, self.registry(), port),
        }
    }

    /// The value that goes out of a port: what passes through where its node is bypassed.
    pub fn value_out_of(&self, map: &Map, port: &PortRef) -> Option<Value> {
        let from = self.source(map, port)?;
        self.value(&from.node, &from.port)
    }

    /// The values of the last results that a node takes, in the order of the links.
    pub fn inputs(&self, map: &Map, node: &str) -> Vec<Value> {
        let links = map.links.iter().filter(|link| link.to.node == node);
        links.filter_map(|link| self.value_out_of(map, &link.from)).collect()
    }

    /// Takes in what the threads have told since the last call. Whether a run came to its end.
    pub fn take_in(&mut self) -> bool {
        let mut is_finished = false;
        while let Ok(message) = self.inbox.try_recv() {
            is_finished |= matches!(message, Message::Finished);
            self.hear(message);
        }
        is_finished
    }

    fn drain(&mut self) {
        while let Ok(message) = self.inbox.try_recv() {
            self.hear(message);
        }
    }

    fn hear(&mut self, message: Message) {
        match message {
            Message::Checked(checked) => {
                // A run checks the map that it was given, which may have changed since.
                if checked.revision >= self.checked.revision {
                    self.checked = *checked;
                }
                self.is_checking = false;
                self.check_next();
            }
            Message::Asks(commands, part) => {
                self.question = Some((commands, part));
                // Nothing has run.
                self.job = None;
            }
            Message::Planned(keys) => {
                if let Some(job) = &mut self.job {
                    let node = |(name, key)| (name, NodeProgress { key, share: None });
                    job.nodes = keys.into_iter().map(node).collect();
                }
            }
            Message::Started(node) => self.set_share(&node, 0.0),
            Message::Progress(node, share) => self.set_share(&node, share),
            Message::Said(line) => self.log.add(line),
            Message::Ended(node, ended) => {
                self.set_share(&node, 1.0);
                self.end(node, *ended);
            }
            Message::Finished => {
                let Some(job) = self.job.take() else { return };
                let time = job.started.elapsed();
                self.last_run = Some(time);
                let n_nodes = job.n_ended();
                let nodes = if n_nodes == 1 { "node" } else { "nodes" };
                let text = format!("ran {n_nodes} {nodes} in {}", seconds_text(time.as_secs_f64()));
                self.log.add(Line::of(None, Loudness::Note, text));
            }
        }
    }

    fn set_share(&mut self, node: &str, share: f64) {
        let known = self.job.as_mut().and_then(|job| job.nodes.get_mut(node));
        if let Some(known) = known {
            known.share = Some(share);
        }
    }

    fn end(&mut self, node: String, mut ended: NodeResult) {
        self.add_up(&node, &mut ended.record);
        match &ended.record.status {
            NodeStatus::Failed { error, .. } => {
                self.log.add(Line::of(Some(&node), Loudness::Error, error));
            }
            // A node that was stopped keeps what it had before.
            NodeStatus::Stopped if self.ended.contains_key(&node) => return,
            NodeStatus::Done => {
                let done = match (ended.record.cached.is_some(), ended.record.seconds) {
                    (false, Some(seconds)) => format!("done in {}", seconds_text(seconds)),
                    _ => "taken from an earlier run".to_owned(),
                };
                self.log.add(Line::of(Some(&node), Loudness::Note, done));
            }
            _ => {}
        }
        if let (Some(seconds), NodeStatus::Done) = (ended.record.seconds, &ended.record.status) {
            self.measured.insert(ended.record.key, seconds);
        }
        self.ended.shift_remove(&node);
        self.ended.insert(node, ended);
    }

    /// Takes over what is known of a node under its new name.
    pub fn rename(&mut self, from: &str, to: &str) {
        if let Some(ended) = self.ended.shift_remove(from) {
            self.ended.insert(to.to_owned(), ended);
        }
    }

    /// Drops what is known of nodes that have become other modules, and of nodes that are no longer
    /// there, but for the last few: they come back when their removal is undone.
    pub fn forget_all_but(&mut self, map: &Map) {
        let mut n_gone = 0;
        let mut kept = std::mem::take(&mut self.ended);
        kept.reverse();
        kept.retain(|name, ended| match map.nodes.get(name) {
            Some(node) => node.module == ended.record.module,
            // What is inside of a map or a loop goes with it.
            None if outermost(name) != name && map.nodes.contains_key(outermost(name)) => true,
            None => {
                n_gone += 1;
                n_gone <= MOST_GONE
            }
        });
        kept.reverse();
        self.ended = kept;
    }
}

/// The node of the map itself that one inside of its maps and loops belongs to.
pub fn outermost(node: &str) -> &str {
    node.split('/').next().unwrap_or(node)
}

impl Job {
    /// How far what is inside of a node is, where something is there: the mean of all shares.
    fn share_inside(&self, node: &str) -> Option<f64> {
        let is_inside = |name: &str| name != node && outermost(name) == node;
        let inside = self.nodes.iter().filter(|(name, _)| is_inside(name));
        let (n, n_begun, sum) = inside.fold((0, 0, 0.0), |(n, n_begun, sum), (_, node)| {
            let begun = usize::from(node.share.is_some());
            (n + 1, n_begun + begun, sum + node.share.unwrap_or(0.0))
        });
        (n_begun > 0).then(|| (sum / f64::from(n)).min(0.999))
    }

    fn n_ended(&self) -> usize {
        self.nodes.values().filter(|node| node.share == Some(1.0)).count()
    }
}

impl Drop for Runner {
    fn drop(&mut self) {
        self.stop();
    }
}

#[cfg(test)]
mod tests;
