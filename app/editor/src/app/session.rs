//! One open map: its document, its canvas, its runs, and what is looked at.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use indexmap::IndexSet;
use mve_core::{MapError, Node, NodeMode, PortRef, Registry, Value};
use mve_modules::data::{Field, TriMesh};

use super::commands::{CommandQuestion, WaitingRun};
use crate::canvas::Canvas;
use crate::catalog::Catalog;
use crate::document::{DiskChange, Document};
use crate::forms::Counts;
use crate::programs::{ProgramPanel, ProgramScene};
use crate::runner::{Line, Loudness, Part, Runner, Shared, Status, Subject};
use crate::views::{Pinned, PortState, Viewer, counts_of};

/// One open map.
pub struct Session {
    /// The map.
    pub document: Document,
    /// Its canvas.
    pub canvas: Canvas,
    /// Its runs.
    pub runner: Runner,
    /// The outputs whose values are shown.
    pub pinned: IndexSet<PortRef>,
    /// Those of them whose nodes were removed.
    lost_pins: IndexSet<PortRef>,
    /// What shows them.
    pub viewer: Viewer,
    /// Its programs.
    pub programs: ProgramPanel,
    /// What can be put into it.
    pub catalog: Catalog,
    /// The modules, and the maps that are known around it.
    around: Registry,
    /// The map that this one is part of.
    pub inside: Option<Inside>,
    /// The folder of that one.
    around_folder: PathBuf,
    /// Tells maps without a file from each other.
    pub number: usize,
    /// What somebody else did to the map's file.
    pub disk_change: Option<DiskChange>,
    /// A run that waits until a person allows its outside programs.
    pub question: Option<CommandQuestion>,
    /// Outside programs that a person has seen and allowed, as long as the map is open.
    allowed: Arc<BTreeSet<String>>,
    /// The state of the map that was sent to be checked.
    checked: Option<u64>,
    /// The state of the map that was run on edit.
    run_for: Option<u64>,
}

/// Of a map that is edited in a tab of its own: where it belongs.
pub struct Inside {
    /// The number of the document around it.
    pub(super) document: u64,
    /// Its name there.
    pub name: String,
    /// The revisions of both when they were the same last: its own, that of the map around it.
    pub(super) same: (u64, u64),
}

impl Session {
    /// Opens a session on a map.
    pub fn new(document: Document, shared: &Arc<Shared>) -> Self {
        let wake = Arc::clone(shared);
        let revision = document.revision();
        let mut session = Self {
            document,
            canvas: Canvas::default(),
            runner: Runner::new(shared),
            pinned: IndexSet::new(),
            lost_pins: IndexSet::new(),
            viewer: Viewer::new(),
            programs: ProgramPanel::new(Arc::new(move || (wake.wake)())),
            number: 1,
            disk_change: None,
            question: None,
            allowed: Arc::default(),
            checked: None,
            // What was opened is run by hand first.
            run_for: Some(revision),
            catalog: Catalog::new(&shared.registry),
            around: shared.registry.clone(),
            inside: None,
            around_folder: PathBuf::new(),
        };
        session.find_maps();
        session.lay_out();
        session
    }

    /// Puts nodes without a place where they are apart, before they are drawn.
    fn lay_out(&mut self) {
        let Self { canvas, document, runner, .. } = self;
        canvas.measure(document, runner.registry());
    }

    /// Opens a map's file.
    pub fn open(path: &Path, shared: &Arc<Shared>) -> Result<Self, MapError> {
        Ok(Self::new(Document::open(path)?, shared))
    }

    /// The name of the map's file without its extension, for the tab.
    pub fn title(&self) -> String {
        if let Some(inside) = &self.inside {
            return format!("\u{25b8} {}", inside.name);
        }
        let stem = self.document.path().and_then(Path::file_stem);
        match (stem, self.number) {
            (Some(stem), _) => stem.to_string_lossy().into_owned(),
            (None, 1) => "untitled".to_owned(),
            (None, number) => format!("untitled {number}"),
        }
    }

    /// The folder that the map's input paths are relative to.
    pub fn folder(&self) -> PathBuf {
        match self.inside {
            Some(_) => self.around_folder.clone(),
            None => self.document.folder(),
        }
    }

    /// Takes over what is known around a map inside of another one.
    pub fn set_around(&mut self, registry: Registry, folder: PathBuf) {
        (self.around, self.around_folder) = (registry, folder);
        self.checked = None;
        self.find_maps();
        self.lay_out();
    }

