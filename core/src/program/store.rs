//! The store: the folder that holds a program's finished steps, and alone decides what is done.
//!
//! ```text
//! plan.json          what the program runs: steps, versions, hashes of its inputs
//! steps/<id>/        a finished step: record.json, log.txt, outputs/
//! outputs/           the outputs of all steps under the names that the map gives them
//! results.csv, results.jsonl, summary.md     made anew from the steps
//! claims/, work/     steps under way; both can be deleted when nothing runs
//! cache/             values for the next call; can be deleted at any time
//! ```
//!
//! A step is worked on in `work/` and becomes part of `steps/` by one rename. A process claims a
//! step by locking a file in `claims/`; the system gives the lock back when the process dies, so
//! a claim never outlives its owner. (A claim by rename, which needs no locks, would.) Where the
//! file system has no locks two processes may do the same work, and the second rename fails.
//!
//! A claim that is free and has a count of attempts beside it was given back by the system alone:
//! the process ended while it worked on the step.

use std::collections::{HashMap, HashSet};
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::Value as Json;
use thiserror::Error;

use super::plan_file::PlanFile;
use super::record::{StepRecord, is_sound, log_of, with_checksum};
use crate::disk_cache::DiskCache;
use crate::files::{fresh_file, is_below, refuse_links};
use crate::run::NodeRecord;

/// Steps that took longer are on the disk, not only in the system's memory, once they are done.
const WORTH_SYNC_SECONDS: f64 = 0.1;

const PLAN: &str = "plan.json";
const PARTS: [&str; 3] = ["steps", "claims", "work"];
/// Values that outlive a call.
pub(super) const CACHE: &str = "cache";
const RECORD: &str = "record.json";

