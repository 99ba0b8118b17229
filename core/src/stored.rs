//! Values that stay in a file: bytes that need not fit into memory.
//!
//! A [`Stored`] is a handle. Its content is cut into blocks of [`BLOCK`] bytes, each with a hash of
//! its own, so that any range is read and verified without reading the rest. A data type that holds
//! such handles names them in [`Data::stored`](crate::data::Data::stored); the cache on disk then
//! keeps the files themselves, by a second name where the file system allows that, and never copies
//! them through memory.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};
use tempfile::{NamedTempFile, TempPath};

use crate::files::fresh_file;
use crate::fingerprint::{Fingerprint, FingerprintBuilder};

/// Bytes of a block; the last one of a value may be shorter.
pub const BLOCK: usize = 1 << 20;

/// A handle to bytes in a file that never change. Clones share the file, which is deleted with the
/// last of them unless a cache keeps it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Stored(Arc<Content>);

#[derive(Debug, Serialize, Deserialize)]
struct Content {
    n_bytes: u64,
    /// The hash of each block.
    blocks: Vec<Fingerprint>,
    /// Where the bytes are; of a handle that was read from a cache, once they are found.
    #[serde(skip)]
    place: OnceLock<Place>,
}

#[derive(Debug)]
struct Place {
    path: PathBuf,
    /// Open as long as there is a handle, so that a cache may drop its name of the file.
    file: Mutex<File>,
    /// Deletes the file that a [`StoredWriter`] made.
    _own: Option<TempPath>,
}

impl Stored {
    /// How many bytes there are.
    pub fn n_bytes(&self) -> u64 {
        self.0.n_bytes
    }

    /// The name of the content: equal bytes have equal names.
    pub fn id(&self) -> Fingerprint {
        let mut id = FingerprintBuilder::new("mve stored 1");
        id.part(&self.0.n_bytes.to_le_bytes());
        self.0.blocks.iter().for_each(|block| id.fingerprint(*block));
        id.finish()
    }

    /// Fills `bytes` with what stands from `start` on. Reads and verifies the blocks that hold it,
    /// and no others; memory for one block.
    ///
    /// # Errors
    /// [`io::ErrorKind::UnexpectedEof`] beyond the end, [`io::ErrorKind::InvalidData`] for a block
    /// that has changed on disk, and whatever the system reports. A file with such a block is
    /// deleted, so that a cache makes the value again in the next run.
    pub fn read(&self, start: u64, bytes: &mut [u8]) -> io::Result<()> {
        let end = start.checked_add(bytes.len() as u64).filter(|end| *end <= self.0.n_bytes);
        let end = end.ok_or_else(|| io::Error::from(io::ErrorKind::UnexpectedEof))?;
        let place = self.0.place.get().ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))?;
        let mut block = Vec::new();
        let mut at = start;
        while at < end {
            let number = at / BLOCK as u64;
            let first = number * BLOCK as u64;
            let n = (self.0.n_bytes - first).min(BLOCK as u64);
            block.resize(n as usize, 0);
            {
                let mut file = place.file.lock().unwrap_or_else(PoisonError::into_inner);
                file.seek(SeekFrom::Start(first))?;
                file.read_exact(&mut block)?;
            }
            if self.0.blocks.get(number as usize) != Some(&Fingerprint::of(&block)) {
                let _ = std::fs::remove_file(&place.path);
                let message = format!(
                    "{}: block {number} has changed since it was written; run again",
                    place.path.display()
                );
                return Err(io::Error::new(io::ErrorKind::InvalidData, message));
            }
            let upto = end.min(first + n);
            let (from, into) = ((at - first) as usize, (at - start) as usize);
            let len = (upto - at) as usize;
            bytes[into..into + len].copy_from_slice(&block[from..from + len]);
            at = upto;
        }
        Ok(())
    }

    /// Gives the file a second name in a folder, or copies it where that cannot be.
    pub(crate) fn keep_in(&self, folder: &Path, prefix: &str) -> io::Result<()> {
        let place = self.0.place.get().ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))?;
        let kept = folder.join(self.file_name());
        if std::fs::metadata(&kept).is_ok_and(|about| about.len() == self.0.n_bytes) {
            return Ok(());
        }
        // What a full disk or a hand has cut short is no copy.
        let _ = std::fs::remove_file(&kept);
        if std::fs::hard_link(&place.path, &kept).is_ok() {
            return Ok(());
        }
        let mut copy = fresh_file(folder, prefix)?;
        io::copy(&mut File::open(&place.path)?, &mut copy)?;
        copy.persist(kept)?;
        Ok(())
    }

    /// Finds the bytes of a handle that was read from a cache in the cache's folder; whether a file
    /// of the right name and length is there. Its blocks are verified when they are read.
    pub(crate) fn find_in(&self, folder: &Path) -> bool {
        let path = folder.join(self.file_name());
        // Anything else of this name, such as a pipe, could keep a reader waiting for ever.
        let is_file = std::fs::symlink_metadata(&path).is_ok_and(|about| about.is_file());
        let Some(file) = is_file.then(|| File::open(&path).ok()).flatten() else { return false };
        let is_whole = file.metadata().is_ok_and(|about| about.len() == self.0.n_bytes);
        if is_whole {
            // The time of the file is the time of its last use.
            let _ = file.set_modified(std::time::SystemTime::now());
            self.0.place.get_or_init(|| Place { path, file: Mutex::new(file), _own: None });
        }
        is_whole
    }

    fn file_name(&self) -> String {
        format!("{}{SUFFIX}", self.id())
    }
}

