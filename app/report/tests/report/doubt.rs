//! What is left open: chance, single pairs, inputs, equal results.

use mve_report::{Format, Report};
use serde_json::{Value as Json, json};

use super::{Maker, small, text};

/// The answers to the questions of a store, in one text each.
fn answers(maker: Maker) -> Vec<(String, String)> {
    let answers = Report::read(maker.finish().path()).unwrap().answers_in_words();
    let joined = |(question, words): (String, Vec<String>)| (question, words.join(" "));
    answers.into_iter().map(joined).map(|(q, words)| (q, words.replace('\u{a0}', " "))).collect()
}

/// Two ratios by two costs, three repeats each, with these errors.
fn repeated(errors: [[f64; 3]; 4]) -> Maker {
    let axes = json!([{ "model.module": ["Box", "Vase"] }, { "cut.cost": ["A", "B"] }]);
    let mut maker = Maker::new(json!({ "axes": axes, "repeats": 3 }));
    for (place, errors) in errors.into_iter().enumerate() {
        let (model, cost) = (["Box", "Vase"][place / 2], ["A", "B"][place % 2]);
        for (repeat, error) in errors.into_iter().enumerate() {
            let outputs = json!({ "err": error, "faces": 100 });
            let params = json!({ "model.module": model, "cut.cost": cost });
            maker.step(params, repeat as u32, Some(outputs));
        }
    }
    maker
}

#[test]
fn noise_is_not_the_best() {
    // Student's t of two degrees of freedom is 4.3027: 3 ± 2.48 and 2.9 ± 2.48 overlap, 1 ± 0.25
    // and 9 ± 0.25 do not.
    let errors = [[2.0, 3.0, 4.0], [1.9, 2.9, 3.9], [0.9, 1.0, 1.1], [8.9, 9.0, 9.1]];
    let folder = repeated(errors).finish();
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("| Box | 3 ± 2.5 | 2.9 ± 2.5 |"), "{markdown}");
    assert!(markdown.contains("| Vase | **1 ± 0.25** | 9 ± 0.25 |"), "{markdown}");
    assert!(markdown.contains("| Best in, of 2 | 1 | 0 |"), "{markdown}");
    let note = "the 95 % confidence interval of the best one overlaps that of another";
    assert!(markdown.contains(note), "{markdown}");
    for format in [Format::Html, Format::Latex] {
        let page = text(folder.path(), format);
        assert!(page.contains("confidence interval of the best one overlaps"), "{page}");
    }
    // Where all is noise its mean is noise, and nothing is counted.
    let errors = [[2.0, 3.0, 4.0], [1.9, 2.9, 3.9], [2.0, 3.0, 4.0], [1.9, 2.9, 3.9]];
    let markdown = text(repeated(errors).finish().path(), Format::Markdown);
    assert!(!markdown.contains("| **") && !markdown.contains("Best in"), "{markdown}");
}

#[test]
fn the_chief_measure_of_each_metric_is_shown() {
    let axes = json!([{ "cut.ratio": [1, 2] }, { "compare.metric": ["Far", "Picture"] }]);
    let mut maker = Maker::new(json!({ "axes": axes }));
    let only = |title: &str, role: &str, metric: &str| {
        json!({ "title": title, "better": "lower", "role": role,
            "only_with": ["compare.metric", metric] })
    };
    maker.plan["columns"]["compare.rms"] =
        json!([only("RMS", "detail", "Far"), only("RMS of pictures", "chief", "Picture")]);
    for ratio in [1, 2] {
        for (metric, outputs) in [
            ("Far", json!({ "err": 1.0 * f64::from(ratio), "rms": 3.5, "faces": 100 })),
            ("Picture", json!({ "rms": 7.25 * f64::from(ratio), "faces": 100 })),
        ] {
            let params = json!({ "cut.ratio": ratio, "compare.metric": metric });
            maker.step(params, 0, Some(outputs));
        }
    }
    let markdown = text(maker.finish().path(), Format::Markdown);
    assert!(markdown.contains("## RMS of pictures (lower is better)"), "{markdown}");
    assert!(markdown.contains("| 7.25 |") && markdown.contains("| 14.5 |"), "{markdown}");
    assert!(!markdown.contains("## RMS ("), "{markdown}");
}

