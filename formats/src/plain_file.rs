//! Reading ordinary files. Devices and pipes are refused, since they may have no end.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use mve_core::{Cancelled, Control, ModuleError};
use rayon::prelude::*;
use thiserror::Error;

use super::FileError;

/// Why the bytes of a file could not be read as one of its format.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ReadError {
    /// What is wrong with them, with the line where there are lines.
    #[error("{0}")]
    Wrong(String),
    /// The caller ended the work.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Bytes that are read between two looks whether the work was cancelled: some milliseconds.
const PIECE: u64 = 1 << 23;

/// Opens an ordinary file, and tells how many bytes it has.
pub fn open_plain(path: &Path) -> io::Result<(File, u64)> {
    let about = fs::metadata(path)?;
    if about.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    if !about.is_file() {
        return Err(io::Error::other("it is a device or a pipe"));
    }
    Ok((File::open(path)?, about.len()))
}

/// Reads an ordinary file of at most so many bytes.
pub fn read_plain(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    read_long(path, max_bytes, Control::none())
}

/// The same of a file that may take long: fails with [`Cancelled`] in it when `control` says so.
pub fn read_long(path: &Path, max_bytes: u64, control: Control) -> io::Result<Vec<u8>> {
    let (mut file, n_bytes) = open_plain(path)?;
    if n_bytes > max_bytes {
        return Err(io::Error::other(format!("it is larger than {} MB", max_bytes >> 20)));
    }
    let mut bytes = read_on_threads(&file, n_bytes, control)?;
    // What stands there of a file that grows, and of one whose length the system does not tell.
    file.seek(SeekFrom::Start(bytes.len() as u64))?;
    loop {
        control.at(0.0).map_err(io::Error::other)?;
        if (&mut file).take(PIECE).read_to_end(&mut bytes)? == 0 {
            return Ok(bytes);
        }
    }
}

/// Files of fewer bytes are read at once.
const SHORT: u64 = 1 << 22;

/// Reads so many bytes on all threads, since one alone copies slower than memory can; none of a
/// short file, or where the system cannot.
fn read_on_threads(file: &File, n_bytes: u64, control: Control) -> io::Result<Vec<u8>> {
    let none = Vec::with_capacity(n_bytes.min(SHORT) as usize);
    #[cfg(unix)]
    if n_bytes > SHORT {
        use std::os::unix::fs::FileExt;
        const PART: usize = 1 << 19;
        // A length that is no memory's is an error, and no end of the program.
        Vec::<u8>::new().try_reserve_exact(n_bytes as usize)?;
        let mut bytes = vec![0; n_bytes as usize];
        let mut start = 0;
        for piece in bytes.chunks_mut(4 * PIECE as usize) {
            control.at(0.0).map_err(io::Error::other)?;
            let read = piece
                .par_chunks_mut(PART)
                .enumerate()
                .try_for_each(|(at, part)| file.read_exact_at(part, start + (at * PART) as u64));
            match read {
                // Somebody cuts it short at this moment.
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(none),
                read => read?,
            }
            start += 4 * PIECE;
        }
        return Ok(bytes);
    }
    Ok(none)
}

/// How a file that gzip has packed begins.
const GZIP: &[u8] = b"\x1f\x8b";

/// Whether gzip has packed a file that begins with these bytes.
pub fn is_packed(bytes: &[u8]) -> bool {
    bytes.starts_with(GZIP)
}

/// Bytes of the largest mesh that is unpacked.
const MOST_UNPACKED: u64 = 16 << 30;

/// Reads the file of a mesh, unpacked if gzip has packed it.
pub fn read_mesh_file(path: &Path, control: Control) -> io::Result<Vec<u8>> {
    let bytes = read_long(path, u64::MAX, control)?;
    if !is_packed(&bytes) {
        return Ok(bytes);
    }
    let mut packed = MultiGzDecoder::new(bytes.as_slice());
    let mut unpacked = Vec::new();
    loop {
        control.at(0.0).map_err(io::Error::other)?;
        if (&mut packed).take(PIECE).read_to_end(&mut unpacked)? == 0 {
            return Ok(unpacked);
        }
        if unpacked.len() as u64 > MOST_UNPACKED {
            let most = MOST_UNPACKED >> 30;
            return Err(io::Error::other(format!("it is larger than {most} GiB when unpacked")));
        }
    }
}

/// Reads at most so many bytes from the beginning of the file of a mesh, unpacked likewise.
pub fn read_beginning(path: &Path, n_bytes: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_plain(path)?.0.take(n_bytes).read_to_end(&mut bytes)?;
    if is_packed(&bytes) {
        bytes.clear();
        MultiGzDecoder::new(open_plain(path)?.0).take(n_bytes).read_to_end(&mut bytes)?;
    }
    Ok(bytes)
}

/// Reads the file of a mesh as what `read` makes of its bytes.
///
/// # Errors
/// As [`load`].
pub fn load_with<T>(
    path: &Path,
    control: Control,
    read: impl FnOnce(&[u8], Control) -> Result<T, ReadError>,
) -> Result<T, ModuleError> {
    let bytes = read_mesh_file(path, control.part(0.0, 0.2));
    let bytes = bytes.map_err(|source| FileError::read(path, source))?;
    read(&bytes, control.part(0.2, 1.0)).map_err(|error| match error {
        ReadError::Wrong(message) => ModuleError::io(path, message),
        ReadError::Cancelled(cancelled) => cancelled.into(),
    })
}

/// Reads an ordinary file of at most so many bytes as what `read` makes of them.
///
/// # Errors
/// With the path, where the file or its content cannot be read; that `control` ended the work.
pub fn load<T>(
    path: &Path,
    max_bytes: u64,
    control: Control,
    read: impl FnOnce(&[u8], Control) -> Result<T, ReadError>,
) -> Result<T, ModuleError> {
    let bytes = read_long(path, max_bytes, control);
    let bytes = bytes.map_err(|source| FileError::read(path, source))?;
    read(&bytes, control).map_err(|error| match error {
        ReadError::Wrong(message) => ModuleError::io(path, message),
        ReadError::Cancelled(cancelled) => cancelled.into(),
    })
}
