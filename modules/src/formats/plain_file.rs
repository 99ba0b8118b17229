//! Reading a file whole, if it is one.

use std::fs;
use std::io;
use std::path::Path;

/// Reads an ordinary file of at most so many bytes. Devices and pipes are refused, since they may
/// have no end.
pub fn read_plain(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    let about = fs::metadata(path)?;
    if about.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    if !about.is_file() {
        return Err(io::Error::other("it is a device or a pipe"));
    }
    if about.len() > max_bytes {
        return Err(io::Error::other(format!("it is larger than {} MB", max_bytes >> 20)));
    }
    fs::read(path)
}