    /// The panel of its programs, and what it shows.
    pub fn programs<'a>(
        &'a mut self,
        shared: &'a Shared,
    ) -> (&'a mut ProgramPanel, ProgramScene<'a>) {
        let folder = self.folder();
        let Self { document, runner, programs, allowed, .. } = self;
        let map = document.map();
        let scene = ProgramScene {
            folder,
            map,
            map_file: document.path(),
            registry: runner.registry(),
            output_folder: &shared.output_folder,
            allowed,
            counts: Box::new(|node| counts_in(&runner.inputs(map, node))),
        };
        (programs, scene)
    }

    /// How many of each kind of elements there are in what a node takes.
    pub fn counts(&self, node: &str) -> Counts {
        counts_in(&self.runner.inputs(self.document.map(), node))
    }

    /// The map as the runner takes it.
    pub fn subject(&self) -> Subject {
        Subject {
            map: Arc::clone(self.document.map()),
            revision: self.document.revision(),
            folder: self.folder(),
            registry: self.runner.registry().clone(),
            allowed: Arc::clone(&self.allowed),
            asks: true,
        }
    }

    /// Whether a run of the map asks a person for leave before it begins.
    pub fn asks_first(&self) -> bool {
        !self.runner.checked().unasked.is_empty()
    }

    /// Lets outside programs run that a person has seen, from now on.
    pub fn allow_commands(&mut self, lines: impl Iterator<Item = String>) {
        Arc::make_mut(&mut self.allowed).extend(lines);
        self.check_again();
    }

    /// Forgets what was allowed: the map's file has become another one.
    pub fn forget_allowed(&mut self) {
        self.allowed = Arc::default();
    }

    /// Runs a part of the map without the outside programs that nobody has allowed.
    pub fn run_without_commands(&mut self, part: Part) {
        self.run_for = Some(self.document.revision());
        self.runner.run(Subject { asks: false, ..self.subject() }, part);
    }

    /// Whether the map is a part of another one, without which nothing of it runs.
    pub fn is_part(&self) -> bool {
        self.runner.checked().is_part
    }

    /// Runs a part of the map.
    pub fn run(&mut self, part: Part) {
        self.run_for = Some(self.document.revision());
        self.runner.run(self.subject(), part);
    }

    /// Takes in what the threads have told, and has changes checked and, if asked for, run.
    pub fn update(&mut self, runs_on_edit: bool) {
        if self.runner.take_in() {
            self.pin_something();
        }
        if let Some((commands, part)) = self.runner.take_question() {
            self.question = Some(CommandQuestion { commands, run: WaitingRun::Map(part) });
        }
        self.programs.take_in();
        for (is_trouble, text) in self.programs.take_messages() {
            let loudness = if is_trouble { Loudness::Error } else { Loudness::Note };
            self.runner.log.add(Line::of(None, loudness, text));
        }
        let revision = self.document.revision();
        if self.checked != Some(revision) {
            self.checked = Some(revision);
            self.find_maps();
            self.runner.forget_all_but(self.document.map());
            self.runner.check(self.subject());
        }
        let has_settled = self.runner.checked().revision == revision;
        if runs_on_edit && has_settled && self.run_for != Some(revision) {
            self.run_changes();
        }
    }

    /// Looks which maps its map names, and what they are as nodes.
    fn find_maps(&mut self) {
        let registry = self.around.with_maps_of(self.document.map(), &self.folder());
        self.catalog = Catalog::new(&registry);
        self.runner.set_registry(registry);
    }

    /// Runs what a change has made old. A run for an older state of the map gives way; one that a
    /// person asked for goes on to its end.
    fn run_changes(&mut self) {
        if self.runner.is_running() && !self.runner.is_overtaken() {
            return;
        }
        // A note or a move makes nothing old; what writes files waits for a person.
        match self.runner.is_running() || self.has_changes_to_run() == Some(false) {
            true => self.run(Part::Quiet),
            false => self.run_for = Some(self.document.revision()),
        }
    }

    /// Has the map checked again, for files that it reads may have changed.
    pub fn check_again(&mut self) {
        self.checked = None;
    }

    /// The first node that was stopped before it was done, and has no value since.
    pub fn first_stopped(&self) -> Option<&str> {
        let mut nodes = self.document.map().nodes.keys();
        nodes.find(|name| self.runner.status(name) == Status::Stopped).map(String::as_str)
    }

    /// Whether some node's outputs are not those of the map as it stands, and if so, whether all
    /// such nodes write files.
    pub fn has_changes_to_run(&self) -> Option<bool> {
        let is_old = |name: &str| matches!(self.runner.status(name), Status::New | Status::Dirty);
        let writes = |node: &Node| self.runner.registry().writes_files(node);
        let nodes = self.document.map().nodes.iter();
        let old = nodes.filter(|(name, node)| node.mode == NodeMode::Active && is_old(name));
        old.map(|(_, node)| writes(node)).reduce(|all, writes| all && writes)
    }

    /// The first node of the map that failed, and its error.
    pub fn first_failure(&self) -> Option<(&str, String)> {
        self.document.map().nodes.keys().find_map(|name| match self.runner.status(name) {
            Status::Failed(error) => Some((name.as_str(), error)),
            _ => None,
        })
    }

    /// After a first run something is to be seen at once: the last thing of the kind that is most
    /// worth looking at.
    fn pin_something(&mut self) {
        if !self.pinned.is_empty() {
            return;
        }
        let mut values = Vec::new();
        for (name, node) in self.runner.all_ended() {
            // What is inside of a map is looked at there.
            if !self.document.map().nodes.contains_key(name) {
                continue;
            }
            let outputs = node.names.iter().zip(&node.outputs);
            for (output, value) in outputs.filter(|(_, value)| !self.viewer.is_empty(value)) {
                let port = PortRef { node: name.to_owned(), port: (*output).to_owned() };
                values.push((port, value));
            }
        }
        // Meshes, which the work is about, else the kind of the largest value; of that kind what
        // was made last. So pictures that compare pictures are not what is seen first.
        let mesh = values.iter().find(|(_, value)| value.get::<TriMesh>().is_some());
        let largest = values.iter().max_by_key(|(_, value)| value.byte_size());
        let kind = mesh
            .or(largest)
            .filter(|(_, value)| value.scalar().is_none())
            .map(|(_, value)| value.data_type());
        let best = values.iter().rev().find(|(_, value)| Some(value.data_type()) == kind);
        let best = best.map(|(port, _)| port.clone());
        self.pinned.extend(best);
    }

    /// Shows an output, or no longer.
    pub fn toggle_pin(&mut self, port: PortRef) {
        if !self.pinned.shift_remove(&port) {
            self.pinned.insert(port);
        }
    }

    /// What the viewer shows.
    pub fn pinned_values(&self) -> Vec<Pinned> {
        let value_of = |port: &PortRef| self.runner.value(&port.node, &port.port);
        let state_of = |port: &PortRef| match self.runner.status(&port.node) {
            Status::Done(_) | Status::Cached(_) => PortState::Ready,
            _ if value_of(port).is_some() => PortState::Outdated,
            status => PortState::Absent(status.explanation()),
        };
        let pinned = |port: &PortRef| {
            let title = port.to_string();
            let Some(from) = self.runner.source(self.document.map(), port) else {
                let state = PortState::Absent(self.runner.status(&port.node).explanation());
                return Pinned { title, state, ..Pinned::default() };
            };
            let value = value_of(&from);
            let mesh = value.as_ref().and_then(|value| self.mesh_of(&from.node, value));
            Pinned { title, value, state: state_of(&from), mesh }
        };
        self.pinned.iter().map(pinned).collect()
    }

    /// The mesh that a field of a node is over: the first that it fits of those that the node takes
    /// and gives.
    fn mesh_of(&self, node: &str, field: &Value) -> Option<Arc<TriMesh>> {
        let field = field.get::<Field>()?;
        let inputs = self.runner.inputs(self.document.map(), node);
        let outputs = self.runner.ended(node).map_or(&[][..], |ended| &ended.outputs);
        let mut meshes = inputs.iter().chain(outputs).filter_map(Value::get::<TriMesh>);
        meshes.find(|mesh| field.check_fits(mesh).is_ok())
    }

    /// The value that goes out of a port: what passes through where its node is bypassed.
    pub fn value_out_of(&self, port: &PortRef) -> Option<Value> {
        self.runner.value_out_of(self.document.map(), port)
    }

    /// Takes over a node's new name.
    pub fn rename(&mut self, from: &str, to: &str) {
        self.runner.rename(from, to);
        let renamed = |port: &PortRef| match port.node == from {
            true => PortRef { node: to.to_owned(), port: port.port.clone() },
            false => port.clone(),
        };
        self.pinned = self.pinned.iter().map(renamed).collect();
    }

    /// Takes off pins of nodes and ports that are no longer there, and puts those back whose nodes
    /// have come back.
    pub fn prune_pins(&mut self) {
        self.find_maps();
        let registry = self.runner.registry();
        let map = self.document.map();
        let is_there = |port: &PortRef| {
            let module = map.nodes.get(&port.node).and_then(|node| registry.of(node));
            module.is_some_and(|info| {
                info.module.outputs.iter().any(|output| output.name == port.port)
            })
        };
        let all = self.pinned.drain(..).chain(self.lost_pins.drain(..));
        (self.pinned, self.lost_pins) = all.partition(is_there);
    }
}

/// How many of each kind of elements there are in some values.
fn counts_in(values: &[Value]) -> Counts {
    values.iter().flat_map(counts_of).collect()
}
