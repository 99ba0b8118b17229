//! The map: nodes, links, layout and programs, as one JSON file says them.
//!
//! A map always loads, unless the file is not JSON at all or was written by a newer mve. What does
//! not fit is kept as it stands, saved back unchanged, and reported by [`Map::problems`]; whether
//! the rest makes sense (do the modules exist, do the links fit) is for [`crate::Plan`] to say.

mod axes;
mod link;
mod parts;
mod position;
mod read;
mod repeat;
mod text;
mod words;

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map as JsonMap, Value as Json};
use thiserror::Error;

pub use axes::Axis;
pub use link::{Link, PortRef};
pub(crate) use parts::MAP_INPUT_ID;
pub use parts::{Node, NodeMode, ProgramSpec, Promoted};
pub use position::Position;
pub use repeat::{Repeat, Until};

use crate::files::fresh_file;
use crate::json::{self, Step};
use crate::problem::{LONGEST_NAME, Problem, is_steering};

/// The version of the format that this mve writes.
const FORMAT: u64 = 1;

/// Takes the JSON of one version of the format to the next.
type Migration = fn(&mut JsonMap<String, Json>);

/// Migration `i` takes version `i + 1` to `i + 2`.
const MIGRATIONS: &[Migration] = &[];

/// Some text editors put it at the beginning of a file.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// Of this node, `seconds.area` would be an output and the time of a node `area`.
const RESERVED: &str = "seconds";

/// Nodes, links, layout and programs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// What the map is for.
    pub title: String,
    /// Nodes by name, in the order of the file.
    pub nodes: IndexMap<String, Node>,
    /// Links, in the order of the file.
    pub links: Vec<Link>,
    /// Where each node is drawn.
    pub layout: IndexMap<String, [f64; 2]>,
    /// Programs by name.
    pub programs: IndexMap<String, ProgramSpec>,
    /// Maps that nodes of this one may name as their module.
    pub maps: IndexMap<String, Map>,
    /// Parameters that the map has as a node of another one: the name, and the parameters of its
    /// nodes that get the value.
    pub parameters: IndexMap<String, Promoted>,
    /// Fields of the file that this version does not know.
    pub extra: JsonMap<String, Json>,
    /// Parts of known sections that could not be understood: section, key, value.
    leftovers: Vec<(&'static str, String, Json)>,
    problems: Vec<Problem>,
    source: Option<Arc<Source>>,
}

/// The text that a map was read from, and what it said.
#[derive(Debug, PartialEq)]
struct Source {
    text: String,
    map: Map,
}

/// Why a file is no map, or was not written.
#[derive(Debug, Error)]
pub enum MapError {
    /// The file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is not a JSON object.
    #[error("not a map: {0}")]
    NotJson(String),
    /// A newer mve wrote it.
    #[error("written in format {0}, and this mve reads formats up to {FORMAT}; use a newer mve")]
    Newer(u64),
}

impl Map {
    /// Bytes of the largest file that is read: no map that a person made comes near this; it stops
    /// a wrong path from filling the memory.
    pub const LARGEST_FILE: u64 = 64 << 20;

    /// Reads a map file.
    pub fn load(path: &Path) -> Result<Self, MapError> {
        let fail = |source| MapError::Io { path: path.to_owned(), source };
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(fail)?;
        file.take(Self::LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(fail)?;
        if bytes.len() as u64 > Self::LARGEST_FILE {
            return Err(MapError::NotJson("the file is larger than 64 MiB".to_owned()));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let byte = error.utf8_error().valid_up_to() + 1;
            MapError::NotJson(format!("the file is not text: byte {byte} is not UTF-8"))
        })?;
        Self::parse(&text)
    }

