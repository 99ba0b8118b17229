//! Values that stay in a file: bytes that need not fit into memory.
//!
//! A [`Stored`] is a handle. Its content is cut into blocks of [`BLOCK`] bytes, each with a hash of
//! its own, so that any range is read and verified without reading the rest. A data type that holds
//! such handles names them in [`Data::stored`](crate::data::Data::stored); the cache on disk then
//! keeps the files themselves and never copies them through memory. Modules write in its folder, so
//! that to keep a file is to give it another name.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};
use tempfile::{NamedTempFile, TempPath};

use crate::files::fresh_file;
use crate::fingerprint::{Fingerprint, FingerprintBuilder};

/// Bytes of a block; the last one of a value may be shorter.
pub const BLOCK: usize = 1 << 20;

/// How names of the files end that a cache keeps of stored values.
pub(crate) const SUFFIX: &str = ".stored";

/// How names of files begin that no cache has kept yet.
pub(crate) const TEMPORARY: &str = ".mve-values-";

/// A handle to bytes in a file that never change. Clones share the file, which is deleted with the
/// last of them unless a cache keeps it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Stored(Arc<Content>);

#[derive(Debug, Serialize, Deserialize)]
struct Content {
    n_bytes: u64,
    /// The hash of each block.
    blocks: Vec<Fingerprint>,
    /// Where the bytes are; of a handle that was read from a cache, once they are found. `None`
    /// again once a block was damaged.
    #[serde(skip)]
    place: Mutex<Option<Place>>,
}

#[derive(Debug)]
struct Place {
    /// Open as long as there is a handle, so that a cache may drop its name of the file.
    file: File,
    name: FileName,
    /// Blocks, by number, that were as they were written when they were first read from here.
    verified: Vec<bool>,
}

impl Place {
    /// Fills `part` with what stands in a block from `first` on. Whether the block is as it was
    /// written, as far as that is looked at.
    fn read(
        &mut self,
        content: &Content,
        number: u64,
        first: usize,
        part: &mut [u8],
    ) -> io::Result<bool> {
        let from = number * BLOCK as u64;
        if self.verified.get(number as usize) == Some(&true) {
            self.file.seek(SeekFrom::Start(from + first as u64))?;
            self.file.read_exact(part)?;
            return Ok(true);
        }
        let mut block = vec![0; (content.n_bytes - from).min(BLOCK as u64) as usize];
        self.file.seek(SeekFrom::Start(from))?;
        self.file.read_exact(&mut block)?;
        part.copy_from_slice(&block[first..first + part.len()]);
        let is_same = content.blocks.get(number as usize) == Some(&Fingerprint::of(&block));
        if is_same {
            self.verified.resize(content.blocks.len(), false);
            self.verified[number as usize] = true;
        }
        Ok(is_same)
    }
}

#[derive(Debug)]
enum FileName {
    /// Of the writer. The file is deleted with the name.
    Temporary(TempPath),
    /// In the folder of a cache.
    Kept(PathBuf),
}

impl Deref for FileName {
    type Target = Path;

    fn deref(&self) -> &Path {
        match self {
            Self::Temporary(path) => path,
            Self::Kept(path) => path,
        }
    }
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

    /// Fills `bytes` with what stands from `start` on. A block is read as a whole and verified the
    /// first time that a handle reads any of it, and after that only what is asked for; memory for
    /// one block.
    ///
    /// # Errors
    /// [`ErrorKind::UnexpectedEof`] beyond the end, and [`ErrorKind::InvalidData`] for a block that
    /// has changed on disk or cannot be read. A file with such a block is deleted and no handle
    /// reads it any more; [`run`](crate::run) then makes the value anew, once.
    pub fn read(&self, start: u64, bytes: &mut [u8]) -> io::Result<()> {
        let end = start.checked_add(bytes.len() as u64).filter(|end| *end <= self.0.n_bytes);
        let end = end.ok_or_else(|| io::Error::from(ErrorKind::UnexpectedEof))?;
        let mut at = start;
        while at < end {
            let number = at / BLOCK as u64;
            let upto = end.min((number + 1) * BLOCK as u64);
            let part = &mut bytes[(at - start) as usize..(upto - start) as usize];
            self.read_part(number, (at % BLOCK as u64) as usize, part)?;
            at = upto;
        }
        Ok(())
    }

    /// Fills `part` with what stands in a block from `first` on, or gives the file up.
    fn read_part(&self, number: u64, first: usize, part: &mut [u8]) -> io::Result<()> {
        let gone = || io::Error::new(ErrorKind::InvalidData, "its file was damaged; run again");
        // One lock for all of it: what is given up is what was read, and nothing found since.
        let mut place = self.place();
        let fault = match place.as_mut().ok_or_else(gone)?.read(&self.0, number, first, part) {
            Ok(true) => return Ok(()),
            Ok(false) => "has changed since it was written".to_owned(),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => "is cut short".to_owned(),
            Err(error) => format!("cannot be read: {error}"),
        };
        let Place { name, .. } = place.take().ok_or_else(gone)?;
        let _ = std::fs::remove_file(&*name);
        let message = format!("{}: block {number} {fault}; run again", name.display());
        Err(io::Error::new(ErrorKind::InvalidData, message))
    }

    /// Whether no block was found damaged so far.
    pub(crate) fn is_sound(&self) -> bool {
        self.place().is_some()
    }

