//! Pages, tables and plots, and that nothing in a store breaks them.

use std::fs;
use std::path::Path;

use mve_report::{Asked, Format, Report, ReportError};
use serde_json::{Value as Json, json};

use super::{Maker, experiment, png, small, text};

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
    assert!(page.contains("alt=\"Box · Ssim (size 2) · result\""));
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

#[test]
fn a_column_has_numbers_of_one_form() {
    let report = json!({ "measures": [{ "column": "compare.err" }] });
    let folder = small(report.clone(), [1.6679e-4, 0.0014279, 0.5, 0.25]).finish();
    let page = text(folder.path(), Format::Html);
    assert!(page.contains("<td class=\"best\">1.6679e-4</td><td>1.4279e-3</td>"), "{page}");
    assert!(page.contains("<td>5.0000e-1</td><td class=\"best\">2.5000e-1</td>"), "{page}");
    assert!(page.contains("<td data-v=\"0.0014279\">1.4279e-3</td>"), "{page}");
    // How often each is the best is a count as it was.
    assert!(page.contains("Best in, of 2</th><td>1</td><td>1</td>"), "{page}");
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("| Box | **1.6679e-4** | 1.4279e-3 |"), "{markdown}");
    let folder = small(report, [0.0016679, 0.0014279, 0.5, 0.25]).finish();
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("| Box | 0.0016679 | **0.0014279** |"), "{markdown}");
}

#[test]
fn textures_beside_a_mesh_are_no_pictures() {
    let mut maker = small(json!({}), [1.0; 4]);
    let folder = maker.folder.path().join("steps").join(format!("{:016x}", 1));
    let record = fs::read_to_string(folder.join("record.json")).unwrap();
    let mut record: Json = serde_json::from_str(&record).unwrap();
    let files =
        [("save", json!(["a.obj", "a.mtl", "a-textures/t.png"])), ("draw", json!(["d/p.png"]))];
    for (node, files) in files {
        record["nodes"][node] = json!({ "module": "S", "status": "done", "key": "0".repeat(64),
            "files": files });
    }
    maker.put(&format!("{:016x}", 1), &record);
    for file in ["a.obj", "a.mtl", "a-textures/t.png", "d/p.png"] {
        let path = folder.join("outputs").join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, png()).unwrap();
    }
    maker.plan["nodes"] = json!(["cut", "save", "draw"]);
    let page = text(maker.finish().path(), Format::Html);
    assert_eq!(page.matches("data:image/png;base64,").count(), 1);
    assert!(page.contains("· draw\"") && !page.contains("t.png"), "{page}");
}

#[test]
fn columns_of_one_title_are_told_apart() {
    let report = json!({ "measures": [{ "column": "compare.err" }] });
    let mut maker = small(report, [1.0, 2.0, 3.0, 4.0]);
    maker.plan["columns"]["compare.faces"] = json!([{ "title": "faces", "role": "chief" }]);
    let page = text(maker.finish().path(), Format::Html);
    assert!(page.contains(">faces, cut.faces</th>") && page.contains(">faces, compare.faces</th>"));
}

#[test]
fn what_has_no_correlation_has_no_table() {
    let measures =
        json!({ "measures": [{ "column": "compare.err" }, { "column": "compare.faces" }] });
    let page_of = |n: u32| {
        let steps: Vec<u32> = (1..=n).collect();
        let mut maker = Maker::new(json!({ "axes": [{ "cut.seed": steps }], "report": measures }));
        for step in 1..=n {
            let outputs = json!({ "err": 1.0 / f64::from(step), "faces": 100 + step % 3 });
            maker.step(json!({ "cut.seed": step }), 0, Some(outputs));
        }
        text(maker.finish().path(), Format::Html)
    };
    // Two points are always on a line.
    let (few, enough) = (page_of(2), page_of(5));
    assert!(enough.contains("Spearman"));
    assert!(!few.contains("Spearman") && !few.contains("Pearson"));
}

