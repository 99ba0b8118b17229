//! The store: the folder that holds a program's finished steps, and alone decides what is done.
//!
//! ```text
//! plan.json          what the program runs: steps, versions, hashes of its inputs
//! steps/<id>/        a finished step: record.json, log.txt, outputs/
//! outputs/           the outputs of all steps under the names that the map gives them
//! results.csv, results.jsonl, summary.md     made anew from the steps
//! claims/, work/     steps under way; both can be deleted when nothing runs
//! ```
//!
//! A step is worked on in `work/` and becomes part of `steps/` by one rename. A process claims a
//! step by locking a file in `claims/`; the system gives the lock back when the process dies, so
//! a claim never outlives its owner. (A claim by rename, which needs no locks, would.) Where the
//! file system has no locks two processes may do the same work, and the second rename fails.

use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use thiserror::Error;

use super::plan_file::PlanFile;
use crate::files::{fresh_file, is_below, refuse_links};
use crate::run::{NodeRecord, NodeStatus};

/// Steps that took longer are on the disk, not only in the system's memory, once they are done.
const WORTH_SYNC_SECONDS: f64 = 0.1;

const PLAN: &str = "plan.json";
const PARTS: [&str; 3] = ["steps", "claims", "work"];
const RECORD: &str = "record.json";

/// The folder of a program's results.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    /// Records read so far; a record never changes.
    known: Mutex<HashMap<String, Arc<StepRecord>>>,
}

/// What is kept of a finished step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// Hash of what determines its result, short.
    pub id: String,
    /// Number of the repeat, from 0.
    pub repeat: u32,
    /// The parameters that the program set.
    pub params: IndexMap<String, Json>,
    /// How it ended.
    #[serde(flatten)]
    pub status: StepStatus,
    /// Seconds from its start to its end.
    pub seconds: f64,
    /// Whether it ran alone, with nothing shared, so that its seconds can be compared.
    #[serde(default)]
    pub is_timed: bool,
    /// Version of mve.
    pub version: String,
    /// Its nodes by name.
    pub nodes: IndexMap<String, NodeRecord>,
}

/// How a step ended. A step that was stopped by hand has not ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum StepStatus {
    /// Every node is done.
    Done,
    /// A node failed.
    Failed {
        /// Which, and why.
        reason: String,
    },
    /// It took longer than the time limit.
    TimedOut {
        /// What it was at, and the limit.
        reason: String,
        /// The limit in seconds.
        limit: f64,
    },
}

impl StepStatus {
    /// The word for a table.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed { .. } => "failed",
            Self::TimedOut { .. } => "timed out",
        }
    }

    /// Why it is not done.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Done => None,
            Self::Failed { reason } | Self::TimedOut { reason, .. } => Some(reason),
        }
    }
}

/// Why a store could not be used.
#[derive(Debug, Error)]
pub enum StoreError {
    /// The system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The folder holds the steps of another program.
    #[error("{}: the folder holds the results of program \"{other}\"; name another one with --out",
        folder.display())]
    OtherProgram {
        /// The folder.
        folder: PathBuf,
        /// The program.
        other: String,
    },
    /// The plan cannot be understood.
    #[error("{}: not the plan of a program: {error}", path.display())]
    TornPlan {
        /// The file.
        path: PathBuf,
        /// What the reader said.
        error: serde_json::Error,
    },
    /// The folder holds other things.
    #[error("{}: the folder is not empty and not a store of mve; name an empty or new one",
        .0.display())]
    NotAStore(PathBuf),
}

impl StoreError {
    fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }
}

/// The right to work on a step, held while this is alive.
pub(crate) struct StepClaim {
    id: String,
    path: PathBuf,
    /// Locked where the file system has locks.
    _lock: File,
    /// Where the step is worked on.
    pub work: PathBuf,
}

impl StepClaim {
    /// Where the savers of the step write.
    pub fn outputs(&self) -> PathBuf {
        self.work.join("outputs")
    }
}

