//! Seconds of the processor that loading a file takes, for `tests/peers/loaders`:
//! `cargo bench -p mve-formats --bench loading -- mve|tobj FILE RUNS`.
//!
//! The file is read from the disk each time. What comes out is JSON: the seconds of each run, and
//! what was read.

use std::path::Path;

use mve_core::Control;
use mve_formats::mesh_file;
use mve_formats::obj::FileScope;
use rustix::time::{ClockId, clock_gettime};

/// Reads a file; how many vertices and faces it has.
type Loader = fn(&Path) -> [usize; 2];

fn mve(path: &Path) -> [usize; 2] {
    let (mesh, _) = mesh_file::load(path, FileScope::Folder, Control::none()).expect("a mesh");
    [mesh.positions.len(), mesh.faces.len()]
}

fn tobj(path: &Path) -> [usize; 2] {
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (models, _) = tobj::load_obj(path, &options).expect("an OBJ file");
    let sum = |length: fn(&tobj::Mesh) -> usize| models.iter().map(|m| length(&m.mesh) / 3).sum();
    [sum(|mesh| mesh.positions.len()), sum(|mesh| mesh.indices.len())]
}

fn process_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn main() {
    // Cargo puts an option of its own behind.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let [program, file, runs] = words.as_slice() else {
        return eprintln!("loading mve|tobj FILE RUNS");
    };
    let load: Loader = if program == "tobj" { tobj } else { mve };
    let mut size = [0; 2];
    let mut run = |_: usize| {
        let start = process_seconds();
        size = load(Path::new(file));
        process_seconds() - start
    };
    let seconds: Vec<f64> = (0..runs.parse().unwrap_or(1)).map(&mut run).collect();
    let [vertices, faces] = size;
    println!("{{\"cpu\": {seconds:?}, \"vertices\": {vertices}, \"faces\": {faces}}}");
}