    /// Keeps the file in a cache's folder: under another name where the file system allows that,
    /// else as a copy. Gives its path there.
    pub(crate) fn keep_in(&self, folder: &Path) -> io::Result<PathBuf> {
        let kept = folder.join(self.file_name());
        let mut place = self.place();
        let place = place.as_mut().ok_or_else(|| io::Error::from(ErrorKind::NotFound))?;
        let is_temporary = matches!(place.name, FileName::Temporary(_));
        if is_temporary && std::fs::rename(&*place.name, &kept).is_ok() {
            place.name = FileName::Kept(kept.clone());
            return Ok(kept);
        }
        if std::fs::metadata(&kept).is_ok_and(|about| about.len() == self.0.n_bytes) {
            return Ok(kept);
        }
        let mut copy = fresh_file(folder, TEMPORARY)?;
        place.file.rewind()?;
        io::copy(&mut place.file, &mut copy)?;
        copy.persist(&kept)?;
        Ok(kept)
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
            self.place().get_or_insert(Place {
                file,
                name: FileName::Kept(path),
                verified: Vec::new(),
            });
        }
        is_whole
    }

    fn place(&self) -> MutexGuard<'_, Option<Place>> {
        self.0.place.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn file_name(&self) -> String {
        format!("{}{SUFFIX}", self.id())
    }
}

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

/// Writes a [`Stored`] piece by piece. A module gets one that writes where the cache can keep the
/// file without a copy: see [`Io::stored_writer`](crate::Io::stored_writer).
#[derive(Debug)]
pub struct StoredWriter {
    file: NamedTempFile,
    n_bytes: u64,
    blocks: Vec<Fingerprint>,
    /// The block that is not full yet.
    block: Vec<u8>,
}

impl StoredWriter {
    /// Begins a value of no bytes, in the system's folder for temporary files (`TMPDIR`).
    ///
    /// # Errors
    /// If the system has no room for temporary files.
    pub fn new() -> io::Result<Self> {
        Self::in_folder(&std::env::temp_dir())
    }

    /// Begins a value of no bytes in this folder.
    pub(crate) fn in_folder(folder: &Path) -> io::Result<Self> {
        let file = fresh_file(folder, TEMPORARY)?;
        Ok(Self { file, n_bytes: 0, blocks: Vec::new(), block: Vec::with_capacity(BLOCK) })
    }

    /// Ends the value.
    ///
    /// # Errors
    /// If the last block cannot be written.
    pub fn finish(mut self) -> io::Result<Stored> {
        self.end_block()?;
        let (file, path) = self.file.into_parts();
        let place =
            Mutex::new(Some(Place { file, name: FileName::Temporary(path), verified: Vec::new() }));
        let Self { n_bytes, blocks, .. } = self;
        Ok(Stored(Arc::new(Content { n_bytes, blocks, place })))
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

    fn path_of(value: &Stored) -> PathBuf {
        value.place().as_ref().unwrap().name.to_path_buf()
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
        let path = path_of(&one);
        let clone = one.clone();
        drop(one);
        assert!(path.is_file());
        drop(clone);
        assert!(!path.exists());
        assert_eq!(stored(b"").n_bytes(), 0);
    }

    #[test]
    fn a_damaged_file_is_named_and_given_up() {
        let damages: [fn(&Path); 2] = [
            |path| {
                let mut bytes = std::fs::read(path).unwrap();
                bytes[BLOCK + 5] ^= 1;
                std::fs::write(path, bytes).unwrap();
            },
            |path| {
                let file = File::options().write(true).open(path).unwrap();
                file.set_len(BLOCK as u64 + 5).unwrap();
            },
        ];
        for damage in damages {
            let value = stored(&content(3 * BLOCK));
            let (path, clone) = (path_of(&value), value.clone());
            damage(&path);
            let mut byte = [0];
            value.read(0, &mut byte).unwrap();
            let error = value.read(BLOCK as u64 + 900, &mut byte).unwrap_err();
            let said = ["block 1 has changed", "block 1 is cut short"];
            assert!(said.iter().any(|said| error.to_string().contains(said)), "{error}");
            assert!(!path.exists() && !clone.is_sound());
            let error = clone.read(0, &mut byte).unwrap_err();
            assert_eq!(error.to_string(), "its file was damaged; run again");
        }
    }

    #[test]
    fn a_block_is_verified_once_and_then_read_in_parts() {
        let bytes = content(2 * BLOCK);
        let value = stored(&bytes);
        let mut part = [0; 9];
        value.read(BLOCK as u64 + 1, &mut part).unwrap();
        // What is beside the part is not looked at again; in the other block it is.
        let mut damaged = bytes.clone();
        (damaged[BLOCK + 500], damaged[500]) = (!bytes[BLOCK + 500], !bytes[500]);
        std::fs::write(path_of(&value), damaged).unwrap();
        value.read(BLOCK as u64 + 200, &mut part).unwrap();
        assert_eq!(part, bytes[BLOCK + 200..BLOCK + 209]);
        assert!(value.read(200, &mut part).unwrap_err().to_string().contains("block 0 has"));
    }

    #[test]
    fn a_kept_file_is_moved_and_made_again_from_the_open_one() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = StoredWriter::in_folder(folder.path()).unwrap();
        writer.write_all(b"abc").unwrap();
        let value = writer.finish().unwrap();
        let kept = value.keep_in(folder.path()).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert_eq!((path_of(&value), std::fs::read(&kept).unwrap()), (kept.clone(), b"abc".into()));
        std::fs::remove_file(&kept).unwrap();
        assert_eq!(value.keep_in(folder.path()).unwrap(), kept);
        drop(value);
        assert_eq!(std::fs::read(&kept).unwrap(), b"abc");
    }
}
