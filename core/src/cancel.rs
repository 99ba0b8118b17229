//! The token that stops a run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Asks work to stop: by hand, at a deadline, or because the token that it was made from was
/// cancelled. Clones share their state.
#[derive(Clone, Debug, Default)]
pub struct CancelToken {
    flag: Arc<AtomicBool>,
    parent: Option<Arc<CancelToken>>,
    deadline: Option<Instant>,
    /// Nanoseconds by which the deadline is later than it was set.
    waited: Arc<AtomicU64>,
}

impl CancelToken {
    /// A token that nobody has cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// A token that is cancelled with this one, and by itself at `deadline` where there is one.
    pub fn child(&self, deadline: Option<Instant>) -> Self {
        let parent = Some(Arc::new(self.clone()));
        Self { parent, deadline, ..Self::default() }
    }

    /// Cancels this token and its children.
    pub fn cancel(&self) {
        self.flag.store(true, Ordering::Relaxed);
    }

    /// Whether to stop. Costs a load, and a look at the clock where there is a deadline.
    pub fn is_cancelled(&self) -> bool {
        self.flag.load(Ordering::Relaxed)
            || self.parent.as_ref().is_some_and(|parent| parent.is_cancelled())
            || self.is_overdue()
    }

    /// Whether the deadline has passed.
    pub fn is_overdue(&self) -> bool {
        let late = self.deadline.and_then(|end| Instant::now().checked_duration_since(end));
        late.is_some_and(|late| late.as_nanos() >= self.waited.load(Ordering::Relaxed).into())
    }

    /// Puts its deadline off, and those of the tokens that it was made from: the work has waited
    /// for others so long.
    pub(crate) fn put_off(&self, waited: Duration) {
        let nanoseconds = u64::try_from(waited.as_nanos()).unwrap_or(u64::MAX);
        self.waited.fetch_add(nanoseconds, Ordering::Relaxed);
        if let Some(parent) = &self.parent {
            parent.put_off(waited);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_child_stops_with_its_parent_and_not_the_other_way_round() {
        let parent = CancelToken::new();
        let child = parent.child(None);
        child.cancel();
        assert!(child.is_cancelled() && !parent.is_cancelled());
        let second = parent.child(None);
        parent.cancel();
        assert!(second.is_cancelled() && !second.is_overdue());
    }

    #[test]
    fn a_deadline_cancels() {
        let token = CancelToken::new().child(Some(Instant::now()));
        assert!(token.is_cancelled() && token.is_overdue());
        let below = token.child(None);
        below.put_off(Duration::from_secs(3600));
        assert!(!token.is_overdue() && !below.is_cancelled());
    }
}
