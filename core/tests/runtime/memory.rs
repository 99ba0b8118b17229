//! Steps of a program that reserve memory.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use mve_core::testing::program_options;
use mve_core::{
    CancelToken, Listed, Map, Module, ModuleList, Out, Param, Program, ProgramOptions,
    ProgramOutcome, Registry, Store, run_program,
};

/// How many steps hold memory now, and the most that did at once.
static HOLDING: [AtomicUsize; 2] = [AtomicUsize::new(0), AtomicUsize::new(0)];

const SHARE: Param<f64> = Param::number("share", "Of the budget.", 0.0);
const NUMBER: Out<f64> = Out::new("number", "Nothing.");

/// Reserves a share of 1 TiB for a while.
static HOLD: Module = Module {
    id: "Hold",
    summary: "Holds memory.",
    inputs: &[],
    outputs: &[NUMBER.spec()],
    params: &[SHARE.spec()],
    run: |io| {
        io.reserve((io.param(SHARE)? * (1_u64 << 40) as f64) as usize)?;
        let n = HOLDING[0].fetch_add(1, Ordering::SeqCst) + 1;
        HOLDING[1].fetch_max(n, Ordering::SeqCst);
        for _ in 0..8 {
            std::thread::sleep(Duration::from_millis(5));
            io.progress(0.5)?;
        }
        HOLDING[0].fetch_sub(1, Ordering::SeqCst);
        io.put(NUMBER, 0.0);
        Ok(())
    },
};

static HOLDERS: ModuleList =
    ModuleList { category: "test", modules: &[Listed { item: &HOLD, source: 1 }] };

/// Runs four steps at once that hold these shares of the budget, and gives the outcome, the most
/// that held at once, and the longest seconds of a node.
fn held(shares: &str, limit: Option<Duration>) -> (ProgramOutcome, usize, f64) {
    static ALONE: Mutex<()> = Mutex::new(());
    let _alone = ALONE.lock();
    let text = format!(
        r#"{{"mve": 1, "nodes": {{"n": {{"module": "Hold"}}}},
            "programs": {{"p": {{"axes": [{{"n.share": [{shares}]}}]}}}}}}"#
    );
    let registry = Registry::new().with(&[&HOLDERS], "test");
    let map = Map::parse(&text).unwrap();
    let program = Program::new(&map, "p", &registry, Path::new("/")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let cancel = CancelToken::new();
    let shared = program_options(&cancel);
    let options = ProgramOptions { jobs: 4, memory: 1 << 40, time_limit: limit, ..shared };
    HOLDING[1].store(0, Ordering::SeqCst);
    let outcome = run_program(&program, &store, &options).unwrap();
    let records = program.steps.iter().filter_map(|step| store.record(&step.id));
    let seconds = records.filter_map(|record| record.nodes["n"].seconds).fold(0.0, f64::max);
    (outcome, HOLDING[1].load(Ordering::SeqCst), seconds)
}

#[test]
fn steps_wait_until_what_they_reserve_fits() {
    let (outcome, n, seconds) = held("0.6, 0.61, 0.62, 2", None);
    assert_eq!((outcome.ran, outcome.failed), (4, 0));
    // What they waited is no part of their seconds.
    assert!(n == 1 && seconds < 0.12, "{n} at once, {seconds} s");
    let (outcome, n, _) = held("0.01, 0.02, 0.03, 0.04", None);
    assert_eq!((outcome.ran, outcome.failed, n), (4, 0, 4));
}

#[test]
fn what_a_step_waits_is_no_part_of_its_time_limit() {
    // Each takes 40 ms, and the last one waits three times that.
    let (outcome, n, _) = held("0.6, 0.61, 0.62, 2", Some(Duration::from_millis(100)));
    assert_eq!((outcome.ran, outcome.failed, n), (4, 0, 1));
}
