//! Reports of stores that are made by hand: what they say, and that nothing in a store breaks them.

use std::fs;
use std::path::Path;

use mve_report::{Format, Report, ReportError};
use serde_json::{Value as Json, json};
use tempfile::TempDir;

/// A picture of one red pixel.
fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_pixel(1, 1, image::Rgb([255, 0, 0]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A store under construction.
struct Maker {
    folder: TempDir,
    plan: Json,
}

impl Maker {
    fn new(spec: Json) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let varied: Vec<String> = spec["axes"]
            .as_array()
            .into_iter()
            .flatten()
            .flat_map(|axis| axis.as_object().unwrap().keys().cloned().collect::<Vec<_>>())
            .collect();
        let plan = json!({
            "program": "p", "mve": "0.1.0", "inputs": {}, "modules": {}, "steps": [],
            "varied": varied, "nodes": ["model", "cut", "compare", "save"], "spec": spec,
            "map": { "mve": 1, "title": "A title", "nodes": {} }
        });
        Self { folder, plan }
    }

    /// Adds a step that gave these values; without values it has not ended.
    fn step(&mut self, params: Json, repeat: u32, outputs: Option<Json>) -> String {
        let steps = self.plan["steps"].as_array_mut().unwrap();
        let id = format!("{:016x}", steps.len() + 1);
        let seconds = 0.5 + steps.len() as f64;
        steps.push(json!({ "id": id, "repeat": repeat, "params": params }));
        let Some(outputs) = outputs else { return id };
        let node = |outputs: Json| {
            json!({ "module": "M", "status": "done", "key": "0".repeat(64),
            "seconds": seconds, "phases": { "heap": seconds / 4.0 }, "scalars": outputs })
        };
        let mut record = json!({
            "id": id, "repeat": repeat, "params": params, "status": "done", "seconds": 1.5,
            "is_timed": true, "version": "0.1.0",
            "nodes": { "cut": node(json!({ "faces": outputs["faces"] })), "compare": node(outputs) }
        });
        if let Some(reason) = record["nodes"]["compare"]["scalars"]["fail"].as_str() {
            let reason = reason.to_owned();
            record["status"] = json!("failed");
            record["reason"] = json!(reason);
        }
        self.put(&id, &record);
        id
    }

    fn put(&self, id: &str, record: &Json) {
        let folder = self.folder.path().join("steps").join(id);
        fs::create_dir_all(folder.join("outputs")).unwrap();
        fs::write(folder.join("record.json"), record.to_string()).unwrap();
    }

    fn finish(self) -> TempDir {
        fs::write(self.folder.path().join("plan.json"), self.plan.to_string()).unwrap();
        self.folder
    }
}

fn text(folder: &Path, format: Format) -> String {
    Report::read(folder).unwrap().text(format, Some(folder))
}

/// Two models by two costs, one of them at two resolutions.
fn experiment() -> Maker {
    let costs = json!(["Quadric", { "Mse": { "size": 1 } }, { "Mse": { "size": 2 } },
        { "Ssim": { "size": 1 } }, { "Ssim": { "size": 2 } }]);
    let mut maker = Maker::new(json!({
        "axes": [{ "model.module": ["Box", "Vase"] }, { "cut.cost": costs }],
        "report": {
            "measures": [{ "column": "compare.err", "title": "Error" },
                { "column": "compare.like", "better": "higher" }, { "column": "compare.none" }],
            "questions": [{ "text": "Is Ssim lower than Mse?", "measure": "compare.err",
                "compare": { "cut.cost": ["Ssim", "Mse"] } }]
        }
    }));
    let values = [[4.0, 2.0, 2.0, 1.0, 1.0], [8.0, 4.0, 4.0, 2.0, 4.0]];
    for (model, values) in ["Box", "Vase"].into_iter().zip(values) {
        for (cost, value) in costs.as_array().unwrap().iter().zip(values) {
            let faces = if model == "Vase" && value == 2.0 { 101 } else { 100 };
            let outputs = json!({ "err": value, "like": 1.0 / value, "faces": faces });
            maker.step(json!({ "model.module": model, "cut.cost": cost }), 0, Some(outputs));
        }
    }
    maker
}

#[test]
fn a_question_is_answered_from_pairs_of_equal_parameters() {
    let folder = experiment().finish();
    let report = Report::read(folder.path()).unwrap();
    let answers = report.answers_in_words();
    assert_eq!(answers[0].0, "Is Ssim lower than Mse?");
    let words = answers[0].1.join(" ").replace('\u{a0}', " ");
    // Ratios 1/2, 1/2, 1/2, 1: the geometric mean is 2^(-3/4) = 0.5946. Of the three that differ
    // all are lower, and 2 of 8 signs are as far from the middle: p = 0.25.
    let lead = "Too few pairs to tell: on average “Error” is 41 % lower with Ssim than with Mse";
    assert!(words.starts_with(lead), "{words}");
    assert!(words.contains("geometric mean of 4 pairs"), "{words}");
    let counts = "it is lower in 3 of 4, equal in 1; p = 0.25 by the signed-rank test";
    assert!(words.contains(counts), "{words}");
    assert!(words.contains("In 1 of 4 pairs cut.faces is not the same, by up to 0.99 %."));
    // By model first: 1/2 and 1/sqrt 2, whose geometric mean is the same.
    assert!(
        words.contains("averaged first, since they are not independent: 41 % lower"),
        "{words}"
    );
}

#[test]
fn tables_mark_the_best_of_each_row() {
    let folder = experiment().finish();
    let latex = text(folder.path(), Format::Latex);
    let row = "Box & 4 & 2 & 2 & \\textbf{1} & \\textbf{1} \\\\";
    assert!(latex.contains(row), "{latex}");
    assert!(latex.contains("model.module & Quadric & Mse 1 & Mse 2 & Ssim 1 & Ssim 2 \\\\"));
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("| Vase | 8 | 4 | 4 | **2** | 4 |"), "{markdown}");
    assert!(markdown.contains("| Vase | 0.125 | 0.25 | 0.25 | **0.5** | 0.25 |"), "{markdown}");
    let csv = text(folder.path(), Format::Csv);
    assert!(csv.starts_with("model.module,cut.cost,compare.err,compare.like,"), "{csv}");
    assert!(csv.contains("Box,\"{\"\"Mse\"\":{\"\"size\"\":1}}\",2,0.5,"), "{csv}");
    let page = text(folder.path(), Format::Html);
    assert!(page.contains("<td class=\"best\">1</td>"));
    assert!(page.contains("No step gave a number for compare.none."));
    assert!(page.contains("<svg") && page.contains("<h2>Correlation of the measures</h2>"));
}