impl Store {
    /// Opens a store, making the folder if it is not there.
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        fs::create_dir_all(folder).map_err(StoreError::at(folder))?;
        refuse_other_things(folder)?;
        for part in PARTS {
            let path = folder.join(part);
            fs::create_dir_all(&path).map_err(StoreError::at(&path))?;
        }
        Ok(Self { folder: folder.to_owned(), known: Mutex::default() })
    }

    /// Looks at a store without changing it; `None` if the folder is not there.
    pub fn look(folder: &Path) -> Result<Option<Self>, StoreError> {
        match fs::metadata(folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(StoreError::at(folder)(error)),
            Ok(_) => refuse_other_things(folder)?,
        }
        Ok(Some(Self { folder: folder.to_owned(), known: Mutex::default() }))
    }

    /// Refuses to mix the steps of two programs, whose tables would take each other's place.
    pub(crate) fn belong_to(&self, program: &str) -> Result<(), StoreError> {
        let plan = fs::read(self.folder.join(PLAN)).unwrap_or_default();
        let plan: Json = serde_json::from_slice(&plan).unwrap_or_default();
        match plan["program"].as_str() {
            Some(other) if other != program => {
                let (folder, other) = (self.folder.clone(), other.to_owned());
                Err(StoreError::OtherProgram { folder, other })
            }
            _ => Ok(()),
        }
    }

    /// What it says it holds: `plan.json`, read and understood as a whole or not at all.
    pub fn plan(&self) -> Result<PlanFile, StoreError> {
        let path = self.folder.join(PLAN);
        let text = fs::read(&path).map_err(StoreError::at(&path))?;
        serde_json::from_slice(&text).map_err(|error| StoreError::TornPlan { path, error })
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn step_folder(&self, id: &str) -> PathBuf {
        self.folder.join("steps").join(id)
    }

    /// The record of a finished step. A record that cannot be read is not there.
    pub fn record(&self, id: &str) -> Option<Arc<StepRecord>> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(record) = known.get(id) {
            return Some(Arc::clone(record));
        }
        let bytes = fs::read(self.step_folder(id).join(RECORD)).ok()?;
        let record: StepRecord = serde_json::from_slice(&bytes).ok()?;
        let outputs = self.step_folder(id).join("outputs");
        let files = || record.nodes.values().flat_map(|node| &node.files);
        let is_whole = files().all(|file| is_below(file) && outputs.join(file).is_file());
        if record.id != id || !is_whole {
            return None;
        }
        let record = Arc::new(record);
        known.insert(id.to_owned(), Arc::clone(&record));
        Some(record)
    }

    /// How many steps the store holds that are not among `ids`.
    pub(crate) fn count_others(&self, ids: &std::collections::HashSet<&str>) -> usize {
        let steps = fs::read_dir(self.folder.join("steps")).into_iter().flatten().flatten();
        steps.filter(|step| !ids.contains(&*step.file_name().to_string_lossy())).count()
    }

    /// Removes a finished step, so that it runs again.
    pub(crate) fn forget(&self, id: &str) -> Result<(), StoreError> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).remove(id);
        let folder = self.step_folder(id);
        // Out of the way by one rename first: a step is there whole or not at all.
        let trash = self.folder.join("work").join(format!("{id}.forgotten.{}", std::process::id()));
        match fs::rename(&folder, &trash) {
            Ok(()) => fs::remove_dir_all(&trash).map_err(StoreError::at(&trash)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            Err(error) => Err(StoreError::at(&folder)(error)),
        }
    }

    /// Claims a step: `None` if it is done, or another process works on it.
    pub(crate) fn claim(&self, id: &str) -> Result<Option<StepClaim>, StoreError> {
        let path = self.folder.join("claims").join(id);
        let lock = File::create(&path).map_err(StoreError::at(&path))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Ok(None),
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(StoreError::at(&path)(error)),
        }
        // The lock is on this file even if its owner before removed the name; whoever finished
        // the step did so before that, and the record tells.
        if self.record(id).is_some() {
            let _ = fs::remove_file(&path);
            return Ok(None);
        }
        self.clear_work(id);
        let work = self.folder.join("work").join(format!("{id}.{}", std::process::id()));
        fs::create_dir(&work).map_err(StoreError::at(&work))?;
        Ok(Some(StepClaim { id: id.to_owned(), path, _lock: lock, work }))
    }

    /// Removes what an earlier owner of the claim left half done.
    fn clear_work(&self, id: &str) {
        let Ok(left) = fs::read_dir(self.folder.join("work")) else { return };
        for folder in left.flatten() {
            let name = folder.file_name();
            if name.to_string_lossy().split('.').next() == Some(id) {
                // What cannot be removed is in nobody's way: it is never read.
                let _ = fs::remove_dir_all(folder.path());
            }
        }
    }

    /// Makes a finished step part of the store, by one rename.
    pub(crate) fn commit(
        &self,
        claim: StepClaim,
        record: StepRecord,
    ) -> Result<Arc<StepRecord>, StoreError> {
        let path = claim.work.join(RECORD);
        let text = serde_json::to_vec_pretty(&record)
            .map_err(|error| StoreError::at(&path)(error.into()))?;
        let mut file = File::create(&path).map_err(StoreError::at(&path))?;
        file.write_all(&text).map_err(StoreError::at(&path))?;
        if record.seconds >= WORTH_SYNC_SECONDS {
            file.sync_all().map_err(StoreError::at(&path))?;
        }
        drop(file);
        write_log(&claim.work, &record)?;
        let target = self.step_folder(&claim.id);
        if let Err(error) = fs::rename(&claim.work, &target) {
            if let Some(other) = self.record(&claim.id) {
                let _ = fs::remove_dir_all(&claim.work);
                return Ok(other);
            }
            // What stands there has no record that can be read.
            self.forget(&claim.id)?;
            fs::rename(&claim.work, &target).map_err(|_| StoreError::at(&target)(error))?;
        }
        self.publish(&record)?;
        let record = Arc::new(record);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.insert(claim.id.clone(), Arc::clone(&record));
        drop(known);
        let _ = fs::remove_file(&claim.path);
        Ok(record)
    }

    /// Gives up a claimed step, and all that was done for it.
    pub(crate) fn abandon(&self, claim: &StepClaim) {
        let _ = fs::remove_dir_all(&claim.work);
    }

    /// Puts the outputs of a step into `outputs/`, as second names of the same files where the
    /// file system allows that. Costs a look at each file if they are there already.
    pub(crate) fn publish(&self, record: &StepRecord) -> Result<(), StoreError> {
        let from = self.step_folder(&record.id).join("outputs");
        for written in record.nodes.values().flat_map(|node| &node.files) {
            let (source, target) = (from.join(written), self.folder.join("outputs").join(written));
            if !is_below(written) || is_same(&source, &target) {
                continue;
            }
            refuse_links(&self.folder, &Path::new("outputs").join(written))
                .map_err(|why| StoreError::at(&target)(std::io::Error::other(why)))?;
            self.with_lock(|| {
                let folder = target.parent().unwrap_or(&self.folder);
                fs::create_dir_all(folder).map_err(StoreError::at(folder))?;
                let fresh = self.folder.join("work").join(format!("{}.link", record.id));
                let _ = fs::remove_file(&fresh);
                fs::hard_link(&source, &fresh)
                    .or_else(|_| fs::copy(&source, &fresh).map(drop))
                    .and_then(|()| fs::rename(&fresh, &target))
                    .map_err(StoreError::at(&target))
            })?;
        }
        Ok(())
    }

    /// Removes what processes that were killed left of files that are written [`Store::with_lock`].
    pub(crate) fn sweep(&self) {
        let Ok(left) = fs::read_dir(self.folder.join("work")) else { return };
        for entry in left.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with(".tmp") || name.ends_with(".link") {
                // What cannot be removed is in nobody's way: it is never read.
                let _ = fs::remove_file(entry.path());
            }
        }
    }

    /// Writes a file of the store so that readers see the old one or the new one. To be called
    /// within [`Store::with_lock`].
    pub(crate) fn write(&self, name: &str, content: &[u8]) -> Result<(), StoreError> {
        let path = self.folder.join(name);
        let mut file =
            fresh_file(&self.folder.join("work"), ".tmp").map_err(StoreError::at(&path))?;
        file.write_all(content).map_err(StoreError::at(&path))?;
        file.as_file().sync_all().map_err(StoreError::at(&path))?;
        file.persist(&path).map_err(|error| StoreError::at(&path)(error.error))?;
        Ok(())
    }

    /// Runs `work` under the lock on the files that all steps share; one process at a time has it.
    pub(crate) fn with_lock<T>(
        &self,
        work: impl FnOnce() -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let path = self.folder.join("claims").join("tables");
        let lock = File::create(&path).map_err(StoreError::at(&path))?;
        // Without locks the tables are still whole, and complete once the last process is done.
        let _ = lock.lock();
        work()
    }
}

