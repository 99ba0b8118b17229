//! Values in files: modules pass handles, and the cache on disk keeps the files.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use mve_core::testing::{plan_options, run_options};
use mve_core::{
    BLOCK, Cache, CacheUse, CancelToken, DiskCache, Event, EventKind, FileHashes, In, Io, Listed,
    Map, Module, ModuleError, ModuleList, NodeStatus, Out, Param, Plan, Registry, RunOptions,
    RunOutcome, Scalar, Stored, run,
};

const BYTES_OUT: Out<Stored> = Out::new("bytes", "Blocks, each full of its number.");
const BYTES_IN: In<Stored> = In::new("bytes", "Blocks, each full of its number.");
const PLACE: Param<i64> = Param::integer("place", "Which byte to read.", 0);
const BYTE_OUT: Out<f64> = Out::new("byte", "The byte.");
const N_BLOCKS: usize = 8;

/// Writes a block at a time; takes long enough to be worth a place in the cache.
static WRITE: Module = Module {
    id: "Write",
    summary: "Writes.",
    inputs: &[],
    outputs: &[BYTES_OUT.spec()],
    params: &[],
    run: |io: &mut Io| {
        let failed = |error: std::io::Error| ModuleError::Failed(error.to_string());
        let mut writer = io.stored_writer()?;
        for block in 0..N_BLOCKS {
            writer.write_all(&vec![block as u8; BLOCK]).map_err(failed)?;
        }
        std::thread::sleep(std::time::Duration::from_millis(30));
        io.put(BYTES_OUT, writer.finish().map_err(failed)?);
        Ok(())
    },
};

static READ: Module = Module {
    id: "Read",
    summary: "Reads.",
    inputs: &[BYTES_IN.spec()],
    outputs: &[BYTE_OUT.spec()],
    params: &[PLACE.spec()],
    run: |io: &mut Io| {
        let mut byte = [0];
        let place = io.param(PLACE)? as u64;
        let read = io.get(BYTES_IN)?.read(place, &mut byte);
        read.map_err(|error| ModuleError::Failed(error.to_string()))?;
        io.put(BYTE_OUT, f64::from(byte[0]));
        Ok(())
    },
};

static LIST: ModuleList = ModuleList {
    category: "test",
    modules: &[Listed { item: &READ, source: 1 }, Listed { item: &WRITE, source: 2 }],
};

/// Reads one byte of the blocks, as a process of its own would: with nothing in memory.
fn read(cache: &Path, budget: u64, place: usize) -> RunOutcome {
    read_by(&Cache::new(1 << 30, Some(DiskCache::open(cache, budget).unwrap())), place)
}

fn read_by(cache: &Cache, place: usize) -> RunOutcome {
    heard_by(cache, place).0
}

/// The outcome, and the events that are no progress, in a word each.
fn heard_by(cache: &Cache, place: usize) -> (RunOutcome, Vec<String>) {
    let map = format!(
        r#"{{"mve": 1, "nodes": {{"write": {{"module": "Write"}},
            "read": {{"module": "Read", "params": {{"place": {place}}}}}}},
            "links": ["write.bytes -> read.bytes"]}}"#
    );
    let files = FileHashes::new();
    let registry = Registry::new().with(&[&LIST], "");
    let options = plan_options(Path::new("/"), &files);
    let plan = Plan::new(&Map::parse(&map).unwrap(), &registry, &options).unwrap();
    let (out, cancel) = (tempfile::tempdir().unwrap(), CancelToken::new());
    let heard = Mutex::new(Vec::new());
    let observer = |event: &Event| {
        let what = match event.kind {
            EventKind::Ended { record, .. } if record.status == NodeStatus::Done => "done",
            EventKind::Ended { .. } => "not done",
            EventKind::Started => "started",
            _ => return,
        };
        heard.lock().unwrap().push(format!("{} {what}", event.node));
    };
    let options = RunOptions { observer: &observer, ..run_options(out.path(), &cancel) };
    let outcome = run(&plan, &RunOptions { cache: Some(cache), ..options });
    (outcome, heard.into_inner().unwrap())
}

fn files(cache: &Path) -> Vec<PathBuf> {
    let all = std::fs::read_dir(cache).unwrap().map(|file| file.unwrap().path());
    all.filter(|path| path.extension().is_some_and(|e| e == "stored")).collect()
}

fn damage_block_6(file: &Path) {
    let mut bytes = std::fs::read(file).unwrap();
    bytes[6 * BLOCK + 9] ^= 1;
    std::fs::write(file, bytes).unwrap();
}

fn byte(outcome: &RunOutcome) -> Option<&Scalar> {
    outcome.nodes["read"].record.scalars.get("byte")
}

#[test]
fn the_cache_keeps_the_file_and_a_damaged_block_is_made_again() {
    let cache = tempfile::tempdir().unwrap();
    let budget = 1 << 30;
    let first = read(cache.path(), budget, 0);
    assert_eq!(first.nodes["write"].record.cached, None);
    let [file] = files(cache.path()).try_into().unwrap();
    assert_eq!(file.metadata().unwrap().len(), (N_BLOCKS * BLOCK) as u64);
    let second = read(cache.path(), budget, 5 * BLOCK + 3);
    assert_eq!(second.nodes["write"].record.cached, Some(CacheUse::Disk));
    assert_eq!(byte(&second), Some(&Scalar::Number(5.0)));
    // Block 6 is damaged. Who reads another block does not notice, so only that block is read.
    damage_block_6(&file);
    assert_eq!(byte(&read(cache.path(), budget, BLOCK)), Some(&Scalar::Number(1.0)));
    // Who reads it makes the value again, in the same run.
    let again = read(cache.path(), budget, 6 * BLOCK);
    assert_eq!(again.nodes["write"].record.cached, None);
    assert_eq!(byte(&again), Some(&Scalar::Number(6.0)));
}

#[test]
fn a_damaged_file_leaves_the_memory_of_the_process_too() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::new(1 << 30, Some(DiskCache::open(folder.path(), 1 << 30).unwrap()));
    assert_eq!(read_by(&cache, 0).nodes["write"].record.cached, None);
    let [file] = files(folder.path()).try_into().unwrap();
    damage_block_6(&file);
    assert_eq!(read_by(&cache, 0).nodes["write"].record.cached, Some(CacheUse::Memory));
    let (again, heard) = heard_by(&cache, 6 * BLOCK);
    assert_eq!(again.nodes["write"].record.cached, None);
    assert_eq!(byte(&again), Some(&Scalar::Number(6.0)));
    // Both ran twice, or were to.
    assert_eq!(heard, ["write done", "read started", "read done"]);
    assert_eq!(files(folder.path()), [file]);
}

#[test]
fn a_file_that_was_cut_short_is_kept_anew() {
    let cache = tempfile::tempdir().unwrap();
    let budget = 1 << 30;
    read(cache.path(), budget, 0);
    let [file] = files(cache.path()).try_into().unwrap();
    std::fs::File::options().write(true).open(&file).unwrap().set_len(77).unwrap();
    assert_eq!(read(cache.path(), budget, 0).nodes["write"].record.cached, None);
    assert_eq!(read(cache.path(), budget, 0).nodes["write"].record.cached, Some(CacheUse::Disk));
}

#[test]
fn the_budget_counts_files() {
    let cache = tempfile::tempdir().unwrap();
    let outcome = read(cache.path(), (N_BLOCKS * BLOCK - 1) as u64, 3 * BLOCK);
    assert_eq!(byte(&outcome), Some(&Scalar::Number(3.0)));
    assert!(files(cache.path()).is_empty());
}
