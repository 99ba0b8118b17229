//! Standard output and standard error. A reader that goes away, as `head` does, is no error: the
//! rest is not written.

use std::fs;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;

use console::style;
use serde::Serialize;

use crate::exit::{Exit, Stop, explain};

/// Columns of the terminal that standard output is; `None` where it is a file or a pipe.
pub fn width() -> Option<usize> {
    let is_terminal = std::io::stdout().is_terminal();
    is_terminal.then(|| usize::from(console::Term::stdout().size().1).max(20))
}

/// Puts an empty line before a result that stands below progress on the same terminal.
pub fn part_from_progress(text: &mut String) {
    if width().is_some() {
        text.insert(0, '\n');
    }
}

/// Writes a text to standard output.
pub fn print(text: &str) -> Result<Exit, Stop> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let message = format!("cannot write to standard output: {}", explain(&error));
            Err(Stop { exit: Exit::Files, message })
        }
        _ => Ok(Exit::Done),
    }
}

/// Writes a value to standard output, as one line of JSON.
pub fn json(value: &impl Serialize) -> Result<Exit, Stop> {
    // Everything that is written here is plain data, which JSON can always say.
    let line = serde_json::to_string(value).unwrap_or_default();
    print(&format!("{line}\n"))
}

/// Writes a file so that readers see the old one or the new one.
pub fn write_file(path: &Path, text: &str) -> Result<(), Stop> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let fail = |error| Stop::file(path, &error);
    fs::create_dir_all(folder).map_err(fail)?;
    if path.is_dir() {
        return Err(Stop::file(path, &ErrorKind::IsADirectory.into()));
    }
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What the user's mask leaves of it, unlike the owner-only default of temporary files.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(fail)?;
    file.write_all(text.as_bytes()).map_err(fail)?;
    file.as_file().sync_all().map_err(fail)?;
    file.persist(path).map_err(|error| fail(error.error))?;
    Ok(())
}

/// Writes a line to standard error. Nobody can be told if that fails.
pub fn tell(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Writes an error to standard error.
pub fn complain(message: &str) {
    tell(&format!("{} {message}", error_mark()));
}

/// `error:`, colored where standard error is a terminal.
pub fn error_mark() -> String {
    style("error:").for_stderr().red().bold().to_string()
}

/// `warning:`, colored where standard error is a terminal.
pub fn warning_mark() -> String {
    style("warning:").for_stderr().yellow().bold().to_string()
}
