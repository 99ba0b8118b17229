//! The `mve-editor` command: opens maps and meshes in the window.

use std::path::PathBuf;
use std::process::ExitCode;

use mve_editor::FirstSight;

const HELP: &str = "\
Opens maps of mve in a window: build, run and look at them. Files that a module
reads, such as meshes, come into a new map.

Usage: mve-editor [--view] [FILE]...

Without a file, the window opens the maps of the last time, or an example.

Options:
      --view     show what is in the files alone, without the map
  -h, --help     print this
  -V, --version  print the version";

fn main() -> ExitCode {
    mve_core::contain_panics();
    let (mut files, mut first) = (Vec::new(), FirstSight::Map);
    for argument in std::env::args_os().skip(1) {
        match argument.to_str() {
            Some("-h" | "--help") => {
                println!("{HELP}");
                return ExitCode::SUCCESS;
            }
            Some("-V" | "--version") => {
                println!("mve-editor {}", mve_core::VERSION);
                return ExitCode::SUCCESS;
            }
            Some("--view") => first = FirstSight::Values,
            Some(option) if option.starts_with('-') => {
                eprintln!("mve-editor: there is no option {option}; see mve-editor --help");
                return ExitCode::from(2);
            }
            _ => files.push(PathBuf::from(argument)),
        }
    }
    match mve_editor::open_window(mve_modules::registry(), files, first) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("mve-editor: {error}");
            ExitCode::FAILURE
        }
    }
}
