//! What is called better than something else, and what is not.

use std::fs;

use mve_report::{Asked, Format, Report};
use serde_json::{Value as Json, json};

use super::{Maker, experiment, small, text};

#[test]
fn a_question_is_answered_from_pairs_of_equal_parameters() {
    let folder = experiment().finish();
    let report = Report::read(folder.path()).unwrap();
    let answers = report.answers_in_words();
    assert_eq!(answers[0].0, "Is Ssim lower than Mse?");
    let words = answers[0].1.join(" ").replace('\u{a0}', " ");
    // Ratios 1/2, 1/2, 1/2, 1: the geometric mean is 2^(-3/4) = 0.5946. Of the three that differ
    // all are lower, and 2 of 8 signs are as far from the middle: p = 0.25.
    let lead =
        "Too few pairs to tell: on average “Error” is 1.68 times lower with Ssim than with Mse";
    assert!(words.starts_with(lead), "{words}");
    assert!(words.contains("geometric mean of 4 pairs"), "{words}");
    let counts = "it is lower in 3 of 4, equal in 1; p = 0.25 by the signed-rank test";
    assert!(words.contains(counts), "{words}");
    assert!(words.contains("In 1 of 4 pairs faces is not the same, by up to 0.99 %."));
    // By model first: 1/2 and 1/sqrt 2, whose geometric mean is the same, 1 / 1.68; two of them
    // leave an interval that percents cannot say, so the whole answer is in times.
    assert!(
        words.contains("averaged first, since they are not independent: 1.68 times lower"),
        "{words}"
    );
}

