//! The commands around maps: documentation, schema, completions, pages, and new files.

use std::path::Path;
use std::process::Stdio;

use crate::common::{Answer, Folder};

#[test]
fn help_comes_alone_and_names_the_exit_codes() {
    let folder = Folder::new();
    let answer = folder.mve(&[]).succeeds();
    assert_eq!(answer.out, folder.mve(&["-h"]).out);
    answer.says("Exit codes:").says("130  interrupted").says("Examples:");
    folder.mve(&["--version"]).succeeds().says(concat!("mve ", env!("CARGO_PKG_VERSION")));
    for command in ["run", "program", "check", "modules", "schema", "new", "completions", "man"] {
        folder.mve(&[command, "--help"]).succeeds().says("Examples:");
    }
}

#[test]
fn modules_are_listed_and_described() {
    let folder = Folder::new();
    let answer = folder.mve(&["modules"]).succeeds();
    answer.says("generate\n").says("Constant").says("  Puts out a number, to be linked to");
    folder.mve(&["modules", "Print"]).succeeds().says("Inputs:").says("`label` (text;");
    folder.mve(&["modules", "Prnt"]).fails(2, "\"Prnt\"; did you mean \"Print\"?\n");
    let found = folder.mve(&["modules", "decimate"]).succeeds();
    assert!(found.says("Simplificator").out.ends_with("2 modules; `mve modules ID` tells more\n"));
    folder.mve(&["modules", "hausdorff"]).succeeds().says("MeshComparer");
    folder.mve(&["modules", "--write", "docs/modules.md"]).succeeds();
    assert!(folder.read("docs/modules.md").contains("### Constant"));
    folder.mve(&["modules", "--write", "map.json/x"]).fails(4, "a file of this name is in the way");
    let lines = folder.mve(&["modules", "Constant", "--json"]).succeeds().json();
    assert_eq!((lines.len(), &lines[0]["category"]), (1, &"generate".into()));
    assert_eq!(lines[0]["params"]["properties"]["value"]["default"], 0.0);
}

#[test]
fn the_schema_is_json() {
    let folder = Folder::new();
    let text = folder.mve(&["schema"]).succeeds().out;
    let schema: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(schema["title"], "A map of mve");
    folder.mve(&["help", "run"]).succeeds().says("Examples:");
    folder.mve(&["schema", "--write", "schema.json"]).succeeds();
    assert_eq!(folder.read("schema.json"), text);
}

#[test]
fn shells_and_man_get_their_files() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        folder.mve(&["completions", shell]).succeeds().says("mve").says("dry-run");
    }
    folder.mve(&["completions", "basic"]).fails(2, "invalid value");
    folder.mve(&["man"]).succeeds().says(".TH mve 1").says("interrupted");
    folder.mve(&["man", "--dir", "man"]).succeeds();
    assert!(folder.has("man/mve.1") && folder.has("man/mve-program.1"));
}

#[test]
fn a_reader_that_goes_away_is_no_panic() {
    let folder = Folder::new();
    let calls: [&[&str]; 6] = [
        &[],
        &["modules"],
        &["schema"],
        &["run", "map.json"],
        &["run", "map.json", "--json"],
        &["program", "map.json", "sweep", "--json"],
    ];
    for args in calls {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = folder.command(args);
        let child = command.stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
        let answer = Answer::new(child.wait_with_output().unwrap()).succeeds();
        assert!(!answer.err.contains("panicked"), "{args:?}: {}", answer.err);
    }
    assert!(folder.has("mve-out/map-sweep/results.csv"));
}

#[test]
fn a_new_map_is_written_once() {
    let folder = Folder::new();
    folder.mve(&["new", "map", "first.json"]).succeeds().says("run it with: mve run first.json\n");
    let text = folder.read("first.json");
    folder.mve(&["new", "map", "first.json"]).fails(4, "a file of this name is in the way");
    assert_eq!(folder.read("first.json"), text);
    let map: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(map["mve"], 1);
}

/// What `mve new` looks at of a checkout.
fn checkout() -> Folder {
    let folder = Folder::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for file in ["core/Cargo.toml", "modules/src/lib.rs", "modules/src/measure/mod.rs"] {
        folder.write(file, &std::fs::read_to_string(root.join(file)).unwrap());
    }
    let list = "static COSTS: Entry<CostBuild> = COST in edge_length, quadric;";
    folder.write("modules/src/cost/mod.rs", &format!("registered! {{\n    {list}\n}}\n"));
    let list = "static ENTRIES: Entry<MakeMetric> = METRIC in hausdorff, image_rms;";
    folder.write("modules/src/metric/mod.rs", &format!("registered! {{\n    {list}\n}}\n"));
    folder
}

#[test]
fn a_new_module_is_a_file_and_a_name_in_a_list() {
    let folder = checkout();
    let before = folder.read("modules/src/measure/mod.rs");
    let new = |id: &str| folder.mve(&["new", "module", id, "--folder", "measure"]);
    new("AaaVolume").succeeds().says("measure/aaa_volume.rs\n").says("cargo test");
    let module = folder.read("modules/src/measure/aaa_volume.rs");
    assert!(module.contains("id: \"AaaVolume\"") && !module.contains('@'));
    let after = folder.read("modules/src/measure/mod.rs");
    assert_eq!(after.replace("aaa_volume, ", "").replace("    aaa_volume,\n", ""), before);
    assert_ne!(after, before);
    new("AaaVolume").fails(4, "a file of this name is in the way");
    new("Print").fails(2, "there is a module \"Print\" already");
    new("../Evil").fails(2, "write it in CamelCase");
    let answer = folder.mve(&["new", "module", "Abc", "--folder", "nowhere"]);
    answer.fails(2, "has no list of its own; name one of measure\n");
}

#[test]
fn a_new_cost_is_a_file_and_a_name_in_the_list() {
    let folder = checkout();
    folder.mve(&["new", "cost", "Longest"]).succeeds();
    assert!(folder.read("modules/src/cost/longest.rs").contains("impl Cost for Longest"));
    assert!(folder.read("modules/src/cost/mod.rs").contains("in edge_length, longest, quadric;"));
}

#[test]
fn a_new_image_cost_is_a_file_and_a_name_in_the_list() {
    let folder = checkout();
    folder.mve(&["new", "image-cost", "ImageAbsolute"]).succeeds().says("image_absolute\n");
    let cost = folder.read("modules/src/cost/image_absolute.rs");
    assert!(cost.contains("impl Difference for ImageAbsolute"));
    assert!(cost.contains("id: \"ImageAbsolute\"") && !cost.contains('@'));
    let list = folder.read("modules/src/cost/mod.rs");
    assert!(list.contains("in edge_length, image_absolute, quadric;"));
}

#[test]
fn a_new_metric_is_a_file_and_a_name_in_the_list() {
    let folder = checkout();
    folder.mve(&["new", "metric", "Areas"]).succeeds().says("metric/areas.rs\n");
    assert!(folder.read("modules/src/metric/areas.rs").contains("impl Metric for Areas"));
    assert!(folder.read("modules/src/metric/mod.rs").contains("in areas, hausdorff, image_rms;"));
}

#[test]
fn new_modules_need_a_checkout() {
    Folder::new().mve(&["new", "cost", "Longest"]).fails(2, "not a checkout of mve");
}
