//! From the JSON of a report to what it says, with each slip told at its place.

use indexmap::IndexMap;
use serde_json::{Map as JsonMap, Value as Json};

use super::report_spec::{Measure, Question, ReportFault, ReportSpec};
use crate::map::Step;
use crate::param::shown;
use crate::problem::{did_you_mean, nearest};
use crate::quantity::Better;

const COLUMN: &str = "the name of a column, such as \"compare.rms\"";
const COMPARED: &str = "one parameter with its two values, such as {\"simplify.cost\": [\"Quadric\", \
                        \"EdgeLength\"]}";

/// Reads a report, and keeps what is wrong with it.
#[derive(Default)]
pub(super) struct Reader {
    pub faults: Vec<ReportFault>,
    /// Where it reads.
    path: Vec<Step>,
}

impl Reader {
    /// The whole of it.
    pub fn report(&mut self, json: &Json) -> ReportSpec {
        let known = ["measures", "against", "group", "series", "questions"];
        let Some(fields) = self.object(json, &known, "an object; see `mve schema`") else {
            return ReportSpec::default();
        };
        let texts = "a list, such as [\"info.faces\"]";
        ReportSpec {
            against: self.list(fields, "against", texts, |reader, item| reader.text(item, COLUMN)),
            group: self.one_or_more(fields, "group"),
            measures: self.list(
                fields,
                "measures",
                "a list of measures, such as [{\"column\": \"compare.rms\"}]",
                Self::measure,
            ),
            series: self.one_or_more(fields, "series"),
            questions: self.list(fields, "questions", "a list of questions", Self::question),
        }
    }

    fn measure(&mut self, json: &Json) -> Option<Measure> {
        let form = "a measure, such as {\"column\": \"compare.rms\"}";
        let fields = self.object(json, &["column", "better", "title"], form)?;
        let better = self.within(fields, "better", |reader, value| match value.as_str() {
            Some("lower") => Some(Better::Lower),
            Some("higher") => Some(Better::Higher),
            Some("neither") => Some(Better::Neither),
            _ => reader.misfit(value, "\"lower\", \"higher\" or \"neither\""),
        });
        let title = self.within(fields, "title", |reader, value| reader.text(value, "a text"));
        let column = self.needed(fields, "column", COLUMN)?;
        Some(Measure { column, better, title: title.unwrap_or_default() })
    }

    fn question(&mut self, json: &Json) -> Option<Question> {
        let form = "a question: an object with \"text\", \"measure\" and \"compare\"";
        let fields = self.object(json, &["text", "measure", "compare", "same"], form)?;
        let text = self.needed(fields, "text", "the question, as a person would ask it");
        let measure = self.needed(fields, "measure", COLUMN);
        let compare = match fields.contains_key("compare") {
            true => self.within(fields, "compare", Self::compared),
            false => self.missing(fields, "compare", COMPARED),
        };
        let texts = "a list of columns, such as [\"info.faces\"]";
        let same = self.list(fields, "same", texts, |reader, item| reader.text(item, COLUMN));
        Some(Question { text: text?, measure: measure?, compare: compare?, same })
    }

    fn compared(&mut self, json: &Json) -> Option<IndexMap<String, [Json; 2]>> {
        let mut fields = json.as_object().into_iter().flatten();
        if let (Some((path, Json::Array(sides))), None) = (fields.next(), fields.next())
            && let [a, b] = sides.as_slice()
        {
            return Some(IndexMap::from([(path.clone(), [a.clone(), b.clone()])]));
        }
        let why = format!("{} does not name {COMPARED}", shown(json));
        self.faults.push(ReportFault::at(&self.path, why));
        None
    }

    /// An object of these fields; keys that begin with `_` or `$` are remarks.
    fn object<'a>(
        &mut self,
        json: &'a Json,
        known: &[&str],
        form: &str,
    ) -> Option<&'a JsonMap<String, Json>> {
        let Some(fields) = json.as_object() else { return self.misfit(json, form) };
        let is_remark = |key: &str| key.starts_with(['_', '$']);
        for key in fields.keys().filter(|key| !known.contains(&key.as_str()) && !is_remark(key)) {
            let hint = did_you_mean(key, known.iter().copied());
            let why = format!("there is no field \"{key}\"{hint}");
            let mut fault = ReportFault::at(&self.path, why);
            fault.path.push(key.as_str().into());
            self.faults.push(fault);
        }
        Some(fields)
    }

    /// What `read` makes of a field, where it is there.
    fn within<T>(
        &mut self,
        fields: &JsonMap<String, Json>,
        key: &str,
        read: impl FnOnce(&mut Self, &Json) -> Option<T>,
    ) -> Option<T> {
        let value = fields.get(key)?;
        self.path.push(key.into());
        let read = read(self, value);
        self.path.pop();
        read
    }

    /// A text that must be there.
    fn needed(&mut self, fields: &JsonMap<String, Json>, key: &str, form: &str) -> Option<String> {
        match fields.contains_key(key) {
            true => self.within(fields, key, |reader, value| reader.text(value, form)),
            false => self.missing(fields, key, form),
        }
    }

    /// Tells that a field is not there, unless one has been told of that is probably meant for it.
    fn missing<T>(&mut self, fields: &JsonMap<String, Json>, key: &str, form: &str) -> Option<T> {
        if fields.keys().any(|given| nearest(given, [key].into_iter()).is_some()) {
            return None;
        }
        self.path.push(key.into());
        self.faults.push(ReportFault::at(&self.path, format!("is missing: {form}")));
        self.path.pop();
        None
    }

    /// A list, of what `read` makes of its items; empty where it is not there.
    fn list<T>(
        &mut self,
        fields: &JsonMap<String, Json>,
        key: &str,
        form: &str,
        mut read: impl FnMut(&mut Self, &Json) -> Option<T>,
    ) -> Vec<T> {
        let all = self.within(fields, key, |reader, value| {
            let Some(items) = value.as_array() else { return reader.misfit(value, form) };
            let item = |(place, item)| {
                reader.path.push(Step::Item(place));
                let item = read(reader, item);
                reader.path.pop();
                item
            };
            Some(items.iter().enumerate().filter_map(item).collect())
        });
        all.unwrap_or_default()
    }

    /// A text, or a list of texts.
    fn one_or_more(&mut self, fields: &JsonMap<String, Json>, key: &str) -> Vec<String> {
        let form = "a text, such as \"simplify.cost\", or a list of texts";
        if fields.get(key).is_some_and(Json::is_array) {
            return self.list(fields, key, form, |reader, item| {
                reader.text(item, "a varied parameter, such as \"simplify.cost\"")
            });
        }
        self.within(fields, key, |reader, value| reader.text(value, form)).into_iter().collect()
    }

    fn text(&mut self, json: &Json, form: &str) -> Option<String> {
        match json.as_str() {
            Some(text) => Some(text.to_owned()),
            None => self.misfit(json, form),
        }
    }

    fn misfit<T>(&mut self, json: &Json, form: &str) -> Option<T> {
        self.faults.push(ReportFault::at(&self.path, format!("{} is not {form}", shown(json))));
        None
    }
}