#[test]
fn pictures_that_are_the_same_are_shown_once() {
    let mut maker = experiment();
    let ids: Vec<String> = (1..=5).map(|n| format!("{n:016x}")).collect();
    for (place, id) in ids.iter().enumerate() {
        let folder = maker.folder.path().join("steps").join(id);
        let record = fs::read_to_string(folder.join("record.json")).unwrap();
        let mut record: Json = serde_json::from_str(&record).unwrap();
        let saver = |file: &str| {
            json!({ "module": "S", "status": "done", "key": "0".repeat(64),
            "files": [file] })
        };
        record["nodes"]["original"] = saver("o.png");
        record["nodes"]["result"] = saver("r.png");
        maker.put(id, &record);
        let other = image::RgbImage::from_pixel(2, 2, image::Rgb([0, 0, 10 * place as u8]));
        fs::write(folder.join("outputs/o.png"), png()).unwrap();
        other.save(folder.join("outputs/r.png")).unwrap();
    }
    maker.plan["nodes"] = json!(["cut", "original", "result"]);
    let page = text(maker.finish().path(), Format::Html);
    assert_eq!(page.matches("data:image/png;base64,").count(), 1 + 5);
    assert!(page.contains("alt=\"Box · the same for all · original\""));
    assert!(page.contains("alt=\"Box · Ssim 2 · result\""));
}

