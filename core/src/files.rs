//! Fingerprints of input files, remembered for as long as a file keeps its size and time.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use crate::fingerprint::Fingerprint;

/// Remembers the fingerprints of files, so that ten thousand steps over one scan read it once.
#[derive(Debug, Default)]
pub struct FileHashes {
    known: Mutex<HashMap<PathBuf, Known>>,
}

#[derive(Clone, Copy, Debug)]
struct Known {
    size: u64,
    modified: Option<SystemTime>,
    fingerprint: Fingerprint,
}

impl FileHashes {
    /// An empty memory.
    pub fn new() -> Self {
        Self::default()
    }

    /// The fingerprint of a file's content; the error is a sentence for a person.
    pub fn fingerprint(&self, path: &Path) -> Result<Fingerprint, String> {
        let about = std::fs::metadata(path).map_err(|error| explain(&error))?;
        if about.is_dir() {
            return Err("is a folder; name a file in it".to_owned());
        }
        if !about.is_file() {
            return Err("is not a regular file".to_owned());
        }
        let (size, modified) = (about.len(), about.modified().ok());
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(old) = known.get(path)
            && old.size == size
            && old.modified == modified
        {
            return Ok(old.fingerprint);
        }
        let fingerprint = Fingerprint::of_file(path).map_err(|error| explain(&error))?;
        known.insert(path.to_owned(), Known { size, modified, fingerprint });
        Ok(fingerprint)
    }
}

/// What went wrong with a file, and what to do.
fn explain(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => {
            "there is no such file; paths are relative to the map's folder".to_owned()
        }
        std::io::ErrorKind::PermissionDenied => {
            "permission denied; make the file readable for this user".to_owned()
        }
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_file_has_another_fingerprint() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let files = FileHashes::new();
        std::fs::write(&path, "one").unwrap();
        let first = files.fingerprint(&path).unwrap();
        assert_eq!(first, Fingerprint::of(b"one"));
        std::fs::write(&path, "three").unwrap();
        assert_ne!(files.fingerprint(&path).unwrap(), first);
    }

    #[test]
    fn folders_and_missing_files_are_explained() {
        let folder = tempfile::tempdir().unwrap();
        let files = FileHashes::new();
        assert!(files.fingerprint(folder.path()).unwrap_err().contains("folder"));
        let missing = files.fingerprint(&folder.path().join("no")).unwrap_err();
        assert!(missing.contains("no such file"));
    }
}