#[test]
fn tables_mark_the_best_of_each_row() {
    let folder = experiment().finish();
    let latex = text(folder.path(), Format::Latex);
    let row = "Vase & 0.125 & 0.250 & 0.250 & \\textbf{0.500} & 0.250 \\\\";
    assert!(latex.contains(row), "{latex}");
    assert!(latex.contains(
        "model & Quadric & Mse (size 1) & Mse (size 2) & Ssim (size 1) & Ssim (size 2) \\\\"
    ));
    let caption =
        "\\caption{Error (lower is better). Columns: cost. The best of each row is bold.}";
    assert!(latex.contains(caption) && latex.contains("\\label{tab:compare-err}"), "{latex}");
    assert!(latex.contains("\\paragraph{Is Ssim lower than Mse?}\nToo few pairs"), "{latex}");
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
fn rounding_counts_as_zero_and_is_not_ranked() {
    let report = json!({
        "measures": [{ "column": "compare.err" }],
        "questions": [{ "text": "A or B?", "measure": "compare.err",
            "compare": { "cut.cost": ["A", "B"] } }]
    });
    let note = "or of the size of the model are rounding and count as 0.";
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
    assert!(!page.contains(note) && page.contains("<td class=\"best\">1.0000e-11</td>"), "{page}");
}

#[test]
fn rounding_is_nothing_where_all_is_rounding() {
    // Of a box whose flat sides lose nothing: each distance is rounding of its diagonal.
    let rounding = [1e-17, 1e-18, 0.0, 3e-17];
    let has_verdict = |maker: Maker| {
        let folder = maker.finish();
        let markdown = text(folder.path(), Format::Markdown);
        let answers = Report::read(folder.path()).unwrap().answers_in_words();
        let words = answers[0].1.join(" ");
        let equal = "“Error” is equal with B and with A in both pairs.";
        let has_best = markdown.contains("| **");
        assert_eq!(words.starts_with(equal), !has_best, "{markdown} {words}");
        has_best
    };
    assert!(!has_verdict(small(json!({}), rounding)));
    // A length is small against the diagonal, here of 3 mm and of 3 nm.
    let in_model_units = |diagonal: f64| {
        let mut maker = Maker::new(json!({
            "axes": [{ "model.module": ["Box", "Vase"] }, { "cut.cost": ["A", "B"] }]
        }));
        maker.plan["columns"]["compare.err"] = json!([{ "title": "Error", "better": "lower",
            "role": "chief", "unit": "model units", "is_of_model": true }]);
        maker.plan["columns"]["compare.diagonal"] =
            json!([{ "unit": "model units", "is_of_model": true }]);
        for (place, error) in rounding.into_iter().enumerate() {
            let (model, cost) = (["Box", "Vase"][place / 2], ["A", "B"][place % 2]);
            let outputs = json!({ "err": error, "faces": 100, "diagonal": diagonal });
            let params = json!({ "model.module": model, "cut.cost": cost });
            maker.step(params, 0, Some(outputs));
        }
        maker
    };
    assert!(!has_verdict(in_model_units(3e-3)));
    assert!(has_verdict(in_model_units(3e-9)));
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
    assert!(markdown.contains("| model | A | B |"), "{markdown}");
    assert!(markdown.contains("| Vase | **1** | 2 |"), "{markdown}");
}

/// A step of a model and an angle whose target was missed or not.
fn turned(maker: &mut Maker, model: &str, angle: Json, faces: u32, error: f64) {
    let params = json!({ "model.module": model, "cut.angle": angle });
    let id = maker.step(params, 0, Some(json!({ "err": error, "faces": faces })));
    if faces != 600 {
        let path = maker.folder.path().join("steps").join(&id).join("record.json");
        let mut record: Json = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
        let missed = json!([{ "what": "faces", "asked": 600.0, "reached": faces }]);
        record["nodes"]["cut"]["missed"] = missed;
        record["nodes"]["cut"]["log"] =
            json!([{ "is_warning": true, "text": format!("stopped at {faces} faces") }]);
        maker.put(&id, &record);
    }
}

#[test]
fn a_step_that_missed_its_target_is_marked_and_never_the_best() {
    let axes = json!([{ "model.module": ["Box", "Vase"] }, { "cut.angle": [10, 45, null] }]);
    let mut maker = Maker::new(json!({ "axes": axes }));
    for model in ["Box", "Vase"] {
        turned(&mut maker, model, json!(10), 2734, 0.1);
        turned(&mut maker, model, json!(45), 600, 0.4);
        turned(&mut maker, model, json!(null), 600, 0.8);
    }
    let folder = maker.finish();
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("\n2 of 6 steps did not reach their target.\n"), "{markdown}");
    assert!(markdown.contains("| model | 10 | 45 | off |"), "{markdown}");
    assert!(markdown.contains("| Box | 0.1† | **0.4** | 0.8 |"), "{markdown}");
    assert!(!markdown.contains("as in the map") && !markdown.contains("Geometric mean"));
    let page = text(folder.path(), Format::Html);
    assert!(page.contains("2 of 6 steps did not reach their target."));
    assert!(page.contains("<td title=\"cut: 2734 of 600 faces\">0.1†</td>"), "{page}");
    assert!(page.contains("† cut: 2734 of 600 faces"));
    let latex = text(folder.path(), Format::Latex);
    let row = "Box & 0.100\\rlap{$^\\dagger$} & \\textbf{0.400} & 0.800 \\\\";
    assert!(latex.contains(row), "{latex}");
    let csv = text(folder.path(), Format::Csv);
    let row = csv.lines().find(|line| line.starts_with("Box,10,")).unwrap();
    assert!(row.ends_with(",cut: 2734 of 600 faces,1,done"), "{csv}");
    assert!(csv.contains("\nBox,off,0.8,"), "{csv}");
    // 0.8 is twice 0.4 in both models; the pairs with 10 degrees are left out.
    let answers = Report::read(folder.path()).unwrap().answers_in_words();
    let words = answers.iter().map(|(question, answer)| (question.as_str(), answer.join(" ")));
    let words: Vec<_> = words.collect();
    assert_eq!(words[0].0, "Is “Error” lower with angle 10 than with angle 45?");
    assert!(words[0].1.ends_with("2 pairs are left out, as a step did not reach its target."));
}

#[test]
fn results_of_different_sizes_are_not_ranked() {
    let mut maker = small(json!({}), [1.0, 2.0, 1.0, 2.0]);
    let params = json!({ "model.module": "Tube", "cut.cost": "A" });
    maker.step(params, 0, Some(json!({ "err": 1.0, "faces": 102 })));
    let params = json!({ "model.module": "Tube", "cut.cost": "B" });
    maker.step(params, 0, Some(json!({ "err": 2.0, "faces": 100 })));
    let folder = maker.finish();
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("| Box | **1** | 2 |"), "{markdown}");
    assert!(markdown.contains("| Tube‡ | 1 | 2 |"), "{markdown}");
    assert!(markdown.contains("| Best in, of 2 comparable rows | 2 | 0 |"), "{markdown}");
    assert!(markdown.contains("| Geometric mean of 2 comparable rows | **1** | 2 |"));
    assert!(markdown.contains("1 pair is left out, as the results differ in size by more than 1"));
}

