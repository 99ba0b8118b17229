//! What a program says of its report: which columns measure, which way is better, and what is
//! asked.
//!
//! ```text
//! "report": {
//!   "measures": [ { "column": "ssim.value", "better": "higher", "title": "SSIM" } ],
//!   "against": [ "info.faces", "seconds.simplify" ],
//!   "group": "model.module",
//!   "series": ["simplify.cost", "simplify.placement"],
//!   "questions": [ { "text": "Does A give less error than B?", "measure": "compare.rms",
//!                    "compare": { "simplify.cost": ["A", "B"] }, "same": ["info.faces"] } ]
//! }
//! ```
//!
//! Everything may be left out. A column is named as in the table of results: `node.output`,
//! `seconds`, `seconds.node`, or the path of a varied parameter. Which values are better, and what
//! a column is called, modules declare; a map says it only to overrule them.

use std::fmt;

use indexmap::IndexMap;
use serde_json::Value as Json;

use super::columns::Columns;
use super::report_reader::Reader;
use crate::map::Step;
use crate::problem::did_you_mean;
use crate::quantity::Better;

/// What a program says of its report.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReportSpec {
    /// The columns that measure, the most important first; chosen by the report where empty.
    pub measures: Vec<Measure>,
    /// The columns that measures are plotted against; chosen by the report where empty.
    pub against: Vec<String>,
    /// Varied parameters: their axes give the rows of tables and of pictures, and part plots;
    /// chosen by the report where empty.
    pub group: Vec<String>,
    /// Varied parameters: their axes give the columns of tables and the series of plots; chosen by
    /// the report where empty.
    pub series: Vec<String>,
    /// Questions that the report answers.
    pub questions: Vec<Question>,
}

/// A column that measures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Measure {
    /// Its name in the table of results.
    pub column: String,
    /// Which values are better; as its module declares where not said.
    pub better: Option<Better>,
    /// Its name for a person; as its module declares where empty.
    pub title: String,
}

impl Measure {
    /// A column of which the module says the rest.
    pub fn new(column: &str) -> Self {
        Self { column: column.to_owned(), better: None, title: String::new() }
    }
}

/// A question: how do two values of a parameter compare, all else being equal?
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// As a person would ask it.
    pub text: String,
    /// The column that is compared.
    pub measure: String,
    /// One varied parameter and its two values. An entry of a choice may be named by its id alone:
    /// it then stands for all its settings, which are paired by their own parameters, unless the
    /// axis holds the bare id as a value of its own.
    pub compare: IndexMap<String, [Json; 2]>,
    /// Columns that should be the same in both steps of a pair; chosen by the report where empty.
    pub same: Vec<String>,
}

/// What is wrong with a report, and where in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportFault {
    /// The way to it through the JSON of the report.
    pub(super) path: Vec<Step>,
    /// The place and a sentence.
    message: String,
}

impl ReportFault {
    /// A fault at a place, such as `measures[0].column`.
    pub(super) fn at(path: &[Step], why: impl fmt::Display) -> Self {
        let mut place = "report".to_owned();
        for step in path {
            match step {
                Step::Key(key) => place.extend([".", key]),
                Step::Item(item) => place.push_str(&format!("[{item}]")),
                Step::Link(link) => place.push_str(&link.to_string()),
            }
        }
        Self { path: path.to_vec(), message: format!("\"{place}\": {why}") }
    }
}

impl fmt::Display for ReportFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl ReportSpec {
    /// Reads what a program says, or lists what is wrong with it.
    pub fn parse(json: &Json) -> Result<Self, Vec<ReportFault>> {
        let mut reader = Reader::default();
        let spec = reader.report(json);
        if reader.faults.is_empty() { Ok(spec) } else { Err(reader.faults) }
    }

    /// What does not fit the results that it is about.
    pub(super) fn faults(&self, about: &About) -> Vec<ReportFault> {
        let values = &about.values;
        let column = |(place, name): (Vec<Step>, &String)| {
            let hint = did_you_mean(name, about.names().iter().map(String::as_str));
            let why = format!(
                "\"{name}\" is not a column; write \"node.output\", \"seconds.node\" or \
                 \"seconds\"{hint}"
            );
            (!about.has(name)).then(|| ReportFault::at(&place, why))
        };
        let varied = |(place, path): (Vec<Step>, &String)| {
            let hint = did_you_mean(path, values.keys().map(String::as_str));
            let why = format!("\"{path}\" is not varied by the program{hint}");
            (!values.contains_key(path)).then(|| ReportFault::at(&place, why))
        };
        let mut faults: Vec<ReportFault> = self.columns().into_iter().filter_map(column).collect();
        faults.extend(self.paths().into_iter().filter_map(varied));
        for (i, question) in self.questions.iter().enumerate() {
            let place = ["questions".into(), Step::Item(i), "compare".into()];
            for (path, sides) in &question.compare {
                let Some(known) = values.get(path) else { continue };
                let is_missing = |side: &&Json| meant(side, known.iter().copied()).is_empty();
                faults.extend(sides.iter().filter(is_missing).map(|side| {
                    let why = format!("{side} is not among the values of {path}");
                    ReportFault::at(&place, why)
                }));
            }
        }
        faults
    }

