//! STL files on the disk.

use std::path::Path;

use mve_core::{Control, ModuleError};
use mve_mesh::data::TriMesh;

use super::read::read_stl;
use crate::load_with;
use crate::warnings::Warning;

/// Reads an STL file, packed by gzip or not. Of a binary one that is not packed only so much is in
/// memory as is being worked on.
///
/// # Errors
/// With the path, where it cannot be read; that `control` ended the work.
pub fn load(path: &Path, control: Control) -> Result<(TriMesh, Vec<Warning>), ModuleError> {
    #[cfg(unix)]
    if let Some(mesh) = load_binary(path, control)? {
        return Ok(mesh);
    }
    load_with(path, control, read_stl)
}

/// Reads a binary file; `None` of a file that is not, or only says so.
#[cfg(unix)]
fn load_binary(
    path: &Path,
    control: Control,
) -> Result<Option<(TriMesh, Vec<Warning>)>, ModuleError> {
    use std::io::Read;

    use super::read::{BEGINNING, Kind, kind_of, read_binary};
    use super::records::{Records, Trouble};
    use super::{HEAD, RECORD};
    use crate::plain_file::{is_packed, open_plain};
    use crate::{FileError, ReadError};

    let failed = |error| FileError::read(path, error);
    let (file, n_bytes) = open_plain(path).map_err(failed)?;
    let mut beginning = Vec::new();
    (&file).take(BEGINNING as u64).read_to_end(&mut beginning).map_err(failed)?;
    if is_packed(&beginning) || (n_bytes as usize) < beginning.len() {
        return Ok(None);
    }
    let Ok(Kind::Binary(n)) = kind_of(&beginning, n_bytes) else { return Ok(None) };
    let n_more = n_bytes - (HEAD + n * RECORD) as u64;
    match read_binary(Records::File(&file, n), n_more, control) {
        Ok(mesh) => Ok(Some(mesh)),
        Err(Trouble::System(error)) => Err(failed(error).into()),
        Err(Trouble::Content(ReadError::Wrong(message))) => Err(ModuleError::io(path, message)),
        Err(Trouble::Content(ReadError::Cancelled(cancelled))) => Err(cancelled.into()),
    }
}