    /// Reads the text of a map file.
    pub fn parse(text: &str) -> Result<Self, MapError> {
        let plain = text.trim_start_matches(BYTE_ORDER_MARK);
        let (json, repeated) = json::parse(plain)
            .map_err(|error| MapError::NotJson(words::of_syntax(plain, &error)))?;
        let Json::Object(mut object) = json else {
            return Err(MapError::NotJson("the file is JSON, but not an object".to_owned()));
        };
        let mut map = Self::default();
        for path in repeated {
            let keys = path.iter().filter_map(|step| match step {
                Step::Key(key) => Some(key.as_str()),
                Step::Item(_) | Step::Text(_) => None,
            });
            let keys = keys.collect::<Vec<_>>().join(".");
            let message = format!("\"{keys}\" stands twice in the file; rename or remove one");
            let mut problem = Problem::error(message);
            problem.place.path = Some(path.into());
            map.problems.push(problem);
        }
        match object.shift_remove("mve").map(|version| (version.as_u64(), version)) {
            Some((Some(version), _)) if version > FORMAT => return Err(MapError::Newer(version)),
            Some((Some(version), _)) if version > 0 => migrate(&mut object, version, MIGRATIONS),
            Some((_, version)) => {
                let message = format!("\"mve\": {version} is not a version; write \"mve\": 1");
                map.problems.push(Problem::error(message).along(["mve".into()]));
            }
            None => {
                let message = "the file does not say \"mve\": 1; is it a map of mve?";
                map.problems.push(Problem::error(message).along([]));
            }
        }
        map.read_parts(object);
        let source = Source { text: text.to_owned(), map: map.clone() };
        map.source = Some(Arc::new(source));
        Ok(map)
    }

    /// Reads a map that stands in another one, from its JSON.
    pub fn inner(object: JsonMap<String, Json>) -> Self {
        let mut map = Self::default();
        map.read_parts(object);
        map
    }

    fn read_parts(&mut self, object: JsonMap<String, Json>) {
        let unknown = read::unknown_keys_of_map(&object);
        self.fill(object);
        self.problems.extend(unknown);
    }

    /// Whether an inner map may have this name. Modules begin with a capital.
    pub fn can_name_a_map(name: &str) -> bool {
        Self::can_name_a_node(name) && !name.starts_with(char::is_uppercase)
    }

    /// Whether a map must be opened up before it is planned: some node stands for a map, or runs
    /// more than once, or for what another map gives.
    pub fn has_maps(&self) -> bool {
        self.nodes
            .values()
            .any(|node| node.repeat.is_some() || node.is_map() || node.module == MAP_INPUT_ID)
    }

    /// Whether a node may have this name: the signs that links, paths and templates are made of are
    /// not for names, and neither are those that nobody sees.
    pub fn can_name_a_node(name: &str) -> bool {
        let is_bad = |c: char| c.is_whitespace() || is_steering(c) || ".{}>/\\".contains(c);
        let is_long = name.chars().nth(LONGEST_NAME).is_some();
        !(name.is_empty() || name.contains(is_bad) || is_long || name == RESERVED)
    }

    /// What the file says that could not be understood.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Whether the file has a node of this name that could not be read.
    pub(crate) fn has_unread_node(&self, name: &str) -> bool {
        self.leftovers.iter().any(|(section, known, _)| *section == "nodes" && known == name)
    }

    /// The text of the map's file. A map that was not changed since it was read has the text that
    /// it was read from, byte for byte.
    pub fn to_text(&self) -> String {
        match &self.source {
            Some(source) if self.says_the_same_as(&source.map) => source.text.clone(),
            _ => text::canonical(&self.to_json()),
        }
    }

    /// Leaves out the problems of all programs but one, which are none of its own.
    pub(crate) fn forget_other_programs(&mut self, name: &str) {
        let is_own = |problem: &Problem| problem.place.program.as_ref().is_none_or(|p| p == name);
        self.problems.retain(is_own);
    }

    /// The map alone: what one step of a program needs, and cheap to copy.
    pub(crate) fn without_programs(&self) -> Self {
        Self { programs: IndexMap::new(), source: None, ..self.clone() }
    }

    /// What stands for the map where another one names it: its nodes with their links, and the
    /// parameters that it makes known.
    pub(crate) fn as_inside(&self) -> Self {
        let (nodes, links) = (self.nodes.clone(), self.links.clone());
        Self { nodes, links, parameters: self.parameters.clone(), ..self.emptied() }
    }

