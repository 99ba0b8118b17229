//! Steps of a program that reserve memory.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use mve_core::testing::program_options;
use mve_core::{
    CancelToken, Listed, Map, Module, ModuleList, Out, Param, Program, ProgramOptions, Registry,
    Store, run_program,
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
        std::thread::sleep(Duration::from_millis(40));
        HOLDING[0].fetch_sub(1, Ordering::SeqCst);
        io.put(NUMBER, 0.0);
        Ok(())
    },
};

static HOLDERS: ModuleList =
    ModuleList { category: "test", modules: &[Listed { item: &HOLD, source: 1 }] };

#[test]
fn steps_wait_until_what_they_reserve_fits() {
    let most_at_once = |shares: &str| {
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
        let options = ProgramOptions { jobs: 4, memory: 1 << 40, ..program_options(&cancel) };
        HOLDING[1].store(0, Ordering::SeqCst);
        let outcome = run_program(&program, &store, &options).unwrap();
        assert_eq!((outcome.ran, outcome.failed), (4, 0));
        // What they waited is no part of their seconds.
        let records = program.steps.iter().filter_map(|step| store.record(&step.id));
        let seconds = records.map(|record| record.nodes["n"].seconds.unwrap());
        (HOLDING[1].load(Ordering::SeqCst), seconds.fold(0.0, f64::max))
    };
    let (n, seconds) = most_at_once("0.6, 0.61, 0.62, 2");
    assert!(n == 1 && seconds < 0.12, "{n} at once, {seconds} s");
    assert_eq!(most_at_once("0.01, 0.02, 0.03, 0.04").0, 4);
}
