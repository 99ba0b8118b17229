//! Ctrl-C and SIGTERM: the first stops cleanly, the second at once.

use std::sync::atomic::{AtomicBool, Ordering};

use mve_core::CancelToken;

use crate::exit::{Exit, Stop};
use crate::progress::Progress;

/// Cancels `cancel` at the first signal, and says `message`.
pub fn on_signal(
    cancel: &CancelToken,
    progress: &Progress,
    message: &'static str,
) -> Result<(), Stop> {
    let (cancel, progress) = (cancel.clone(), progress.clone());
    let was_asked = AtomicBool::new(false);
    ctrlc::set_handler(move || {
        if was_asked.swap(true, Ordering::Relaxed) {
            std::process::exit(Exit::Interrupted as i32);
        }
        cancel.cancel();
        progress.say(message);
    })
    .map_err(|error| Stop::usage(format!("cannot listen for Ctrl-C: {error}")))
}
