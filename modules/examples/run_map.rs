//! Runs one map from a program of one's own, and prints what an output gave.
//!
//! ```text
//! cargo run -p mve-modules --example run_map -- maps/simplify_and_measure.json compare.value
//! ```

use std::error::Error;
use std::path::Path;

use mve_core::{CancelToken, FileHashes, Keep, Map, Plan, PlanOptions, RunOptions, run};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(path), Some(output)) = (arguments.next(), arguments.next()) else {
        return Err("name a map and an output: maps/simplify_and_measure.json compare.value".into());
    };
    let (path, output) = (Path::new(&path), output.split_once('.').ok_or("write node.output")?);
    let map = Map::load(path)?;

    // The plan checks everything before anything runs: all problems of the map come at once.
    let files = FileHashes::new();
    let folder = path.parent().unwrap_or(Path::new("."));
    let planned = Plan::new(&map, &mve_modules::registry(), &PlanOptions::new(folder, &files));
    let plan = planned.map_err(|problems| {
        let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
        lines.join("\n")
    })?;

    // Savers write below this folder. `keep` holds values beyond the run; `cancel` stops it.
    let cancel = CancelToken::new();
    let options = RunOptions { keep: Keep::All, ..RunOptions::new(Path::new("mve-out"), &cancel) };
    let outcome = run(&plan, &options);
    if let Some((node, error)) = outcome.failures().next() {
        return Err(format!("{node}: {error}").into());
    }
    let value = outcome.value(output.0, output.1).ok_or("the map has no such output")?;
    println!("{}.{}: {}", output.0, output.1, value.summary());
    Ok(())
}
