//! One run of a program, on a thread of its own.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indexmap::IndexMap;
use mve_core::{
    CancelToken, EventKind, Machine, Part, Patience, Program, ProgramEvent, ProgramOptions,
    ProgramOutcome, Retry, Sharing, StepRecord, Store, run_program,
};
use mve_report::{Format, Report};

use super::check::of_other_map;
use crate::programs::{ProgramMessage, Wake};

/// The report's name in a store, as `mve program` has it.
pub const PAGE: &str = "report.html";

/// Memory where the machine does not say how much it has.
const SOME_MEMORY: usize = 4 << 30;

/// How a program is to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct How {
    /// Steps that run at once.
    pub jobs: usize,
    /// Whether steps share their work.
    pub sharing: Sharing,
    /// What becomes of steps that failed before.
    pub retry: Retry,
}

impl Default for How {
    fn default() -> Self {
        Self { jobs: threads(), sharing: Sharing::Shared, retry: Retry::Nothing }
    }
}

/// How many threads the machine offers.
pub fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// A step that runs.
#[derive(Clone, Debug)]
pub struct RunningStep {
    /// When it began.
    pub since: Instant,
    /// The node that it is at.
    pub node: String,
    /// How far that node is, 0 to 1.
    pub share: Option<f64>,
}

/// What has happened since the window looked last. It is shared and not sent, so that a window that
/// draws no frames, such as a hidden one, does not let messages pile up.
#[derive(Default)]
pub struct News {
    /// Steps that run, by place.
    pub running: IndexMap<usize, RunningStep>,
    /// Steps that have ended.
    pub ended: Vec<Arc<StepRecord>>,
    /// Since when no new step may start.
    paused_since: Option<Instant>,
    /// How long that was so before.
    paused: Duration,
}

/// A program under way.
pub struct ProgramJob {
    /// What runs.
    pub program: Arc<Program>,
    /// How.
    pub how: How,
    cancel: CancelToken,
    shared: Arc<(Mutex<News>, Condvar)>,
}

impl ProgramJob {
    /// Starts to run a program into a folder. The last message is [`ProgramMessage::Finished`].
    pub fn start(
        program: Arc<Program>,
        folder: PathBuf,
        how: How,
        outbox: Sender<ProgramMessage>,
        wake: Wake,
    ) -> Self {
        let job = Self { program, how, cancel: CancelToken::new(), shared: Arc::default() };
        let (program, cancel) = (Arc::clone(&job.program), job.cancel.clone());
        let shared = Arc::clone(&job.shared);
        std::thread::spawn(move || {
            let outcome = run_into(&program, &folder, how, &cancel, &shared, &wake);
            let outcome = outcome.map(|outcome| {
                // Whoever stops a program wants it to stop; the report can be asked for.
                let report = (!outcome.is_stopped).then(|| write_report(&folder));
                (outcome, report)
            });
            // The window may be gone; then nobody needs to know.
            let _ = outbox.send(ProgramMessage::Finished(outcome));
            wake();
        });
        job
    }

    /// What has ended since the last call, and what runs.
    pub fn news(&self) -> (Vec<Arc<StepRecord>>, IndexMap<usize, RunningStep>) {
        let mut news = lock(&self.shared.0);
        (std::mem::take(&mut news.ended), news.running.clone())
    }

    /// Lets no new step start, or lets them start again. Steps that run come to their end.
    pub fn pause(&self, is_paused: bool) {
        let mut news = lock(&self.shared.0);
        let before = news.paused_since.take();
        news.paused += before.map_or(Duration::ZERO, |since| since.elapsed());
        news.paused_since = is_paused.then(Instant::now);
        self.shared.1.notify_all();
    }

    /// For how long new steps have waited in all.
    pub fn paused_for(&self) -> Duration {
        let news = lock(&self.shared.0);
        news.paused + news.paused_since.map_or(Duration::ZERO, |since| since.elapsed())
    }

    /// Whether new steps wait.
    pub fn is_paused(&self) -> bool {
        lock(&self.shared.0).paused_since.is_some()
    }

