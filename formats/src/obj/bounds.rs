//! Where the files lie that an OBJ file may name.

use std::io;
use std::path::{Path, PathBuf};

/// Which of the files that an OBJ file names may be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileScope {
    /// Those beside it and below. Then a file of a stranger names nothing else of this machine.
    Folder,
    /// All of them.
    Anywhere,
}

/// Where files may lie that a mesh names.
pub(crate) struct Bounds {
    /// The folder, without links in its path; `None` where all may be read.
    folder: Option<PathBuf>,
}

impl Bounds {
    /// The bounds of a scope around a folder.
    pub fn new(folder: &Path, scope: FileScope) -> Self {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let real = || folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        Self { folder: (scope == FileScope::Folder).then(real) }
    }

    /// Refuses a file that is elsewhere, through links or not.
    pub fn check(&self, path: &Path) -> io::Result<()> {
        let Some(folder) = &self.folder else { return Ok(()) };
        let message = "it lies outside of the folder of the mesh; switch allow_outside on if you \
                       trust it";
        match path.canonicalize()?.starts_with(folder) {
            true => Ok(()),
            false => Err(io::Error::other(message)),
        }
    }
}
