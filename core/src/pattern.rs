//! Files whose names fit a pattern, `scans/**/*.obj`, found within a bound: a pattern is also a
//! stranger's, and may lead through all of a disk.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glob::{MatchOptions, Pattern, PatternError};

/// How far a search goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// The most files and folders that are looked at.
    pub entries: usize,
    /// The longest that it takes.
    pub time: Duration,
}

/// What a search found.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Found {
    /// The files, as the pattern names them, in the order of their names.
    pub files: Vec<PathBuf>,
    /// The first folder that could not be read, and why.
    pub closed: Option<String>,
    /// Files and folders that were looked at when it was given up; `None` if it came to its end.
    pub given_up_at: Option<usize>,
    /// How many files have a name that is no text, which no map can say.
    pub n_nameless: usize,
}

/// What is wrong with a pattern, in words.
pub(crate) fn fault(error: &PatternError) -> &'static str {
    if error.msg.contains("range") {
        "a [ is not closed, or has nothing in it; [[] stands for the sign itself"
    } else {
        "** stands alone between two slashes, for any number of folders, and *** for nothing"
    }
}

/// The files of a pattern, which is relative to `folder`. A part `**` stands for any number of
/// folders, not through links; what begins with a dot is found where the pattern says the dot.
pub(crate) fn files(pattern: &str, folder: &Path, bounds: Bounds) -> Result<Found, PatternError> {
    Pattern::new(pattern)?;
    let is_separator = |c: char| c == '/' || (cfg!(windows) && c == '\\');
    let parts = pattern.split(is_separator).filter(|part| !part.is_empty() && *part != ".");
    let parts: Vec<(&str, Pattern)> =
        parts.map(|part| Ok((part, Pattern::new(part)?))).collect::<Result<_, PatternError>>()?;
    let start = match pattern.starts_with(is_separator) {
        true => PathBuf::from("/"),
        false => PathBuf::new(),
    };
    let (n_looked, begin) = (0, Instant::now());
    let mut search = Search { folder, bounds, begin, n_looked, found: Found::default() };
    let is_done = search.descend(&start, &parts);
    let mut found = search.found;
    found.given_up_at = is_done.is_none().then_some(search.n_looked);
    found.files.sort();
    found.files.dedup();
    Ok(found)
}

/// A file or folder in a folder.
struct Item {
    name: String,
    is_folder: bool,
    /// Whether this is its name, to the byte.
    is_text: bool,
}

struct Search<'a> {
    folder: &'a Path,
    bounds: Bounds,
    begin: Instant,
    n_looked: usize,
    found: Found,
}

impl Search<'_> {
    /// Finds what fits the parts below a folder that is named `base`; `None` once it is given up.
    fn descend(&mut self, base: &Path, parts: &[(&str, Pattern)]) -> Option<()> {
        let Some(((part, pattern), rest)) = parts.split_first() else {
            if self.whole(base).is_file() {
                self.found.files.push(base.to_owned());
            }
            return Some(());
        };
        if *part == "**" {
            return self.below(base, rest);
        }
        if !part.contains(['*', '?', '[']) {
            return self.descend(&base.join(part), rest);
        }
        for Item { name, is_folder, is_text } in self.entries(base)? {
            let fits = pattern.matches_with(&name, OPTIONS);
            match (is_folder, rest.is_empty()) {
                _ if !fits => {}
                (false, true) if !is_text => self.found.n_nameless += 1,
                (true, _) | (_, true) => self.descend(&base.join(&name), rest)?,
                (false, false) => {}
            }
        }
        Some(())
    }

    /// What fits in a folder and in all folders in it.
    fn below(&mut self, base: &Path, rest: &[(&str, Pattern)]) -> Option<()> {
        let mut todo = vec![base.to_owned()];
        while let Some(base) = todo.pop() {
            if !rest.is_empty() {
                self.descend(&base, rest)?;
            }
            for Item { name, is_folder, is_text } in self.entries(&base)? {
                let path = base.join(&name);
                if name.starts_with('.') {
                    continue;
                }
                if is_folder && !self.whole(&path).is_symlink() {
                    todo.push(path);
                } else if rest.is_empty() && !is_text {
                    self.found.n_nameless += 1;
                } else if rest.is_empty() {
                    self.descend(&path, rest)?;
                }
            }
        }
        Some(())
    }

    /// What is in a folder.
    fn entries(&mut self, base: &Path) -> Option<Vec<Item>> {
        let folder = self.whole(base);
        let entries = match std::fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(error) => {
                // What was there a moment ago, and what is no folder, tells nobody anything.
                if self.n_looked == 0 || error.kind() == ErrorKind::PermissionDenied {
                    let why = error.to_string();
                    let why = why.split(" (os error").next().unwrap_or_default().to_owned();
                    let closed = || format!("{}: {why}", folder.display());
                    self.found.closed.get_or_insert_with(closed);
                }
                return Some(Vec::new());
            }
        };
        let mut items = Vec::new();
        for entry in entries.flatten() {
            self.n_looked += 1;
            let is_late = self.begin.elapsed() > self.bounds.time;
            if is_late || self.n_looked > self.bounds.entries {
                return None;
            }
            let is_folder = match entry.file_type() {
                Ok(kind) if kind.is_symlink() => entry.path().is_dir(),
                kind => kind.is_ok_and(|kind| kind.is_dir()),
            };
            let name = entry.file_name();
            let is_text = name.to_str().is_some();
            items.push(Item { name: name.to_string_lossy().into_owned(), is_folder, is_text });
        }
        Some(items)
    }

    fn whole(&self, path: &Path) -> PathBuf {
        let whole = self.folder.join(path);
        if whole.as_os_str().is_empty() { PathBuf::from(".") } else { whole }
    }
}

