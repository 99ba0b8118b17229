//! `mve rate`, and `mve report` with what people saved.

use serde_json::{Value as Json, json};

use crate::common::Folder;

const MAP: &str = r#"{"mve": 1, "nodes": {
    "model": {"module": "Box"}, "simplify": {"module": "Simplificator"},
    "compare": {"module": "MeshComparer"}, "info": {"module": "MeshInfo"}},
  "links": ["model.mesh -> simplify.mesh", "model.mesh -> compare.original",
    "simplify.mesh -> compare.simplified", "simplify.mesh -> info.mesh"],
  "programs": {"faces": {"axes": [{"model.size_x": [1, 2]}, {"simplify.target_faces": [12, 100, 300]}]}}}"#;

const STORE: &str = "mve-out/box-faces";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("box.json", MAP);
    folder.mve(&["program", "box.json"]).succeeds();
    folder
}

/// What stands in the page.
fn data(folder: &Folder) -> Json {
    let page = folder.read(&format!("{STORE}/rate.html"));
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn the_page_has_each_result_beside_its_original_and_its_marks_come_back() {
    let folder = folder();
    let rate = ["rate", STORE, "--frames", "5", "--size", "64"];
    folder.mve(&rate).succeeds().says("6 results of 2 originals");
    let page = data(&folder);
    assert_eq!(
        (&page["frames"], &page["columns"], &page["size"]),
        (&json!(5), &json!(3), &json!(64))
    );
    let items = page["items"].as_array().unwrap();
    let of_first = items.iter().filter(|item| item["original"] == 0).count();
    assert_eq!((items.len(), of_first), (6, 3));
    assert_eq!(page["results"].as_array().unwrap().len(), 6);
    folder.mve(&[&rate[..], &["--only", "simplify.target_faces=100"]].concat()).succeeds();
    assert_eq!(data(&folder)["items"].as_array().unwrap().len(), 2);
    let none = folder.mve(&[&rate[..], &["--only", "simplify.target_faces=101"]].concat());
    none.fails(2, "--only simplify.target_faces: no step has it as 101");
    let slip = folder.mve(&[&rate[..], &["--only", "simplify.target_face=100"]].concat());
    slip.fails(2, "did you mean \"simplify.target_faces\"?");
    // The same page once more, from values that are kept.
    folder.mve(&rate).succeeds();
    assert_eq!(data(&folder), page);
    let ratings = |rater: &str, first: f64| {
        let marks = items.iter().enumerate();
        let marks: Vec<Json> = marks
            .map(|(n, item)| json!({ "step": item["step"], "mark": first + n as f64 }))
            .collect();
        json!({ "mve_ratings": 1, "program": "faces", "rater": rater, "marks": marks }).to_string()
    };
    folder.write("a.json", &ratings("a", 0.0));
    folder.write("b.json", &ratings("b", 3.0));
    let tables = ["report", STORE, "--ratings", "a.json,b.json", "--format", "markdown"];
    folder
        .mve(&tables)
        .succeeds()
        .says("2 people")
        .says("1.00 (1.00 to 1.00)")
        .says("0.20 (0.20 to 0.20)");
    folder.mve(&["report", STORE, "--ratings", "a.json", "b.json"]).succeeds();
    assert!(folder.read(&format!("{STORE}/report.html")).contains("<h2>People</h2>"));
    let last = folder.mve(&["report", "--format", "markdown", "--ratings", "a.json", STORE]);
    last.succeeds().says("1 person");
    let none = folder.mve(&["report", "--ratings", "a.json"]);
    none.fails(2, "name the folder of the results");
    folder.write("other.json", &ratings("c", 1.0).replace(items[0]["step"].as_str().unwrap(), "x"));
    let other = folder.mve(&["report", STORE, "--ratings", "other.json"]);
    other.fails(3, "other.json: marks results of another store");
    folder.write("broken.json", "{");
    let broken = folder.mve(&["report", STORE, "--ratings", "broken.json", "a.json"]);
    broken.fails(3, "broken.json: is no file of ratings");
    folder
        .mve(&["report", STORE, "--ratings", "none.json"])
        .fails(4, "none.json: there is no such");
}

#[test]
fn what_cannot_be_shown_is_told() {
    let folder = folder();
    folder.mve(&["rate", "nowhere"]).fails(4, "no results of a program here");
    let odd = ["rate", STORE, "--frames", "1", "--size", "64"];
    let with = |more: &[&str]| folder.mve(&[&odd, more].concat());
    with(&["--original", "modle.mesh"]).fails(2, "the map has no node \"modle\"");
    with(&["--result", "info.area"]).fails(2, "info.area is no output with a mesh");
    with(&["--result", "model.mesh", "--up", "z", "--shading", "smooth"]).succeeds();
    folder.mve(&["rate", STORE, "--frames", "0"]).fails(2, "--frames");
    // A map that has no comparison does not tell what to show.
    folder.write(
        "plain.json",
        r#"{"mve": 1, "nodes": {"a": {"module": "Box"}},
        "programs": {"p": {"axes": [{"a.segments": [1, 2]}]}}}"#,
    );
    folder.mve(&["program", "plain.json"]).succeeds();
    folder.mve(&["rate", "mve-out/plain-p"]).fails(2, "name what is shown with --original");
    let both = ["--original", "a.mesh", "--result", "a.mesh", "--frames", "1", "--size", "64"];
    folder.mve(&[&["rate", "mve-out/plain-p"][..], &both].concat()).succeeds();
}
