//! The files in which people's marks come back.

use std::collections::HashMap;

use serde_json::Value as Json;

/// The version of the form.
const FORM: u64 = 1;

/// Both ends of a mark: no difference, and a large one.
const MARKS: (f64, f64) = (0.0, 10.0);

/// Longest name that is kept, in characters.
const LONGEST_NAME: usize = 60;

/// The marks of one person.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratings {
    /// The file, as errors and notes name it.
    pub file: String,
    /// Who marked.
    pub rater: String,
    /// Name of the program whose results were marked.
    pub program: String,
    /// Marks from 0 to 10 by the id of the step.
    pub marks: HashMap<String, f64>,
}

impl Ratings {
    /// Reads a file; `file` is its name for messages. The error is a sentence with that name.
    pub fn parse(file: &str, text: &str) -> Result<Self, String> {
        let fault = |why: &str| format!("{file}: {why}");
        let json: Json = serde_json::from_str(text.trim_start_matches('\u{feff}'))
            .map_err(|error| fault(&format!("is no file of ratings: {error}")))?;
        match json.get("mve_ratings").and_then(Json::as_u64) {
            Some(FORM) => {}
            Some(newer) if newer > FORM => {
                return Err(fault("was written by a page of a newer mve; update mve"));
            }
            _ => {
                let whole = "take the file that the page of `mve rate` saves";
                return Err(fault(&format!("is no file of ratings; {whole}")));
            }
        }
        let text = |key: &str| json.get(key).and_then(Json::as_str).map(str::trim);
        let rater = text("rater").filter(|name| !name.is_empty());
        let rater: String = rater
            .ok_or_else(|| fault("\"rater\" must be a name"))?
            .chars()
            .take(LONGEST_NAME)
            .collect();
        let program = text("program").unwrap_or_default().to_owned();
        let list = json.get("marks").and_then(Json::as_array);
        let list = list.ok_or_else(|| fault("\"marks\" must be a list"))?;
        let mut marks = HashMap::new();
        for (place, json) in list.iter().enumerate() {
            let fault = |why: &str| fault(&format!("mark {}: {why}", place + 1));
            let step = json.get("step").and_then(Json::as_str).filter(|step| !step.is_empty());
            let step = step.ok_or_else(|| fault("\"step\" must be the id of a step"))?;
            let mark = json.get("mark").and_then(Json::as_f64);
            let mark = mark.filter(|mark| (MARKS.0..=MARKS.1).contains(mark));
            let mark = mark.ok_or_else(|| fault("\"mark\" must be a number from 0 to 10"))?;
            if marks.insert(step.to_owned(), mark).is_some() {
                return Err(fault(&format!("step {step} is marked twice")));
            }
        }
        if marks.is_empty() {
            return Err(fault("holds no marks"));
        }
        Ok(Self { file: file.to_owned(), rater, program, marks })
    }

    /// The marks from 0 to 1: the least of this person is 0, the largest 1. `None` where all are
    /// equal, as then they say nothing.
    pub fn normalized(&self) -> Option<HashMap<&str, f64>> {
        let least = self.marks.values().copied().fold(f64::INFINITY, f64::min);
        let most = self.marks.values().copied().fold(f64::NEG_INFINITY, f64::max);
        let marks = self.marks.iter();
        (most > least)
            .then(|| marks.map(|(step, mark)| (&**step, (mark - least) / (most - least))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Ratings, String> {
        Ratings::parse("a.json", text)
    }

    #[test]
    fn marks_are_read_and_spread_over_their_range() {
        let text = r#"{"mve_ratings": 1, "program": "p", "rater": " Anna ", "marks": [
            {"step": "a", "mark": 2, "position": 1}, {"step": "b", "mark": 7},
            {"step": "c", "mark": 4.5}]}"#;
        let ratings = parse(text).unwrap();
        assert_eq!((ratings.rater.as_str(), ratings.marks.len()), ("Anna", 3));
        let expected = HashMap::from([("a", 0.0), ("b", 1.0), ("c", 0.5)]);
        assert_eq!(ratings.normalized(), Some(expected));
        let equal = text.replace("7", "2").replace("4.5", "2");
        assert_eq!(parse(&equal).unwrap().normalized(), None);
    }

    #[test]
    fn broken_files_say_what_is_wrong() {
        let with = |marks: &str| {
            format!(r#"{{"mve_ratings": 1, "rater": "x", "program": "p", "marks": {marks}}}"#)
        };
        let cases = [
            ("".to_owned(), "a.json: is no file of ratings: EOF"),
            ("[1, 2]".to_owned(), "is no file of ratings; take the file"),
            (r#"{"mve_ratings": 2}"#.to_owned(), "newer mve"),
            (r#"{"mve_ratings": 1, "rater": " "}"#.to_owned(), "\"rater\" must be a name"),
            (with("3"), "\"marks\" must be a list"),
            (with("[]"), "holds no marks"),
            (with(r#"[{"mark": 3}]"#), "mark 1: \"step\" must be"),
            (with(r#"[{"step": "a", "mark": 11}]"#), "mark 1: \"mark\" must be a number from 0"),
            (with(r#"[{"step": "a", "mark": "3"}]"#), "must be a number from 0 to 10"),
            (
                with(r#"[{"step": "a", "mark": 3}, {"step": "a", "mark": 3}]"#),
                "mark 2: step a is marked twice",
            ),
        ];
        for (text, part) in cases {
            let message = parse(&text).unwrap_err();
            assert!(message.contains(part) && message.starts_with("a.json: "), "{message}");
        }
    }
}
