//! What a person sees while nodes or steps run: live bars on a terminal, plain lines elsewhere.
//!
//! Events only change a small model; one thread draws it a few times a second, so that a thousand
//! steps a second cost nothing and what is over at once never flickers.

use std::io::IsTerminal;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indexmap::IndexMap;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::out;

/// Pause between two drawings.
const FRAME: Duration = Duration::from_millis(100);

/// What runs shorter is not drawn.
const WORTH_A_LINE: Duration = Duration::from_millis(150);

/// Without a terminal, what runs long says so this often.
const REMINDER: Duration = Duration::from_secs(60);

/// … and the first time after this.
const FIRST_REMINDER: Duration = Duration::from_secs(10);

/// Lines of running things that are drawn; more would push each other off the terminal.
const MOST_LINES: usize = 16;

/// The display. Clones are the same display.
#[derive(Clone)]
pub struct Progress(Arc<Inner>);

struct Inner {
    style: Style,
    unit: &'static str,
    multi: MultiProgress,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Style {
    Live,
    Plain,
    Quiet,
}

struct State {
    tasks: IndexMap<String, Task>,
    bar: Option<ProgressBar>,
    start: Instant,
    total: usize,
    /// Ended now or before.
    ended: usize,
    /// Ended before this call.
    found: usize,
    failed: usize,
    is_over: bool,
}

/// Something that runs.
struct Task {
    label: String,
    /// What it is at, such as a node of a step.
    at: String,
    share: Option<f64>,
    since: Instant,
    told: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// A display of `total` things, `found` of which are done. Without `is_shown` nothing is said
    /// but what [`Progress::say`] is given.
    pub fn new(unit: &'static str, total: usize, found: usize, is_shown: bool) -> Self {
        let is_dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let style = match is_shown {
            false => Style::Quiet,
            true if std::io::stderr().is_terminal() && !is_dumb => Style::Live,
            true => Style::Plain,
        };
        let target = match style {
            Style::Live => ProgressDrawTarget::stderr(),
            _ => ProgressDrawTarget::hidden(),
        };
        let state = State {
            tasks: IndexMap::new(),
            bar: None,
            start: Instant::now(),
            total,
            ended: found,
            found,
            failed: 0,
            is_over: false,
        };
        let multi = MultiProgress::with_draw_target(target);
        let (state, changed) = (Mutex::new(state), Condvar::new());
        Self(Arc::new(Inner { style, unit, multi, state, changed }))
    }

    /// Does `work` while the display is drawn; then the display goes away.
    pub fn watch<T>(&self, work: impl FnOnce() -> T) -> T {
        if self.0.style == Style::Quiet {
            return work();
        }
        std::thread::scope(|scope| {
            scope.spawn(|| self.draw());
            let _guard = Over(self);
            work()
        })
    }

    /// Something starts.
    pub fn start(&self, key: &str, label: String) {
        if self.0.style != Style::Quiet {
            let now = Instant::now();
            let at = String::new();
            let task = Task { label, at, share: None, since: now, told: now, bar: None };
            self.lock().tasks.insert(key.to_owned(), task);
        }
    }

    /// It is at `at`, and this far.
    pub fn update(&self, key: &str, at: &str, share: Option<f64>) {
        if self.0.style != Style::Quiet
            && let Some(task) = self.lock().tasks.get_mut(key)
        {
            if task.at != at {
                task.at = at.to_owned();
            }
            task.share = share;
        }
    }

    /// It has ended. Without a terminal, a line says so.
    pub fn end(&self, key: &str, is_failed: bool, line: impl FnOnce(usize, usize) -> String) {
        if self.0.style == Style::Quiet {
            return;
        }
        let mut state = self.lock();
        state.ended += 1;
        state.failed += usize::from(is_failed);
        let task = state.tasks.shift_remove(key);
        let (ended, total) = (state.ended, state.total);
        drop(state);
        if let Some(bar) = task.and_then(|task| task.bar) {
            self.0.multi.remove(&bar);
        }
        if self.0.style == Style::Plain {
            out::tell(&line(ended, total));
        }
    }

    /// Writes a line to standard error, above the bars.
    pub fn say(&self, line: &str) {
        self.0.multi.suspend(|| out::tell(line));
    }

