//! The program of a map as a table to edit, to run and to watch.
//!
//! The panel owns no program: it shows the one of the map that it is given, and hands changes back
//! as [`ProgramAction`]s. Checks and runs happen on threads; what they find is taken in once a
//! frame by [`ProgramPanel::take_in`]. The store of a program is the one that `mve program` would
//! take, so either goes on where the other stopped.

mod results;
mod run;
mod setup;
mod show;
mod widgets;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use indexmap::IndexMap;
use mve_core::{
    Map, ParamSpec, Program, ProgramOutcome, ProgramSpec, Registry, Retry, Sharing, StepStatus,
};
use serde_json::Value as Json;

use results::sheet::{Records, Sheet, StepState};
use run::check::{ProgramCheck, ProgramSubject};
use run::job::{How, ProgramJob, RunningStep};
pub use run::pace::in_words;

use crate::forms::Counts;

/// Pause between two drawings of the results while steps end.
const REFRESH: Duration = Duration::from_millis(200);

/// Asks the window to draw itself again; called from any thread.
type Wake = Arc<dyn Fn() + Send + Sync>;

/// What the panel shows.
pub struct ProgramScene<'a> {
    /// The map. Another state of it is another `Arc`.
    pub map: &'a Arc<Map>,
    /// The folder that its input paths are relative to.
    pub folder: PathBuf,
    /// Its file; none before it has one.
    pub map_file: Option<&'a Path>,
    /// The modules.
    pub registry: &'a Registry,
    /// The folder of all results: `mve-out`, as for the command.
    pub output_folder: &'a Path,
    /// Outside programs that a person has seen and allowed.
    pub allowed: &'a BTreeSet<String>,
    /// How many of a unit there are in the inputs of a node: `("faces", 69451)`.
    pub counts: Box<dyn Fn(&str) -> Counts + 'a>,
}

impl ProgramScene<'_> {
    /// How many of what a parameter counts there are in the inputs of its node.
    fn counts_at(&self, path: &str, spec: Option<&ParamSpec>) -> Counts {
        // Of the others nothing can be suggested by a count.
        match spec.is_some_and(|spec| !spec.unit.is_empty()) {
            true => (self.counts)(path.split('.').next().unwrap_or_default()),
            false => Counts::new(),
        }
    }

    /// The folder of a program's results: the one that `mve program` takes by itself.
    fn store_folder(&self, program: &str) -> PathBuf {
        let stem = self.map_file.and_then(Path::file_stem);
        let stem = stem.map_or("map".into(), |stem| stem.to_string_lossy());
        let plain = |c: char| if c.is_control() || "/\\:*?\"<>|".contains(c) { '-' } else { c };
        let folder: String = format!("{stem}-{program}").chars().map(plain).collect();
        self.output_folder.join(folder)
    }
}

/// What the panel asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum ProgramAction {
    /// A program of the map is made, changed, or removed.
    SetProgram {
        /// Its name.
        name: String,
        /// The program; `None` removes it.
        spec: Option<ProgramSpec>,
    },
    /// A program gets another name.
    RenameProgram {
        /// Its name.
        name: String,
        /// The other one.
        to: String,
    },
    /// The parameters of one step are put into the map: node, dotted path within the node, value.
    /// They stand in the order in which they must be set. The path `module` stands for the module
    /// of the node, as in programs; [`mve_core::assign`] understands all of them.
    LoadStep(Vec<(String, String, Json)>),
    /// A file or folder is to be opened by the system.
    OpenFile(PathBuf),
    /// A node is to be shown.
    ShowNode(String),
    /// A run wants leave for these outside programs, each with its node.
    AllowCommands(BTreeSet<(String, String)>, Retry),
}

/// What the threads tell.
enum ProgramMessage {
    Checked(Box<ProgramCheck>),
    /// A run is over; with its report, if one was to be written.
    Finished(Result<(ProgramOutcome, Option<Result<PathBuf, String>>), String>),
    /// The report was written because a person wants to read it.
    Reported(Result<PathBuf, String>),
}

