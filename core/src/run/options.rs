//! How a plan is run.

use std::path::Path;

use super::Event;
use crate::cache::Cache;
use crate::cancel::CancelToken;
use crate::memory::MemoryBudget;
use crate::plan::OutputScope;

/// How to run a plan.
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Where savers write.
    pub output_folder: &'a Path,
    /// How many nodes run at once, at least 1. Modules have threads of their own beside these.
    pub threads: usize,
    /// Values made before.
    pub cache: Option<&'a Cache>,
    /// Stops the run.
    pub cancel: &'a CancelToken,
    /// Hears what happens, from several threads.
    pub observer: &'a (dyn Fn(&Event) + Sync),
    /// Which values the outcome holds.
    pub keep: Keep,
    /// Whether savers may follow symbolic links out of the output folder.
    pub output_scope: OutputScope,
    /// Memory that modules reserve, where runs that go on at once share it.
    pub memory: Option<&'a MemoryBudget>,
}

impl<'a> RunOptions<'a> {
    /// Of a run that writes to a folder: one node at a time, no cache, nobody listens, scalars are
    /// kept.
    pub fn new(output_folder: &'a Path, cancel: &'a CancelToken) -> Self {
        Self {
            output_folder,
            threads: 1,
            cache: None,
            cancel,
            observer: &|_| {},
            keep: Keep::Scalars,
            output_scope: OutputScope::Folder,
            memory: None,
        }
    }
}

/// Which values of a run outlive it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// The scalars only, as part of the records; others go with their last consumer.
    Scalars,
    /// Every output of every node.
    All,
}
