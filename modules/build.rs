//! Hands the hashes of the sources to the lists of modules and entries; see `sources/mod.rs`.

mod sources;

use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let hashes = sources::source_hashes(Path::new(".."), env!("CARGO_PKG_NAME"))?;
    for path in &hashes.watched {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    println!("cargo::rustc-env=MVE_SHARED_SOURCES={}", hashes.shared);
    for (module, hash) in &hashes.entries {
        println!("cargo::rustc-env=MVE_SOURCE_OF_{module}={hash}");
    }
    Ok(())
}
