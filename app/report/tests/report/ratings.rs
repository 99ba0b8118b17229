//! What people said of results, in the report.

use mve_report::rating::Ratings;
use mve_report::{Format, Report, ReportError};
use serde_json::json;

use super::small;

/// A file of marks of the first steps of a store.
fn file(rater: &str, marks: &[f64]) -> Ratings {
    let marks = marks.iter().enumerate();
    let marks: Vec<_> =
        marks.map(|(n, mark)| json!({ "step": format!("{:016x}", n + 1), "mark": mark })).collect();
    let json = json!({ "mve_ratings": 1, "program": "p", "rater": rater, "marks": marks });
    Ratings::parse(&format!("{rater}.json"), &json.to_string()).unwrap()
}

#[test]
fn marks_are_spread_averaged_and_correlated() {
    // In the order Box A, Box B, Vase A, Vase B.
    let folder = small(json!({}), [1.0, 2.0, 3.0, 4.0]).finish();
    // Spread: 0, 0.5, 0.5, 1, and 0, 0, 1, 1; the means 0, 0.25, 0.75, 1.
    let files = [file("Anna", &[2.0, 4.0, 4.0, 6.0]), file("Ben", &[0.0, 0.0, 10.0, 10.0])];
    let read = || Report::read(folder.path()).unwrap();
    let report = read().with_ratings(&files).unwrap();
    let markdown = report.text(Format::Markdown, None);
    assert!(markdown.contains("## People") && markdown.contains("2 people"), "{markdown}");
    // Two marks of 0.5 and 0: 0.25 ± 12.7062 · 0.25, by Student's t with one degree of freedom, of
    // which the scale holds no more than itself.
    for cell in [
        "| 0.00 (0.00 to 0.00) | 0.25 (0.00 to 1.00) |",
        "| 0.75 (0.00 to 1.00) | 1.00 (1.00 to 1.00) |",
    ] {
        assert!(markdown.contains(cell), "{cell}: {markdown}");
    }
    // numpy.corrcoef([1, 2, 3, 4], [0, .25, .75, 1])[0, 1] = 0.98994949; all ranks agree.
    assert!(markdown.contains("| Error | 0.99 | 1 | 4 |"), "{markdown}");
    let csv = report.text(Format::Csv, None);
    let header = csv.lines().next().unwrap();
    assert!(
        header.contains("people.mark,people.mark.low_95,people.mark.high_95,people.n"),
        "{header}"
    );
    assert!(csv.lines().nth(2).unwrap().contains(",0.25,0,1,2,"), "{csv}");
    let html = report.text(Format::Html, None);
    assert!(html.contains("<section id=\"people\">") && html.contains("0.25 (0.00 to 1.00)"));
    assert!(html.matches("mark of people").count() > 0);
    assert_eq!(report.plots().len(), read().plots().len() + 1);
    // Without ratings nothing is said of people.
    assert!(!read().text(Format::Html, None).contains("id=\"people\""));
}

#[test]
fn equal_marks_say_nothing_and_holes_are_told() {
    let folder = small(json!({}), [1.0, 2.0, 3.0, 4.0]).finish();
    let files =
        [file("Anna", &[0.0, 1.0, 2.0, 4.0]), file("Ben", &[5.0; 4]), file("Cleo", &[1.0, 9.0])];
    let report = Report::read(folder.path()).unwrap().with_ratings(&files).unwrap();
    let text = report.text(Format::Markdown, None);
    assert!(text.contains("Ben gave every result the same mark"), "{text}");
    assert!(text.contains("1 to 2 a result") && text.contains("2 people"), "{text}");
    let alone = Report::read(folder.path()).unwrap().with_ratings(&files[..1]).unwrap();
    let text = alone.text(Format::Markdown, None);
    assert!(text.contains("no confidence interval") && text.contains("1 person"), "{text}");
    assert!(text.contains("| 0.50 | 1.00 |"), "{text}");
}

#[test]
fn marks_of_another_store_are_refused() {
    let folder = small(json!({}), [1.0, 2.0, 3.0, 4.0]).finish();
    let refused = |files: &[Ratings]| match Report::read(folder.path()).unwrap().with_ratings(files)
    {
        Err(ReportError::Asked(faults)) => faults,
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it was taken"),
    };
    let anna = file("Anna", &[1.0, 2.0, 3.0, 4.0, 5.0]);
    let faults = refused(&[anna]);
    assert!(faults[0].starts_with("Anna.json: marks results of another store"), "{faults:?}");
    assert!(faults[0].contains("1 of its 5 steps") && faults[0].contains("0000000000000005"));
    let early = file("Ben", &[1.0, 2.0]);
    let last = Ratings { file: "last.json".to_owned(), ..file("Ben", &[1.0, 3.0, 4.0]) };
    let faults = refused(&[early, last]);
    assert!(
        faults[0].starts_with("last.json: is of Ben, as Ben.json is; name the one"),
        "{faults:?}"
    );
}