    /// Stops: steps that run are given up, finished ones are kept.
    pub fn stop(&self) {
        self.cancel.cancel();
        self.shared.1.notify_all();
    }

    /// Whether it was asked to stop.
    pub fn is_stopping(&self) -> bool {
        self.cancel.is_cancelled()
    }
}

impl Drop for ProgramJob {
    fn drop(&mut self) {
        self.stop();
    }
}

fn lock(news: &Mutex<News>) -> MutexGuard<'_, News> {
    news.lock().unwrap_or_else(PoisonError::into_inner)
}

fn run_into(
    program: &Program,
    folder: &Path,
    how: How,
    cancel: &CancelToken,
    shared: &(Mutex<News>, Condvar),
    wake: &Wake,
) -> Result<ProgramOutcome, String> {
    let store = Store::open(folder).map_err(|error| error.to_string())?;
    if let Some(trouble) = of_other_map(program, &store) {
        return Err(trouble);
    }
    let memory = match Machine::this().memory {
        0 => SOME_MEMORY,
        bytes => usize::try_from(bytes).unwrap_or(usize::MAX),
    };
    // As `mve program` does it: a value that takes long is there in the next run.
    let is_shared = how.sharing == Sharing::Shared;
    let disk_cache = is_shared.then(|| store.disk_cache(None)).transpose();
    let disk_cache = disk_cache.map_err(|error| error.to_string())?;
    let options = ProgramOptions {
        jobs: how.jobs,
        threads: threads(),
        part: Part::default(),
        sharing: how.sharing,
        timings: mve_core::TIMINGS,
        memory: memory / 2,
        disk_cache,
        time_limit: None,
        retry: how.retry,
        patience: Patience::None,
        cancel,
        observer: &|event| {
            hear(event, shared, cancel);
            wake();
        },
    };
    run_program(program, &store, &options).map_err(|error| error.to_string())
}

/// Takes an event in. A step that is about to start waits here while the program is paused: its
/// time has not begun, and only its claim is taken.
fn hear(event: &ProgramEvent, (news, changed): &(Mutex<News>, Condvar), cancel: &CancelToken) {
    let mut news = lock(news);
    match event {
        ProgramEvent::Began { .. } | ProgramEvent::StepFound { .. } => {}
        ProgramEvent::StepStarted { place, .. } => {
            while news.paused_since.is_some() && !cancel.is_cancelled() {
                let waited = changed.wait_timeout(news, Duration::from_millis(100));
                news = waited.map_or_else(|poisoned| poisoned.into_inner().0, |(news, _)| news);
            }
            let step = RunningStep { since: Instant::now(), node: String::new(), share: None };
            news.running.insert(*place, step);
        }
        ProgramEvent::Node { place, node_event } => {
            let Some(step) = news.running.get_mut(place) else { return };
            match node_event.kind {
                EventKind::Started => (step.node, step.share) = (node_event.node.to_owned(), None),
                EventKind::Progress { share } => step.share = Some(share),
                _ => {}
            }
        }
        ProgramEvent::StepEnded { place, record } => {
            news.running.shift_remove(place);
            news.ended.push(Arc::new((*record).clone()));
        }
    }
}

/// Writes the page of a store, as `mve program` does at its end, and says where it is.
pub fn write_report(folder: &Path) -> Result<PathBuf, String> {
    let report = Report::read(folder).map_err(|error| error.to_string())?;
    let page = folder.join(PAGE);
    let fail = |error: std::io::Error| format!("{}: {error}", page.display());
    let text = report.text(Format::Html, Some(folder));
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What the user's mask leaves of it, unlike the owner-only default of temporary files.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut fresh = builder.prefix(".tmp").tempfile_in(folder).map_err(fail)?;
    fresh.write_all(text.as_bytes()).map_err(fail)?;
    fresh.as_file().sync_all().map_err(fail)?;
    fresh.persist(&page).map_err(|error| fail(error.error))?;
    Ok(page)
}
