//! Progress and cancellation of a long computation.
//!
//! An algorithm that loops takes a [`Control`] and calls [`Control::at`] every few milliseconds,
//! from any thread. Whoever called it sees how far the work is and may end it. In a module,
//! [`Io::control`](crate::Io::control) is that of the run.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use thiserror::Error;

use crate::cancel::CancelToken;

/// The caller ended the computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Hears what a module says while it runs, from any of its threads.
pub trait Reporter: Sync {
    /// The share of the work that is done, 0 to 1.
    fn progress(&self, share: f64);
    /// A line for the log.
    fn log(&self, line: &str);
    /// Trouble that does not stop the module.
    fn warn(&self, line: &str);
    /// A part of the work is done and took so many seconds.
    fn phase(&self, _name: &'static str, _seconds: f64) {}
}

/// The caller's callback: it is told the done fraction, 0 to 1, and says whether to go on.
///
/// With several threads fractions may arrive out of order.
pub type Report<'a> = &'a (dyn Fn(f64) -> ControlFlow<()> + Sync);

/// Whom to tell of progress and to ask whether to go on, and the part of the whole work that this
/// computation is.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    caller: Caller<'a>,
    start: f64,
    end: f64,
}

#[derive(Clone, Copy)]
enum Caller<'a> {
    Callback(Report<'a>),
    Run { reporter: &'a dyn Reporter, cancel: &'a CancelToken },
}

impl<'a> Control<'a> {
    /// The whole work, reported to `report`.
    pub fn new(report: Report<'a>) -> Self {
        Self { caller: Caller::Callback(report), start: 0.0, end: 1.0 }
    }

    /// The whole work of a module.
    pub(crate) fn of_run(reporter: &'a dyn Reporter, cancel: &'a CancelToken) -> Self {
        Self { caller: Caller::Run { reporter, cancel }, start: 0.0, end: 1.0 }
    }

    /// Never reports and never ends the work.
    pub fn none() -> Control<'static> {
        Control::new(&|_| ControlFlow::Continue(()))
    }

    /// The share of this work from fraction `start` to fraction `end`.
    pub fn part(&self, start: f64, end: f64) -> Self {
        let width = self.end - self.start;
        Self {
            caller: self.caller,
            start: self.start + width * start,
            end: self.start + width * end,
        }
    }

    /// Reports that `fraction` of this work is done.
    pub fn at(&self, fraction: f64) -> Result<(), Cancelled> {
        let share = self.start + (self.end - self.start) * fraction;
        let goes_on = match self.caller {
            Caller::Callback(report) => report(share).is_continue(),
            Caller::Run { reporter, cancel } => {
                reporter.progress(share);
                !cancel.is_cancelled()
            }
        };
        if goes_on { Ok(()) } else { Err(Cancelled) }
    }

    /// To be called with every item of a loop over `n`: reports every 8192nd of them.
    #[inline]
    pub fn item(&self, place: usize, n: usize) -> Result<(), Cancelled> {
        const PAUSE: usize = 1 << 13;
        if place.is_multiple_of(PAUSE) { self.at(place as f64 / n.max(1) as f64) } else { Ok(()) }
    }

    /// A counter over `n_steps` equal steps that any thread may take.
    pub fn steps(self, n_steps: usize) -> Steps<'a> {
        Steps { control: self, n_steps, done: AtomicUsize::new(0) }
    }
}

/// Counts steps done on any thread and reports each.
pub struct Steps<'a> {
    control: Control<'a>,
    n_steps: usize,
    done: AtomicUsize,
}

impl Steps<'_> {
    /// One more step is done.
    pub fn step(&self) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.control.at(done as f64 / self.n_steps.max(1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn parts_report_their_share_of_the_whole() {
        let seen = Mutex::new(Vec::new());
        let report = |fraction: f64| {
            seen.lock().unwrap().push(fraction);
            ControlFlow::Continue(())
        };
        let steps = Control::new(&report).part(0.5, 1.0).part(0.0, 0.5).steps(2);
        steps.step().unwrap();
        steps.step().unwrap();
        assert_eq!(*seen.lock().unwrap(), [0.625, 0.75]);
    }

    #[test]
    fn a_break_ends_the_work() {
        let control = Control::new(&|_| ControlFlow::Break(()));
        assert_eq!(control.at(0.0), Err(Cancelled));
    }
}
