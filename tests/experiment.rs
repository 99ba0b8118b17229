//! What the classic experiment must show.

use std::path::Path;

use mve_core::testing::{plan_options, run_options};
use mve_core::{CancelToken, FileHashes, Map, Plan, PlanOptions, Program, RunOutcome, Scalar, run};
use mve_modules::registry;

/// A measure of the box of 768 faces cut to 300, by its name.
fn of_box(cost: &str, placement: &str, measure: &str) -> f64 {
    of_box_by(&format!("\"{cost}\""), placement, "Hausdorff", measure)
}

fn of_box_by(cost: &str, placement: &str, metric: &str, measure: &str) -> f64 {
    let text = format!(
        r#"{{"mve": 1, "nodes": {{"model": {{"module": "Box"}},
            "simplify": {{"module": "Simplificator", "params": {{
                "target_faces": 300, "cost": {cost}, "placement": "{placement}"}}}},
            "compare": {{"module": "MeshComparer", "params": {{"metric": "{metric}"}}}}}},
        "links": ["model.mesh -> simplify.mesh", "model.mesh -> compare.original",
            "simplify.mesh -> compare.simplified"]}}"#
    );
    measured(&text, 0, measure)
}

/// A measure of the node `compare` of a map.
fn measured(text: &str, repeat: u32, measure: &str) -> f64 {
    match outcome(text, repeat).nodes["compare"].record.scalars.get(measure) {
        Some(Scalar::Number(number)) => *number,
        other => panic!("{measure} is {other:?}"),
    }
}

/// What comes of a map that writes no file.
fn outcome(text: &str, repeat: u32) -> RunOutcome {
    let files = FileHashes::new();
    let options = PlanOptions { repeat, ..plan_options(Path::new("/"), &files) };
    let plan = Plan::new(&Map::parse(text).unwrap(), &registry(), &options).unwrap();
    run(&plan, &run_options(Path::new("/nowhere"), &CancelToken::new()))
}

/// A report tells the first prices of a simplification from its collapses.
#[test]
fn both_parts_of_a_simplification_are_timed() {
    let text = r#"{"mve": 1, "nodes": {"model": {"module": "Vase"},
        "simplify": {"module": "Simplificator", "params": {"target_faces": 4000}}},
        "links": ["model.mesh -> simplify.mesh"]}"#;
    let outcome = outcome(text, 0);
    let record = &outcome.nodes["simplify"].record;
    assert_eq!(record.phases.keys().collect::<Vec<_>>(), ["first_prices", "collapses"]);
    let sum: f64 = record.phases.values().sum();
    let whole = record.seconds.unwrap();
    assert!(record.phases.values().all(|seconds| *seconds > 0.0), "{:?}", record.phases);
    assert!(sum <= whole, "{sum} of {whole}");
}

/// The thesis behind the experiment measured 0.00000. On flat areas the quadric's system is
/// singular: an engine that solves it anyway fails here.
#[test]
fn quadrics_keep_a_box() {
    for placement in ["Optimal", "Endpoint"] {
        let max = of_box("Quadric", placement, "max");
        assert!(max < 1e-12, "{placement}: {max}");
    }
}

/// The thesis measured 0.034 for a cube of this kind: short edges say nothing about corners.
#[test]
fn edge_lengths_do_not_keep_a_box() {
    let max = of_box("EdgeLength", "Midpoint", "max");
    assert!((0.005..0.2).contains(&max), "{max}");
}

/// The edges of a cube cost luminance and its flats do not. The thesis measured a Hausdorff
/// distance of 0.00000 and an MSDM2 of 0.00001; the MSDM2 of its time was that of the simplified
/// mesh alone.
#[test]
fn pictures_keep_a_box() {
    let cost = r#"{"ImageMse": {"resolution": 512, "cameras": {"Fibonacci": {"n": 6}}}}"#;
    let max = of_box_by(cost, "Endpoint", "Hausdorff", "max");
    assert!(max < 1e-12, "{max}");
    let msdm2 = of_box_by(cost, "Endpoint", "Msdm2", "simplified_msdm2");
    assert!(msdm2 < 1e-3, "{msdm2}");
}

/// The seed of a sampled metric is a parameter of an entry of a choice.
#[test]
fn repeats_of_a_sampled_metric_differ() {
    let text = r#"{"mve": 1, "nodes": {"model": {"module": "Vase"},
        "simplify": {"module": "Simplificator", "params": {"ratio": 0.2}},
        "compare": {"module": "MeshComparer", "params": {"metric": {"Hausdorff":
            {"samples": 500, "tolerance": null}}}}},
        "links": ["model.mesh -> simplify.mesh", "model.mesh -> compare.original",
            "simplify.mesh -> compare.simplified"]}"#;
    let [first, again, second] = [0, 0, 1].map(|repeat| measured(text, repeat, "rms"));
    assert_eq!(first, again);
    assert_ne!(first, second);
    assert!((first / second - 1.0).abs() < 0.5, "{first} and {second}");
}

/// A mesh is saved with its materials beside it: one slip, whatever the number of repeats and
/// files.
#[test]
fn repeats_that_write_one_file_are_told_once() {
    let text = r#"{"mve": 1, "nodes": {"model": {"module": "Box"},
        "compare": {"module": "MeshComparer", "params": {"metric": "Hausdorff"}},
        "save": {"module": "ObjSaver", "params": {"path": "a.obj"}}},
        "links": ["model.mesh -> compare.original", "model.mesh -> compare.simplified",
            "model.mesh -> save.mesh"],
        "programs": {"p": {"repeats": 5}}}"#;
    let program = Program::new(&Map::parse(text).unwrap(), "p", &registry(), Path::new("/"));
    let problems: Vec<_> = program.err().unwrap().iter().map(ToString::to_string).collect();
    let expected = "program \"p\": save: two repeats write \"a.obj\": put {repeat} into the name";
    assert_eq!(problems, [expected]);
}