#[test]
fn repeats_give_a_mean_and_its_interval() {
    let mut maker = Maker::new(json!({
        "axes": [{ "cut.seed": [1, 2] }], "repeats": 5,
        "report": { "measures": [{ "column": "compare.err" }] }
    }));
    for (seed, add) in [(1, 0.0), (2, 1.0)] {
        for (repeat, value) in [4.1, 3.9, 4.4, 4.0, 4.6].into_iter().enumerate() {
            let outputs = json!({ "err": value + add, "faces": 100 });
            maker.step(json!({ "cut.seed": seed }), repeat as u32, Some(outputs));
        }
    }
    let page = text(maker.finish().path(), Format::Html);
    // The interval is the one of scipy.stats.t.interval, as in the tests of the statistics.
    assert!(page.contains("<td>4.2 ± 0.36</td>"));
    assert!(page.contains("10 of 10 steps done") && page.contains("Means over the repeats"));
}

/// A store of a Box and a Vase by two costs, with these errors.
fn small(report: Json, errors: [f64; 4]) -> Maker {
    let axes = json!([{ "model.module": ["Box", "Vase"] }, { "cut.cost": ["A", "B"] }]);
    let mut maker = Maker::new(json!({ "axes": axes, "report": report }));
    for (place, error) in errors.into_iter().enumerate() {
        let (model, cost) = (["Box", "Vase"][place / 2], ["A", "B"][place % 2]);
        let outputs = json!({ "err": error, "faces": 100 });
        maker.step(json!({ "model.module": model, "cut.cost": cost }), 0, Some(outputs));
    }
    maker
}

#[test]
fn rounding_counts_as_zero_and_is_not_ranked() {
    let report = json!({
        "measures": [{ "column": "compare.err" }],
        "questions": [{ "text": "A or B?", "measure": "compare.err",
            "compare": { "cut.cost": ["A", "B"] } }]
    });
    let note = "Values of a measure below 10⁻¹² of its largest are rounding and count as 0.";
    let folder = small(report.clone(), [1e-17, 1e-16, 1.0, 0.5]).finish();
    let page = text(folder.path(), Format::Html);
    assert!(page.contains(note) && page.contains("equal in 1"), "{page}");
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("| Box | 0 | 0 |"), "{markdown}");
    assert!(markdown.contains("| Vase | 1 | **0.5** |"), "{markdown}");
    // To compute with, the numbers are what they were.
    let csv = text(folder.path(), Format::Csv);
    assert!(csv.contains("Box,A,1e-17,") && csv.contains("Box,B,1e-16,"), "{csv}");
    let page = text(small(report, [1e-11, 1e-10, 1.0, 0.5]).finish().path(), Format::Html);
    assert!(!page.contains(note) && page.contains("<td class=\"best\">1e-11</td>"), "{page}");
}

#[test]
fn seconds_of_a_part_of_a_node_are_a_column() {
    let report = json!({ "measures": [{ "column": "seconds.cut.heap", "title": "Queue" }] });
    let folder = small(report, [1.0; 4]).finish();
    let markdown = text(folder.path(), Format::Markdown);
    // A step takes a second more than the one before it, and a quarter of them in the heap.
    assert!(markdown.contains("| Box | **0.125** | 0.375 |"), "{markdown}");
    assert!(markdown.contains("| Vase | **0.625** | 0.875 |"), "{markdown}");
}

