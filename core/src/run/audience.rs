//! Who hears what happens in a run: of each node that it starts and ends once, though it may run
//! twice.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use super::{Event, EventKind};

/// The observer of a run, and what it has heard.
pub(super) struct Audience<'a> {
    observer: &'a (dyn Fn(&Event) + Sync),
    /// The nodes that have started, and whether they have ended.
    heard: Mutex<HashMap<String, bool>>,
}

impl<'a> Audience<'a> {
    pub fn new(observer: &'a (dyn Fn(&Event) + Sync)) -> Self {
        Self { observer, heard: Mutex::default() }
    }

    /// Tells of an event, unless it has happened before.
    pub fn tell(&self, event: &Event) {
        if self.is_news(event) {
            (self.observer)(event);
        }
    }

    fn is_news(&self, event: &Event) -> bool {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        let is_over = heard.get(event.node).copied();
        match event.kind {
            EventKind::Started => {
                is_over.is_none() && heard.insert(event.node.to_owned(), false).is_none()
            }
            EventKind::Ended { .. } => {
                heard.insert(event.node.to_owned(), true);
                is_over != Some(true)
            }
            EventKind::Progress { .. } | EventKind::Log { .. } | EventKind::Warning { .. } => {
                is_over != Some(true)
            }
        }
    }
}
