//! `mve clean`: what a store holds and its results do not need.

use std::path::{Path, PathBuf};

use mve_core::Store;

use crate::check::count;
use crate::exit::{Exit, Stop};
use crate::out;

/// Lines of each kind that are listed.
const MOST_LINES: usize = 20;

/// List what the results of a program do not need, and remove it
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve clean mve-out/map-costs           list steps of earlier versions, stale outputs, the cache
  mve clean mve-out/map-costs --yes     remove them

Steps of earlier versions of the program are found again should the map become what it was; values \
in the cache save time when a step or a module is added. Clean when nothing runs in the folder.")]
pub struct Args {
    /// The folder of a program's results
    store: PathBuf,
    /// Remove what is listed
    #[arg(long)]
    yes: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    let Some(store) = Store::look(&args.store)? else {
        return Err(Stop::file(&args.store, &std::io::ErrorKind::NotFound.into()));
    };
    let unneeded = store.unneeded()?;
    let kinds = [
        ("step of earlier versions", "steps of earlier versions", &unneeded.steps),
        ("stale output", "stale outputs", &unneeded.outputs),
        ("value in the cache", "values in the cache", &unneeded.cache),
    ];
    let mut text = String::new();
    let mut n_bytes = 0;
    for (one, many, paths) in kinds.iter().filter(|(.., paths)| !paths.is_empty()) {
        let bytes: u64 = paths.iter().map(|path| size(&args.store.join(path))).sum();
        n_bytes += bytes;
        let what = if paths.len() == 1 { one } else { many };
        text.push_str(&format!("{} {what}, {}\n", paths.len(), megabytes(bytes)));
        for path in paths.iter().take(MOST_LINES) {
            text.push_str(&format!("  {}\n", path.display()));
        }
        if paths.len() > MOST_LINES {
            text.push_str(&format!("  … {} more\n", paths.len() - MOST_LINES));
        }
    }
    let all: Vec<&PathBuf> = kinds.iter().flat_map(|(.., paths)| *paths).collect();
    if all.is_empty() {
        return out::print("nothing to clean: the results need all that is there\n");
    }
    let files = count(all.len(), "entry").replace("entrys", "entries");
    if args.yes {
        all.iter().try_for_each(|path| store.remove(path))?;
        text.push_str(&format!("removed {files}, {}\n", megabytes(n_bytes)));
    } else {
        text.push_str(&format!("--yes removes {files}, {}\n", megabytes(n_bytes)));
    }
    out::print(&text)
}

/// Bytes of a file, or of all that is in a folder.
fn size(path: &Path) -> u64 {
    let Ok(about) = std::fs::symlink_metadata(path) else { return 0 };
    if !about.is_dir() {
        return about.len();
    }
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    entries.map(|entry| size(&entry.path())).sum()
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}
