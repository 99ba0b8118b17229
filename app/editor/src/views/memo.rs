//! A derived value that is made anew in the background when what it derives from changes.

use std::sync::Arc;

use eframe::egui;

use super::background::{Progress, Task};

/// The latest result for some key, shown until there is one for the key that is wanted.
#[derive(Debug)]
pub struct Memo<K, T> {
    made: Option<(K, Arc<T>)>,
    task: Option<(K, Task<T>)>,
    /// The key whose task was lost: not tried again.
    lost: Option<K>,
}

impl<K, T> Default for Memo<K, T> {
    fn default() -> Self {
        Self { made: None, task: None, lost: None }
    }
}

impl<K: PartialEq, T: Send + 'static> Memo<K, T> {
    /// Looks after the task, and starts one when the wanted key differs from what is there. At
    /// most one runs at a time.
    pub fn want(
        &mut self,
        context: &egui::Context,
        key: K,
        work: impl FnOnce() -> T + Send + 'static,
    ) {
        self.take_in();
        if self.task.is_some() {
            return;
        }
        let is_made = self.made.as_ref().is_some_and(|(made_for, _)| *made_for == key);
        if !is_made && self.lost.as_ref() != Some(&key) {
            self.task = Some((key, Task::spawn(context, work)));
        }
    }

    /// Looks after the task while nothing is wanted.
    pub fn take_in(&mut self) {
        let Some((made_for, task)) = self.task.take() else { return };
        match task.poll() {
            Progress::Running => self.task = Some((made_for, task)),
            Progress::Done(result) => self.made = Some((made_for, Arc::new(result))),
            Progress::Lost => self.lost = Some(made_for),
        }
    }

    /// Makes the result at once, in this thread, when the wanted key differs from what is there.
    pub fn make(&mut self, key: K, work: impl FnOnce() -> T) {
        if self.made.as_ref().is_none_or(|(made_for, _)| *made_for != key) {
            self.made = Some((key, Arc::new(work())));
        }
    }

    /// The latest result, perhaps for an earlier key.
    pub fn latest(&self) -> Option<Arc<T>> {
        self.made.as_ref().map(|(_, made)| Arc::clone(made))
    }

    /// The latest result with its key.
    pub fn latest_with_key(&self) -> Option<(&K, &Arc<T>)> {
        self.made.as_ref().map(|(key, made)| (key, made))
    }

    /// Whether something is in the making.
    pub fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Whether the last task that ended gave no result.
    pub fn is_lost(&self) -> bool {
        self.lost.is_some() && self.task.is_none()
    }
}

/// A shared value as a key: equal to itself only. It keeps the value, so that no other can take
/// its address.
#[derive(Debug)]
pub struct Same<T>(pub Arc<T>);

impl<T> Clone for Same<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> PartialEq for Same<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_old_result_stays_until_the_new_one_is_there() {
        let context = egui::Context::default();
        let mut memo = Memo::default();
        let settle = |memo: &mut Memo<i32, i32>, key: i32| loop {
            let from = memo.latest().map_or(0, |old| *old);
            memo.want(&context, key, move || from + key);
            if !memo.is_busy() {
                break memo.latest().map(|made| *made);
            }
        };
        assert_eq!(settle(&mut memo, 5), Some(5));
        memo.want(&context, 7, || 100);
        assert_eq!(memo.latest().as_deref(), Some(&5));
        assert_eq!(settle(&mut memo, 7), Some(100));
        memo.want(&context, 8, || std::panic::panic_any("expected in this test"));
        assert_eq!(settle(&mut memo, 8), Some(100), "a loss keeps the old one");
        assert!(memo.is_lost());
    }
}