/// A store of two models by some values of a parameter; of the first value no step reaches its
/// target.
fn turned(values: &Json, defaults: Json) -> Maker {
    let axes = json!([{ "model.module": ["Box", "Vase"] }, { "cut.angle": values }]);
    let mut maker = Maker::new(json!({ "axes": axes }));
    maker.plan["defaults"] = defaults;
    for model in ["Box", "Vase"] {
        for (place, value) in values.as_array().unwrap().iter().enumerate() {
            let params = json!({ "model.module": model, "cut.angle": value });
            let outputs = json!({ "err": 1.0 + place as f64, "faces": 100 });
            let id = maker.step(params, 0, Some(outputs));
            if place == 0 {
                let path = maker.folder.path().join("steps").join(&id).join("record.json");
                let record = std::fs::read_to_string(path).unwrap();
                let mut record: Json = serde_json::from_str(&record).unwrap();
                record["nodes"]["cut"]["missed"] =
                    json!([{ "what": "faces", "asked": 60.0, "reached": 100 }]);
                maker.put(&id, &record);
            }
        }
    }
    maker
}

#[test]
fn the_reference_is_the_default_or_else_what_reached_its_target() {
    let angles = json!([3, 30, 90, null]);
    let asked = |maker: Maker| answers(maker).into_iter().map(|(q, _)| q).collect::<Vec<_>>();
    let first = asked(turned(&angles, json!({})));
    assert_eq!(first[0], "Is “Error” lower with angle 3 than with angle 30?");
    assert_eq!(first[1], "Is “Error” lower with angle 90 than with angle 30?");
    let default = asked(turned(&angles, json!({ "cut.angle": 90 })));
    assert_eq!(default.len(), 3);
    assert!(default.iter().all(|text| text.ends_with("than with angle 90?")), "{default:?}");
    let off = asked(turned(&angles, json!({ "cut.angle": null })));
    assert!(off.iter().all(|text| text.ends_with("than with angle off?")), "{off:?}");
    // A default with which no step can be compared says nothing.
    let missed = asked(turned(&angles, json!({ "cut.angle": 3 })));
    assert!(missed.iter().all(|text| text.ends_with("than with angle 30?")), "{missed:?}");
}

#[test]
fn no_model_is_asked_to_be_better_than_another() {
    let links = json!(["model.mesh -> cut.mesh", "cut.mesh -> compare.simplified"]);
    let models = |inputs: Json, path: &str, values: Json| {
        let mut maker =
            Maker::new(json!({ "axes": [{ "cut.ratio": [1, 2] }, { path: values.clone() }] }));
        maker.plan["map"]["links"] = links.clone();
        maker.plan["inputs"] = inputs;
        for ratio in [1, 2] {
            for value in values.as_array().unwrap() {
                let outputs = json!({ "err": 1.0 + ratio as f64, "faces": 100 * ratio });
                maker.step(json!({ "cut.ratio": ratio, path: value }), 0, Some(outputs));
            }
        }
        answers(maker)
    };
    let hash = "0".repeat(64);
    let files = json!({ "/m/cow.obj": hash, "/m/spot.obj": hash });
    let paths = json!(["cow.obj", "spot.obj"]);
    assert!(models(json!({}), "model.path", paths.clone()).is_empty());
    assert!(models(json!({}), "model.module", json!(["Box", "Vase"])).is_empty());
    // A file that another node reads is an input as well.
    assert!(models(files, "cut.pattern", paths).is_empty());
    assert_eq!(models(json!({}), "cut.cost", json!(["A", "B"])).len(), 1);
}