const OPTIONS: MatchOptions = MatchOptions {
    case_sensitive: true,
    require_literal_separator: true,
    require_literal_leading_dot: true,
};

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Bounds = Bounds { entries: 1000, time: Duration::from_secs(60) };

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in ["b.obj", "a.obj", ".h.obj", "c.txt", "s/d.obj", "s/t/e.obj", ".g/f.obj"] {
            let path = folder.path().join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        folder
    }

    #[test]
    fn patterns_find_what_shells_find() {
        let folder = folder();
        let found = |pattern: &str| {
            let found = files(pattern, folder.path(), ALL).unwrap();
            assert_eq!(found.given_up_at, None);
            let names = found.files.iter().map(|path| path.to_str().unwrap().to_owned());
            names.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(found("*.obj"), "a.obj b.obj");
        assert_eq!(found("./[ab].*"), "a.obj b.obj");
        assert_eq!(found("**/*.obj"), "a.obj b.obj s/d.obj s/t/e.obj");
        assert_eq!(found("s/**"), "s/d.obj s/t/e.obj");
        assert_eq!(found("*/d.obj"), "s/d.obj");
        assert_eq!(found("s/../?.txt"), "s/../c.txt");
        assert_eq!(found(".*.obj"), ".h.obj");
        assert_eq!(found("s"), "");
        let absolute = folder.path().join("*.txt");
        let whole = folder.path().join("c.txt");
        assert_eq!(found(absolute.to_str().unwrap()), whole.to_str().unwrap());
        assert!(files("a**b", folder.path(), ALL).is_err());
        assert!(files("[", folder.path(), ALL).is_err());
    }

    #[test]
    fn a_search_ends_at_its_bounds() {
        let folder = folder();
        let few = Bounds { entries: 3, ..ALL };
        assert_eq!(files("**/*.obj", folder.path(), few).unwrap().given_up_at, Some(4));
        let short = Bounds { time: Duration::ZERO, ..ALL };
        assert_eq!(files("**/*.none", folder.path(), short).unwrap().given_up_at, Some(1));
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_into_no_circle_and_closed_folders_are_named() {
        let folder = folder();
        std::os::unix::fs::symlink(folder.path(), folder.path().join("s/round")).unwrap();
        let found = files("**/*.obj", folder.path(), ALL).unwrap();
        assert_eq!(found.files.len(), 4);
        assert_eq!(files("s/round/*.obj", folder.path(), ALL).unwrap().files.len(), 2);
        let none = files("none/*.obj", folder.path(), ALL).unwrap();
        assert!(none.closed.unwrap().contains("none: "));
        let odd = std::os::unix::ffi::OsStrExt::from_bytes(b"s/n\xff.obj");
        std::fs::write(folder.path().join::<&std::ffi::OsStr>(odd), "").unwrap();
        for pattern in ["s/*.obj", "**/*.obj", "s/**"] {
            assert_eq!(files(pattern, folder.path(), ALL).unwrap().n_nameless, 1, "{pattern}");
        }
    }
}