/// The folder of a program's results.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    /// Records read so far; a record never changes.
    known: Mutex<HashMap<String, Arc<StepRecord>>>,
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
    pub(super) fn at(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
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
    /// How often a process ended while it worked on the step.
    pub n_crashes: u32,
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

    /// The map whose results these are, if it is another file than `map` and still there.
    pub fn other_map(&self, map: &Path) -> Option<PathBuf> {
        let other = self.plan().ok()?.map_path;
        let same = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        (other.is_file() && same(&other) != same(map)).then_some(other)
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
        let text = fs::read_to_string(self.step_folder(id).join(RECORD)).ok()?;
        let record: StepRecord = serde_json::from_str(&text).ok().filter(|_| is_sound(&text))?;
        let outputs = self.step_folder(id).join("outputs");
        if record.id != id || !record.nodes.values().all(|node| is_whole(node, &outputs)) {
            return None;
        }
        let record = Arc::new(record);
        known.insert(id.to_owned(), Arc::clone(&record));
        Some(record)
    }

    /// Whether the store has a step of this id whose record cannot be believed.
    pub(crate) fn is_damaged(&self, id: &str) -> bool {
        self.step_folder(id).exists() && self.record(id).is_none()
    }

    /// Values for the next call, of at most so many bytes, or of a tenth of what is free on the
    /// disk.
    pub fn disk_cache(&self, budget: Option<u64>) -> Result<DiskCache, StoreError> {
        let folder = self.folder.join(CACHE);
        let budget =
            budget.unwrap_or_else(|| tenth_of_disk(&self.folder).unwrap_or(DiskCache::USUAL_BYTES));
        DiskCache::open(&folder, budget).map_err(StoreError::at(&folder))
    }

    fn attempts_file(&self, id: &str) -> PathBuf {
        self.folder.join("claims").join(format!("{id}.attempts"))
    }

    /// How often a step was begun and neither finished nor given up. Of a step that no process
    /// works on, that many processes ended over it.
    pub(crate) fn attempts(&self, id: &str) -> u32 {
        let text = fs::read_to_string(self.attempts_file(id)).unwrap_or_default();
        text.trim().parse().unwrap_or(0)
    }

    /// How many steps the store holds that are not among `ids`.
    pub(crate) fn count_others(&self, ids: &HashSet<&str>) -> usize {
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
        let n_crashes = match lock.try_lock() {
            Ok(()) => self.attempts(id),
            Err(TryLockError::WouldBlock) => return Ok(None),
            // Another process may be at it, which is no crash.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => 0,
            Err(TryLockError::Error(error)) => return Err(StoreError::at(&path)(error)),
        };
        // The lock is on this file even if its owner before removed the name; whoever finished
        // the step did so before that, and the record tells.
        if self.record(id).is_some() {
            let _ = fs::remove_file(&path);
            return Ok(None);
        }
        self.clear_work(id);
        let work = self.folder.join("work").join(format!("{id}.{}", std::process::id()));
        fs::create_dir(&work).map_err(StoreError::at(&work))?;
        Ok(Some(StepClaim { id: id.to_owned(), path, _lock: lock, work, n_crashes }))
    }

    /// Notes that the work on a step begins, over which so many processes have ended.
    pub(crate) fn begin(&self, id: &str, n_crashes: u32) -> Result<(), StoreError> {
        let path = self.attempts_file(id);
        fs::write(&path, (n_crashes + 1).to_string()).map_err(StoreError::at(&path))
    }

    /// Notes that the process has not ended over it.
    pub(crate) fn end(&self, id: &str) {
        let _ = fs::remove_file(self.attempts_file(id));
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
        let text = serde_json::to_string_pretty(&record)
            .map_err(|error| StoreError::at(&path)(error.into()))?;
        let mut file = File::create(&path).map_err(StoreError::at(&path))?;
        file.write_all(with_checksum(&text).as_bytes()).map_err(StoreError::at(&path))?;
        if record.seconds >= WORTH_SYNC_SECONDS {
            file.sync_all().map_err(StoreError::at(&path))?;
        }
        drop(file);
        let log = log_of(&record);
        if !log.is_empty() {
            let path = claim.work.join("log.txt");
            fs::write(&path, log).map_err(StoreError::at(&path))?;
        }
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
        self.end(&claim.id);
        let _ = fs::remove_file(&claim.path);
        Ok(record)
    }

    /// Puts a record of a finished step into the place of an older one of the same step.
    pub(crate) fn amend(&self, record: StepRecord) -> Result<Arc<StepRecord>, StoreError> {
        let path = Path::new("steps").join(&record.id).join(RECORD);
        let text = serde_json::to_string_pretty(&record)
            .map_err(|error| StoreError::at(&self.folder.join(&path))(error.into()))?;
        self.with_lock(|| self.write(&path, with_checksum(&text).as_bytes()))?;
        let record = Arc::new(record);
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.insert(record.id.clone(), Arc::clone(&record));
        Ok(record)
    }

    /// A new folder for a run whose outputs nobody keeps.
    pub(crate) fn scratch(&self, id: &str) -> Result<PathBuf, StoreError> {
        self.clear_work(id);
        let path = self.folder.join("work").join(format!("{id}.{}", std::process::id()));
        fs::create_dir(&path).map_err(StoreError::at(&path))?;
        Ok(path)
    }

    /// Gives up a claimed step, and all that was done for it.
    pub(crate) fn abandon(&self, claim: &StepClaim) {
        let _ = fs::remove_dir_all(&claim.work);
        self.end(&claim.id);
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
    pub(crate) fn write(&self, name: impl AsRef<Path>, content: &[u8]) -> Result<(), StoreError> {
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

/// Whether the files that a node wrote lie there with all of their bytes.
fn is_whole(node: &NodeRecord, outputs: &Path) -> bool {
    node.files.iter().enumerate().all(|(place, file)| {
        let is_as_long = |length: u64| node.file_bytes.get(place).is_none_or(|&n| n == length);
        let about = outputs.join(file).metadata();
        is_below(file) && about.is_ok_and(|about| about.is_file() && is_as_long(about.len()))
    })
}

/// A tenth of what is free on the disk of a folder; `None` where the system does not tell.
fn tenth_of_disk(folder: &Path) -> Option<u64> {
    #[cfg(unix)]
    {
        let about = rustix::fs::statvfs(folder).ok()?;
        Some(about.f_bavail.saturating_mul(about.f_frsize) / 10)
    }
    #[cfg(not(unix))]
    {
        let _ = folder;
        None
    }
}

/// Refuses a folder that holds other things. One that another process is just making a store of
/// holds nothing but parts of a store.
fn refuse_other_things(folder: &Path) -> Result<(), StoreError> {
    let content = fs::read_dir(folder).map_err(StoreError::at(folder))?;
    let mut names = content.flatten().map(|entry| entry.file_name());
    let has_others = names.any(|name| name != CACHE && !PARTS.iter().any(|part| name == *part));
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
