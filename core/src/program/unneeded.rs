//! What a store holds and its results do not need.

use std::collections::HashSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::store::{CACHE, Store, StoreError};

/// What a store holds and no step of its plan needs, as paths below its folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Unneeded {
    /// Steps of earlier plans.
    pub steps: Vec<PathBuf>,
    /// Files in `outputs/` that no step of the plan wrote.
    pub outputs: Vec<PathBuf>,
    /// Values that are there to save time.
    pub cache: Vec<PathBuf>,
}

impl Store {
    /// What no step of its plan needs.
    pub fn unneeded(&self) -> Result<Unneeded, StoreError> {
        let plan = self.plan()?;
        Ok(self.unneeded_by(&plan.steps.iter().map(|step| step.id.as_str()).collect()))
    }

    fn unneeded_by(&self, ids: &HashSet<&str>) -> Unneeded {
        let names = |part: &str| {
            let entries = fs::read_dir(self.folder().join(part)).into_iter().flatten().flatten();
            let mut names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
            names.sort();
            names
        };
        let is_stale = |name: &std::ffi::OsString| !ids.contains(&*name.to_string_lossy());
        let steps = names("steps").into_iter().filter(is_stale);
        let cache = names(CACHE).into_iter().map(|name| Path::new(CACHE).join(name));
        Unneeded {
            steps: steps.map(|name| Path::new("steps").join(name)).collect(),
            outputs: self.stale_outputs(ids),
            cache: cache.collect(),
        }
    }

    /// Files in `outputs/` that none of these steps wrote.
    fn stale_outputs(&self, ids: &HashSet<&str>) -> Vec<PathBuf> {
        let records: Vec<_> = ids.iter().filter_map(|id| self.record(id)).collect();
        let nodes = records.iter().flat_map(|record| record.nodes.values());
        let written: HashSet<&Path> =
            nodes.flat_map(|node| &node.files).map(PathBuf::as_path).collect();
        let mut stale = Vec::new();
        let mut folders = vec![PathBuf::new()];
        while let Some(folder) = folders.pop() {
            let path = self.folder().join("outputs").join(&folder);
            for entry in fs::read_dir(path).into_iter().flatten().flatten() {
                let path = folder.join(entry.file_name());
                match entry.file_type() {
                    Ok(kind) if kind.is_dir() => folders.push(path),
                    Ok(_) if !written.contains(path.as_path()) => {
                        stale.push(Path::new("outputs").join(path));
                    }
                    _ => {}
                }
            }
        }
        stale.sort();
        stale
    }

    /// Takes the files out of `outputs/` that none of these steps wrote; those of steps of earlier
    /// plans stay with their steps.
    pub(crate) fn drop_stale_outputs(&self, ids: &HashSet<&str>) -> Result<(), StoreError> {
        self.stale_outputs(ids).iter().try_for_each(|path| self.remove(path))
    }

    /// Removes a file or folder below the folder of the store, and folders that it leaves empty.
    pub fn remove(&self, below: &Path) -> Result<(), StoreError> {
        let path = self.folder().join(below);
        let is_folder = fs::symlink_metadata(&path).is_ok_and(|about| about.is_dir());
        let removed = if is_folder { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        match removed {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(StoreError::at(&path)(error)),
            _ => {
                let above = below.ancestors().skip(1).filter(|folder| folder.iter().count() > 1);
                // A folder that holds something else stays.
                above.for_each(|folder| drop(fs::remove_dir(self.folder().join(folder))));
                Ok(())
            }
        }
    }
}
