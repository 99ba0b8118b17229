//! `mve schema`: the JSON Schema of maps.

use std::path::PathBuf;

use crate::exit::{Exit, Stop};
use crate::out;

/// Print the JSON Schema of map files, so that text editors complete and check maps
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve schema --write map.schema.json
  Then, in the settings of VS Code:
  \"json.schemas\": [{ \"fileMatch\": [\"maps/*.json\"], \"url\": \"./map.schema.json\" }]")]
pub struct Args {
    /// Write the schema to a file
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    let schema = mve_core::schema(&mve_modules::registry());
    let text = format!("{schema:#}\n");
    match &args.write {
        None => out::print(&text),
        Some(path) => {
            out::write_file(path, &text)?;
            out::print(&format!("wrote {}\n", path.display()))
        }
    }
}