/// How names of the files end that a cache keeps of stored values.
pub(crate) const SUFFIX: &str = ".stored";

impl PartialEq for Stored {
    fn eq(&self, other: &Self) -> bool {
        self.0.n_bytes == other.0.n_bytes && self.0.blocks == other.0.blocks
    }
}

impl Eq for Stored {}

impl Stored {
    /// Bytes of memory that the handle takes.
    pub(crate) fn handle_size(&self) -> usize {
        size_of::<Content>() + self.0.blocks.len() * size_of::<Fingerprint>()
    }

    /// Tests that there is a hash for each block.
    pub(crate) fn check(&self) -> Result<(), String> {
        let n_blocks = self.0.n_bytes.div_ceil(BLOCK as u64);
        let found = self.0.blocks.len();
        let complaint = || format!("{found} blocks for {} bytes", self.0.n_bytes);
        if n_blocks == found as u64 { Ok(()) } else { Err(complaint()) }
    }
}

/// Writes a [`Stored`] piece by piece, into a file in the system's folder for temporary files
/// (`TMPDIR`).
#[derive(Debug)]
pub struct StoredWriter {
    file: NamedTempFile,
    n_bytes: u64,
    blocks: Vec<Fingerprint>,
    /// The block that is not full yet.
    block: Vec<u8>,
}

impl StoredWriter {
    /// Begins a value of no bytes.
    ///
    /// # Errors
    /// If the system has no room for temporary files.
    pub fn new() -> io::Result<Self> {
        let file = fresh_file(&std::env::temp_dir(), "mve-stored-")?;
        Ok(Self { file, n_bytes: 0, blocks: Vec::new(), block: Vec::with_capacity(BLOCK) })
    }

    /// Ends the value.
    ///
    /// # Errors
    /// If the last block cannot be written.
    pub fn finish(mut self) -> io::Result<Stored> {
        self.end_block()?;
        let (file, path) = self.file.into_parts();
        let place = Place { path: path.to_path_buf(), file: Mutex::new(file), _own: Some(path) };
        let Self { n_bytes, blocks, .. } = self;
        Ok(Stored(Arc::new(Content { n_bytes, blocks, place: place.into() })))
    }

    fn end_block(&mut self) -> io::Result<()> {
        if !self.block.is_empty() {
            self.file.write_all(&self.block)?;
            self.blocks.push(Fingerprint::of(&self.block));
            self.block.clear();
        }
        Ok(())
    }
}

impl Write for StoredWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = bytes.len().min(BLOCK - self.block.len());
        self.block.extend_from_slice(&bytes[..n]);
        self.n_bytes += n as u64;
        if self.block.len() == BLOCK {
            self.end_block()?;
        }
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes of which no two blocks are alike.
    fn content(n: usize) -> Vec<u8> {
        (0..n).map(|i| (i ^ (i >> 8) ^ (i >> 16).wrapping_mul(101)) as u8).collect()
    }

    fn stored(bytes: &[u8]) -> Stored {
        let mut writer = StoredWriter::new().unwrap();
        writer.write_all(bytes).unwrap();
        writer.finish().unwrap()
    }

    #[test]
    fn any_range_comes_back_and_nothing_beyond_the_end() {
        let bytes = content(2 * BLOCK + 77);
        let value = stored(&bytes);
        assert_eq!((value.n_bytes(), value.0.blocks.len(), value.check()), (2_097_229, 3, Ok(())));
        for (start, n) in [(0, 5), (BLOCK - 2, 4), (BLOCK, BLOCK + 3), (2 * BLOCK + 70, 7), (9, 0)]
        {
            let mut found = vec![0; n];
            value.read(start as u64, &mut found).unwrap();
            assert_eq!(found, bytes[start..start + n], "{start} {n}");
        }
        let beyond = value.read(2 * BLOCK as u64 + 71, &mut [0; 7]).unwrap_err();
        assert_eq!(beyond.kind(), io::ErrorKind::UnexpectedEof);
        assert!(value.read(u64::MAX, &mut [0; 2]).is_err());
    }

    #[test]
    fn equal_bytes_have_one_name_and_the_file_goes_with_the_last_handle() {
        let (one, same, other) = (stored(b"abc"), stored(b"abc"), stored(b"abd"));
        assert!(one == same && one.id() == same.id() && one.id() != other.id());
        let path = one.0.place.get().unwrap().path.clone();
        let clone = one.clone();
        drop(one);
        assert!(path.is_file());
        drop(clone);
        assert!(!path.exists());
        assert_eq!(stored(b"").n_bytes(), 0);
    }

    #[test]
    fn a_block_that_has_changed_is_named_and_the_others_are_read() {
        let value = stored(&content(3 * BLOCK));
        let path = value.0.place.get().unwrap().path.clone();
        let mut file = File::options().write(true).open(&path).unwrap();
        file.seek(SeekFrom::Start(BLOCK as u64 + 5)).unwrap();
        file.write_all(b"x!").unwrap();
        let mut byte = [0];
        value.read(0, &mut byte).unwrap();
        value.read(2 * BLOCK as u64, &mut byte).unwrap();
        let error = value.read(BLOCK as u64 + 900, &mut byte).unwrap_err();
        assert!(error.to_string().contains("block 1 has changed"), "{error}");
        assert!(!path.exists());
    }
}
