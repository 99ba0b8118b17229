//! Work that the window does not wait for.

use std::sync::mpsc::{Receiver, TryRecvError, channel};

use eframe::egui;

/// What has become of a task.
#[derive(Debug)]
pub enum Progress<T> {
    /// It runs.
    Running,
    /// Its result, given out once.
    Done(T),
    /// It ended without a result: it panicked, or its thread could not be started.
    Lost,
}

/// A result in the making on a thread of its own.
///
/// A task that is dropped runs to its end unheard.
#[derive(Debug)]
pub struct Task<T>(Receiver<T>);

impl<T: Send + 'static> Task<T> {
    /// Starts the work; the window is drawn again when it is done.
    pub fn spawn(context: &egui::Context, work: impl FnOnce() -> T + Send + 'static) -> Self {
        let (sender, receiver) = channel();
        let context = context.clone();
        let started = std::thread::Builder::new().name("view".to_owned()).spawn(move || {
            // The frame after the result is in the channel must come, and the one after a panic.
            let wake = WakeOnDrop(context);
            // An error means that nobody waits any longer.
            sender.send(work()).ok();
            drop(sender);
            drop(wake);
        });
        // A thread that could not be started has dropped the sender, which reads as lost.
        started.ok();
        Self(receiver)
    }

    /// Looks whether it is done, without waiting.
    pub fn poll(&self) -> Progress<T> {
        match self.0.try_recv() {
            Ok(result) => Progress::Done(result),
            Err(TryRecvError::Empty) => Progress::Running,
            Err(TryRecvError::Disconnected) => Progress::Lost,
        }
    }
}

struct WakeOnDrop(egui::Context);

impl Drop for WakeOnDrop {
    fn drop(&mut self) {
        self.0.request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_gives_its_result_once_and_a_panic_is_a_loss() {
        let context = egui::Context::default();
        let task = Task::spawn(&context, || 7);
        let wait = |task: &Task<i32>| loop {
            match task.poll() {
                Progress::Running => std::thread::yield_now(),
                other => break other,
            }
        };
        assert!(matches!(wait(&task), Progress::Done(7)));
        assert!(matches!(wait(&task), Progress::Lost));
        let task = Task::spawn(&context, || std::panic::panic_any("expected in this test"));
        assert!(matches!(wait(&task), Progress::Lost));
    }
}
