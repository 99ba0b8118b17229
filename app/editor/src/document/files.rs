//! Copies of maps that were not saved, for the case of a crash.
//!
//! A process keeps its copies under a session of its own, and holds a lock on the session's file
//! for as long as it lives. The system releases the lock when the process is killed, so the copies
//! of a session without a lock are those of a crash.

use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use mve_core::MapError;
use serde::{Deserialize, Serialize};

use super::Document;

/// What the files of sessions and of copies end in.
const SESSION: &str = "session";
const COPY: &str = "copy";

/// Keeps copies of maps that were not saved.
#[derive(Debug)]
pub struct Recovery {
    folder: PathBuf,
    session: String,
    /// The locks of this session, and of those whose copies were found by it.
    locks: Vec<File>,
    /// The revisions of documents that were copied last.
    copied: HashMap<u64, u64>,
}

/// What a copy's file holds: one file, so that text and path are never of different times.
#[derive(Serialize, Deserialize)]
struct Copy {
    path: Option<PathBuf>,
    text: String,
}

/// A map that was not saved before a crash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recovered {
    /// The map's file, if it had one.
    pub path: Option<PathBuf>,
    /// The text of the map.
    pub text: String,
    /// When it was copied, if the file system says so.
    pub at: Option<SystemTime>,
    /// The copy.
    file: PathBuf,
}

impl Recovery {
    /// Begins a session in a folder, which is made if it is not there.
    pub fn new(folder: &Path) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        loop {
            let mut name = tempfile::Builder::new();
            let made = name.suffix(&format!(".{SESSION}")).tempfile_in(folder)?;
            let (file, path) = made.keep().map_err(|error| error.error)?;
            lock(&file)?;
            // Between making and locking, another process may have cleared the file away.
            let session = path.file_stem().and_then(|stem| stem.to_str());
            if let (Some(session), true) = (session, path.exists()) {
                let session = session.to_owned();
                let folder = folder.to_owned();
                return Ok(Self { folder, session, locks: vec![file], copied: HashMap::new() });
            }
        }
    }

    /// Copies a document that was not saved; does nothing if it was not changed since the last
    /// copy, and removes the copy of a document that was saved.
    pub fn autosave(&mut self, document: &Document) -> io::Result<()> {
        let known = self.copied.get(&document.id()).copied();
        if !document.is_dirty() {
            return if known.is_some() { self.forget(document) } else { Ok(()) };
        }
        if known == Some(document.revision()) {
            return Ok(());
        }
        let path = document.path().map(std::path::absolute).transpose()?;
        let copy = Copy { path, text: document.text().to_owned() };
        let mut file = tempfile::NamedTempFile::new_in(&self.folder)?;
        file.write_all(&serde_json::to_vec(&copy)?)?;
        file.as_file().sync_all()?;
        file.persist(self.file_of(document)).map_err(|error| error.error)?;
        self.copied.insert(document.id(), document.revision());
        Ok(())
    }

    /// Removes the copy of a document that was saved or closed.
    pub fn forget(&mut self, document: &Document) -> io::Result<()> {
        match self.copied.remove(&document.id()) {
            Some(_) => fs::remove_file(self.file_of(document)),
            None => Ok(()),
        }
    }

    /// The maps that sessions before this one left behind. They stay until they are discarded, and
    /// no other process finds them as long as this one lives.
    pub fn found(&mut self) -> io::Result<Vec<Recovered>> {
        let mut found = Vec::new();
        let mut files: Vec<PathBuf> = fs::read_dir(&self.folder)?
            .map(|entry| Ok(entry?.path()))
            .collect::<io::Result<_>>()?;
        files.sort();
        let is_a = |path: &&PathBuf, kind: &str| path.extension().is_some_and(|e| e == kind);
        for session in files.iter().filter(|path| is_a(path, SESSION)) {
            let Some(name) = session.file_stem().and_then(|stem| stem.to_str()) else { continue };
            let Ok(file) = File::open(session) else { continue };
            if name == self.session || !lock(&file)? {
                continue;
            }
            let copies = files.iter().filter(|path| is_a(path, COPY));
            let begins = format!("{name}-");
            let own = copies.filter(|path| {
                path.file_name().and_then(|n| n.to_str()).is_some_and(|n| n.starts_with(&begins))
            });
            let read = own.filter_map(|path| {
                let Copy { path: of, text } = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
                let at = fs::metadata(path).and_then(|about| about.modified()).ok();
                Some(Recovered { path: of, text, at, file: path.clone() })
            });
            let n_before = found.len();
            found.extend(read);
            if found.len() == n_before {
                fs::remove_file(session)?;
            } else {
                self.locks.push(file);
            }
        }
        Ok(found)
    }

    /// Removes a copy that was opened again, or that nobody wants.
    pub fn discard(&mut self, recovered: &Recovered) -> io::Result<()> {
        fs::remove_file(&recovered.file)
    }

    fn file_of(&self, document: &Document) -> PathBuf {
        self.folder.join(format!("{}-{}.{COPY}", self.session, document.id()))
    }
}

impl Drop for Recovery {
    fn drop(&mut self) {
        // With copies left, the next session finds them by this file.
        if self.copied.is_empty() {
            let file = self.folder.join(format!("{}.{SESSION}", self.session));
            let _ = fs::remove_file(file);
        }
    }
}

impl Recovered {
    /// The map as it was, not saved.
    pub fn open(&self) -> Result<Document, MapError> {
        let mut document = Document::from_text(&self.text)?;
        document.path.clone_from(&self.path);
        document.on_disk = None;
        document.keep_mine();
        Ok(document)
    }
}

/// Whether the lock is ours now. Where the file system has no locks, it is.
fn lock(file: &File) -> io::Result<bool> {
    match file.try_lock() {
        Ok(()) => Ok(true),
        Err(TryLockError::WouldBlock) => Ok(false),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(true),
        Err(TryLockError::Error(error)) => Err(error),
    }
}
