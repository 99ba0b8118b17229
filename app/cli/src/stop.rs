//! Ctrl-C and SIGTERM: the first stops cleanly, the second at once. While a map is read and its
//! files are looked at there is nothing to keep, and the first one ends that.

use std::sync::{Arc, Mutex, PoisonError};

use mve_core::CancelToken;

use crate::exit::{Exit, Stop};
use crate::out;
use crate::progress::Progress;

/// What a signal stops.
enum Work {
    /// Reading and checking; whether events are told.
    Checking { json: bool },
    /// What these stop, and what is said then.
    Running(CancelToken, Progress, &'static str),
    /// It was asked to stop.
    Stopping,
}

/// Hears signals from the beginning of a command on.
pub struct Signals(Arc<Mutex<Work>>);

impl Signals {
    /// Listens while a map is checked.
    pub fn listen(json: bool) -> Result<Self, Stop> {
        let work = Arc::new(Mutex::new(Work::Checking { json }));
        let heard = Arc::clone(&work);
        ctrlc::set_handler(move || {
            let mut work = heard.lock().unwrap_or_else(PoisonError::into_inner);
            match std::mem::replace(&mut *work, Work::Stopping) {
                Work::Checking { json } => {
                    if json {
                        let last = serde_json::json!({"event": "finished", "status": "stopped"});
                        // Whoever stopped it may be gone.
                        let _ = out::event(&last);
                    }
                    out::complain("stopped before anything ran");
                    std::process::exit(Exit::Interrupted as i32);
                }
                Work::Running(cancel, progress, message) => {
                    cancel.cancel();
                    progress.say(message);
                }
                Work::Stopping => std::process::exit(Exit::Interrupted as i32),
            }
        })
        .map_err(|error| Stop::usage(format!("cannot listen for Ctrl-C: {error}")))?;
        Ok(Self(work))
    }

    /// From here on the first signal cancels `cancel`, and says `message`.
    pub fn stop(&self, cancel: &CancelToken, progress: &Progress, message: &'static str) {
        let mut work = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *work = Work::Running(cancel.clone(), progress.clone(), message);
    }
}
