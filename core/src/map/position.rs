//! Where in the text of a map its parts stand.

use std::fmt;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::{BYTE_ORDER_MARK, Map, PortRef};
use crate::json::Step;
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
    /// told; `None` for what is in no file.
    pub fn position_of(&self, problem: &Problem) -> Option<Position> {
        let text = self.source.as_ref()?.text.trim_start_matches(BYTE_ORDER_MARK);
        let candidates = self.paths_to(&problem.place);
        let byte = candidates.iter().find_map(|path| find(text, path))?;
        Some(Position::of(text, byte))
    }

    /// Paths through the file's JSON to a place, the best first.
    fn paths_to(&self, place: &Place) -> Vec<Vec<Step>> {
        let Place { node, port, program, path } = place;
        let mut paths = Vec::new();
        let within = match program {
            Some(program) => vec!["programs".into(), program.as_str().into()],
            None => Vec::new(),
        };
        if let Some(path) = path {
            paths.extend((0..=path.len()).rev().map(|n| [&within[..], &path[..n]].concat()));
        }
        if let (Some(node), Some(port), Some(program)) = (node, port, program) {
            paths.extend(self.paths_to_varied(program, &format!("{node}.{port}")));
        }
        match (node, port) {
            (Some(node), port) => paths.extend(self.paths_to_node(node, port.as_deref())),
            (None, Some(key)) => paths.push([&within[..], &[key.as_str().into()]].concat()),
            (None, None) => {}
        }
        if program.is_some() {
            paths.push(within);
        }
        paths
    }

    /// Where a program sets a parameter, or one above it.
    fn paths_to_varied(&self, program: &str, varied: &str) -> Vec<Vec<Step>> {
        let Some(spec) = self.programs.get(program) else { return Vec::new() };
        let axes = spec.axes.iter().enumerate();
        let axes = axes.flat_map(|(i, axis)| axis.keys().map(move |key| ("axes", i, key)));
        let steps = spec.steps.iter().enumerate();
        let steps = steps.flat_map(|(i, step)| step.keys().map(move |key| ("steps", i, key)));
        let is_it = |key: &str| varied == key || varied.starts_with(&format!("{key}."));
        let found = axes.chain(steps).filter(|(_, _, key)| is_it(key));
        let path = |(list, i, key): (&str, usize, &String)| {
            let place = [list.into(), Step::Item(i), key.as_str().into()];
            ["programs".into(), program.into()].into_iter().chain(place).collect()
        };
        found.map(path).collect()
    }

    /// Where a node says what is about a port or parameter, else the link of that port, else the
    /// node.
    fn paths_to_node(&self, node: &str, port: Option<&str>) -> Vec<Vec<Step>> {
        if let Some((outer, inner)) = node.split_once('/') {
            return self.paths_inside(outer, inner, port);
        }
        let of_node: [Step; 2] = ["nodes".into(), node.into()];
        let mut paths = Vec::new();
        if let Some(port) = port {
            let mut nested: Vec<Step> = port.split('.').map(Step::from).collect();
            while !nested.is_empty() {
                paths.push([&of_node[..], &["params".into()], &nested].concat());
                nested.pop();
            }
            paths.push([&of_node[..], &[port.into()]].concat());
            let is_end = |end: &PortRef| end.node == node && end.port == port;
            let link = self.links.iter().find(|link| is_end(&link.to) || is_end(&link.from));
            paths.extend(link.map(|link| vec!["links".into(), Step::Text(link.to_string())]));
        }
        paths.push(of_node.to_vec());
        paths
    }

    /// Where a node stands of a map that a node of this one stands for, else that node.
    fn paths_inside(&self, outer: &str, inner: &str, port: Option<&str>) -> Vec<Vec<Step>> {
        let node = self.nodes.get(outer);
        // The first part is the number of a round.
        let inner = match node.is_some_and(|node| node.repeat.is_some()) {
            true => inner.split_once('/').map(|(_, inner)| inner),
            false => Some(inner),
        };
        let module = node.map(|node| node.module.as_str());
        let map = module.and_then(|module| Some((module, self.maps.get(module)?)));
        let mut paths = Vec::new();
        if let (Some((module, map)), Some(inner)) = (map, inner) {
            let before: [Step; 2] = ["maps".into(), module.into()];
            let within = map.paths_to_node(inner, port).into_iter();
            paths.extend(within.map(|path| [&before[..], &path].concat()));
        }
        paths.extend(self.paths_to_node(outer, None));
        paths
    }
}

/// The first byte of the key or item that a path through the JSON leads to; of a path that ends
/// too soon `None`. The text is JSON.
pub(super) fn find(text: &str, path: &[Step]) -> Option<usize> {
    let space = |text: &str| text.len() - text.trim_start().len();
    let Some((step, rest)) = path.split_first() else { return Some(space(text)) };
    let (next, start) = match step {
        Step::Key(key) => {
            let object: IndexMap<String, &RawValue> = serde_json::from_str(text).ok()?;
            let next = object.get(key)?.get();
            // A key stands before its value; nothing but `:` and space lies between them.
            let end = text[..offset(text, next)].trim_end().strip_suffix(':')?.trim_end();
            (next, start_of_text(end)?)
        }
        Step::Item(item) => {
            let array: Vec<&RawValue> = serde_json::from_str(text).ok()?;
            let next = array.get(*item)?.get();
            (next, offset(text, next))
        }
        Step::Text(text_of_it) => {
            let array: Vec<&RawValue> = serde_json::from_str(text).ok()?;
            let bare = |text: &str| text.split_whitespace().collect::<String>();
            let is_it = |item: &&&RawValue| {
                let said = serde_json::from_str::<String>(item.get()).ok();
                said.is_some_and(|said| bare(&said) == bare(text_of_it))
            };
            let next = array.iter().rev().find(is_it)?.get();
            (next, offset(text, next))
        }
    };
    if rest.is_empty() {
        return Some(start);
    }
    find(next, rest).map(|byte| offset(text, next) + byte)
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
    use super::*;

    #[test]
    fn a_path_leads_to_line_and_column_of_its_key() {
        let text = r#"{
  "nodes": {
    "ä\"b": { "module": "A",
 "params" : {"x": 1}}
  },
  "links": ["p", "q", "a.x->b.y"]
}"#;
        let found = |keys: &[&str], last: &[Step]| {
            let keys: Vec<Step> = keys.iter().map(|key| Step::from(*key)).collect();
            find(text, &[&keys[..], last].concat()).map(|byte| Position::of(text, byte))
        };
        let at = |line, column| Some(Position { line, column });
        assert_eq!(found(&[], &[]), at(1, 1));
        assert_eq!(found(&["nodes"], &[]), at(2, 3));
        assert_eq!(found(&["nodes", "ä\"b"], &[]), at(3, 5));
        assert_eq!(found(&["nodes", "ä\"b", "module"], &[]), at(3, 15));
        assert_eq!(found(&["nodes", "ä\"b", "params", "x"], &[]), at(4, 14));
        assert_eq!(found(&["links"], &[Step::Item(1)]), at(6, 18));
        assert_eq!(found(&["links"], &[Step::Item(3)]), None);
        let link = |text: &str| Step::Text(text.to_owned());
        assert_eq!(found(&["links"], &[link("a.x -> b.y")]), at(6, 23));
        assert_eq!(found(&["links"], &[link("a.x -> b.z")]), None);
        assert_eq!(found(&["layout"], &[]), None);
    }
}