/// The panel of one map.
pub struct ProgramPanel {
    wake: Wake,
    inbox: Receiver<ProgramMessage>,
    outbox: Sender<ProgramMessage>,
    /// The program that is shown, if a person chose one.
    chosen: Option<String>,
    /// How the next run is to go.
    how: How,
    job: Option<ProgramJob>,
    running: IndexMap<usize, RunningStep>,
    /// What is asked to be checked, and what a thread is at.
    to_check: Option<ProgramSubject>,
    being_checked: Option<ProgramSubject>,
    checked: Option<ProgramCheck>,
    records: Records,
    sheet: Sheet,
    /// When the sheet was made, and whether more is known since.
    sheet_made: Instant,
    is_sheet_stale: bool,
    /// What came of the last run, or other news in a line.
    note: Option<Notice>,
    /// The same, for the log.
    said: Vec<(bool, String)>,
    /// What is to be asked for when the panel is shown next.
    waiting: Vec<ProgramAction>,
    bar: run::bar::BarState,
    setup: setup::SetupState,
    table: results::table::TableState,
    plot: results::plot::PlotState,
    view: show::PanelTab,
}

/// A line of news.
struct Notice {
    text: String,
    is_trouble: bool,
}

impl ProgramPanel {
    /// A panel that has run nothing. `wake` asks the window to draw itself again.
    pub fn new(wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let (outbox, inbox) = channel();
        Self {
            wake,
            inbox,
            outbox,
            chosen: None,
            how: How::default(),
            job: None,
            running: IndexMap::new(),
            to_check: None,
            being_checked: None,
            checked: None,
            records: Records::new(),
            sheet: Sheet::default(),
            sheet_made: Instant::now(),
            is_sheet_stale: false,
            note: None,
            said: Vec::new(),
            waiting: Vec::new(),
            bar: run::bar::BarState::default(),
            setup: setup::SetupState::default(),
            table: results::table::TableState::default(),
            plot: results::plot::PlotState::default(),
            view: show::PanelTab::default(),
        }
    }

    /// Whether a program runs, or is paused.
    pub fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Whether some step of the shown program has ended.
    pub fn has_results(&self) -> bool {
        self.sheet
            .rows
            .iter()
            .any(|row| matches!(row.state, StepState::Done | StepState::Failed(_)))
    }

    /// Stops what runs; finished steps are kept.
    pub fn stop(&mut self) {
        if let Some(job) = &self.job {
            job.stop();
        }
    }

    /// Takes in what the threads have told since the last call.
    pub fn take_in(&mut self) {
        self.hear_job();
        while let Ok(message) = self.inbox.try_recv() {
            match message {
                ProgramMessage::Checked(checked) => self.hear_check(*checked),
                ProgramMessage::Finished(outcome) => {
                    self.hear_job();
                    self.finish(outcome);
                }
                ProgramMessage::Reported(Ok(page)) => {
                    self.waiting.push(ProgramAction::OpenFile(page))
                }
                ProgramMessage::Reported(Err(error)) => {
                    self.complain(format!("no report: {error}"))
                }
            }
        }
        if self.is_sheet_stale && self.sheet_made.elapsed() >= REFRESH {
            self.make_sheet();
        }
    }

    fn hear_job(&mut self) {
        let Some(job) = &self.job else { return };
        let (ended, running) = job.news();
        let places =
            |steps: &IndexMap<usize, RunningStep>| steps.keys().copied().collect::<Vec<_>>();
        self.is_sheet_stale |= !ended.is_empty() || places(&running) != places(&self.running);
        self.running = running;
        self.records.extend(ended.into_iter().map(|record| (record.id.clone(), record)));
    }

    fn hear_check(&mut self, checked: ProgramCheck) {
        self.being_checked = None;
        let found = checked.records.iter();
        self.records.extend(found.map(|record| (record.id.clone(), Arc::clone(record))));
        self.checked = Some(checked);
        self.make_sheet();
        self.check_next();
    }

