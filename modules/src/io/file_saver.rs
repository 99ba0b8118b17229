//! Writes a file that [`FileLoader`](super::file_loader) took, byte for byte.
//!
//! So a step keeps what its results came from (a scan's calibration, its license, the raw capture)
//! beside them.

use mve_core::{BLOCK, Stored};
use mve_formats::save_atomic;

use crate::prelude::*;

const FILE_IN: In<Stored> = In::new("file", "The bytes of the file.");
const PATH: Param<PathBuf> = Param::output_file("path", "The file.", &[]);

pub static MODULE: Module = Module {
    id: "FileSaver",
    summary: "Writes a file beside the other results, byte for byte as it was loaded.",
    inputs: &[FILE_IN.spec()],
    outputs: &[],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let (file, path) = (io.get(FILE_IN)?, io.param(PATH)?);
    let n_bytes = file.n_bytes();
    let write = |out: &mut dyn std::io::Write| {
        let mut block = vec![0; BLOCK];
        for start in (0..n_bytes).step_by(BLOCK) {
            let n = (n_bytes - start).min(BLOCK as u64) as usize;
            file.read(start, &mut block[..n])?;
            out.write_all(&block[..n])?;
            let share = (start + n as u64) as f64 / n_bytes as f64;
            io.control().at(share).map_err(std::io::Error::other)?;
        }
        Ok(())
    };
    Ok(save_atomic(&path, write)?)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use mve_core::testing::Trial;
    use mve_core::{BLOCK, StoredWriter};

    #[test]
    fn the_bytes_come_out_as_they_went_in() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("license.txt");
        for n_bytes in [0, 5, 2 * BLOCK + 3] {
            let bytes: Vec<u8> = (0..n_bytes).map(|i| (i % 251) as u8).collect();
            let mut writer = StoredWriter::new().unwrap();
            writer.write_all(&bytes).unwrap();
            let trial = Trial::of(&super::MODULE).input("file", writer.finish().unwrap());
            trial.set("path", path.to_str().unwrap()).run().unwrap();
            assert!(std::fs::read(&path).unwrap() == bytes, "{n_bytes} bytes");
        }
    }
}
