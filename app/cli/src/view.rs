//! `mve view`: files in the window at once, without a map.

use std::path::PathBuf;

use crate::edit::open_editor;
use crate::exit::{Exit, Stop};

/// Look at meshes and other files that a module reads, side by side
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve view bunny.obj                    turn it, see its wire, its borders, its layers
  mve view before.obj after.obj         two with one camera; Wipe compares them")]
pub struct Args {
    /// The files
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

/// Starts the window on the files and waits until it is closed.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    if let Some(missing) = args.files.iter().find(|path| !path.is_file()) {
        let message = format!("there is no file {}", missing.display());
        return Err(Stop { exit: Exit::Files, message });
    }
    let files = args.files.iter().map(|path| path.as_os_str().to_owned());
    open_editor(std::iter::once("--view".into()).chain(files))
}
