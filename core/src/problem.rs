//! What is wrong with a map: where, what, and what to do.

use std::borrow::Cow;
use std::fmt;

use serde::Serialize;

use crate::map::Step;

/// Whether a problem stops a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The map does not run.
    Error,
    /// The map runs, perhaps not as meant.
    Warning,
}

/// Where in a map a problem is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Place {
    /// Name of the node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<String>,
    /// Name of its port, or dotted path of its parameter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub port: Option<String>,
    /// Name of the program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub program: Option<String>,
    /// The way to it through the JSON of the map, or of the program where one is named.
    #[serde(skip)]
    pub(crate) path: Option<Box<[Step]>>,
}

/// One problem of a map.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// Whether it stops a run.
    pub severity: Severity,
    /// Where it is.
    #[serde(flatten)]
    pub place: Place,
    /// What is wrong and what to do about it.
    pub message: String,
}

impl Problem {
    pub(crate) fn error(message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, place: Place::default(), message: message.into() }
    }

    pub(crate) fn warning(message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(message) }
    }

    pub(crate) fn at(mut self, node: &str) -> Self {
        self.place.node = Some(node.to_owned());
        self
    }

    pub(crate) fn port(mut self, port: &str) -> Self {
        self.place.port = Some(port.to_owned());
        self
    }

    /// Says where it stands in the JSON of the map, or of the program where one is named.
    pub(crate) fn along<const N: usize>(mut self, path: [Step; N]) -> Self {
        self.place.path = Some(Box::new(path));
        self
    }

    pub(crate) fn in_program(mut self, program: &str) -> Self {
        self.place.program = Some(program.to_owned());
        self
    }

    /// What stands for so many more that would say nothing new.
    pub(crate) fn more(n: usize) -> Self {
        Self::error(format!("{n} {MORE}"))
    }

    /// Whether it stands for others that are not listed.
    pub fn counts_others(&self) -> bool {
        self.message.ends_with(MORE)
    }

    /// Whether it stops a run.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { node, port, program, .. } = &self.place;
        if let Some(program) = program {
            write!(f, "program \"{}\": ", plain(program, LONGEST_NAME))?;
        }
        let name = |name: &String| plain(name, LONGEST_NAME);
        match (node.as_ref().map(name), port.as_ref().map(name)) {
            (Some(node), Some(port)) => write!(f, "{node}.{port}: ")?,
            (Some(node), None) => write!(f, "{node}: ")?,
            _ => {}
        }
        f.write_str(&plain(&self.message, LONGEST_MESSAGE))
    }
}

const MORE: &str = "more problems of this kind";

/// Longest name and message that are shown whole, in characters.
pub(crate) const LONGEST_NAME: usize = 100;
const LONGEST_MESSAGE: usize = 2000;

/// A text from a file as a terminal can show it, cut where it is very long.
pub(crate) fn plain(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => printable(&text[..end]).into_owned() + "…",
        None => printable(text).into_owned(),
    }
}

/// Whether a character steers what shows it, in place of being seen: a terminal, or the order in
/// which the letters of a line are set (UAX 9, explicit directional formatting).
pub fn is_steering(c: char) -> bool {
    let is_directional = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}')
        || ('\u{202a}'..='\u{202e}').contains(&c)
        || ('\u{2066}'..='\u{2069}').contains(&c);
    c.is_control() || is_directional || matches!(c, '\u{2028}' | '\u{2029}')
}

/// What is said of a name with such a character.
pub(crate) const HOLDS_NO_STEERING: &str =
    "cannot hold control characters, nor signs that turn the direction of a text";

/// A text with what would steer a terminal, a log or a page written out, in one line: `\u{1b}`.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_steering) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_steering(c) { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    Cow::Owned(shown)
}

/// `; did you mean "…"?` where one of the candidates is close to `name`, else nothing.
pub fn did_you_mean<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> String {
    nearest(name, candidates).map_or_else(String::new, |near| format!("; did you mean \"{near}\"?"))
}

/// The candidate that is closest to `name`, if one is close: its beginning is like that of the
/// name, or one slip of the pen leads from one to the other.
pub fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_lowercase();
    let likeness = |known: &str| {
        let known = known.to_lowercase();
        let is_slip = lower.len() > 1 && strsim::osa_distance(&lower, &known) == 1;
        strsim::jaro_winkler(&lower, &known).max(if is_slip { 0.81 } else { 0.0 })
    };
    candidates
        .map(|known| (likeness(known), known))
        .filter(|(likeness, _)| *likeness > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_close_name_is_offered_and_a_far_one_is_not() {
        let known = ["target_faces", "cost", "placement"];
        let hint = did_you_mean("target_face", known.into_iter());
        assert_eq!(hint, "; did you mean \"target_faces\"?");
        assert_eq!(did_you_mean("path", ["cost"].into_iter()), "");
        assert_eq!(nearest("rn", ["program", "run", "man"].into_iter()), Some("run"));
        assert_eq!(nearest("x", ["y"].into_iter()), None);
    }

    #[test]
    fn what_steers_a_terminal_is_written_out() {
        assert_eq!(printable("a\u{1b}[31m\u{202e}b\n"), "a\\u{1b}[31m\\u{202e}b\\n");
        assert_eq!(printable("\u{9b}\u{2066}\u{200f}"), "\\u{9b}\\u{2066}\\u{200f}");
        assert!(matches!(printable("Stanford-Hase, Ωμέγα, 兎"), Cow::Borrowed(_)));
        assert_eq!(plain("äöüß", 3), "äöü…");
    }

    #[test]
    fn a_problem_says_where() {
        let problem = Problem::error("is missing").at("load").port("path").in_program("costs");
        assert_eq!(problem.to_string(), "program \"costs\": load.path: is missing");
    }
}
