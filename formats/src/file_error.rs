//! A failed file operation: what was tried, on which path, why it failed and what to do about it.

use std::io;
use std::path::{Path, PathBuf};

use mve_core::{Cancelled, ModuleError};
use thiserror::Error;

/// Why a file could not be read or written. The message names the path and the way out.
#[derive(Debug, Error)]
#[error("cannot {action} {path}: {source}; {advice}", path = path.display(), advice = self.advice())]
pub struct FileError {
    /// The file, as the caller named it.
    pub path: PathBuf,
    /// `read` or `write`.
    pub action: FileAction,
    /// What the system said.
    pub source: io::Error,
}

/// What was being done to a file when it failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileAction {
    /// Reading it.
    Read,
    /// Writing it.
    Write,
}

impl std::fmt::Display for FileAction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Read => "read",
            Self::Write => "write",
        })
    }
}

impl FileError {
    /// The error of reading `path`.
    pub fn read(path: &Path, source: io::Error) -> Self {
        Self { path: path.to_path_buf(), action: FileAction::Read, source }
    }

    /// The error of writing `path`.
    pub fn write(path: &Path, source: io::Error) -> Self {
        Self { path: path.to_path_buf(), action: FileAction::Write, source }
    }

    /// Whether the caller ended the work: writers pass [`Cancelled`] on as an [`io::Error`].
    pub fn is_cancelled(&self) -> bool {
        self.source.get_ref().is_some_and(|inner| inner.is::<Cancelled>())
    }

    /// What the user can do, in a few words.
    fn advice(&self) -> &'static str {
        use io::ErrorKind as Kind;
        let is_read = self.action == FileAction::Read;
        match self.source.kind() {
            Kind::NotFound if is_read => "check its name and the folder that it is relative to",
            Kind::NotFound => "create the folder first",
            Kind::PermissionDenied if is_read => "ask for permission to read it",
            Kind::PermissionDenied => "choose a folder in which you may write",
            Kind::IsADirectory | Kind::NotADirectory => "name a file, not a folder",
            Kind::StorageFull | Kind::QuotaExceeded => {
                "free some space; the file that was there before is untouched"
            }
            Kind::InvalidData | Kind::InvalidInput => "nothing was changed",
            _ if is_read => "check that it is an ordinary file",
            _ => "the file that was there before is untouched",
        }
    }
}

impl From<FileError> for ModuleError {
    fn from(error: FileError) -> Self {
        if error.is_cancelled() {
            return Self::Cancelled;
        }
        let FileError { path, action, source } = &error;
        Self::io(path, format!("cannot {action} it: {source}; {}", error.advice()))
    }
}
