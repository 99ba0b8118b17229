//! `mve report`, and the page that `mve program` leaves.

use crate::common::Folder;

const MAP: &str = r#"{"mve": 1, "title": "Cuts <of> a box",
  "nodes": {
    "model": {"module": "Box"},
    "simplify": {"module": "Simplificator"},
    "info": {"module": "MeshInfo"}},
  "links": ["model.mesh -> simplify.mesh", "simplify.mesh -> info.mesh"],
  "programs": {"costs": {
    "axes": [{"simplify.target_faces": [300, 500]}, {"simplify.cost": ["EdgeLength", "Quadric"]}],
    "report": {
      "measures": [{"column": "info.area", "better": "higher", "title": "Area"}],
      "questions": [{"text": "Does Quadric keep more area?", "measure": "info.area",
                     "compare": {"simplify.cost": ["Quadric", "EdgeLength"]}}]}}}}"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("box.json", MAP);
    folder
}

#[test]
fn a_program_leaves_a_page_and_answers() {
    let folder = folder();
    let answer = folder.mve(&["program", "box.json"]).succeeds();
    let answer =
        answer.says("Does Quadric keep more area?\n").says("is equal with Quadric and with");
    answer.says("report   mve-out/box-costs/report.html\n");
    let page = folder.read("mve-out/box-costs/report.html");
    assert!(page.contains("<title>Cuts &lt;of&gt; a box</title>"));
    assert!(page.contains("<dt>map</dt><dd>box.json</dd>") && page.contains("<dt>machine</dt>"));
    assert!(page.contains("href=\"steps/") && page.contains("href=\"results.csv\""));
    // What a question compares with, where nobody asks one.
    let plan: serde_json::Value =
        serde_json::from_str(&folder.read("mve-out/box-costs/plan.json")).unwrap();
    assert_eq!(plan["defaults"]["simplify.cost"], "Quadric");
    let summary = folder.read("mve-out/box-costs/summary.md");
    let place = |what: &str| summary.find(what).unwrap();
    assert!(place("info.area") < place("info.vertices"), "{summary}");
}

#[test]
fn the_readme_shows_what_the_program_says() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let lines = readme.lines().skip_while(|line| !line.starts_with("> **Is “"));
    let quoted = lines.map_while(|line| line.strip_prefix("> ")).collect::<Vec<_>>().join(" ");
    let (question, answer) = quoted.trim_start_matches("**").split_once("** ").unwrap();
    let folder = Folder::new();
    let map = root.join("maps/placements.json");
    let args = ["program", map.to_str().unwrap(), "--out", "out"];
    let said = folder.mve(&args).succeeds().out.replace('\u{a0}', " ");
    assert!(said.contains(&format!("{question}\n  {answer}\n")), "{said}");
}

#[test]
fn the_page_is_left_out_on_demand() {
    let folder = folder();
    folder.mve(&["program", "box.json", "--no-report"]).succeeds();
    assert!(!folder.has("mve-out/box-costs/report.html"));
    let answer = folder.mve(&["report", "mve-out/box-costs"]).succeeds();
    answer.says("report   mve-out/box-costs/report.html\n");
    let elsewhere = ["report", "mve-out/box-costs", "--out", "pages/box.html"];
    folder.mve(&elsewhere).fails(4, "pages/box.html: there is no folder pages; create it first");
    assert!(!folder.has("pages"));
    std::fs::create_dir(folder.path().join("pages")).unwrap();
    folder.mve(&elsewhere).succeeds();
    assert!(folder.read("pages/box.html").contains("href=\"../mve-out/box-costs/steps/"));
}

#[test]
fn tables_go_to_standard_output() {
    let folder = folder();
    folder.mve(&["program", "box.json"]).succeeds();
    let with =
        |format: &str| folder.mve(&["report", "mve-out/box-costs", "--format", format]).succeeds();
    with("csv").says("simplify.target_faces,simplify.cost,info.area,");
    with("markdown").says("## Area (higher is better)\n");
    with("latex").says("target faces & EdgeLength & Quadric \\\\\n");
    folder.mve(&["report", "x", "--format", "doc"]).fails(2, "invalid value 'doc'");
}