    /// Does something that writes to standard output, with the bars out of its way.
    pub fn aside<T>(&self, write: impl FnOnce() -> T) -> T {
        self.0.multi.suspend(write)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Draws until all is over.
    fn draw(&self) {
        let mut state = self.lock();
        while !state.is_over {
            let waited = self.0.changed.wait_timeout(state, FRAME);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
            match self.0.style {
                Style::Live => self.draw_bars(&mut state),
                Style::Plain => remind(&mut state, self.0.unit),
                Style::Quiet => return,
            }
        }
    }

    fn draw_bars(&self, state: &mut State) {
        if state.is_over || state.start.elapsed() < WORTH_A_LINE {
            return;
        }
        let (ended, total, text) = (state.ended, state.total, state.summary(self.0.unit));
        let bar = state.bar.get_or_insert_with(|| {
            let style = style("{bar:24.cyan/dim} {msg}").progress_chars("━━─");
            self.0.multi.add(ProgressBar::new(total as u64).with_style(style))
        });
        bar.set_message(text);
        bar.set_position(ended as u64);
        let width = usize::from(console::Term::stderr().size().1).saturating_sub(20).max(20);
        let mut n_drawn = state.tasks.values().filter(|task| task.bar.is_some()).count();
        for task in state.tasks.values_mut() {
            if task.bar.is_none() && n_drawn < MOST_LINES && task.since.elapsed() >= WORTH_A_LINE {
                n_drawn += 1;
                let bar = ProgressBar::new(1000).with_elapsed(task.since.elapsed());
                task.bar = Some(self.0.multi.add(bar.with_style(spinner())));
            }
            if let Some(bar) = &task.bar {
                bar.set_prefix(clock(task.since.elapsed()));
                // A full line would be broken in two by the `^C` that terminals echo.
                let text = task.text();
                let text = mve_core::printable(&text);
                bar.set_message(console::truncate_str(&text, width, "…").into_owned());
                bar.tick();
            }
        }
    }
}

/// Ends the display, however the work ends.
struct Over<'a>(&'a Progress);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        let mut state = self.0.lock();
        state.is_over = true;
        let bars = state.tasks.values_mut().filter_map(|task| task.bar.take()).collect::<Vec<_>>();
        let total = state.bar.take();
        drop(state);
        bars.into_iter().chain(total).for_each(|bar| bar.finish_and_clear());
        self.0.0.changed.notify_all();
    }
}

impl State {
    fn summary(&self, unit: &str) -> String {
        let mut text = format!("{}/{} {unit}", self.ended, self.total);
        if self.failed > 0 {
            let failed = format!("{} failed", self.failed);
            text.push_str(&format!(" · {}", console::style(failed).for_stderr().red()));
        }
        text.push_str(&format!(" · {}", clock(self.start.elapsed())));
        let now = self.ended.saturating_sub(self.found);
        // The first few say little about the rest.
        if now >= 3 && self.total > self.ended && unit == "steps" {
            let left = self.start.elapsed().mul_f64((self.total - self.ended) as f64 / now as f64);
            text.push_str(&format!(" · about {} left", clock(left)));
        }
        text
    }
}

impl Task {
    fn text(&self) -> String {
        let mut text = self.label.clone();
        if !self.at.is_empty() {
            text.push_str(&format!(" · {}", self.at));
        }
        if let Some(share) = self.share {
            text.push_str(&format!(" · {:.0} %", share * 100.0));
        }
        text
    }
}

fn remind(state: &mut State, unit: &str) {
    let (ended, total) = (state.ended, state.total);
    for task in state.tasks.values_mut() {
        let is_first = task.told == task.since;
        if task.told.elapsed() >= if is_first { FIRST_REMINDER } else { REMINDER } {
            task.told = Instant::now();
            let (text, time) = (task.text(), clock(task.since.elapsed()));
            out::tell(&format!("running for {time}: {text} ({ended}/{total} {unit} ended)"));
        }
    }
}

fn spinner() -> ProgressStyle {
    style("  {spinner:.cyan} {prefix:>6}  {msg}")
}

/// A style from a template of this file.
fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// A duration for a display: `7 s`, `1:20`, `2:03:10`.
pub fn clock(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m}:{s:02}"),
        (h, m, s) => format!("{h}:{m:02}:{s:02}"),
    }
}

/// Seconds for a result: four digits that count, not below a millisecond.
pub fn seconds(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.3}"),
        s if s < 100.0 => format!("{s:.2}"),
        s => format!("{s:.1}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_well() {
        let clocks = [(7, "7 s"), (80, "1:20"), (7390, "2:03:10")];
        clocks.iter().for_each(|(s, text)| assert_eq!(clock(Duration::from_secs(*s)), *text));
        assert_eq!(seconds(0.00123), "0.001");
        assert_eq!(seconds(12.3456), "12.35");
    }

    #[test]
    fn templates_are_valid() {
        for template in ["{bar:24.cyan/dim} {msg}", "  {spinner:.cyan} {prefix:>6}  {msg}"] {
            assert!(ProgressStyle::with_template(template).is_ok());
        }
    }
}
