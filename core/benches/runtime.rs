//! What the runtime itself costs: a map of a thousand trivial nodes, a program of ten thousand
//! trivial steps with their records on disk.

use std::hint::black_box;
use std::path::Path;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use mve_core::testing::{plan_options, program_options, registry, run_options};
use mve_core::{
    CancelToken, FileHashes, Map, Plan, Program, ProgramOptions, RunOptions, Store, run,
    run_program,
};

const N_NODES: usize = 1000;
const N_STEPS: usize = 10_000;

/// A chain of additions, each of nothing, so that no value leaves its range.
fn chain() -> Map {
    let node = |i| format!(r#""n{i}": {{"module": "Add", "params": {{"amount": 0}}}}"#);
    let nodes: Vec<_> = (0..N_NODES).map(node).collect();
    let links: Vec<_> = (1..N_NODES).map(|i| format!("\"n{}.sum -> n{i}.a\"", i - 1)).collect();
    let text = format!(
        r#"{{"mve": 1, "nodes": {{{}}}, "links": [{}]}}"#,
        nodes.join(","),
        links.join(",")
    );
    Map::parse(&text).expect("the map is JSON")
}

fn plan(map: &Map) -> Plan {
    let files = FileHashes::new();
    Plan::new(map, &registry(), &plan_options(Path::new("/"), &files))
        .expect("the map has no problems")
}

fn nodes(criterion: &mut Criterion) {
    let map = chain();
    let checked = plan(&map);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut group = criterion.benchmark_group("a map of 1,000 trivial nodes");
    group.throughput(Throughput::Elements(N_NODES as u64));
    group.bench_function("plan", |bencher| bencher.iter(|| black_box(plan(&map))));
    for threads in [1, 2] {
        group.bench_function(format!("run, {threads} threads"), |bencher| {
            bencher.iter(|| {
                let cancel = CancelToken::new();
                run(&checked, &RunOptions { threads, ..run_options(folder.path(), &cancel) })
            });
        });
    }
    group.finish();
}

fn steps(criterion: &mut Criterion) {
    let amounts: Vec<_> = (0..N_STEPS).map(|i| format!("{}", i as f64 / 200.0)).collect();
    let text = format!(
        r#"{{"mve": 1, "nodes": {{"a": {{"module": "Add"}}, "b": {{"module": "Add"}}}},
            "links": ["a.sum -> b.a"], "programs": {{"p": {{"axes": [{{"a.amount": [{}]}}]}}}}}}"#,
        amounts.join(",")
    );
    let map = Map::parse(&text).expect("the map is JSON");
    let mut group = criterion.benchmark_group("a program of 10,000 trivial steps");
    group.throughput(Throughput::Elements(N_STEPS as u64)).sample_size(10);
    for jobs in [1, 2] {
        group.bench_function(format!("check and run, {jobs} jobs"), |bencher| {
            bencher.iter_batched(
                || tempfile::tempdir().expect("a temporary folder"),
                |folder| {
                    let program = Program::new(&map, "p", &registry(), Path::new("/"))
                        .unwrap_or_else(|problems| panic!("{problems:?}"));
                    let store = Store::open(folder.path()).expect("a store");
                    let cancel = CancelToken::new();
                    let options = ProgramOptions { jobs, ..program_options(&cancel) };
                    let outcome = run_program(&program, &store, &options).expect("it runs");
                    assert_eq!(outcome.ran, N_STEPS);
                    folder
                },
                BatchSize::PerIteration,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, nodes, steps);
criterion_main!(benches);