#[cfg(unix)]
#[test]
fn pipes_and_links_are_not_replaced() {
    use std::os::unix::fs::FileTypeExt;
    let folder = folder();
    folder.mve(&["program", "box.json"]).succeeds();
    let path = |name: &str| folder.path().join(name);
    assert!(std::process::Command::new("mkfifo").arg(path("pipe")).status().unwrap().success());
    folder.write("kept.tex", "kept");
    std::os::unix::fs::symlink("kept.tex", path("link")).unwrap();
    let to =
        |out: &str| folder.mve(&["report", "mve-out/box-costs", "--format", "latex", "--out", out]);
    to("pipe").fails(4, "pipe is a device or a pipe, and a file would take its place");
    to("link").fails(4, "link is a symbolic link, and a file would take its place");
    let kind = |name: &str| std::fs::symlink_metadata(path(name)).unwrap().file_type();
    assert!(kind("pipe").is_fifo() && kind("link").is_symlink());
    assert_eq!(folder.read("kept.tex"), "kept");
    to("-").succeeds().says("target faces & EdgeLength & Quadric \\\\\n");
    assert!(!folder.has("-"));
    let plots = ["report", "mve-out/box-costs", "--format", "svg", "--out"];
    folder.mve(&[&plots[..], &["-"]].concat()).fails(2, "name a folder for them");
}

#[test]
fn plots_are_files_of_their_own() {
    let folder = folder();
    folder.mve(&["program", "box.json"]).succeeds();
    let report = ["report", "mve-out/box-costs", "--format", "svg"];
    let answer = folder.mve(&report).succeeds();
    answer.says("plot     mve-out/box-costs/plots/info.area-by-simplify.faces.svg\n");
    let plot = folder.read("mve-out/box-costs/plots/info.area-by-simplify.faces.svg");
    assert!(plot.starts_with("<svg"), "{plot:.200}");
    let answer = folder.mve(&["report", "mve-out/box-costs", "--format", "pdf", "--out", "pages"]);
    match cfg!(feature = "pdf") {
        true => drop(answer.succeeds()),
        false => drop(answer.fails(1, "this build of mve writes no PDF; write SVG")),
    }
    let has_pdf = folder.has("pages/info.area-by-simplify.faces.pdf");
    assert_eq!(has_pdf, cfg!(feature = "pdf"));
}

#[test]
fn the_present_report_of_a_map_can_be_taken() {
    let folder = folder();
    folder.mve(&["program", "box.json"]).succeeds();
    let report = ["report", "mve-out/box-costs", "--format", "markdown", "--map", "box.json"];
    folder
        .write("box.json", &MAP.replace("\"info.area\", \"better\"", "\"info.euler\", \"better\""));
    folder.mve(&report).succeeds().says("## Area (higher is better)\n").says("| 300 | 2 | 2 |");
    folder
        .write("box.json", &MAP.replace("\"info.area\", \"better\"", "\"info.arae\", \"better\""));
    let answer = folder.mve(&report);
    answer.fails(3, "\"info.arae\" is not a column").fails(3, "did you mean \"info.area\"?");
    let answer = folder.mve(&["check", "box.json"]);
    answer.fails(3, "box.json: 1 problem").says("did you mean \"info.area\"?");
    folder.write("box.json", &MAP.replace("\"costs\"", "\"cost\""));
    folder.mve(&report).fails(3, "there is no program \"costs\", of which this is a store");
}

#[test]
fn what_options_name_is_told_by_the_option() {
    let folder = folder();
    folder.mve(&["program", "box.json"]).succeeds();
    let slips = [
        (
            "--columns",
            "simplify.cots",
            "is not varied by the program; did you mean \"simplify.cost\"?",
        ),
        ("--rows", "s.cost", "\"s.cost\" is not varied by the program"),
        ("--measure", "info.arae", "did you mean \"info.area\"?"),
    ];
    for (option, name, message) in slips {
        let answer = folder.mve(&["report", "mve-out/box-costs", option, name]);
        answer.fails(3, &format!("{option}: \"{name}\" is not ")).fails(3, message);
    }
}

#[test]
fn slips_are_told_before_anything_runs() {
    let folder = folder();
    folder.write("box.json", &MAP.replace("\"better\"", "\"beter\""));
    let answer = folder.mve(&["program", "box.json"]);
    answer.fails(
        3,
        "program \"costs\": \"report.measures[0]\": there is no field \"beter\"; did you mean",
    );
    folder.write("box.json", &MAP.replace("[\"Quadric\", \"EdgeLength\"]}}", "[\"Q\", \"R\"]}}"));
    let answer = folder.mve(&["check", "box.json"]);
    answer.fails(3, "box.json: 2 problems").says("\"Q\" is not among the values of simplify.cost");
}

#[test]
fn folders_that_are_no_stores_are_refused() {
    let folder = folder();
    folder.mve(&["report", "none"]).fails(4, "error: none: no results of a program here");
    folder
        .mve(&["report", "."])
        .fails(4, "not a store of mve; name the folder that `mve program` wrote");
    folder.write("torn/plan.json", "{");
    folder.mve(&["report", "torn"]).fails(4, "torn/plan.json: not the plan of a program");
}
