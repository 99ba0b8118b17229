//! Values in a folder, so that the next process does not make them again.
//!
//! One file a key: the hash of the rest, then the outputs. A file that does not hash to what it
//! says is not there; nothing here is ever an error, because a cache can always be done without.
//! Files that a value is a handle to ([`Stored`]) are kept beside it, by their hash.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::control::MissedTarget;
use crate::data::Value;
use crate::files::fresh_file;
use crate::fingerprint::Fingerprint;
use crate::module::Module;
use crate::node_outputs::{LogLine, NodeOutputs};
use crate::stored::{SUFFIX, Stored, TEMPORARY};

/// Outputs made in less time than this are made again sooner than they are read.
const WORTH_SECONDS: f64 = 0.02;

/// Length of the hash before the content.
const HASH: usize = 32;

/// A folder of values within a budget of bytes; the ones used longest ago go first.
#[derive(Clone, Debug)]
pub struct DiskCache {
    folder: PathBuf,
    budget: u64,
    /// Bytes that may be written before the folder is looked through again. Other processes write
    /// too, so it is a part of what is free.
    leeway: Arc<AtomicU64>,
}

/// The part of what is free that is written before the folder is looked through again.
const LEEWAY: u64 = 8;

#[derive(Serialize, Deserialize)]
struct FileContent {
    /// Type and bytes of each output.
    outputs: Vec<(String, Vec<u8>)>,
    log: Vec<LogLine>,
    missed: Vec<MissedTarget>,
    seconds: f64,
    phases: IndexMap<String, f64>,
}

impl DiskCache {
    /// The budget of a folder of which nobody says more.
    pub const USUAL_BYTES: u64 = 16 << 30;