#[test]
fn what_has_no_declared_direction_has_no_best() {
    let mut maker =
        small(json!({ "measures": [{ "column": "compare.err" }] }), [1.0, 2.0, 3.0, 1.0]);
    maker.plan["columns"]["compare.err"] = json!([{ "title": "Tries" }]);
    let folder = maker.finish();
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("## Tries\n") && markdown.contains("| Box | 1 | 2 |"), "{markdown}");
    assert!(!markdown.contains("**") && !markdown.contains("better"), "{markdown}");
    let page = text(folder.path(), Format::Html);
    assert!(!page.contains("class=\"best\"") && !page.contains("Pareto front</span>"));
    let higher = json!({ "measures": [{ "column": "compare.err", "better": "higher" }] });
    let asked = Asked { report: Some(higher), ..Asked::default() };
    let markdown = Report::read_for(folder.path(), &asked).unwrap().text(Format::Markdown, None);
    assert!(markdown.contains("| Box | 1 | **2** |"), "{markdown}");
}

#[test]
fn a_column_of_two_metrics_is_two_measures() {
    let axes = json!([{ "model.module": ["Box", "Vase"] }, { "compare.metric": ["Far", "Near"] }]);
    let mut maker = Maker::new(json!({ "axes": axes }));
    maker.plan["columns"]["compare.err"] = json!([
        { "title": "Distance", "better": "lower", "role": "chief",
            "only_with": ["compare.metric", "Far"] },
        { "title": "Likeness", "better": "higher", "role": "chief",
            "only_with": ["compare.metric", "Near"] }
    ]);
    for (place, model) in ["Box", "Vase"].into_iter().enumerate() {
        for (metric, error) in [("Far", 1e-4), ("Near", 2.86)] {
            let params = json!({ "model.module": model, "compare.metric": metric });
            maker.step(params, 0, Some(json!({ "err": error + place as f64, "faces": 100 })));
        }
    }
    let markdown = text(maker.finish().path(), Format::Markdown);
    assert!(markdown.contains("## Distance (lower is better)\n\n| model | Far |"), "{markdown}");
    assert!(markdown.contains("## Likeness (higher is better)\n\n| model | Near |"), "{markdown}");
    assert!(!markdown.contains("**1e-4**") && !markdown.contains("**2.86**"), "{markdown}");
}

#[test]
fn few_models_are_the_reason_and_stand_first() {
    // By model the first is 1/2, 1/4 and 1/64 of the second: the mean is 2^-3, an eighth.
    let axes = json!([{ "model.module": ["Box", "Vase", "Tube"] }, { "cut.ratio": [1, 2, 3] },
        { "cut.cost": ["A", "B"] }]);
    let mut maker = Maker::new(json!({ "axes": axes }));
    for (model, part) in [("Box", 2.0), ("Vase", 4.0), ("Tube", 64.0)] {
        for ratio in 1..=3 {
            for (cost, error) in [("A", 1.0), ("B", 1.0 / part)] {
                let params = json!({ "model.module": model, "cut.ratio": ratio, "cut.cost": cost });
                let outputs = json!({ "err": error, "faces": 100 });
                maker.step(params, 0, Some(outputs));
            }
        }
    }
    let answers = Report::read(maker.finish().path()).unwrap().answers_in_words();
    let words = answers[0].1.join(" ").replace('\u{a0}', " ");
    // Of the logarithms 1, 2 and 6 to the base 2 the standard error is sqrt(7/3); Student's t of
    // two degrees of freedom is 4.3027: 2^(3 ± 6.572) is 0.084 and 761. Of all nine, with
    // sqrt(42 / 72) and 2.3060: 2^(3 ± 1.761), 2.36 and 27.1.
    let lead = "Three models are too few to tell: with the pairs of each model averaged first, since \
                they are not independent, “Error” is 8 times lower with B than with A (geometric \
                mean of 3, 95 % confidence interval 760 times lower to 12 times higher). Over all \
                9 pairs it is 8 times lower (95 % confidence interval 2.4 to 27 times lower), and \
                lower in 9 of 9; p = 0.0039 by the signed-rank test.";
    assert!(words.starts_with(lead), "{words}");
    assert!(!words.contains("do not show") && !words.contains("better one"), "{words}");
}

