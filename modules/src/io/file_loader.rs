//! Takes a file of any kind and size into the map, for [`FileSaver`](super::file_saver).
//!
//! Its bytes go through memory a block at a time and then stay on disk, so that the file may be
//! larger than memory. What they mean is not looked at.

use std::io::{Read, Write};

use mve_core::{BLOCK, Stored};
use mve_formats::FileError;
use mve_formats::plain_file::open_plain;

use crate::prelude::*;

const PATH: Param<PathBuf> = Param::input_file("path", "The file.", &[]);
const FILE_OUT: Out<Stored> = Out::new("file", "The bytes of the file.");

pub static MODULE: Module = Module {
    id: "FileLoader",
    summary: "Takes a file of any kind and size as it is, to keep it with the results.",
    inputs: &[],
    outputs: &[FILE_OUT.spec()],
    params: &[PATH.spec()],
    run,
};

fn run(io: &mut Io) -> Result<(), ModuleError> {
    let path = io.param(PATH)?;
    let unreadable = |source| FileError::read(&path, source);
    let (mut file, n_bytes) = open_plain(&path).map_err(unreadable)?;
    let mut writer = io.stored_writer()?;
    let mut block = vec![0; BLOCK];
    let mut n_done = 0;
    loop {
        let n = file.read(&mut block).map_err(unreadable)?;
        if n == 0 {
            break;
        }
        writer.write_all(&block[..n]).map_err(|error| not_kept(&error))?;
        n_done += n;
        io.progress(n_done as f64 / n_bytes.max(1) as f64)?;
    }
    io.put(FILE_OUT, writer.finish().map_err(|error| not_kept(&error))?);
    Ok(())
}

fn not_kept(error: &std::io::Error) -> ModuleError {
    let folders = "that of the cache, or TMPDIR where there is none";
    ModuleError::Failed(format!("cannot keep the file: {error}; free some space in {folders}"))
}

#[cfg(test)]
mod tests {
    use mve_core::testing::Trial;
    use mve_core::{BLOCK, Stored};

    #[test]
    fn every_byte_is_taken_whatever_the_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scan.raw");
        for n_bytes in [0, 5, BLOCK + 3] {
            let bytes: Vec<u8> = (0..n_bytes).map(|i| (i % 251) as u8).collect();
            std::fs::write(&path, &bytes).unwrap();
            let trial = Trial::of(&super::MODULE).set("path", path.to_str().unwrap());
            let file = trial.run().unwrap()["file"].get::<Stored>().unwrap();
            let mut found = vec![0; n_bytes];
            file.read(0, &mut found).unwrap();
            assert!(file.n_bytes() == n_bytes as u64 && found == bytes, "{n_bytes} bytes");
        }
        let trial = Trial::of(&super::MODULE).set("path", folder.path().to_str().unwrap());
        assert!(trial.run().unwrap_err().to_string().contains("name a file, not a folder"));
    }
}