    /// A cache in this folder, which is made if it is not there.
    pub fn open(folder: &Path, budget: u64) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let leeway = Arc::default();
        Ok(Self { folder: folder.to_owned(), budget, leeway })
    }

    /// The folder, in which modules write files that it may keep.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    fn path(&self, key: Fingerprint) -> PathBuf {
        self.folder.join(format!("{key}.values"))
    }

    pub(crate) fn load(&self, key: Fingerprint, module: &Module) -> Option<NodeOutputs> {
        let path = self.path(key);
        // Anything else of this name, such as a pipe, could keep a reader waiting for ever.
        if !fs::symlink_metadata(&path).ok()?.is_file() {
            return None;
        }
        let bytes = fs::read(&path).ok()?;
        let (hash, content) = bytes.split_at_checked(HASH)?;
        if blake3::hash(content).as_bytes() != hash {
            return None;
        }
        let kept: FileContent = postcard::from_bytes(content).ok()?;
        let outputs = kept.outputs.iter().zip(module.outputs).map(|((type_id, bytes), spec)| {
            (type_id == spec.data_type.id).then(|| (spec.decode)(bytes).ok()).flatten()
        });
        let outputs: Vec<Value> = outputs.collect::<Option<_>>()?;
        if !outputs.iter().flat_map(Value::stored).all(|file| file.find_in(&self.folder)) {
            return None;
        }
        // The time of the file is the time of its last use; if it cannot be set, it goes sooner.
        let _ = fs::File::open(&path).and_then(|file| file.set_modified(SystemTime::now()));
        let is_whole = outputs.len() == module.outputs.len();
        let FileContent { log, missed, seconds, phases, .. } = kept;
        is_whole.then_some(NodeOutputs { outputs, log, missed, seconds, phases })
    }

    pub(crate) fn store(&self, key: Fingerprint, results: &NodeOutputs) {
        if results.seconds < WORTH_SECONDS {
            return;
        }
        let outputs = results.outputs.iter().map(|value| {
            Ok::<_, postcard::Error>((value.data_type().id.to_owned(), value.encode()?))
        });
        let Ok(outputs) = outputs.collect::<Result<_, _>>() else { return };
        let kept = FileContent {
            outputs,
            log: results.log.clone(),
            missed: results.missed.clone(),
            seconds: results.seconds,
            phases: results.phases.clone(),
        };
        // A full disk costs the next process time, and nothing else.
        if let Ok(content) = postcard::to_stdvec(&kept) {
            let files: Vec<_> = results.outputs.iter().flat_map(Value::stored).collect();
            let _ = self.write(key, &content, &files);
        }
    }

    fn write(&self, key: Fingerprint, content: &[u8], files: &[Stored]) -> io::Result<()> {
        let of_files: u64 = files.iter().map(Stored::n_bytes).sum();
        if (HASH + content.len()) as u64 + of_files > self.budget {
            return Ok(());
        }
        let kept = files.iter().map(|file| file.keep_in(&self.folder));
        let mut new: Vec<PathBuf> = kept.collect::<Result<_, _>>()?;
        let mut file = fresh_file(&self.folder, TEMPORARY)?;
        file.write_all(blake3::hash(content).as_bytes())?;
        file.write_all(content)?;
        file.persist(self.path(key))?;
        new.push(self.path(key));
        let n_written = (HASH + content.len()) as u64 + of_files;
        let take = |leeway: u64| leeway.checked_sub(n_written);
        if self.leeway.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).is_err() {
            let left = self.evict(self.own_files()?, &new);
            self.leeway.store(self.budget.saturating_sub(left) / LEEWAY, Ordering::Relaxed);
        }
        Ok(())
    }

    /// The files of this cache: time of the last use, size, path.
    fn own_files(&self) -> io::Result<Vec<(SystemTime, u64, PathBuf)>> {
        let mut files = Vec::new();
        for file in fs::read_dir(&self.folder)? {
            let file = file?;
            // Another process may have removed it by now.
            let Ok(about) = file.metadata() else { continue };
            // A folder that somebody uses for other things too keeps those.
            if about.is_file() && is_own(&file.file_name().to_string_lossy()) {
                files.push((about.modified()?, about.len(), file.path()));
            }
        }
        Ok(files)
    }

    /// Removes the files used longest ago, none of the new ones, until the budget holds. The bytes
    /// of those that are left.
    fn evict(&self, mut files: Vec<(SystemTime, u64, PathBuf)>, new: &[PathBuf]) -> u64 {
        files.sort();
        let mut total: u64 = files.iter().map(|(_, size, _)| size).sum();
        for (_, size, path) in files {
            if total <= self.budget {
                break;
            }
            // One that another process has removed makes room too; one that stays makes none.
            if !new.contains(&path) && (fs::remove_file(&path).is_ok() || !path.exists()) {
                total -= size;
            }
        }
        total
    }
}