#[test]
fn equal_pairs_and_single_pairs_are_told_without_a_test() {
    let equal = answers(small(json!({}), [1.0, 1.00001, 3.0, 3.0]));
    assert_eq!(
        equal[0].1,
        "“Error” differs by less than 0.005 % with B and with A in both pairs. Both steps of every \
         pair have the same faces."
    );
    let same = answers(small(json!({}), [1.0, 1.0, 3.0, 3.0]));
    assert!(same[0].1.starts_with("“Error” is equal with B and with A in both pairs."));
    let mut maker = Maker::new(json!({ "axes": [{ "cut.cost": ["A", "B"] }] }));
    for (cost, error) in [("A", 1.0), ("B", 1.25)] {
        maker.step(json!({ "cut.cost": cost }), 0, Some(json!({ "err": error, "faces": 100 })));
    }
    let one = answers(maker);
    assert!(
        one[0].1.starts_with(
            "“Error” is 25 % higher with B than with A in the only pair; one pair does not tell \
             whether others would be alike."
        ),
        "{one:?}"
    );
    for (_, words) in equal.iter().chain(&same).chain(&one) {
        assert!(!words.contains("p =") && !words.contains("no different"), "{words}");
    }
}

/// Some models that are only counted.
fn counted(all: &[(&str, u32, f64)]) -> String {
    let names: Vec<&str> = all.iter().map(|(name, ..)| *name).collect();
    let mut maker = Maker::new(json!({ "axes": [{ "model.path": names }] }));
    maker.plan["map"]["links"] = json!(["model.mesh -> cut.mesh", "model.mesh -> compare.mesh"]);
    maker.plan["columns"] = json!({ "cut.faces": [{ "role": "size" }] });
    for (name, faces, area) in all {
        let outputs = json!({ "faces": faces, "area": area, "loops": 0 });
        maker.step(json!({ "model.path": name }), 0, Some(outputs));
    }
    text(maker.finish().path(), Format::Markdown)
}

#[test]
fn a_folder_of_models_is_one_table_with_a_row_for_each() {
    let markdown = counted(&[("m/cow.obj", 5804, 108.5), ("m/spot.obj", 5856, 5.75)]);
    assert_eq!(markdown.matches("\n## ").count(), 1, "{markdown}");
    assert!(markdown.contains("| model | faces | area |"), "{markdown}");
    assert!(markdown.contains("| cow.obj | 5804 | 108.5 |"), "{markdown}");
    assert!(markdown.contains("| spot.obj | 5856 | 5.75 |"), "{markdown}");
    assert!(!markdown.contains("gave the same"), "{markdown}");
}

#[test]
fn equal_models_are_said_to_be_equal() {
    let markdown = counted(&[("a.obj", 12, 6.0), ("b.obj", 12, 6.0), ("c.obj", 12, 6.0)]);
    let note = "All 3 cases gave the same: no measure differs between them.";
    assert!(markdown.contains(note), "{markdown}");
    assert!(markdown.contains("| b.obj | 12 |") && markdown.contains("| 6 |"), "{markdown}");
}

#[test]
fn what_sets_the_size_is_plotted_along_and_parts_no_panels() {
    for axes in [
        json!([{ "compare.samples": [100, 1000] }, { "cut.ratio": [0.5, 0.2, 0.1] }]),
        json!([{ "cut.ratio": [0.5, 0.2, 0.1] }, { "compare.samples": [100, 1000] }]),
    ] {
        let mut maker = Maker::new(json!({ "axes": axes }));
        for ratio in [0.5, 0.2, 0.1] {
            for samples in [100, 1000] {
                let error = 1.0 / ratio + 1.0 / f64::from(samples);
                let outputs = json!({ "err": error, "faces": (1000.0 * ratio) as u32 });
                let params = json!({ "compare.samples": samples, "cut.ratio": ratio });
                maker.step(params, 0, Some(outputs));
            }
        }
        let folder = maker.finish();
        let markdown = text(folder.path(), Format::Markdown);
        assert!(markdown.contains("| ratio | 100 | 1000 |"), "{markdown}");
        let plots = Report::read(folder.path()).unwrap().plots();
        let plot = plots.iter().find(|plot| plot.name() == "compare.err-by-cut.faces").unwrap();
        let svg = String::from_utf8(plot.svg().unwrap()).unwrap();
        // A panel with a line for each number of samples.
        assert_eq!(svg.matches("stroke-width=\"1.2\"").count(), 2, "{svg}");
    }
}
