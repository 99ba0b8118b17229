//! Panics of modules: caught, kept off standard error, and turned into errors of their nodes.

use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::ModuleError;

/// Modules at work: while there are any, a panic is theirs, and the hook keeps quiet.
static AT_WORK: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Where the last panic of this thread happened.
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Keeps panics of modules off standard error; their messages and places become part of the
/// node's error. For programs with a display of their own; call it once at their start.
pub fn contain_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if AT_WORK.load(Ordering::Relaxed) == 0 {
                return before(info);
            }
            let place = info.location().map(|l| format!("{}:{}", l.file(), l.line()));
            PLACE.with_borrow_mut(|known| *known = place);
        }));
    });
}

/// Calls `work`; a panic becomes an error.
pub(crate) fn contained<T>(
    work: impl FnOnce() -> Result<T, ModuleError>,
) -> Result<T, ModuleError> {
    AT_WORK.fetch_add(1, Ordering::Relaxed);
    let result = catch_unwind(AssertUnwindSafe(work));
    AT_WORK.fetch_sub(1, Ordering::Relaxed);
    result.unwrap_or_else(|payload| {
        let place = PLACE.take().map(|place| format!(" at {place}")).unwrap_or_default();
        Err(ModuleError::Bug(format!("it panicked{place}: {}", message_of(&*payload))))
    })
}

fn message_of(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message")
}