#[test]
fn models_of_different_sizes_are_in_different_charts() {
    let axes = json!([{ "model.module": ["Box", "Vase"] }, { "cut.cost": ["A", "B"] }]);
    let page = |size: [u32; 4]| {
        let report = json!({ "measures": [{ "column": "compare.err" }], "against": ["cut.faces"] });
        let mut maker = Maker::new(json!({ "axes": axes, "report": report }));
        for (place, faces) in size.into_iter().enumerate() {
            let (model, cost) = (["Box", "Vase"][place / 2], ["A", "B"][place % 2]);
            let outputs = json!({ "err": 1.0 + place as f64, "faces": faces });
            maker.step(json!({ "model.module": model, "cut.cost": cost }), 0, Some(outputs));
        }
        text(maker.finish().path(), Format::Html)
    };
    let constant = page([300, 300, 4000, 4000]);
    assert!(!constant.contains("<svg"), "one count of faces a model: nothing to see");
    let differing = page([300, 600, 2000, 4000]);
    assert_eq!(differing.matches("<svg").count(), 3, "the means, the Box and the Vase");
}

#[test]
fn an_axis_of_one_value_gives_no_series() {
    let mut maker = Maker::new(json!({
        "axes": [{ "cut.cost": ["A", "B"] }, { "model.module": ["Vase"] }]
    }));
    for (place, cost) in ["A", "B"].into_iter().enumerate() {
        let outputs = json!({ "err": 1.0 + place as f64, "faces": 100 });
        maker.step(json!({ "cut.cost": cost, "model.module": "Vase" }), 0, Some(outputs));
    }
    let markdown = text(maker.finish().path(), Format::Markdown);
    assert!(markdown.contains("| model.module | A | B |"), "{markdown}");
    assert!(markdown.contains("| Vase | **1** | 2 |"), "{markdown}");
}

#[test]
fn seconds_of_reading_the_cache_are_no_time() {
    let mut maker = Maker::new(json!({
        "axes": [{ "cut.seed": [1, 2] }], "repeats": 2,
        "report": { "measures": [{ "column": "seconds" }, { "column": "seconds.cut" }] }
    }));
    let mut ids = Vec::new();
    for (seed, repeat) in [(1, 0), (1, 1), (2, 0), (2, 1)] {
        let outputs = json!({ "err": 1.0, "faces": 100 });
        ids.push(maker.step(json!({ "cut.seed": seed }), repeat, Some(outputs)));
    }
    let path = maker.folder.path().join("steps").join(&ids[1]).join("record.json");
    let mut record: Json = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    record["seconds"] = json!(0.001);
    for node in ["cut", "compare"] {
        record["nodes"][node]["cached"] = json!("memory");
        record["nodes"][node].as_object_mut().unwrap().remove("seconds");
    }
    maker.put(&ids[1], &record);
    let markdown = text(maker.finish().path(), Format::Markdown);
    // The first has one step that worked, the other two: 2.5 s and 3.5 s.
    assert!(markdown.contains("| 1 | 1.5 | 0.5 |"), "{markdown}");
    assert!(markdown.contains("| 2 | 1.5 | 3 ± "), "{markdown}");
}

#[test]
fn what_is_missing_is_said_in_every_format() {
    let mut maker = small(json!({ "measures": [{ "column": "compare.err" }] }), [1.0; 4]);
    maker.step(json!({ "model.module": "Tube", "cut.cost": "A" }), 0, None);
    let failed = json!({ "fail": "too large" });
    maker.step(json!({ "model.module": "Tube", "cut.cost": "B" }), 0, Some(failed));
    let folder = maker.finish();
    let words = "4 of 6 steps are done, 1 failed, 1 to do";
    assert!(text(folder.path(), Format::Markdown).contains(words));
    assert!(text(folder.path(), Format::Latex).contains(words));
    let csv = text(folder.path(), Format::Csv);
    let rows: Vec<&str> = csv.lines().filter(|line| line.starts_with("Tube")).collect();
    assert!(rows[0].ends_with(",to do") && rows[1].ends_with(",failed"), "{csv}");
}