/// Refuses a folder that holds other things. One that another process is just making a store of
/// holds nothing but parts of a store.
fn refuse_other_things(folder: &Path) -> Result<(), StoreError> {
    let content = fs::read_dir(folder).map_err(StoreError::at(folder))?;
    let mut names = content.flatten().map(|entry| entry.file_name());
    let has_others = names.any(|name| !PARTS.iter().any(|part| name == *part));
    if has_others && !folder.join(PLAN).exists() {
        return Err(StoreError::NotAStore(folder.to_owned()));
    }
    Ok(())
}

/// Whether two paths are names of one file, as far as can be told cheaply: same size and time.
fn is_same(one: &Path, other: &Path) -> bool {
    match (one.metadata(), other.metadata()) {
        (Ok(a), Ok(b)) => a.len() == b.len() && a.modified().ok() == b.modified().ok(),
        _ => false,
    }
}

/// `log.txt`, for steps that have something to say.
fn write_log(work: &Path, record: &StepRecord) -> Result<(), StoreError> {
    let mut text = String::new();
    for (name, node) in &record.nodes {
        for line in &node.log {
            let mark = if line.is_warning { "warning: " } else { "" };
            text.push_str(&format!("{name}: {mark}{}\n", line.text));
        }
        if let NodeStatus::Failed { error } = &node.status {
            text.push_str(&format!("{name}: error: {error}\n"));
        }
    }
    let path = work.join("log.txt");
    if text.is_empty() { Ok(()) } else { fs::write(&path, text).map_err(StoreError::at(&path)) }
}