/// Whether a file of this name is one of ours: `<key>.values`, `<id>.stored`, or what a killed
/// process left.
fn is_own(name: &str) -> bool {
    let hash = name.strip_suffix(".values").or_else(|| name.strip_suffix(SUFFIX));
    hash.is_some_and(|hash| hash.parse::<Fingerprint>().is_ok()) || name.starts_with(TEMPORARY)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::port::Out;
    use crate::stored::StoredWriter;
    use crate::testing::ECHO;

    fn outputs(text: &str) -> NodeOutputs {
        let values = vec![Value::new(text.to_owned())];
        NodeOutputs {
            outputs: values,
            log: Vec::new(),
            missed: Vec::new(),
            seconds: 1.0,
            phases: IndexMap::new(),
        }
    }

    #[test]
    fn brings_back_what_was_stored_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let cache = DiskCache::open(folder.path(), 1 << 20).unwrap();
        let key = Fingerprint::of(b"a");
        cache.store(key, &outputs("hello"));
        assert_eq!(cache.load(key, &ECHO).unwrap().outputs[0].summary(), "hello");
        assert!(cache.load(Fingerprint::of(b"b"), &ECHO).is_none());
    }

    #[test]
    fn any_changed_byte_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let cache = DiskCache::open(folder.path(), 1 << 20).unwrap();
        let key = Fingerprint::of(b"a");
        cache.store(key, &outputs("hello"));
        let whole = fs::read(cache.path(key)).unwrap();
        for place in 0..whole.len() {
            let mut broken = whole.clone();
            broken[place] ^= 1;
            fs::write(cache.path(key), &broken).unwrap();
            assert!(cache.load(key, &ECHO).is_none(), "byte {place}");
            fs::write(cache.path(key), &whole[..place]).unwrap();
            assert!(cache.load(key, &ECHO).is_none(), "cut at {place}");
        }
    }

    #[test]
    fn the_budget_holds_and_the_files_of_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("scans")).unwrap();
        let scan = fs::File::create(folder.path().join("scan.obj")).unwrap();
        scan.set_len(1 << 40).unwrap();
        let cache = DiskCache::open(folder.path(), 3000).unwrap();
        for n in 0..10_u8 {
            cache.store(Fingerprint::of(&[n]), &outputs(&"x".repeat(1000)));
        }
        assert_eq!(scan.metadata().unwrap().len(), 1 << 40);
        assert!(folder.path().join("scan.obj").exists() && folder.path().join("scans").exists());
        let own = fs::read_dir(folder.path()).unwrap().flatten();
        let own = own.filter(|file| is_own(&file.file_name().to_string_lossy()));
        let sizes: Vec<u64> = own.map(|file| file.metadata().unwrap().len()).collect();
        assert!(!sizes.is_empty() && sizes.iter().sum::<u64>() <= 3000, "{sizes:?}");
    }

    #[test]
    fn what_another_process_has_removed_makes_room_and_what_is_new_stays() {
        let folder = tempfile::tempdir().unwrap();
        let cache = DiskCache::open(folder.path(), 25).unwrap();
        let file = |n: u8, is_there: bool| {
            let path = cache.path(Fingerprint::of(&[n]));
            if is_there {
                fs::write(&path, [0; 10]).unwrap();
            }
            (SystemTime::UNIX_EPOCH + Duration::from_secs(n.into()), 10, path)
        };
        // In the order of their last use: new, gone, old, and one that fits with the new one.
        let files = vec![file(0, true), file(1, false), file(2, true), file(3, true)];
        let paths: Vec<_> = files.iter().map(|(.., path)| path.clone()).collect();
        cache.evict(files, &paths[..1]);
        let is_there: Vec<_> = paths.iter().map(|path| path.exists()).collect();
        assert_eq!(is_there, [true, false, false, true]);
    }

    #[test]
    fn a_file_that_is_kept_already_stays_for_the_next_value() {
        const FILE_OUT: Out<Stored> = Out::new("file", "A file.");
        static FILE: Module = Module {
            id: "File",
            summary: "Gives a file.",
            inputs: &[],
            outputs: &[FILE_OUT.spec()],
            params: &[],
            run: |_| Ok(()),
        };
        let folder = tempfile::tempdir().unwrap();
        let mut writer = StoredWriter::in_folder(folder.path()).unwrap();
        writer.write_all(&[7; 1000]).unwrap();
        let file = writer.finish().unwrap();
        let kept = file.keep_in(folder.path()).unwrap();
        let handle = fs::File::options().write(true).open(kept).unwrap();
        handle.set_modified(SystemTime::UNIX_EPOCH).unwrap();
        // The oldest file goes first, but for the one that the value needs.
        let cache = DiskCache::open(folder.path(), 1500).unwrap();
        let [text, key] = [Fingerprint::of(b"a"), Fingerprint::of(b"b")];
        fs::write(cache.path(text), [0; 600]).unwrap();
        cache.store(key, &NodeOutputs { outputs: vec![Value::new(file.clone())], ..outputs("") });
        assert!(!cache.path(text).exists());
        let found = cache.load(key, &FILE).unwrap();
        assert_eq!(found.outputs[0].get::<Stored>().as_deref(), Some(&file));
    }
}