/// A store of one model by six ratios and some values of another parameter.
fn by_ratio(path: &str, values: &Json, report: &Json, error: impl Fn(f64, usize) -> f64) -> Maker {
    let ratios = [0.5, 0.4, 0.3, 0.2, 0.15, 0.1];
    let axes = json!([{ "cut.ratio": ratios }, { path: values }]);
    let mut maker = Maker::new(json!({ "axes": axes, "report": report }));
    for ratio in ratios {
        for (place, value) in values.as_array().unwrap().iter().enumerate() {
            let outputs = json!({ "err": error(ratio, place), "faces": (1000.0 * ratio) as u32 });
            maker.step(json!({ "cut.ratio": ratio, path: value }), 0, Some(outputs));
        }
    }
    maker
}

#[test]
fn a_bare_entry_beside_its_settings_is_paired_with_itself_alone() {
    let costs = json!([{ "Quadric": { "weight": 0 } }, "Quadric", { "Quadric": { "weight": 9 } }]);
    for asked in [json!({}), json!({ "measures": [{ "column": "compare.err" }] })] {
        // Half, and a quarter, of the first in each of six pairs: 2 of 64 signs are as one-sided.
        let maker =
            by_ratio("cut.cost", &costs, &asked, |ratio, place| ratio / f64::from(1 << place));
        let answers = Report::read(maker.finish().path()).unwrap().answers_in_words();
        let words = |n: usize| answers[n].1.join(" ").replace('\u{a0}', " ");
        assert_eq!(answers.len(), 2);
        assert!(words(0).contains("is 50 % lower with Quadric than with "), "{}", words(0));
        assert!(words(1).contains("is 75 % lower with "), "{}", words(1));
        for n in 0..2 {
            let counts = "it is lower in 6 of 6; p = 0.031 by";
            assert!(words(n).contains(counts) && !words(n).contains("partner"), "{}", words(n));
            assert!(words(n).contains("geometric mean of 6 pairs"), "{}", words(n));
        }
    }
}

#[test]
fn several_settings_may_have_one_partner_and_none_is_alone() {
    let costs = json!(["Plain", { "Mse": { "size": 1 } }, { "Mse": { "size": 2 } }]);
    let asked = json!({ "questions": [{ "text": "?", "measure": "compare.err",
        "compare": { "cut.cost": ["Mse", "Plain"] } }] });
    let maker = by_ratio("cut.cost", &costs, &asked, |ratio, place| ratio + place as f64);
    let answers = Report::read(maker.finish().path()).unwrap().answers_in_words();
    let words = answers[0].1.join(" ");
    assert!(words.contains("geometric mean of 12 pairs") && !words.contains("partner"), "{words}");
}

#[test]
fn ways_to_measure_are_not_ranked() {
    let metrics = json!(["Far", { "Far": { "samples": 9 } }]);
    let store = |report: Json| {
        let mut maker =
            by_ratio("compare.metric", &metrics, &report, |r, place| r / (1.0 + place as f64));
        maker.plan["map"]["links"] =
            json!(["model.mesh -> compare.original", "cut.mesh -> compare.simplified"]);
        maker.finish()
    };
    let folder = store(json!({}));
    assert!(Report::read(folder.path()).unwrap().answers_in_words().is_empty());
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("| 0.5 | 0.25 |") && !markdown.contains("**"), "{markdown}");
    assert!(markdown.contains("Columns that are measured in different ways are not compared."));
    let page = text(folder.path(), Format::Html);
    assert!(!page.contains("class=\"best\"") && !page.contains("Pareto front</span>"), "{page}");
    // Who asks gets the numbers, and no winner.
    let asked = json!({ "questions": [{ "text": "?", "measure": "compare.err",
        "compare": { "compare.metric": [metrics[1], "Far"] } }] });
    let answers = Report::read(store(asked).path()).unwrap().answers_in_words();
    let words = answers[0].1.join(" ").replace('\u{a0}', " ");
    assert!(words.contains("is 50 % lower with") && !words.contains("By this measure"), "{words}");
    assert!(words.contains("ways to measure it, so none of them is the better one"), "{words}");
}

