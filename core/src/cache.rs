//! Values that were made before, by the key of the node that made them.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::cancel::CancelToken;
use crate::data::Value;
use crate::disk_cache::DiskCache;
use crate::fingerprint::Fingerprint;
use crate::module::Module;
use crate::node_outputs::NodeOutputs;

/// How long a thread that waits for another's result sleeps before it looks whether to stop.
const PATIENCE: Duration = Duration::from_millis(50);

/// Where a node's outputs came from, if not from running it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CacheUse {
    /// From this process.
    Memory,
    /// From a folder that outlives it.
    Disk,
}

/// A cache in memory, within a budget of bytes, over one on disk if there is one.
///
/// Runs on many threads may share it: of those that want the same key at the same time one makes
/// the value and the others wait for it.
#[derive(Debug)]
pub struct Cache {
    state: Mutex<State>,
    changed: Condvar,
    budget: usize,
    disk: Option<DiskCache>,
    wanted: Option<HashSet<Fingerprint>>,
}

#[derive(Debug, Default)]
struct State {
    slots: HashMap<Fingerprint, Slot>,
    /// Keys by the time of their last use, for eviction.
    by_age: BTreeMap<u64, Fingerprint>,
    clock: u64,
    bytes: usize,
}

#[derive(Debug)]
enum Slot {
    /// Some thread makes it.
    Claimed,
    Full {
        results: Arc<NodeOutputs>,
        bytes: usize,
        used: u64,
    },
}

/// What came of asking for a key.
pub(crate) enum Claim<'a> {
    /// It is there.
    Hit(Arc<NodeOutputs>, CacheUse),
    /// The caller makes it.
    Mine(Ticket<'a>),
    /// The run was stopped while another thread was making it.
    Stopped,
}

/// The duty to make a value. Dropping it without [`Ticket::fulfill`] passes the duty on.
pub(crate) struct Ticket<'a> {
    cache: &'a Cache,
    key: Fingerprint,
}

impl Cache {
    /// A cache that keeps at most `budget` bytes of values in memory.
    pub fn new(budget: usize, disk: Option<DiskCache>) -> Self {
        let (state, changed) = (Mutex::default(), Condvar::new());
        Self { state, changed, budget, disk, wanted: None }
    }

    /// Keeps only these keys in memory, when it is known which values are needed again.
    pub fn only(mut self, keys: HashSet<Fingerprint>) -> Self {
        self.wanted = Some(keys);
        self
    }

    /// The folder of values on disk, if there is one.
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.disk.as_ref().map(DiskCache::folder)
    }

    /// Bytes of values in memory.
    pub fn bytes(&self) -> usize {
        self.lock().bytes
    }

    /// Gives the value, or the duty to make it; waits while another thread has that duty.
    pub(crate) fn claim(
        &self,
        key: Fingerprint,
        module: &'static Module,
        cancel: &CancelToken,
    ) -> Claim<'_> {
        let mut state = self.lock();
        loop {
            state.drop_damaged(key);
            if let Some(results) = state.touch(key) {
                return Claim::Hit(results, CacheUse::Memory);
            }
            if !state.slots.contains_key(&key) {
                break;
            }
            if cancel.is_cancelled() {
                return Claim::Stopped;
            }
            let waited = self.changed.wait_timeout(state, PATIENCE);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        state.slots.insert(key, Slot::Claimed);
        drop(state);
        let ticket = Ticket { cache: self, key };
        match self.disk.as_ref().and_then(|disk| disk.load(key, module)) {
            Some(results) => {
                let results = Arc::new(results);
                ticket.keep(&results);
                Claim::Hit(results, CacheUse::Disk)
            }
            None => Claim::Mine(ticket),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Ticket<'_> {
    /// Hands over what was made.
    pub fn fulfill(self, results: &Arc<NodeOutputs>) {
        if let Some(disk) = &self.cache.disk {
            disk.store(self.key, results);
        }
        self.keep(results);
    }

    fn keep(self, results: &Arc<NodeOutputs>) {
        let wanted = self.cache.wanted.as_ref();
        let bytes: usize = results.outputs.iter().map(Value::byte_size).sum();
        if bytes <= self.cache.budget && wanted.is_none_or(|keys| keys.contains(&self.key)) {
            self.cache.lock().insert(self.key, Arc::clone(results), bytes, self.cache.budget);
        }
    }
}

impl Drop for Ticket<'_> {
    fn drop(&mut self) {
        let mut state = self.cache.lock();
        if matches!(state.slots.get(&self.key), Some(Slot::Claimed)) {
            state.slots.remove(&self.key);
        }
        self.cache.changed.notify_all();
    }
}