#[test]
fn nothing_from_a_store_becomes_markup() {
    let bad = "<script>alert(1)</script>";
    let mut maker = Maker::new(json!({
        "axes": [{ "cut.cost": [bad, "B"] }],
        "report": { "questions": [{ "text": bad, "measure": "compare.err",
            "compare": { "cut.cost": [bad, "B"] } }],
            "measures": [{ "column": "compare.err", "title": bad }] }
    }));
    maker.plan["map"]["title"] = json!(bad);
    maker.plan["map"]["note"] = json!("</pre></script><script>");
    maker.plan["program"] = json!(bad);
    maker.plan["map_file"] = json!(bad);
    maker.plan["inputs"] = json!({ bad: "0".repeat(64) });
    maker.step(json!({ "cut.cost": bad }), 0, Some(json!({ "err": 1.0, "text": bad })));
    maker.step(json!({ "cut.cost": "B" }), 0, Some(json!({ "err": 2.0, "fail": bad })));
    let page = text(maker.finish().path(), Format::Html);
    assert_eq!(page.matches("<script").count(), 1, "only the page's own");
    assert_eq!(page.matches("</script>").count(), 1);
    assert!(
        !page.contains("http://")
            || page.matches("http://").count() == page.matches("<svg").count()
    );
    assert!(page.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
}

#[test]
fn odd_stores_have_reports() {
    let mut maker = Maker::new(json!({
        "axes": [{ "model.module": ["A", "B", "C", "D"] }, { "cut.cost": ["X", "Y"] }],
        "report": { "measures": [{ "column": "compare.err" }, { "column": "compare.big" }] }
    }));
    let params = |model: &str, cost: &str| json!({ "model.module": model, "cut.cost": cost });
    maker.step(params("A", "X"), 0, Some(json!({ "err": null, "faces": 1e300, "big": 1e300 })));
    maker.step(params("A", "Y"), 0, Some(json!({ "err": 0.0, "faces": 7, "big": -1e-300 })));
    maker.step(params("B", "X"), 0, None);
    maker.step(params("B", "Y"), 0, Some(json!({ "err": -5.0, "faces": 1e-300, "big": 0.0 })));
    maker.step(params("C", "X"), 0, Some(json!({ "fail": "x".repeat(100_000) })));
    let id = maker.step(params("D", "X"), 0, Some(json!({ "err": 3.0 })));
    fs::write(maker.folder.path().join("steps").join(id).join("record.json"), "{\"id\"").unwrap();
    let folder = maker.finish();
    for format in [Format::Html, Format::Csv, Format::Markdown, Format::Latex] {
        assert!(!text(folder.path(), format).is_empty());
    }
    let page = text(folder.path(), Format::Html);
    assert!(page.contains("3 of 6 steps done") && page.contains("2 to do"), "{page:.3000}");
    assert!(page.contains("not finite") && page.len() < 200_000);
    let empty = Maker::new(json!({})).finish();
    assert!(text(empty.path(), Format::Html).contains("0 of 0 steps done"));
    let mut one = Maker::new(json!({}));
    one.step(json!({}), 0, Some(json!({ "err": 1.0, "faces": 3 })));
    assert!(text(one.finish().path(), Format::Html).contains("1 of 1 step done"));
}

#[test]
fn what_is_no_store_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let read = |path: &Path| Report::read(path).err().unwrap().to_string();
    assert!(read(&folder.path().join("none")).contains("no results of a program here"));
    assert!(read(folder.path()).contains("no results of a program here"));
    fs::write(folder.path().join("x"), "").unwrap();
    assert!(read(folder.path()).contains("not a store of mve"));
    fs::write(folder.path().join("plan.json"), "{\"program\": \"p\"").unwrap();
    assert!(read(folder.path()).contains("not the plan of a program"));
    assert!(matches!(Report::read(folder.path()), Err(ReportError::Store(_))));
}
