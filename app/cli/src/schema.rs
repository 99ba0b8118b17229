//! `mve schema`: the JSON Schemas of maps and of events.

use std::path::PathBuf;

use crate::exit::{Exit, Stop};
use crate::out;

/// Print the JSON Schema of map files, so that text editors complete and check maps
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve schema --write map.schema.json
  mve schema --events                   what `mve run --json` and `mve program --json` print
  Then, in the settings of VS Code:
  \"json.schemas\": [{ \"fileMatch\": [\"maps/*.json\"], \"url\": \"./map.schema.json\" }]")]
pub struct Args {
    /// Write the schema to a file
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// The schema of the events of --json instead, each a line
    #[arg(long)]
    events: bool,
}

const EVENTS: &str = include_str!("events.schema.json");

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    let text = match args.events {
        true => EVENTS.to_owned(),
        false => format!("{:#}\n", mve_core::schema(&mve_modules::registry())),
    };
    match &args.write {
        None => out::print(&text),
        Some(path) => {
            out::write_file(path, &text)?;
            out::print(&format!("wrote {}\n", path.display()))
        }
    }
}