    fn finish(
        &mut self,
        outcome: Result<(ProgramOutcome, Option<Result<PathBuf, String>>), String>,
    ) {
        let paused = self.job.take().map_or(Duration::ZERO, |job| job.paused_for());
        self.running.clear();
        // What became of single steps, the store knows best.
        self.checked = None;
        match outcome {
            Err(error) => self.complain(error),
            Ok((_, Some(Err(error)))) => self.complain(format!("no report: {error}")),
            Ok((outcome, _)) => {
                let ProgramOutcome { ran, failed, missing, seconds, .. } = outcome;
                let seconds = (seconds - paused.as_secs_f64()).max(0.0);
                let time = in_words(Duration::from_secs_f64(seconds));
                let mut text = format!("{} run in {time}", widgets::count(ran, "step"));
                if failed > 0 {
                    text.push_str(&format!(", {failed} failed"));
                }
                if missing > 0 {
                    text.push_str(&format!(", {missing} to do"));
                }
                self.tell(text, failed > 0);
            }
        }
        self.make_sheet();
    }

    fn complain(&mut self, text: String) {
        self.tell(text, true);
    }

    fn tell(&mut self, text: String, is_trouble: bool) {
        let program = self.sheet.program.as_ref().map_or("", |program| program.name.as_str());
        self.said.push((is_trouble, format!("program {program}: {text}")));
        self.note = Some(Notice { text, is_trouble });
    }

    /// What was said since the last call, for the log, and whether it is trouble.
    pub fn take_messages(&mut self) -> Vec<(bool, String)> {
        std::mem::take(&mut self.said)
    }

    /// Makes the table of results anew from what is known.
    fn make_sheet(&mut self) {
        self.is_sheet_stale = false;
        self.sheet_made = Instant::now();
        let Some(program) = self.shown_program().or_else(|| self.sheet.program.clone()) else {
            return;
        };
        let is_of_job = self.job.as_ref().is_some_and(|job| Arc::ptr_eq(&job.program, &program));
        let running = &self.running;
        let is_running = |place: usize| is_of_job && running.contains_key(&place);
        self.sheet = Sheet::new(&program, &self.records, is_running);
    }

    /// The program whose results are shown: the one that runs, if it is the chosen one.
    fn shown_program(&self) -> Option<Arc<Program>> {
        let checked = self.checked.as_ref().and_then(|checked| checked.program.clone());
        let name = checked.as_ref().map(|program| program.name.as_str()).or(self.chosen.as_deref());
        let of_job = self.job.as_ref().map(|job| &job.program);
        let of_job = of_job.filter(|program| name.is_none_or(|name| name == program.name));
        of_job.cloned().or(checked)
    }

    /// The name of the program that is shown.
    fn name<'a>(&'a self, map: &'a Map) -> Option<&'a str> {
        let chosen = self.chosen.as_deref().filter(|name| map.programs.contains_key(*name));
        chosen.or_else(|| map.programs.keys().next().map(String::as_str))
    }

    fn subject(&self, scene: &ProgramScene) -> Option<ProgramSubject> {
        let name = self.name(scene.map)?.to_owned();
        Some(ProgramSubject {
            map: Arc::clone(scene.map),
            folder: scene.folder.clone(),
            map_file: scene.map_file.map(Path::to_owned),
            registry: scene.registry.clone(),
            store: scene.store_folder(&name),
            name,
        })
    }

    /// Has the program checked, unless that was done.
    fn keep_checked(&mut self, scene: &ProgramScene) {
        let Some(subject) = self.subject(scene) else {
            (self.checked, self.sheet) = (None, Sheet::default());
            return;
        };
        let last = self.to_check.as_ref().or(self.being_checked.as_ref());
        let last = last.or(self.checked.as_ref().map(|checked| &checked.subject));
        if last.is_none_or(|last| !last.asks_the_same_as(&subject)) {
            self.to_check = Some(subject);
            self.check_next();
        }
    }

