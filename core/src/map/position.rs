//! Where in the text of a map its parts stand.

use std::fmt;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// A place in a text: line and column, both from 1; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Position {
    /// The line.
    pub line: usize,
    /// The column.
    pub column: usize,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

impl Position {
    /// The place of a byte of the text.
    pub(super) fn of(text: &str, byte: usize) -> Self {
        let before = &text[..text.floor_char_boundary(byte)];
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        Self { line: before.matches('\n').count() + 1, column: before[start..].chars().count() + 1 }
    }
}

/// A key of an object, or the place of an item in an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step<'a> {
    Key(&'a str),
    Item(usize),
}

/// The first byte of the key or item that a path through the JSON leads to; of a path that ends
/// too soon `None`. The text is JSON.
pub(super) fn find(text: &str, path: &[Step]) -> Option<usize> {
    let mut at = 0;
    let mut value: &str = text;
    for step in path {
        let (next, start) = match step {
            Step::Key(key) => {
                let object: IndexMap<String, &RawValue> = serde_json::from_str(value).ok()?;
                let next = object.get(*key)?.get();
                let from = offset(value, next);
                // A key stands before its value; nothing but `:` and space lies between them.
                let end = value[..from].trim_end().strip_suffix(':')?.trim_end();
                (next, at + start_of_text(end)?)
            }
            Step::Item(item) => {
                let array: Vec<&RawValue> = serde_json::from_str(value).ok()?;
                let next = array.get(*item)?.get();
                (next, at + offset(value, next))
            }
        };
        let is_last = std::ptr::eq(step, path.last()?);
        if is_last {
            return Some(start);
        }
        at += offset(value, next);
        value = next;
    }
    Some(at)
}

/// Where a part of a text begins in it.
fn offset(text: &str, part: &str) -> usize {
    part.as_ptr() as usize - text.as_ptr() as usize
}

/// Where the JSON string begins with which a text ends.
fn start_of_text(text: &str) -> Option<usize> {
    let inside = text.strip_suffix('"')?;
    let is_escaped = |quote: usize| {
        let before = &inside[..quote];
        (before.len() - before.trim_end_matches('\\').len()) % 2 == 1
    };
    inside.rmatch_indices('"').map(|(quote, _)| quote).find(|quote| !is_escaped(*quote))
}

#[cfg(test)]
mod tests {
    use super::Step::{Item, Key};
    use super::*;

    #[test]
    fn a_path_leads_to_line_and_column_of_its_key() {
        let text = r#"{
  "nodes": {
    "ä\"b": { "module": "A",
 "params" : {"x": 1}}
  },
  "links": ["p", "q"]
}"#;
        let found = |path: &[Step]| find(text, path).map(|byte| Position::of(text, byte));
        let at = |line, column| Some(Position { line, column });
        assert_eq!(found(&[Key("nodes")]), at(2, 3));
        assert_eq!(found(&[Key("nodes"), Key("ä\"b")]), at(3, 5));
        assert_eq!(found(&[Key("nodes"), Key("ä\"b"), Key("module")]), at(3, 15));
        assert_eq!(found(&[Key("nodes"), Key("ä\"b"), Key("params"), Key("x")]), at(4, 14));
        assert_eq!(found(&[Key("links"), Item(1)]), at(6, 18));
        assert_eq!(found(&[Key("links"), Item(2)]), None);
        assert_eq!(found(&[Key("layout")]), None);
    }
}
