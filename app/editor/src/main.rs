//! The `mve-editor` command: opens maps in the window.

use std::path::PathBuf;
use std::process::ExitCode;

const HELP: &str = "\
Opens maps of mve in a window: build, run and look at them.

Usage: mve-editor [MAP]...

Without a map, the window opens those of the last time, or an example.

Options:
  -h, --help     print this
  -V, --version  print the version";

fn main() -> ExitCode {
    mve_core::contain_panics();
    let mut maps = Vec::new();
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
            Some(option) if option.starts_with('-') => {
                eprintln!("mve-editor: there is no option {option}; see mve-editor --help");
                return ExitCode::from(2);
            }
            _ => maps.push(PathBuf::from(argument)),
        }
    }
    match mve_editor::open_window(mve_modules::registry(), maps) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("mve-editor: {error}");
            ExitCode::FAILURE
        }
    }
}