    /// Nothing of the map but its title.
    pub(crate) fn emptied(&self) -> Self {
        Self { title: self.title.clone(), ..Self::default() }
    }

    /// Writes the map beside its target, then renames: readers see the old file or the new one.
    pub fn save(&self, path: &Path) -> Result<(), MapError> {
        let fail = |source| MapError::Io { path: path.to_owned(), source };
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        let mut file = fresh_file(folder.unwrap_or(Path::new(".")), ".mve-map-").map_err(fail)?;
        file.write_all(self.to_text().as_bytes()).map_err(fail)?;
        file.as_file().sync_all().map_err(fail)?;
        file.persist(path).map_err(|error| fail(error.error))?;
        Ok(())
    }

    /// The whole map as JSON, keys in the fixed order of the format.
    pub fn to_json(&self) -> Json {
        let mut file = JsonMap::new();
        file.insert("mve".to_owned(), Json::from(FORMAT));
        self.write_parts(&mut file);
        Json::Object(file)
    }

    /// Puts the sections of the map into its JSON.
    fn write_parts(&self, file: &mut JsonMap<String, Json>) {
        if !self.title.is_empty() {
            file.insert("title".to_owned(), Json::from(self.title.as_str()));
        }
        let nodes = object_of(&self.nodes);
        let links = self.links.iter().map(|link| Json::from(link.to_string())).collect();
        file.insert("nodes".to_owned(), nodes);
        file.insert("links".to_owned(), Json::Array(links));
        file.insert("layout".to_owned(), Json::Object(self.layout_json()));
        file.insert("programs".to_owned(), object_of(&self.programs));
        file.insert("parameters".to_owned(), object_of(&self.parameters));
        let inner = self.maps.iter().map(|(name, map)| {
            let mut parts = JsonMap::new();
            map.write_parts(&mut parts);
            (name.clone(), Json::Object(parts))
        });
        file.insert("maps".to_owned(), inner.collect());
        for (section, key, value) in &self.leftovers {
            match file.get_mut(*section) {
                Some(Json::Array(array)) => array.push(value.clone()),
                Some(Json::Object(object)) => {
                    object.entry(key).or_insert_with(|| value.clone());
                }
                _ => {
                    file.insert(key.clone(), value.clone());
                }
            }
        }
        file.retain(|key, value| {
            let can_be_left_out = ["links", "layout", "programs", "parameters", "maps"];
            !(can_be_left_out.contains(&key.as_str()) && is_empty(value))
        });
        file.extend(self.extra.clone());
    }

    /// Whole coordinates stand without a fraction, as people write them.
    fn layout_json(&self) -> JsonMap<String, Json> {
        let number = |x: f64| match x.fract() == 0.0 && x.abs() < 1e15 {
            true => Json::from(x as i64),
            false => Json::from(x),
        };
        let place = |at: &[f64; 2]| Json::Array(at.iter().map(|x| number(*x)).collect());
        self.layout.iter().map(|(name, at)| (name.clone(), place(at))).collect()
    }

    fn says_the_same_as(&self, other: &Self) -> bool {
        (&self.title, &self.nodes, &self.links, &self.layout)
            == (&other.title, &other.nodes, &other.links, &other.layout)
            && (&self.maps, &self.parameters) == (&other.maps, &other.parameters)
            && (&self.programs, &self.extra, &self.leftovers)
                == (&other.programs, &other.extra, &other.leftovers)
    }
}

fn migrate(object: &mut JsonMap<String, Json>, from: u64, migrations: &[Migration]) {
    migrations.iter().skip(from as usize - 1).for_each(|migration| migration(object));
}

fn object_of<T: Serialize>(parts: &IndexMap<String, T>) -> Json {
    // Names and parts of a map are plain data, which JSON can always say.
    serde_json::to_value(parts).unwrap_or(Json::Null)
}

