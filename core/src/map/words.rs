//! What is wrong with the text of a map, in the words of a person who writes one.

use serde_json::error::{Category, Error};

use super::position::Position;

/// Why a text is not JSON, with its place.
pub(super) fn of_syntax(text: &str, error: &Error) -> String {
    if text.trim().is_empty() {
        return "the file is empty; `mve new map` writes one to start from".to_owned();
    }
    if error.classify() == Category::Eof {
        let what = "the file ends in the middle: a { or [ or \" is not closed".to_owned();
        return what;
    }
    let byte = byte_of(text, error.line(), error.column());
    // The word in question may begin before it, or behind space.
    let is_of_word = |c: char| c.is_alphanumeric() || "_.+-".contains(c);
    let rest = match text[byte..].starts_with(is_of_word) {
        true => &text[text[..byte].trim_end_matches(is_of_word).len()..],
        false => text[byte..].trim_start(),
    };
    let byte = text.len() - rest.len();
    format!("{}: {}", Position::of(text, byte), what_is_wrong(&error.to_string(), rest))
}

/// The byte at a line and column as serde_json counts them: from 1, columns in bytes.
fn byte_of(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    text.floor_char_boundary((start + column.saturating_sub(1)).min(text.len()))
}

fn what_is_wrong(error: &str, rest: &str) -> String {
    if ["//", "/*", "#"].iter().any(|sign| rest.starts_with(sign)) {
        return "JSON has no comments; a key that begins with _ is a remark, such as \"_why\": \
                \"…\""
            .to_owned();
    }
    if rest.starts_with('\'') {
        return "JSON takes double quotes alone".to_owned();
    }
    let found = match rest.split(|c: char| c.is_whitespace() || ",:]}".contains(c)).next() {
        Some("") | None => rest.chars().next().map_or_else(String::new, |c| c.to_string()),
        Some(word) => word.chars().take(20).collect(),
    };
    let known = FAULTS.iter().find(|(start, _)| error.starts_with(start));
    let sentence = known.map_or(NO_VALUE, |(_, sentence)| sentence);
    sentence.replace("{found}", &found)
}

const NO_VALUE: &str = "found `{found}`, where JSON has a number, a text in double quotes, true, \
                        false, null, [ or {";

/// How errors of the parser begin, and what a person is told.
const FAULTS: [(&str, &str); 12] = [
    ("trailing comma", "a comma before the closing bracket"),
    ("trailing characters", "found `{found}` after the last }"),
    ("recursion limit", "brackets are nested too deeply"),
    ("number out of range", "a number that is too large"),
    (
        "control character",
        "a text goes on over the end of its line (is its closing \" missing?), or has a control \
         character, which is written as \\u and four digits",
    ),
    ("invalid escape", "a \\ in a text that JSON does not know; write \\\\ for a backslash"),
    ("lone leading", "half of a sign in a text: \\u stands for these in pairs"),
    ("unexpected end of hex", "half of a sign in a text: \\u stands for these in pairs"),
    ("expected `,` or `}`", "found `{found}`, where JSON has a comma or }"),
    ("expected `,` or `]`", "found `{found}`, where JSON has a comma or ]"),
    ("expected `:`", "found `{found}`, where JSON has a :"),
    ("key must be a string", "found `{found}`, where JSON has a name in double quotes"),
];

/// What the format expects of a section's parts, or of one of their fields.
pub(super) fn of_form(section: &str, field: Option<&str>) -> &'static str {
    match (section, field) {
        ("nodes", None) => "an object with a \"module\", such as {\"module\": \"Box\"}",
        ("nodes", Some("module")) => "the id of a module, in double quotes",
        ("nodes", Some("mode")) => "\"active\", \"muted\" or \"bypassed\"",
        ("nodes", Some("repeat")) => {
            "how often the node runs, such as {\"times\": 5}, {\"each\": {\"ratio\": [0.5, 0.2]}} \
             or {\"times\": 20, \"until\": {\"output\": \"distance\", \"below\": 0.01}}"
        }
        ("parameters", _) => {
            "the path of a parameter, such as \"simplify.ratio\", or a list of them"
        }
        ("nodes", _) => "an object, such as {\"ratio\": 0.5}",
        ("layout", _) => "two numbers, such as [240, 80]",
        (_, None) => "an object with \"axes\" or \"steps\"",
        (_, Some("axes")) => {
            "a list of axes, such as [{\"simplify.ratio\": [0.5, 0.2]}], or with what stands for \
             many values: {\"range\": [0.1, 0.5, 5]}, {\"log\": [0.02, 0.5, 5]} or \
             {\"glob\": \"scans/*.obj\"}"
        }
        (_, Some("steps")) => "a list of steps, such as [{\"simplify.ratio\": 0.5}]",
        (_, Some("repeats")) => "a whole number above 0",
        (_, _) => "a number of seconds above 0",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> String {
        let error = serde_json::from_str::<serde_json::Value>(text).unwrap_err();
        of_syntax(text, &error)
    }

    #[test]
    fn faults_of_json_are_told_with_their_place_and_what_to_write() {
        assert!(said("{\n  // why\n}").starts_with("line 2, column 3: JSON has no comments"));
        assert!(said("{\"a\": 1, # why\n}").starts_with("line 1, column 10: JSON has no comments"));
        assert!(said("{\"a\": /* why */ 1}").starts_with("line 1, column 7: JSON has no comments"));
        assert!(said("").starts_with("the file is empty"));
        assert!(said("{\"a\": [1, 2").starts_with("the file ends in the middle"));
        let value = "a number, a text in double quotes, true, false, null, [ or {";
        for (text, expected) in [
            ("{\"a\": 1,}", "line 1, column 9: a comma before the closing bracket".to_owned()),
            ("{\"a\": 1} x", "line 1, column 10: found `x` after the last }".to_owned()),
            (
                "{\"a\": 1\n\"b\": 2}",
                "line 2, column 1: found `\"b\"`, where JSON has a comma or }".to_owned(),
            ),
            ("[1 2]", "line 1, column 4: found `2`, where JSON has a comma or ]".to_owned()),
            ("{\"a\" 1}", "line 1, column 6: found `1`, where JSON has a :".to_owned()),
            (
                "{a: 1}",
                "line 1, column 2: found `a`, where JSON has a name in double quotes".to_owned(),
            ),
            ("{'a': 1}", "line 1, column 2: JSON takes double quotes alone".to_owned()),
            ("{\"a\": nan}", format!("line 1, column 7: found `nan`, where JSON has {value}")),
            ("{\"a\": \"C:\\temp\\x\"}", "line 1, column 16: a \\ in a text".to_owned()),
            ("{\"a\": 1e999}", "line 1, column 7: a number that is too large".to_owned()),
        ] {
            let found = said(text);
            assert!(found.starts_with(&expected), "{text}: {found}");
        }
    }
}
