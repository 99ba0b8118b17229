//! Reports of stores that are made by hand: what they say, and that nothing in a store breaks them.

mod doubt;
mod pages;
mod ratings;
mod verdicts;

use std::fs;
use std::path::Path;

use mve_report::{Format, Report};
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
            "columns": {
                "compare.err": [{ "title": "Error", "better": "lower", "role": "chief" }],
                "compare.like": [{ "better": "higher" }],
                "compare.faces": [{}], "compare.none": [{}], "compare.big": [{}],
                "cut.faces": [{ "title": "faces", "role": "size" }]
            },
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
