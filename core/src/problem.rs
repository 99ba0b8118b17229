//! What is wrong with a map: where, what, and what to do.

use std::fmt;

use serde::Serialize;

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

    pub(crate) fn in_program(mut self, program: &str) -> Self {
        self.place.program = Some(program.to_owned());
        self
    }

    /// Whether it stops a run.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { node, port, program } = &self.place;
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

/// Longest name and message that are shown whole, in characters.
const LONGEST_NAME: usize = 80;
const LONGEST_MESSAGE: usize = 2000;

/// A text from a file as a terminal can show it: what would steer the terminal is written out, and
/// a very long text is cut.
fn plain(text: &str, longest: usize) -> String {
    let is_odd = |c: char| c.is_control() || ('\u{202a}'..='\u{202e}').contains(&c);
    let mut shown = String::with_capacity(text.len().min(longest));
    for (place, c) in text.chars().enumerate() {
        if place == longest {
            shown.push('…');
            break;
        }
        if is_odd(c) { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    shown
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
    fn a_problem_says_where() {
        let problem = Problem::error("is missing").at("load").port("path").in_program("costs");
        assert_eq!(problem.to_string(), "program \"costs\": load.path: is missing");
    }
}