    fn check_next(&mut self) {
        if self.being_checked.is_some() {
            return;
        }
        let Some(subject) = self.to_check.take() else { return };
        self.being_checked = Some(subject.clone());
        let (outbox, wake) = (self.outbox.clone(), Arc::clone(&self.wake));
        std::thread::spawn(move || {
            // The window may be gone; then nobody needs to know.
            let _ = outbox.send(ProgramMessage::Checked(Box::new(run::check::check(subject))));
            wake();
        });
    }

    /// The program as it was checked, if that is how the map has it.
    fn sound_program(&self, scene: &ProgramScene) -> Option<(Arc<Program>, PathBuf)> {
        let checked = self.checked.as_ref()?;
        let is_fresh = self.subject(scene)?.asks_the_same_as(&checked.subject);
        let program = checked.program.clone().filter(|_| is_fresh)?;
        Some((program, checked.subject.store.clone()))
    }

    /// Starts to run the steps that the store does not have, or asks whether their outside programs
    /// may run.
    pub fn run(&mut self, scene: &ProgramScene, retry: Retry) {
        let Some((program, store)) = self.sound_program(scene).filter(|_| self.job.is_none())
        else {
            return;
        };
        let lines = program.command_lines.iter();
        let unasked = lines.filter(|(_, line)| !scene.allowed.contains(line)).cloned();
        let unasked: BTreeSet<_> = unasked.collect();
        if !unasked.is_empty() {
            self.waiting.push(ProgramAction::AllowCommands(unasked, retry));
            return;
        }
        let how = How { retry, ..self.how };
        let timings = (how.sharing == Sharing::Timing).then_some(mve_core::TIMINGS);
        let requirement = mve_core::Requirement::of(&program, timings);
        for step in &program.steps {
            let runs_again = self.records.get(&step.id).is_some_and(|record| {
                (retry == Retry::Failed && record.status != StepStatus::Done)
                    || !requirement.is_met_by(record)
            });
            if runs_again {
                self.records.remove(&step.id);
            }
        }
        let (outbox, wake) = (self.outbox.clone(), Arc::clone(&self.wake));
        self.note = None;
        self.job = Some(ProgramJob::start(program, store, how, outbox, wake));
        self.make_sheet();
    }

    /// Writes the report of a store on a thread, and asks to open it.
    fn open_report(&self, store: PathBuf) {
        let (outbox, wake) = (self.outbox.clone(), Arc::clone(&self.wake));
        std::thread::spawn(move || {
            let _ = outbox.send(ProgramMessage::Reported(run::job::write_report(&store)));
            wake();
        });
    }

    /// Makes a parameter an axis of the shown program, with its value in the map and a second one
    /// worth comparing; a parameter that is varied already gets one more value.
    pub fn vary(&mut self, node: &str, param: &str, scene: &ProgramScene) -> Vec<ProgramAction> {
        let path = format!("{node}.{param}");
        let name = match self.name(scene.map) {
            Some(name) => name.to_owned(),
            None => fresh_name(scene.map, "sweep"),
        };
        let mut spec = scene.map.programs.get(&name).cloned().unwrap_or_default();
        setup::axis::vary(&path, scene, &spec).apply(&mut spec);
        self.chosen = Some(name.clone());
        vec![ProgramAction::SetProgram { name, spec: Some(spec) }]
    }
}

/// A name that no program of the map has.
fn fresh_name(map: &Map, wish: &str) -> String {
    let numbered = (2..).map(|n| format!("{wish} {n}"));
    let mut names = std::iter::once(wish.to_owned()).chain(numbered);
    names.find(|name| !map.programs.contains_key(name)).unwrap_or_default()
}

/// The parameters of a step in the order in which they are to be set: modules first, and a choice
/// before what stands under it.
fn load_step(step: &mve_core::Step) -> ProgramAction {
    let mut params: Vec<(String, String, Json)> = step
        .params
        .iter()
        .filter_map(|(path, value)| {
            let (node, param) = path.split_once('.')?;
            Some((node.to_owned(), param.to_owned(), value.clone()))
        })
        .collect();
    params.sort_by_key(|(_, param, _)| (param != "module", param.split('.').count()));
    ProgramAction::LoadStep(params)
}

#[cfg(test)]
mod tests;