    /// Every column that is named, with its place.
    fn columns(&self) -> Vec<(Vec<Step>, &String)> {
        let item = |list: &str, i: usize| vec![list.into(), Step::Item(i)];
        let below = |list: &str, i: usize, key: &str| [item(list, i), vec![key.into()]].concat();
        let measures = self.measures.iter().enumerate();
        let mut named: Vec<_> =
            measures.map(|(i, m)| (below("measures", i, "column"), &m.column)).collect();
        let against = self.against.iter().enumerate();
        named.extend(against.map(|(i, name)| (item("against", i), name)));
        for (i, question) in self.questions.iter().enumerate() {
            named.push((below("questions", i, "measure"), &question.measure));
            let same = question.same.iter().enumerate();
            let place = |j| [below("questions", i, "same"), vec![Step::Item(j)]].concat();
            named.extend(same.map(|(j, name)| (place(j), name)));
        }
        named
    }

    /// Every varied parameter that is named, with its place.
    fn paths(&self) -> Vec<(Vec<Step>, &String)> {
        let axes = [("group", &self.group), ("series", &self.series)];
        let axes = axes
            .into_iter()
            .flat_map(|(place, paths)| paths.iter().map(move |path| (vec![place.into()], path)));
        let questions = self.questions.iter().enumerate();
        let compared = questions.flat_map(|(i, question)| {
            let place = move || vec!["questions".into(), Step::Item(i), "compare".into()];
            question.compare.keys().map(move |path| (place(), path))
        });
        axes.chain(compared).collect()
    }
}

/// Columns of times that every table of results may have: the seconds of a step, and what
/// `--timing` measures beside them.
pub const TIMES: [&str; 5] =
    ["seconds", "seconds_median", "seconds_min", "cpu_seconds", "peak_bytes"];

/// The results that a report is about, before there are any.
pub(super) struct About<'a> {
    /// What modules give.
    pub columns: &'a Columns,
    /// Names of the nodes that run.
    pub nodes: &'a [String],
    /// Nodes of the map that do not run, whose columns are not known.
    pub idle: Vec<String>,
    /// Each varied parameter with all its values.
    pub values: IndexMap<String, Vec<&'a Json>>,
}

impl About<'_> {
    fn has(&self, name: &str) -> bool {
        let node = name.split('.').next().unwrap_or_default();
        let of_node = name.strip_prefix("seconds.").and_then(|place| place.split('.').next());
        TIMES.contains(&name)
            || self.values.contains_key(name)
            || of_node.is_some_and(|node| self.nodes.iter().any(|known| known == node))
            || self.idle.iter().any(|idle| idle == of_node.unwrap_or(node))
            || !self.columns.find(name).is_empty()
    }

    /// All columns by name, but those of parts of the work of a node.
    fn names(&self) -> Vec<String> {
        let times = TIMES.iter().map(|name| (*name).to_owned());
        let of_nodes = self.nodes.iter().map(|node| format!("seconds.{node}"));
        let columns = self.columns.0.keys().chain(self.values.keys()).cloned();
        columns.chain(times).chain(of_nodes).collect()
    }
}

