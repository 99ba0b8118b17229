//! The commands around maps: documentation, schema, completions, pages, and new files.

use std::path::Path;
use std::process::{Command, Stdio};

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
fn view_wants_files_that_are_there() {
    let folder = Folder::new();
    folder.mve(&["view"]).fails(2, "<FILES>");
    folder.mve(&["view", "no-such.obj"]).fails(4, "there is no file no-such.obj");
}

#[test]
fn modules_are_listed_and_described() {
    let folder = Folder::new();
    let answer = folder.mve(&["modules"]).succeeds();
    answer.says("generate\n").says("Constant").says("  Puts out a number, to be linked to");
    folder.mve(&["modules", "Print"]).succeeds().says("Inputs:").says("`label` (text;");
    folder.mve(&["modules", "Prnt"]).fails(2, "\"Prnt\"; did you mean \"Print\"?\n");
    let found = folder.mve(&["modules", "decimate"]).succeeds();
    assert!(found.says("Simplificator").out.ends_with("5 modules; `mve modules ID` tells more\n"));
    folder.mve(&["modules", "hausdorff"]).succeeds().says("MeshComparer");
    let found = folder.mve(&["modules", "albedo"]).succeeds().says("Render");
    let found = found.says("in metric.Flip, metric.ImageRms, metric.ImageSsim\n");
    found.says("in cost.ImageMse, cost.ImageSsim\n");
    let part = folder.mve(&["modules", "MeshComparer.ImageSsim"]).succeeds();
    let part =
        part.says("### MeshComparer.ImageSsim\n").says("- `albedo` (").says("- `ssim` (SSIM of");
    let whole = folder.mve(&["modules", "MeshComparer.metric.ImageSsim"]).succeeds().out;
    assert_eq!(part.out, whole.replace("metric.", ""));
    folder.mve(&["modules", "Simplificator.cost"]).succeeds().says("- `Quadric`:");
    let far = folder.mve(&["modules", "Simplificator.ImageMse.cameras.Direction.x"]).succeeds();
    far.says("; default 1; only where from is Vector): How far");
    let wrong = folder.mve(&["modules", "MeshComparer.ImageSim"]);
    wrong.fails(2, "no parameter or entry \"ImageSim\"; did you mean \"ImageSsim\"?\n");
    std::fs::create_dir(folder.path().join("docs")).unwrap();
    folder.mve(&["modules", "--write", "docs/modules.md"]).succeeds();
    assert!(folder.read("docs/modules.md").contains("### Constant"));
    folder
        .mve(&["modules", "--write", "map.json/x"])
        .fails(4, "a file stands where a folder is needed");
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
    const LISTS: [&str; 6] = ["cost", "filters", "io", "measure", "metric", "placement"];
    let lists = LISTS.map(|name| format!("modules/src/{name}/mod.rs"));
    let others = [
        "core/Cargo.toml",
        "mesh/src/data/mod.rs",
        "modules/src/lib.rs",
        "app/editor/src/views/mod.rs",
    ];
    for file in lists.iter().map(String::as_str).chain(others).chain([".rustfmt.toml"]) {
        folder.write(file, &std::fs::read_to_string(root.join(file)).unwrap());
    }
    folder
}

/// Runs `mve new` for an entry of a list, and gives what it wrote; the list has the name as well.
fn new_entry(what: &str, id: &str, name: &str, list: &str) -> String {
    let folder = checkout();
    let list = format!("modules/src/{list}");
    let before = folder.read(&format!("{list}/mod.rs"));
    folder.mve(&["new", what, id]).succeeds().says(&format!("{name}.rs\n"));
    let names = |text: &str| -> Vec<String> {
        text.split([',', ';', ' ', '\n']).filter(|n| !n.is_empty()).map(str::to_owned).collect()
    };
    let mut after = names(&folder.read(&format!("{list}/mod.rs")));
    after.remove(after.iter().position(|n| n == name).unwrap());
    assert_eq!(after, names(&before));
    let text = folder.read(&format!("{list}/{name}.rs"));
    assert!(text.contains(&format!("id: \"{id}\"")) && !text.contains("emplate"), "{text}");
    text
}