impl State {
    /// Drops what some reader has found damaged, so that it is made again.
    fn drop_damaged(&mut self, key: Fingerprint) {
        let Some(Slot::Full { results, bytes, used }) = self.slots.get(&key) else { return };
        if !results.is_sound() {
            self.by_age.remove(used);
            self.bytes -= bytes;
            self.slots.remove(&key);
        }
    }

    fn touch(&mut self, key: Fingerprint) -> Option<Arc<NodeOutputs>> {
        let Some(Slot::Full { results, used, .. }) = self.slots.get_mut(&key) else { return None };
        self.clock += 1;
        self.by_age.remove(used);
        self.by_age.insert(self.clock, key);
        *used = self.clock;
        Some(Arc::clone(results))
    }

    fn insert(&mut self, key: Fingerprint, results: Arc<NodeOutputs>, bytes: usize, budget: usize) {
        while self.bytes + bytes > budget {
            let Some((_, oldest)) = self.by_age.pop_first() else { break };
            if let Some(Slot::Full { bytes, .. }) = self.slots.remove(&oldest) {
                self.bytes -= bytes;
            }
        }
        self.clock += 1;
        self.by_age.insert(self.clock, key);
        self.bytes += bytes;
        self.slots.insert(key, Slot::Full { results, bytes, used: self.clock });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use indexmap::IndexMap;

    use crate::testing::ECHO;

    fn text_of(n: usize) -> Arc<NodeOutputs> {
        let outputs = vec![Value::new("x".repeat(n))];
        Arc::new(NodeOutputs { outputs, log: Vec::new(), seconds: 1.0, phases: IndexMap::new() })
    }

    fn key(n: u8) -> Fingerprint {
        Fingerprint::of(&[n])
    }

    fn put(cache: &Cache, n: u8, results: &Arc<NodeOutputs>) {
        match cache.claim(key(n), &ECHO, &CancelToken::new()) {
            Claim::Mine(ticket) => ticket.fulfill(results),
            _ => panic!("key {n} was there"),
        }
    }

    fn has(cache: &Cache, n: u8) -> bool {
        matches!(cache.claim(key(n), &ECHO, &CancelToken::new()), Claim::Hit(..))
    }

    #[test]
    fn the_budget_holds_and_the_oldest_goes() {
        let cache = Cache::new(3000, None);
        (0..2).for_each(|n| put(&cache, n, &text_of(1000)));
        assert!(has(&cache, 0)); // now 1 is the oldest
        put(&cache, 2, &text_of(1500));
        assert!(cache.bytes() <= 3000);
        assert!(has(&cache, 0) && has(&cache, 2) && !has(&cache, 1));
    }

    #[test]
    fn what_is_larger_than_the_budget_is_not_kept() {
        let cache = Cache::new(100, None);
        put(&cache, 0, &text_of(1000));
        assert!(!has(&cache, 0));
    }

    #[test]
    fn one_thread_makes_and_the_others_wait() {
        let cache = Cache::new(1 << 20, None);
        let made = std::sync::atomic::AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| match cache.claim(key(7), &ECHO, &CancelToken::new()) {
                    Claim::Mine(ticket) => {
                        std::thread::sleep(Duration::from_millis(20));
                        made.fetch_add(1, std::sync::atomic::Ordering::SeqCst);
                        ticket.fulfill(&text_of(1));
                    }
                    Claim::Hit(value, _) => assert_eq!(value.outputs[0].summary(), "x"),
                    Claim::Stopped => panic!("nobody stopped it"),
                });
            }
        });
        assert_eq!(made.into_inner(), 1);
    }

    #[test]
    fn a_dropped_ticket_passes_the_duty_on() {
        let cache = Cache::new(100, None);
        drop(cache.claim(key(1), &ECHO, &CancelToken::new()));
        assert!(matches!(cache.claim(key(1), &ECHO, &CancelToken::new()), Claim::Mine(_)));
    }
}
