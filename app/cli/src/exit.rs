//! How the command ends: exit codes, and errors in words for a person.

use std::io::ErrorKind;
use std::path::Path;

use mve_core::StoreError;

/// Exit codes; `mve --help` says what they mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All done.
    Done = 0,
    /// A node or a step failed.
    Failed = 1,
    /// Wrong usage. The parser of the command line gives the same code.
    Usage = 2,
    /// The map or the program has problems; nothing was run.
    Refused = 3,
    /// A file or folder could not be read or written.
    Files = 4,
    /// Steps are missing that no failure accounts for: with other processes, or left by them.
    Incomplete = 5,
    /// Stopped by a person.
    Interrupted = 130,
}

/// Why the command cannot go on.
#[derive(Debug)]
pub struct Stop {
    /// The code to end with.
    pub exit: Exit,
    /// What to say; empty where all has been said.
    pub message: String,
}

impl Stop {
    /// Wrong usage that the parser of the command line cannot see.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { exit: Exit::Usage, message: message.into() }
    }

    /// Problems of a map or a program.
    pub fn refused(message: impl Into<String>) -> Self {
        Self { exit: Exit::Refused, message: message.into() }
    }

    /// Trouble with a file or folder.
    pub fn file(path: &Path, error: &std::io::Error) -> Self {
        let message = format!("{}: {}", path.display(), explain(error));
        Self { exit: Exit::Files, message }
    }
}

impl From<StoreError> for Stop {
    fn from(error: StoreError) -> Self {
        match &error {
            StoreError::Io { path, source } => {
                let mut stop = Self::file(path, source);
                if source.kind() == ErrorKind::StorageFull {
                    stop.message += "; finished steps are kept: make room, and the same command \
                                     goes on";
                }
                stop
            }
            StoreError::NotAStore(_)
            | StoreError::OtherProgram { .. }
            | StoreError::TornPlan { .. } => Self { exit: Exit::Files, message: error.to_string() },
        }
    }
}

/// What the system said, in words.
pub fn explain(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file or folder".to_owned(),
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        ErrorKind::IsADirectory => "is a folder, not a file".to_owned(),
        ErrorKind::NotADirectory => "a file stands where a folder is needed".to_owned(),
        ErrorKind::AlreadyExists => "a file of this name is in the way".to_owned(),
        ErrorKind::StorageFull => "the disk is full".to_owned(),
        ErrorKind::ReadOnlyFilesystem => "the disk can only be read".to_owned(),
        _ => {
            let text = error.to_string();
            text.split_once(" (os error").map_or(text.clone(), |(words, _)| words.to_owned())
        }
    }
}