#[test]
fn one_step_is_done() {
    let mut maker = Maker::new(json!({ "axes": [{ "cut.cost": ["A", "B"] }] }));
    maker.step(json!({ "cut.cost": "A" }), 0, Some(json!({ "err": 1.0, "faces": 100 })));
    maker.step(json!({ "cut.cost": "B" }), 0, None);
    let markdown = text(maker.finish().path(), Format::Markdown);
    assert!(markdown.contains("1 of 2 steps is done, 1 to do"), "{markdown}");
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
fn no_cell_of_a_table_is_a_formula() {
    let mut maker = small(json!({ "measures": [{ "column": "compare.err" }] }), [1.0; 4]);
    let outputs = json!({ "err": -1.5, "faces": 100 });
    maker.step(json!({ "model.module": "=cmd|x", "cut.cost": "A" }), 0, Some(outputs));
    let csv = text(maker.finish().path(), Format::Csv);
    assert!(csv.contains("\n'=cmd|x,A,-1.5,"), "{csv}");
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
fn another_report_can_be_asked_of_a_store() {
    let folder = experiment().finish();
    let faults = |asked: Asked| Report::read_for(folder.path(), &asked).err().unwrap().to_string();
    let report = Some(json!({ "measures": [{ "column": "compare.er" }] }));
    let message = faults(Asked { report, ..Asked::default() });
    let expected = "\"report.measures[0].column\": \"compare.er\" is not a column";
    assert!(message.starts_with(expected), "{message}");
    assert!(message.ends_with("did you mean \"compare.err\"?"), "{message}");
    let rows = faults(Asked { rows: vec!["cut.costs".to_owned()], ..Asked::default() });
    assert!(rows.ends_with("not varied by the program; did you mean \"cut.cost\"?"), "{rows}");
    let asked = Asked {
        measures: vec!["compare.like".to_owned()],
        columns: vec!["model.module".to_owned()],
        ..Asked::default()
    };
    let markdown = Report::read_for(folder.path(), &asked).unwrap().text(Format::Markdown, None);
    assert!(markdown.contains("\n| cost | Box | Vase |\n"), "{markdown}");
    assert_eq!(markdown.matches("\n## ").count(), 1, "{markdown}");
}

#[test]
fn times_of_several_runs_are_tables_with_their_spread() {
    let mut maker =
        Maker::new(json!({ "axes": [{ "cut.cost": ["A", "B"] }, { "cut.n": [1, 2] }] }));
    for (cost, slow) in [("A", 1.0), ("B", 3.0)] {
        for n in [1, 2] {
            let params = json!({ "cut.cost": cost, "cut.n": n });
            let id = maker.step(params, 0, Some(json!({ "err": 1.0, "faces": 100 })));
            let path = maker.folder.path().join("steps").join(&id).join("record.json");
            let mut record: Json =
                serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
            record["timings"] = [0.21, 0.19, 0.2]
                .map(|seconds| {
                    json!({ "seconds": seconds * slow, "cpu_seconds": slow,
                    "peak_bytes": 1024, "parts": { "cut": seconds } })
                })
                .to_vec()
                .into();
            maker.put(&id, &record);
        }
    }
    let folder = maker.finish();
    let markdown = text(folder.path(), Format::Markdown);
    let table = |title: &str| {
        let start = markdown.find(title).unwrap_or_else(|| panic!("{title}: {markdown}"));
        markdown[start..].split("\n## ").next().unwrap().to_owned()
    };
    assert!(table("## time of a step, median").contains("| 1 | **0.2** | 0.6 |"), "{markdown}");
    assert!(table("## time of a step, minimum").contains("| 1 | **0.19** | 0.57 |"), "{markdown}");
    assert!(table("## time of the processors").contains("| 1 | **1** | 3 |"), "{markdown}");
    assert!(table("## peak memory").contains("| 1 | 1024 | 1024 |"), "{markdown}");
}

#[test]
fn plots_stand_alone() {
    plots_of(&json!({}));
    plots_of(&json!({ "against": ["cut.faces", "seconds.cut"] }));
}

/// Of a measure that a report names, and of a parameter that is varied.
#[test]
fn axes_of_plots_have_titles() {
    let mut maker = Maker::new(json!({
        "axes": [{ "cut.cost": ["A", "B"] }, { "cut.n_rings": [1, 2, 3] }],
        "report": {
            "measures": [{ "column": "compare.err" },
                { "column": "compare.like", "title": "Likeness" }],
            "against": ["compare.like", "cut.n_rings"]
        }
    }));
    for (series, cost) in ["A", "B"].into_iter().enumerate() {
        for n in [1, 2, 3] {
            let err = f64::from(n) + series as f64;
            let outputs = json!({ "err": err, "like": 1.0 / err, "faces": 100 });
            maker.step(json!({ "cut.cost": cost, "cut.n_rings": n }), 0, Some(outputs));
        }
    }
    let folder = maker.finish();
    let plots = Report::read(folder.path()).unwrap().plots();
    let names: Vec<String> = plots.iter().map(|plot| plot.name()).collect();
    let svg = |name: &str| {
        let plot = names.iter().position(|known| known == name).unwrap();
        String::from_utf8(plots[plot].svg().unwrap()).unwrap()
    };
    assert!(svg("compare.err-by-compare.like").contains(">Likeness<"), "{names:?}");
    assert!(svg("compare.err-by-cut.n_rings").contains(">n rings<"), "{names:?}");
}

fn plots_of(report: &Json) {
    let axes = json!([{ "cut.cost": ["A", "B"] }, { "cut.n": [1, 2, 3] }]);
    let mut maker = Maker::new(json!({ "axes": axes, "report": report }));
    for (series, cost) in ["A", "B"].into_iter().enumerate() {
        for n in [1, 2, 3] {
            let outputs = json!({ "err": f64::from(n) + series as f64, "faces": 1000 / n });
            maker.step(json!({ "cut.cost": cost, "cut.n": n }), 0, Some(outputs));
        }
    }
    let folder = maker.finish();
    let plots = Report::read(folder.path()).unwrap().plots();
    assert_eq!(plots[0].name(), "compare.err-by-cut.faces");
    let svg = String::from_utf8(plots[0].svg().unwrap()).unwrap();
    assert!(svg.starts_with("<svg") && !svg.contains("var(--"), "{svg:.2000}");
    assert!(svg.contains(">Pareto front<"), "the legend names the grey band: {svg:.2000}");
    assert!(svg.contains(">Error<") && svg.contains(">faces<") && svg.contains(">B<"));
    match plots[0].pdf() {
        Ok(pdf) => assert!(cfg!(feature = "pdf") && pdf.starts_with(b"%PDF-")),
        Err(why) => assert!(!cfg!(feature = "pdf") && why.contains("writes no PDF"), "{why}"),
    }
    assert_eq!(plots[1].name(), "compare.err-by-seconds.cut");
    // Times are no measure where steps shared the machine.
    for step in fs::read_dir(folder.path().join("steps")).unwrap() {
        let path = step.unwrap().path().join("record.json");
        let record = fs::read_to_string(&path).unwrap();
        fs::write(&path, record.replace("\"is_timed\":true", "\"is_timed\":false")).unwrap();
    }
    assert_eq!(Report::read(folder.path()).unwrap().plots().len(), 1);
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