#[test]
fn a_row_of_one_number_has_no_best_and_is_not_counted() {
    let mut maker = Maker::new(json!({
        "axes": [{ "model.module": ["Box", "Vase", "Ball"] }, { "cut.cost": ["A", "B"] }]
    }));
    for (model, cost) in [("Box", "A"), ("Box", "B"), ("Vase", "A"), ("Vase", "B"), ("Ball", "A")] {
        let error = if cost == "A" { 1.0 } else { 2.0 };
        let params = json!({ "model.module": model, "cut.cost": cost });
        maker.step(params, 0, Some(json!({ "err": error, "faces": 100 })));
    }
    maker.step(json!({ "model.module": "Ball", "cut.cost": "B" }), 0, None);
    let markdown = text(maker.finish().path(), Format::Markdown);
    assert!(markdown.contains("| Best in, of 2 comparable rows | 2 | 0 |"), "{markdown}");
    assert!(markdown.contains("| Geometric mean of 2 comparable rows | **1** | 2 |"), "{markdown}");
}

#[test]
fn what_is_compared_is_no_group_to_average() {
    let report = json!({ "group": "cut.cost", "series": "cut.n", "questions": [{ "text": "?",
        "measure": "compare.err", "compare": { "cut.cost": ["A", "B"] } }] });
    let axes = json!([{ "cut.cost": ["A", "B"] }, { "cut.n": [1, 2, 3, 4, 5, 6] }]);
    let mut maker = Maker::new(json!({ "axes": axes, "report": report }));
    for (place, cost) in ["A", "B"].into_iter().enumerate() {
        for n in 1..=6 {
            let outputs = json!({ "err": n as f64 / (1.0 + place as f64), "faces": 100 });
            maker.step(json!({ "cut.cost": cost, "cut.n": n }), 0, Some(outputs));
        }
    }
    let answers = Report::read(maker.finish().path()).unwrap().answers_in_words();
    let words = answers[0].1.join(" ");
    assert!(words.contains("geometric mean of 6 pairs") && !words.contains("averaged"), "{words}");
}

/// A node that takes two meshes, fits one to the other and passes it on does not measure.
#[test]
fn what_changes_its_input_is_no_instrument() {
    let is_ranked = |columns: Json, links: &[&str]| {
        let report = json!({ "measures": [{ "column": "compare.err", "better": "lower" }],
            "series": "compare.steps" });
        let mut maker = by_ratio("compare.steps", &json!([1, 2]), &report, |r, n| r + n as f64);
        maker.plan["columns"] = columns;
        let mut all = vec!["model.mesh -> compare.original", "cut.mesh -> compare.mesh"];
        all.extend(links);
        maker.plan["map"]["links"] = json!(all);
        text(maker.finish().path(), Format::Markdown).contains("**")
    };
    let undeclared = || json!({ "compare.err": [{}], "cut.faces": [{ "role": "size" }] });
    assert!(!is_ranked(undeclared(), &[]));
    assert!(is_ranked(undeclared(), &["compare.mesh -> save.mesh"]));
    assert!(is_ranked(json!({ "compare.err": [{ "better": "lower" }] }), &[]));
    let chief = json!({ "compare.err": [{ "better": "lower", "role": "chief" }] });
    assert!(!is_ranked(chief, &["compare.field -> save.field"]));
}

