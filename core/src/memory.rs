//! A budget of memory that work which runs at once shares.
//!
//! Whoever is about to take much memory reserves it first, and waits while others hold so much that
//! it does not fit. Who holds a reservation never waits for another one, so somebody always goes
//! on; what is larger than the whole budget runs once nobody else holds any.

use std::fs;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::cancel::CancelToken;
use crate::control::Cancelled;

/// How long one that waits sleeps before it looks again: memory is given back without a word.
const PAUSE: Duration = Duration::from_millis(20);

/// Bytes of memory for work that runs at once.
#[derive(Debug)]
pub struct MemoryBudget {
    bytes: usize,
    /// Bytes that the process holds.
    resident: fn() -> Option<usize>,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    n_held: usize,
    /// Bytes of all that are held.
    held: usize,
    /// Bytes that the process had when the first of them was taken.
    before: usize,
}

/// Bytes that are set aside as long as this is there.
#[derive(Debug)]
pub(crate) struct Reservation<'a> {
    budget: &'a MemoryBudget,
    bytes: usize,
}

impl MemoryBudget {
    /// A budget of this many bytes, for the whole process.
    pub fn new(bytes: usize) -> Self {
        let (state, changed) = (Mutex::default(), Condvar::new());
        Self { bytes, resident: resident_bytes, state, changed }
    }

    /// Sets bytes aside; waits while they do not fit and somebody else holds some. What it waits
    /// puts the deadline of `cancel` off.
    pub(crate) fn reserve(
        &self,
        bytes: usize,
        cancel: &CancelToken,
    ) -> Result<Reservation<'_>, Cancelled> {
        let mut state = self.lock();
        while state.n_held > 0 && !self.has_room(&state, bytes) {
            if cancel.is_cancelled() {
                return Err(Cancelled);
            }
            let start = Instant::now();
            let waited = self.changed.wait_timeout(state, PAUSE);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
            cancel.put_off(start.elapsed());
        }
        if state.n_held == 0 {
            state.before = (self.resident)().unwrap_or(0);
        }
        state.n_held += 1;
        state.held = state.held.saturating_add(bytes);
        Ok(Reservation { budget: self, bytes })
    }

    /// Whether so many bytes fit beside what the process has now, and what it will have once all
    /// that is set aside is taken.
    fn has_room(&self, state: &State, bytes: usize) -> bool {
        let soon = state.before.saturating_add(state.held);
        let now = (self.resident)().unwrap_or(0);
        now.max(soon).saturating_add(bytes) <= self.bytes
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Reservation<'_> {
    fn drop(&mut self) {
        let mut state = self.budget.lock();
        state.n_held -= 1;
        state.held -= self.bytes.min(state.held);
        self.budget.changed.notify_all();
    }
}

/// Bytes of memory that the process holds; `None` where the system does not tell.
pub(crate) fn resident_bytes() -> Option<usize> {
    // The second number is the resident set, in pages. Pages are 4 KiB wherever it matters here;
    // larger ones make the estimate low, and the budget looser.
    let text = fs::read_to_string("/proc/self/statm").ok()?;
    text.split_whitespace().nth(1)?.parse::<usize>().ok().map(|pages| pages * 4096)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    /// The most reservations of so many bytes that four threads held at once, of a budget of 100
    /// in a process that has 10 already.
    fn most_at_once(bytes: usize) -> usize {
        let budget = MemoryBudget { resident: || Some(10), ..MemoryBudget::new(100) };
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    let _held = budget.reserve(bytes, &CancelToken::new()).unwrap();
                    let n = now.fetch_add(1, Ordering::SeqCst) + 1;
                    most.fetch_max(n, Ordering::SeqCst);
                    std::thread::sleep(Duration::from_millis(60));
                    now.fetch_sub(1, Ordering::SeqCst);
                });
            }
        });
        let State { n_held, held, .. } = *budget.lock();
        assert_eq!((n_held, held), (0, 0));
        most.into_inner()
    }

    #[test]
    fn as_many_run_at_once_as_fit_and_always_one() {
        assert_eq!(most_at_once(1000), 1);
        assert_eq!(most_at_once(46), 1);
        assert_eq!(most_at_once(45), 2);
        assert_eq!(most_at_once(1), 4);
    }

    #[test]
    fn memory_that_nobody_reserved_counts_too() {
        let budget = MemoryBudget { resident: || Some(80), ..MemoryBudget::new(100) };
        let state = State { n_held: 1, held: 10, before: 10 };
        assert!(budget.has_room(&state, 20) && !budget.has_room(&state, 21));
    }

    #[test]
    fn one_that_waits_hears_that_it_is_stopped() {
        let budget = MemoryBudget::new(0);
        let cancel = CancelToken::new();
        let first = budget.reserve(1, &cancel).unwrap();
        cancel.cancel();
        assert!(budget.reserve(1, &cancel).is_err());
        drop(first);
        assert!(budget.reserve(1, &cancel).is_ok());
    }
}
