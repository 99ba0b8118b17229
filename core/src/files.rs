//! Fingerprints of input files, remembered for as long as a file keeps its size and time.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use tempfile::NamedTempFile;

use crate::fingerprint::Fingerprint;

/// A temporary file in `folder`, with the permissions that the system gives new files.
pub(crate) fn fresh_file(folder: &Path, prefix: &str) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask is applied to these, as it is to any new file.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Whether `path` is below its base by its text alone: no `..`, no root, no drive.
pub fn is_below(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

/// Refuses a path below `base` on which a symbolic link could lead elsewhere.
pub(crate) fn refuse_links(base: &Path, below: &Path) -> Result<(), String> {
    let mut path = base.to_owned();
    for part in below.components() {
        path.push(part);
        if path.is_symlink() {
            let message = "is a symbolic link, which may lead out of the output folder";
            return Err(format!("{} {message}; remove it", path.display()));
        }
    }
    Ok(())
}

/// Refuses to write where something else than a file or folder lies, which would be gone.
pub fn refuse_special(path: &Path) -> Result<(), String> {
    let Ok(about) = std::fs::symlink_metadata(path) else { return Ok(()) };
    let what = match about.file_type() {
        kind if kind.is_file() || kind.is_dir() => return Ok(()),
        kind if kind.is_symlink() => "a symbolic link",
        _ => "a device or a pipe",
    };
    Err(format!("{} is {what}, and a file would take its place; name another one", path.display()))
}

/// What lies at a path below `base`: itself, or all that is in the folder there, by name.
pub(crate) fn lying_at(base: &Path, below: &Path) -> Vec<PathBuf> {
    match std::fs::read_dir(base.join(below)) {
        Err(_) => vec![below.to_owned()],
        Ok(entries) => {
            let names = entries.flatten().map(|entry| below.join(entry.file_name()));
            let mut paths: Vec<PathBuf> = names.collect();
            paths.sort();
            paths
        }
    }
}

/// Remembers the fingerprints of files, so that ten thousand steps over one scan read it once.
#[derive(Debug, Default)]
pub struct FileHashes {
    known: Mutex<HashMap<PathBuf, FileHash>>,
}

#[derive(Clone, Copy, Debug)]
struct FileHash {
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
        known.insert(path.to_owned(), FileHash { size, modified, fingerprint });
        Ok(fingerprint)
    }
}

/// What went wrong with a file, and what to do.
fn explain(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
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

    #[cfg(unix)]
    #[test]
    fn links_devices_and_sockets_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let [link, socket] = ["link", "socket"].map(|name| folder.path().join(name));
        std::os::unix::fs::symlink("nowhere", &link).unwrap();
        let _open = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        assert!(refuse_special(&link).unwrap_err().contains("is a symbolic link"));
        for device in [socket.as_path(), Path::new("/dev/null")] {
            assert!(refuse_special(device).unwrap_err().contains("is a device or a pipe"));
        }
        for plain in [folder.path(), &folder.path().join("new.obj")] {
            assert_eq!(refuse_special(plain), Ok(()));
        }
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