#[test]
fn costs_are_ranked_among_those_measured_alike() {
    let axes = json!([{ "model.module": ["Box", "Vase"] }, { "cut.cost": ["A", "B"] },
        { "compare.metric": ["Near", "Far"] }]);
    let report = json!({ "series": ["cut.cost", "compare.metric"] });
    let mut maker = Maker::new(json!({ "axes": axes, "report": report }));
    for (model, cost, metric, error) in [
        ("Box", "A", "Near", 4.0),
        ("Box", "A", "Far", 1.0),
        ("Box", "B", "Near", 3.0),
        ("Box", "B", "Far", 2.0),
        ("Vase", "A", "Near", 4.0),
        ("Vase", "A", "Far", 1.0),
        ("Vase", "B", "Near", 5.0),
        ("Vase", "B", "Far", 2.0),
    ] {
        let params = json!({ "model.module": model, "cut.cost": cost, "compare.metric": metric });
        maker.step(params, 0, Some(json!({ "err": error, "faces": 100 })));
    }
    let folder = maker.finish();
    let markdown = text(folder.path(), Format::Markdown);
    assert!(markdown.contains("| Box | 4 | **1** | **3** | 2 |"), "{markdown}");
    assert!(markdown.contains("| Vase | **4** | **1** | 5 | 2 |"), "{markdown}");
    let answers = Report::read(folder.path()).unwrap().answers_in_words();
    assert_eq!(answers.len(), 1);
    assert_eq!(answers[0].0, "Is “Error” lower with B than with A?");
}

/// Compiles tables inside of an article; `None`, after a line that says so, where there is no
/// pdflatex or it lacks a package.
fn compiled(tables: &str) -> Option<String> {
    use std::process::{Command, Stdio};
    let folder = tempfile::tempdir().unwrap();
    let has_packages = ["booktabs.sty", "multirow.sty"].iter().all(|package| {
        let found = Command::new("kpsewhich").arg(package).stdout(Stdio::null()).status();
        found.is_ok_and(|status| status.success())
    });
    if !has_packages {
        eprintln!("skipped: there is no pdflatex with booktabs and multirow");
        return None;
    }
    let text = format!(
        "\\documentclass{{article}}\n\\usepackage{{booktabs,multirow}}\n\\begin{{document}}\n{tables}\n\
         \\end{{document}}\n"
    );
    std::fs::write(folder.path().join("t.tex"), text).unwrap();
    let mut command = Command::new("pdflatex");
    command.args(["-interaction=nonstopmode", "-halt-on-error", "t.tex"]);
    let output = command.current_dir(folder.path()).stdin(Stdio::null()).output();
    let Ok(output) = output else {
        eprintln!("skipped: there is no pdflatex");
        return None;
    };
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && folder.path().join("t.pdf").is_file(), "{said}");
    Some(said)
}

#[test]
fn latex_compiles() {
    let odd = "a_b & 50 % of {x} $y$ #1 ~z ^2 \\w <\u{3c3}> \u{2264} \u{201c}q\u{201d} \u{2026} \u{b0}\u{fc}";
    let axes = json!([{ "model.module": ["Box", odd] }, { "model.size": [1, 2] },
        { "cut.cost": ["Quadric", { "Mse": { "size": 1 } }] }]);
    let questions = json!([{ "text": format!("Is {odd} lower?"), "measure": "compare.err",
        "compare": { "cut.cost": ["Quadric", "Mse"] } }]);
    let measures = json!([{ "column": "compare.err", "title": odd }]);
    let report = json!({ "measures": measures, "questions": questions });
    let mut maker = Maker::new(json!({ "axes": axes, "repeats": 2, "report": report }));
    for model in ["Box", odd] {
        for size in [1, 2] {
            for (cost, error) in
                [(json!("Quadric"), 1.5e-7), (json!({ "Mse": { "size": 1 } }), 0.3)]
            {
                for repeat in 0..2 {
                    let params =
                        json!({ "model.module": model, "model.size": size, "cut.cost": cost });
                    let error = error * f64::from(size + repeat);
                    let outputs = json!({ "err": error, "faces": 100 });
                    maker.step(params, repeat as u32, Some(outputs));
                }
            }
        }
    }
    let folder = maker.finish();
    let latex = text(folder.path(), Format::Latex);
    assert!(
        latex.contains("\\multirow{2}{*}{Box}") && latex.contains("\\addlinespace\n"),
        "{latex}"
    );
    if let Some(said) = compiled(&latex) {
        assert!(said.contains("Output written on t.pdf (1 page"), "{said}");
        // A table that is no table would fail, so the compiler does look.
        let broken = latex.replacen("\\\\\n\\midrule", "& & & & & & \\\\\n\\midrule", 1);
        assert!(std::panic::catch_unwind(|| compiled(&broken)).is_err());
    }
}