#[test]
fn a_new_module_is_a_file_and_a_name_in_a_list() {
    let folder = checkout();
    let before = folder.read("modules/src/measure/mod.rs");
    let new = |id: &str| folder.mve(&["new", "module", id, "--folder", "measure"]);
    new("AaaVolume").succeeds().says("measure/aaa_volume.rs\n").says("cargo test");
    let module = folder.read("modules/src/measure/aaa_volume.rs");
    assert!(module.contains("id: \"AaaVolume\"") && !module.contains("emplate"));
    let after = folder.read("modules/src/measure/mod.rs");
    assert_eq!(after.replace("aaa_volume, ", "").replace("    aaa_volume,\n", ""), before);
    assert_ne!(after, before);
    new("AaaVolume").fails(4, "a file of this name is in the way");
    new("Print").fails(2, "there is a module \"Print\" already");
    new("../Evil").fails(2, "write it in CamelCase");
    let answer = folder.mve(&["new", "module", "Abc", "--folder", "nowhere"]);
    answer.fails(2, "has no list of its own; name one of filters, io, measure\n");
}

#[test]
fn a_new_entry_is_a_file_and_a_name_in_its_list() {
    let cost = new_entry("cost", "Longest", "longest", "cost");
    assert!(cost.contains("impl Cost for Longest"));
    let cost = new_entry("image-cost", "ImageAbsolute", "image_absolute", "cost");
    assert!(cost.contains("impl Difference for ImageAbsolute"));
    let metric = new_entry("metric", "Areas", "areas", "metric");
    assert!(metric.contains("impl Metric for Areas"));
    let placement = new_entry("placement", "Centroid", "centroid", "placement");
    assert!(placement.contains("impl Placement for Centroid"));
}

#[test]
fn a_new_loader_is_a_file_with_its_reader_and_a_name_in_a_list() {
    let loader = new_entry("loader", "GtsLoader", "gts_loader", "io");
    assert!(loader.contains("&[\"gts\"]).example(EXAMPLE)") && loader.contains("fn read(bytes"));
    let folder = checkout();
    let new = |id: &str| folder.mve(&["new", "loader", id]);
    new("GtsLoader").succeeds().says("cargo test -p mve-modules gts_loader\n");
    new("Stl").fails(2, "\"Stl\" does not name a format");
    new("ObjLoader").fails(2, "there is a module \"ObjLoader\" already");
    // Where the file is in the way, the list stays as it is.
    folder.write("modules/src/io/dxf_loader.rs", "mine");
    let list = folder.read("modules/src/io/mod.rs");
    new("DxfLoader").fails(4, "a file of this name is in the way");
    assert_eq!(folder.read("modules/src/io/mod.rs"), list);
    assert_eq!(folder.read("modules/src/io/dxf_loader.rs"), "mine");
}

#[test]
fn a_new_type_and_its_view_are_a_file_and_a_line_each() {
    let folder = checkout();
    folder.mve(&["new", "data", "Landmarks"]).succeeds();
    let data = folder.read("mesh/src/data/landmarks.rs");
    assert!(data.contains("impl Data for Landmarks") && !data.contains("emplate"));
    let list = folder.read("mesh/src/data/mod.rs");
    assert!(list.contains("    images: Images,\n    landmarks: Landmarks,\n"), "{list}");
    folder.mve(&["new", "view", "Landmarks"]).succeeds().says("cargo test -p mve-editor landmarks");
    let view = folder.read("app/editor/src/views/landmarks.rs");
    assert!(view.contains("impl ValueView for LandmarksView") && !view.contains("easures"));
    let list = folder.read("app/editor/src/views/mod.rs");
    assert!(list.contains("    landmarks::LandmarksView as landmarks,\n}"), "{list}");
}

#[test]
fn new_files_are_formatted_however_long_their_ids_are() {
    let folder = checkout();
    for id in ["Ab", "AWordThatGoesOnAndOnAndOn"] {
        for what in ["module", "cost", "placement", "metric", "data", "view"] {
            folder.mve(&["new", what, id]).succeeds();
        }
        folder.mve(&["new", "image-cost", &format!("{id}Image")]).succeeds();
        folder.mve(&["new", "loader", &format!("{id}Loader")]).succeeds();
    }
    let mut files = Vec::new();
    let mut folders = vec![folder.path().to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false if path.extension().is_some_and(|e| e == "rs") => files.push(path),
                false => {}
            }
        }
    }
    files.retain(|path| !path.ends_with("mod.rs") && !path.ends_with("lib.rs"));
    assert_eq!(files.len(), 2 * 8);
    let mut command = Command::new("rustfmt");
    let output = command.arg("--check").args(&files).current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let is_wide = |line: &&str| line.chars().count() > 100;
        assert_eq!(text.lines().find(is_wide), None, "{}", path.display());
    }
}

#[test]
fn new_modules_need_a_checkout() {
    Folder::new().mve(&["new", "cost", "Longest"]).fails(2, "not a checkout of mve");
}
