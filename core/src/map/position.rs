//! Where in the text of a map its parts stand.

use std::fmt;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::{BYTE_ORDER_MARK, Link, Map, PortRef};
use crate::problem::{Place, Problem};

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

impl Map {
    /// Where the file that the map was read from says what a problem is about, as near as can be
    /// told: a parameter, else its node, else nothing.
    pub fn position_of(&self, problem: &Problem) -> Option<Position> {
        let text = self.source.as_ref()?.text.trim_start_matches(BYTE_ORDER_MARK);
        let candidates = self.paths_to(&problem.place);
        let byte = candidates.iter().find_map(|path| find(text, path))?;
        Some(Position::of(text, byte))
    }

    /// Paths through the file's JSON to a place, the best first.
    fn paths_to<'a>(&'a self, place: &'a Place) -> Vec<Vec<Step<'a>>> {
        use Step::{Item, Key};
        let mut paths = Vec::new();
        let Place { node, port, program } = place;
        if let Some(program) = program {
            let of_program = [Key("programs"), Key(program)];
            let varied = node.as_ref().zip(port.as_ref()).map(|(n, p)| format!("{n}.{p}"));
            let spec = self.programs.get(program);
            let axes = spec.iter().flat_map(|spec| spec.axes.iter().enumerate());
            let keys = axes.flat_map(|(i, axis)| axis.keys().map(move |key| ("axes", i, key)));
            let steps = spec.iter().flat_map(|spec| spec.steps.iter().enumerate());
            let keys = keys
                .chain(steps.flat_map(|(i, step)| step.keys().map(move |key| ("steps", i, key))));
            let found = keys.filter(|(_, _, key)| {
                varied
                    .as_ref()
                    .is_some_and(|path| path == *key || path.starts_with(&format!("{key}.")))
            });
            for (list, i, key) in found {
                paths.push([&of_program[..], &[Key(list), Item(i), Key(key)]].concat());
            }
            if let (None, Some(key)) = (node, port) {
                paths.push([&of_program[..], &[Key(key)]].concat());
            }
            if node.is_none() {
                paths.push(of_program.to_vec());
            }
        }
        if let Some(node) = node {
            let of_node = [Key("nodes"), Key(node)];
            if let Some(port) = port {
                let mut nested: Vec<_> = port.split('.').map(Key).collect();
                while !nested.is_empty() {
                    paths.push([&of_node[..], &[Key("params")], &nested].concat());
                    nested.pop();
                }
                paths.push([&of_node[..], &[Key(port)]].concat());
                let is_end = |end: &PortRef| (&end.node, &end.port) == (node, port);
                let link = |link: &Link| is_end(&link.to) || is_end(&link.from);
                if let Some(i) = self.links.iter().position(link) {
                    paths.push(vec![Key("links"), Item(i)]);
                }
            }
            paths.push(of_node.to_vec());
        } else if let (None, Some(key)) = (program, port) {
            paths.push(vec![Key(key)]);
        }
        paths
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
