//! `mve edit`: the window, which is a program of its own, so that this one needs no display.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

use crate::exit::{Exit, Stop};

/// The command that opens the window.
const EDITOR: &str = "mve-editor";

/// Open maps in the window
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve edit                              the maps of the last time, or an example
  mve edit maps/simplify_and_measure.json")]
pub struct Args {
    /// The maps; without one, those of the last time, or an example
    maps: Vec<PathBuf>,
}

/// Starts the window and waits until it is closed.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    open_editor(args.maps.iter().map(|path| path.as_os_str().to_owned()))
}

/// Starts the window with these arguments and waits until it is closed.
pub fn open_editor(arguments: impl Iterator<Item = OsString>) -> Result<Exit, Stop> {
    let name = format!("{EDITOR}{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().map(|own| own.with_file_name(&name));
    let program = beside.filter(|path| path.is_file()).unwrap_or_else(|| PathBuf::from(&name));
    let status = Command::new(&program).args(arguments).status().map_err(|error| {
        let what = match error.kind() {
            ErrorKind::NotFound => format!(
                "{EDITOR} is neither beside mve nor on the PATH; build it with \
                 `cargo build --release -p {EDITOR}`"
            ),
            _ => format!("{}: {error}", program.display()),
        };
        Stop { exit: Exit::Files, message: what }
    })?;
    Ok(if status.success() { Exit::Done } else { Exit::Failed })
}
