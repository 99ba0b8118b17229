//! Why a module gave no result.

use std::path::PathBuf;

use thiserror::Error;

use crate::control::Cancelled;

/// Why a module gave no result.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ModuleError {
    /// An input is not what the module can work on.
    #[error("input \"{port}\": {message}")]
    Input {
        /// The port.
        port: String,
        /// The offending element, what was found and what was expected.
        message: String,
    },
    /// A parameter does not go with the inputs or with another parameter.
    #[error("parameter \"{name}\": {message}")]
    Param {
        /// The parameter.
        name: String,
        /// What was found and what was expected.
        message: String,
    },
    /// There is no result, for a reason that is not one of the others; the message says all.
    #[error("{0}")]
    Failed(String),
    /// A file could not be read or written.
    #[error("{}: {message}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, with the line where there is one, and what to do.
        message: String,
    },
    /// The run was stopped.
    #[error("stopped")]
    Cancelled,
    /// The module broke its own declaration, or panicked.
    #[error("this is a bug in the module: {0}")]
    Bug(String),
}

impl ModuleError {
    /// Whether it quotes an error of the system, such as a full disk or a missing permission: the
    /// same work may succeed another time.
    pub(crate) fn is_of_the_system(&self) -> bool {
        match self {
            // The sign that the standard library puts behind such an error.
            Self::Io { message, .. } | Self::Failed(message) => message.contains("(os error "),
            _ => false,
        }
    }
}

impl From<Cancelled> for ModuleError {
    fn from(Cancelled: Cancelled) -> Self {
        Self::Cancelled
    }
}
