//! Saving a file whole or not at all.
//!
//! The bytes go to a temporary file in the same folder, are synced to the disk, and replace the
//! old file by one rename. A reader sees the old file or the new one, never a part; a full disk, a
//! failing writer or a killed process leaves the old file whole. Of a large file the disk gets what
//! is there while the rest is being made.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::thread::JoinHandle;

use super::FileError;

/// Writes a file through `fill` and puts it in the place of `path` once it is complete.
///
/// A symbolic link is followed, so that the file it names is replaced and the link stays. The
/// permissions of an old file are kept; a new file gets those that the system gives new files.
///
/// # Errors
/// Whatever `fill` or the system reports, with the path. Then `path` is as it was before and no
/// temporary file is left.
pub fn save_atomic(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    replace(path, fill).map_err(|source| FileError::write(path, source))
}

fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if target.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    let is_special = fs::symlink_metadata(&target).is_ok_and(|about| !about.is_file());
    if is_special {
        let message =
            "it is a device, a pipe or a link that leads nowhere, and a file would take its place";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".mve-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask is applied to these, as it is to any new file.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    // The errors of the crate name the temporary file, which means nothing to the user.
    let plain = |error: io::Error| match error.kind() {
        io::ErrorKind::Other => error,
        kind => error.raw_os_error().map_or(kind.into(), io::Error::from_raw_os_error),
    };
    let file = builder.tempfile_in(folder).map_err(plain)?;
    let mut buffered = BufWriter::with_capacity(1 << 16, EarlySync::of(file.as_file()));
    fill(&mut buffered)?;
    buffered.into_inner().map_err(|error| error.into_error())?.finish()?;
    if let Ok(old) = fs::metadata(&target) {
        file.as_file().set_permissions(old.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|failed| plain(failed.error))?;
    // The rename is complete for every reader; syncing the folder makes it outlive a power cut
    // where the system can do that, and is no error where it cannot.
    if let Ok(handle) = fs::File::open(folder) {
        let _ = handle.sync_all();
    }
    Ok(())
}

/// Bytes after which the system is told to bring them to the disk.
const SYNC_EVERY: usize = 8 << 20;

/// A file of which what was written is synced now and then, on a thread of its own.
struct EarlySync<'a> {
    file: &'a File,
    /// Bytes since the last time.
    n_new: usize,
    running: Option<JoinHandle<io::Result<()>>>,
}

impl<'a> EarlySync<'a> {
    fn of(file: &'a File) -> Self {
        Self { file, n_new: 0, running: None }
    }

    /// Waits for the thread, if there is one. An error that it met is told to nobody else.
    fn finish(mut self) -> io::Result<()> {
        self.wait()
    }

    fn wait(&mut self) -> io::Result<()> {
        match self.running.take().map(JoinHandle::join) {
            Some(Ok(synced)) => synced,
            // It has nothing that could panic; the last sync brings all to the disk.
            Some(Err(_)) | None => Ok(()),
        }
    }
}

impl Write for EarlySync<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.file.write(bytes)?;
        self.n_new += n;
        let is_free = self.running.as_ref().is_none_or(JoinHandle::is_finished);
        if self.n_new >= SYNC_EVERY && is_free {
            self.wait()?;
            self.n_new = 0;
            let file = self.file.try_clone()?;
            let sync = std::thread::Builder::new().name("mve sync".to_owned());
            // Without a thread the last sync has more to do.
            self.running = sync.spawn(move || file.sync_data()).ok();
        }
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("folder");
        entries.map(|e| e.expect("entry").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_failing_writer_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("a.obj");
        fs::write(&path, "old").expect("write");
        let error = save_atomic(&path, |out| {
            out.write_all(&[b'x'; 1 << 20])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .expect_err("the disk is full");
        assert!(error.to_string().contains("a.obj"), "{error}");
        assert!(error.to_string().contains("free some space"), "{error}");
        assert_eq!(fs::read_to_string(&path).expect("read"), "old");
        assert_eq!(names_in(folder.path()), ["a.obj"]);
    }

    /// Large enough to be synced on the way, in pieces of any size.
    #[test]
    fn large_files_are_whole() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("a");
        let bytes: Vec<u8> = (0..3 * SYNC_EVERY + 17).map(|at| ((at * at) >> 7) as u8).collect();
        save_atomic(&path, |out| {
            bytes.chunks(1 << 20).try_for_each(|piece| out.write_all(piece))?;
            out.write_all(b"end")
        })
        .expect("save");
        let read = fs::read(&path).expect("read");
        assert!(
            read.len() == bytes.len() + 3 && read.starts_with(&bytes) && read.ends_with(b"end")
        );
        assert_eq!(names_in(folder.path()), ["a"]);
    }

    #[test]
    fn a_missing_folder_and_a_folder_as_target_are_named() {
        let folder = tempfile::tempdir().expect("folder");
        let missing = save_atomic(&folder.path().join("no/a.obj"), |_| Ok(())).expect_err("no");
        assert!(missing.to_string().contains("create the folder first"), "{missing}");
        assert!(!missing.to_string().contains(".mve-"), "{missing}");
        let is_folder = save_atomic(folder.path(), |_| Ok(())).expect_err("a folder");
        assert!(is_folder.to_string().contains("not a folder"), "{is_folder}");
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_links_to_nowhere_are_not_replaced() {
        let folder = tempfile::tempdir().expect("folder");
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("nowhere", &link).expect("link");
        for path in [link.as_path(), Path::new("/dev/null")] {
            let error = save_atomic(path, |_| Ok(())).expect_err("special").to_string();
            assert!(error.contains("a file would take its place"), "{error}");
        }
        assert!(link.is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_survive() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().expect("folder");
        let (path, link) = (folder.path().join("a"), folder.path().join("b"));
        fs::write(&path, "old").expect("write");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("permissions");
        symlink(&path, &link).expect("link");
        save_atomic(&link, |out| out.write_all(b"new")).expect("save");
        assert_eq!(fs::read_to_string(&path).expect("read"), "new");
        assert!(fs::symlink_metadata(&link).expect("link").is_symlink());
        assert_eq!(fs::metadata(&path).expect("file").permissions().mode() & 0o777, 0o640);
    }
}