fn is_empty(value: &Json) -> bool {
    value.as_array().is_some_and(Vec::is_empty) || value.as_object().is_some_and(JsonMap::is_empty)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ODD: &str = r#"{ "mve": 1, "title": "odd", "nodes": {
        "a": { "module": "NotYetWritten", "params": { "x": 1.0 }, "color": "red" },
        "b": 7 },
      "links": ["a.out -> b.in", "nonsense", 3],
      "programs": { "p": { "axes": [ { "a.x": [1, 2] } ], "note": "kept" }, "q": [] },
      "future": { "z": [1] } }"#;

    #[test]
    fn an_unchanged_map_keeps_its_bytes() {
        assert_eq!(Map::parse(ODD).unwrap().to_text(), ODD);
    }

    #[test]
    fn a_changed_map_keeps_what_it_does_not_understand() {
        let mut map = Map::parse(ODD).unwrap();
        map.title = "changed".to_owned();
        let text = map.to_text();
        let again: Json = serde_json::from_str(&text).unwrap();
        let mut expected: Json = serde_json::from_str(ODD).unwrap();
        expected["title"] = Json::from("changed");
        assert_eq!(again, expected);
        assert_eq!(Map::parse(&text).unwrap().to_text(), text);
        let (errors, warnings): (Vec<_>, Vec<_>) =
            map.problems().iter().partition(|problem| problem.is_error());
        assert_eq!((errors.len(), warnings.len()), (4, 3)); // node b, two links, program q
        let text = errors[0].to_string();
        assert!(text.starts_with("b: 7 is not an object with a \"module\""), "{text}");
    }

    #[test]
    fn keys_that_mean_nothing_are_told_of_with_their_place() {
        let map = Map::parse(
            "{\"mve\": 1, \"titel\": \"x\", \"_why\": \"a remark\",\n\
             \"nodes\": {\"a\": {\"module\": \"X\",\n  \"parms\": {\"ratio\": 0.1}}},\n\
             \"programs\": {\"p\": {\"axis\": []},\n \"q\": {\"repeat\": 5, \"color\": 3}}}",
        );
        let map = map.unwrap();
        let said: Vec<_> = map
            .problems()
            .iter()
            .map(|problem| {
                let Position { line, column } = map.position_of(problem).unwrap();
                assert_eq!(problem.is_error(), problem.message.contains("did you mean"));
                format!("{line}:{column} {problem}")
            })
            .collect();
        let error = |place: &str, key: &str, of: &str, meant: &str| {
            let what = format!("\"{key}\" means nothing in a {of}; did you mean \"{meant}\"?");
            format!("{place}{what} Begin it with _ if it is a remark")
        };
        assert_eq!(
            said,
            [
                error("1:12 ", "titel", "map", "title"),
                error("3:3 a.parms: ", "parms", "node", "params"),
                error("4:20 program \"p\": ", "axis", "program", "axes"),
                error("5:8 program \"q\": ", "repeat", "program", "repeats"),
                "5:21 program \"q\": \"color\" means nothing in a program and is left out"
                    .to_owned(),
            ]
        );
    }

    #[test]
    fn a_key_beside_the_one_that_it_is_like_is_a_warning() {
        let text = r#"{"mve": 1, "title": "t", "titles": 1, "nodes": {
            "a": {"module": "X", "params": {}, "param": {}}},
            "programs": {"p": {"axes": [], "axis": 1, "repeat": 2}}}"#;
        let map = Map::parse(text).unwrap();
        let errors =
            map.problems().iter().map(|p| (p.place.port.as_deref().unwrap(), p.is_error()));
        let expected = [("titles", false), ("param", false), ("axis", false), ("repeat", true)];
        assert_eq!(errors.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn keys_of_loops_that_mean_nothing_are_told_with_what_is_near() {
        let said = |repeat: &str| {
            let text = format!(
                "{{\"mve\": 1, \"nodes\": {{\"a\": {{\"module\": \"X\", \"repeat\": {repeat}}}}}}}"
            );
            let map = Map::parse(&text).unwrap();
            assert_eq!(map.to_text(), text, "what is not understood is kept");
            let problems: Vec<_> = map.problems().iter().map(ToString::to_string).collect();
            assert_eq!(problems.len(), 1, "{problems:?}");
            problems[0].clone()
        };
        let slip = said(r#"{"time": 3}"#);
        assert_eq!(slip, "a.repeat: \"time\" means nothing in a loop; did you mean \"times\"?");
        let far = said(r#"{"times": 3, "color": 1}"#);
        let known = "there are times, each, feed, until";
        assert_eq!(far, format!("a.repeat: \"color\" means nothing in a loop; {known}"));
        let end = said(r#"{"times": 3, "until": {"output": "rms", "bellow": 0.1}}"#);
        let meant = "did you mean \"below\"?";
        let expected = format!("a.repeat: \"bellow\" means nothing in the end of a loop; {meant}");
        assert_eq!(end, expected);
        assert!(said("3").starts_with("a.repeat: 3 is not "));
    }

    #[test]
    fn canonical_text_is_a_fixed_point() {
        let mut map = Map::parse(ODD).unwrap();
        map.source = None;
        let text = map.to_text();
        let mut again = Map::parse(&text).unwrap();
        again.source = None;
        assert_eq!(again.to_text(), text);
        assert!(text.ends_with("}\n"));
        again.layout.insert("a".to_owned(), [240.0, -0.5]);
        assert!(again.to_text().contains("\"a\": [240, -0.5]"), "{}", again.to_text());
    }

    #[test]
    fn a_newer_format_is_refused_and_a_missing_one_reported() {
        assert!(matches!(Map::parse(r#"{"mve": 2}"#), Err(MapError::Newer(2))));
        assert_eq!(Map::parse("{}").unwrap().problems().len(), 1);
        assert!(matches!(Map::parse("[]"), Err(MapError::NotJson(_))));
    }

    #[test]
    fn migrations_run_from_the_version_of_the_file() {
        let add_two: Migration = |object| drop(object.insert("two".into(), Json::Null));
        let add_three: Migration = |object| drop(object.insert("three".into(), Json::Null));
        let mut object = JsonMap::new();
        migrate(&mut object, 2, &[add_two, add_three]);
        assert_eq!(object.keys().collect::<Vec<_>>(), ["three"]);
    }

    #[test]
    fn a_bad_field_of_a_program_is_named() {
        let said = |repeats: &str| {
            let text = format!(
                r#"{{"mve": 1, "programs": {{"p": {{"steps": [], "repeats": {repeats}}}}}}}"#
            );
            Map::parse(&text).unwrap().problems()[0].to_string()
        };
        for repeats in ["-2", "1.5", "\"many\"", "[3]"] {
            let found = said(repeats);
            let repeats = format!("program \"p\": \"repeats\": {repeats} is not ");
            assert_eq!(found, repeats + "a whole number above 0");
        }
    }

    #[test]
    fn all_bad_fields_of_a_part_are_named() {
        let text = r#"{"mve": 1, "nodes": {"a": {"module": 3, "mode": "mutd", "params": []}},
            "programs": {"p": {"axes": [3], "repeats": -1, "time_limit": "1"}}}"#;
        let map = Map::parse(text).unwrap();
        let said: Vec<String> = map.problems().iter().map(|p| p.to_string()).collect();
        let starts = [
            "a.module: 3 is not the id of a module",
            "a.mode: \"mutd\" is not \"active\"",
            "a.params: [] is not an object",
            "program \"p\": axis 1: 3 is not an axis",
            "program \"p\": \"repeats\": -1 is not a whole number",
            "program \"p\": \"time_limit\": \"1\" is not a number of seconds",
        ];
        assert!(said.iter().zip(starts).all(|(said, start)| said.starts_with(start)), "{said:#?}");
        assert_eq!(said.len(), starts.len());
    }

    #[test]
    fn duplicate_names_are_reported() {
        let text = r#"{"mve": 1, "nodes": {"a": {"module": "X"}, "a": {"module": "Y"}}}"#;
        let map = Map::parse(text).unwrap();
        assert!(map.problems()[0].message.contains("\"nodes.a\" stands twice"));
    }
}
