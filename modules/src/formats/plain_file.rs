//! Reading ordinary files. Devices and pipes are refused, since they may have no end.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

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
    let (mut file, n_bytes) = open_plain(path)?;
    if n_bytes > max_bytes {
        return Err(io::Error::other(format!("it is larger than {} MB", max_bytes >> 20)));
    }
    let mut bytes = Vec::with_capacity(n_bytes as usize);
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}
