//! Standard output and standard error. A reader that goes away, as `head` does, is no error: the
//! rest is not written.
//!
//! What a map or a file says is part of many texts, so nothing that would steer a terminal gets out
//! of here but the end of a line and the styles of [`Style`].

use std::fs;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;

use std::time::{SystemTime, UNIX_EPOCH};

use mve_core::{is_steering, refuse_special};
use serde::Serialize;
use serde_json::Value as Json;

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

/// How a text stands out on a terminal with colors.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A title.
    Bold,
    /// Of an error.
    Red,
    /// Of a warning.
    Yellow,
}

/// Each style, the sign that begins it in a text (no character: Unicode keeps it for the use of a
/// program alone), and what begins it on a terminal. A sign in what a map says is at worst bold.
const STYLES: [(Style, char, &str); 3] = [
    (Style::Bold, '\u{fdd0}', "\u{1b}[1m"),
    (Style::Red, '\u{fdd1}', "\u{1b}[1;31m"),
    (Style::Yellow, '\u{fdd2}', "\u{1b}[1;33m"),
];

/// Ends any style.
const PLAIN: (char, &str) = ('\u{fdd3}', "\u{1b}[0m");

/// A text of this module's own in a style, to be written by this module.
pub fn styled(text: &str, style: Style) -> String {
    let sign =
        STYLES.iter().find(|(known, ..)| *known == style).map_or(PLAIN.0, |(_, sign, _)| *sign);
    format!("{sign}{text}{}", PLAIN.0)
}

/// A text as a terminal may have it: its lines, its styles where there are colors, and whatever
/// else would steer it written out.
fn safe(text: &str, has_colors: bool) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        let style = STYLES.iter().map(|(_, sign, code)| (*sign, *code)).chain([PLAIN]);
        match style.into_iter().find(|(sign, _)| *sign == c) {
            Some((_, code)) if has_colors => safe.push_str(code),
            Some(_) => {}
            None if c != '\n' && is_steering(c) => safe.extend(c.escape_default()),
            None => safe.push(c),
        }
    }
    safe
}

/// Writes a text to standard output.
pub fn print(text: &str) -> Result<Exit, Stop> {
    let text = safe(text, console::colors_enabled());
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
    // Such signs stand in texts alone, where JSON has an escape for them.
    let mut safe = String::with_capacity(line.len());
    for c in line.chars() {
        match is_steering(c) {
            true => safe.push_str(&format!("\\u{:04x}", u32::from(c))),
            false => safe.push(c),
        }
    }
    print(&format!("{safe}\n"))
}

/// Writes an event to standard output as a line of JSON, with the time in seconds since 1970.
pub fn event(event: &impl Serialize) -> Result<Exit, Stop> {
    let mut value = serde_json::to_value(event).unwrap_or_default();
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    if let Json::Object(fields) = &mut value {
        let milliseconds = now.as_millis() as f64;
        fields.insert("time".to_owned(), Json::from(milliseconds / 1000.0));
    }
    json(&value)
}

/// Writes a file so that readers see the old one or the new one. Its folder must be there, and a
/// device, a pipe or a link is not replaced.
pub fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Stop> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let fail = |error| Stop::file(path, &error);
    let refuse = |message| Err(Stop { exit: Exit::Files, message });
    if !folder.exists() {
        let (path, folder) = (path.display(), folder.display());
        return refuse(format!("{path}: there is no folder {folder}; create it first"));
    }
    if let Err(message) = refuse_special(path) {
        return refuse(message);
    }
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
    file.write_all(bytes.as_ref()).map_err(fail)?;
    file.as_file().sync_all().map_err(fail)?;
    file.persist(path).map_err(|error| fail(error.error))?;
    Ok(())
}

/// Writes a line to standard error. Nobody can be told if that fails.
pub fn tell(line: &str) {
    let line = safe(line, console::colors_enabled_stderr());
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Writes an error to standard error.
pub fn complain(message: &str) {
    tell(&format!("{} {message}", error_mark()));
}

/// `error:`, colored where standard error is a terminal.
pub fn error_mark() -> String {
    styled("error:", Style::Red)
}

/// `warning:`, colored where standard error is a terminal.
pub fn warning_mark() -> String {
    styled("warning:", Style::Yellow)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn styles_are_the_only_signs_that_reach_a_terminal() {
        let text = format!("{} \u{1b}[31mX\u{7}\u{202e}\r\n", styled("t", Style::Bold));
        assert_eq!(safe(&text, true), "\u{1b}[1mt\u{1b}[0m \\u{1b}[31mX\\u{7}\\u{202e}\\r\n");
        assert_eq!(safe(&text, false), "t \\u{1b}[31mX\\u{7}\\u{202e}\\r\n");
    }
}