/// The values of a parameter that a side of a comparison means, each once: itself where it is one
/// of them, else those that choose the entry of this id. So a bare entry beside others with
/// parameters is a side of its own.
pub fn meant<'a>(side: &Json, values: impl Iterator<Item = &'a Json> + Clone) -> Vec<&'a Json> {
    if let Some(itself) = values.clone().find(|value| *value == side) {
        return vec![itself];
    }
    let Some(id) = side.as_str() else { return Vec::new() };
    let chooses = |value: &Json| {
        value.as_object().is_some_and(|fields| fields.len() == 1 && fields.contains_key(id))
    };
    let mut found: Vec<&Json> = Vec::new();
    for value in values.filter(|value| chooses(value)) {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn reads_what_the_header_shows() {
        let spec = ReportSpec::parse(&json!({
            "measures": [{ "column": "a.x", "better": "higher", "title": "X" }, { "column": "b.y" }],
            "questions": [{ "text": "?", "measure": "b.y", "compare": { "c.cost": ["A", "B"] } }]
        }));
        let spec = spec.unwrap();
        assert_eq!(spec.measures[0].better, Some(Better::Higher));
        assert_eq!(spec.measures[1].better, None);
        assert_eq!(spec.questions[0].compare["c.cost"], [json!("A"), json!("B")]);
    }

    #[test]
    fn slips_are_told_with_their_place() {
        let faults = ReportSpec::parse(&json!({
            "measure": [], "against": 3, "group": 4,
            "measures": [{ "colum": "a.x" }],
            "questions": [{ "text": "?", "measure": "a.x", "compare": {} }]
        }));
        let faults = faults.unwrap_err().iter().map(ReportFault::to_string).collect::<Vec<_>>();
        let of_measure = "\"report.measures[0]\": there is no field \"colum\"; did you mean \
                          \"column\"?";
        assert_eq!(
            faults,
            [
                "\"report\": there is no field \"measure\"; did you mean \"measures\"?",
                "\"report.against\": 3 is not a list, such as [\"info.faces\"]",
                "\"report.group\": 4 is not a text, such as \"simplify.cost\", or a list of texts",
                of_measure,
                "\"report.questions[0].compare\": {} does not name one parameter with its two \
                 values, such as {\"simplify.cost\": [\"Quadric\", \"EdgeLength\"]}",
            ]
        );
        assert!(ReportSpec::parse(&json!([])).is_err());
    }

    #[test]
    fn no_slip_is_told_in_words_of_the_parser() {
        let column = || json!({ "column": "a.x" });
        for odd in [
            json!({ "measures": column() }),
            json!({ "measures": [3] }),
            json!({ "measures": [{ "column": 3 }] }),
            json!({ "measures": [{ "column": "a.x", "better": "less" }] }),
            json!({ "measures": [{ "column": "a.x", "title": 3 }] }),
            json!({ "against": ["a.x", 3] }),
            json!({ "series": [3] }),
            json!({ "questions": [[]] }),
            json!({ "questions": [{ "text": 3, "measure": "a.x", "compare": {} }] }),
            json!({ "questions": [{ "measure": "a.x", "compare": { "a.y": [1] } }] }),
            json!({ "questions": [{ "text": "?", "compare": { "a.y": [1, 2, 3] }, "same": 3 }] }),
            json!({ "questions": [{ "text": "?", "measure": "a.x", "compare": { "a.y": 1 } }] }),
        ] {
            let faults = ReportSpec::parse(&odd).unwrap_err();
            for fault in faults.iter().map(ReportFault::to_string) {
                let words = ["invalid", "expected", "unknown", "missing field", "sequence", "`"];
                let is_told = fault.starts_with("\"report.") && !fault.ends_with(' ');
                assert!(is_told && !words.iter().any(|word| fault.contains(word)), "{fault}");
            }
        }
        let remarks = json!({ "_why": 1, "measures": [{ "column": "a.x", "$x": 2 }] });
        assert!(ReportSpec::parse(&remarks).is_ok());
    }

    #[test]
    fn a_bare_entry_that_is_a_value_means_itself_alone() {
        let (bare, one) = (json!("A"), json!({ "A": { "size": 1 } }));
        let (two, other) = (json!({ "A": { "size": 2 } }), json!({ "B": {} }));
        let all = [&one, &bare, &two, &other, &one];
        assert_eq!(meant(&bare, all.into_iter()), [&bare]);
        assert_eq!(meant(&one, all.into_iter()), [&one]);
        assert_eq!(meant(&bare, [&one, &two, &other, &one].into_iter()), [&one, &two]);
        assert!(meant(&json!("C"), all.into_iter()).is_empty());
    }

    #[test]
    fn columns_and_values_must_exist() {
        let (a, b) = (json!("A"), json!({ "B": { "size": 2 } }));
        let columns = json!({ "compare.rms": [{}], "compare.rms_#": [{}], "cut.faces": [{}] });
        let about = About {
            columns: &serde_json::from_value(columns).unwrap(),
            nodes: &["cut".to_owned(), "compare".to_owned()],
            idle: vec!["muted".to_owned()],
            values: IndexMap::from([("cut.cost".to_owned(), vec![&a, &b])]),
        };
        let faults = |json: Json| {
            let faults = ReportSpec::parse(&json).unwrap().faults(&about);
            faults.iter().map(ReportFault::to_string).collect::<Vec<_>>()
        };
        let fine = json!({
            "measures": [{ "column": "compare.rms" }, { "column": "seconds.cut" },
                { "column": "compare.rms_12" }, { "column": "muted.any" }],
            "against": ["seconds"], "group": "cut.cost",
            "questions": [
                { "text": "?", "measure": "compare.rms", "compare": { "cut.cost": ["A", "B"] } }
            ]
        });
        assert_eq!(faults(fine), [""; 0]);
        let wrong = json!({
            "measures": [{ "column": "compare.rmss" }, { "column": "seconds.cute" }],
            "series": ["cut.costs"],
            "questions": [
                { "text": "?", "measure": "seconds", "compare": { "cut.cost": ["A", "C"] } }
            ]
        });
        let faults = faults(wrong);
        let is_column = "\"report.measures[0].column\": \"compare.rmss\" is not a column";
        assert!(faults[0].starts_with(is_column), "{faults:?}");
        assert!(faults[0].ends_with("; did you mean \"compare.rms\"?"), "{faults:?}");
        assert!(faults[1].ends_with("; did you mean \"seconds.cut\"?"), "{faults:?}");
        assert!(faults[2].contains("not varied by the program; did you mean \"cut.cost\"?"));
        assert!(faults[3].ends_with("\"C\" is not among the values of cut.cost"), "{faults:?}");
    }
}
