//! From the JSON of a file to the parts of a map: what fits, what is kept as it stands, and what is
//! said of it.

use std::str::FromStr;

use indexmap::IndexMap;
use serde::Deserialize;
use serde_json::{Map as JsonMap, Value as Json};

use super::{Link, Map, words};
use crate::param::shown;
use crate::problem::{Problem, did_you_mean};

/// The keys that the format gives a meaning to. `canvas` is the window's.
const KEYS: [&str; 7] = ["mve", "title", "nodes", "links", "layout", "canvas", "programs"];
const KEYS_OF_NODES: [&str; 3] = ["module", "mode", "params"];
const KEYS_OF_PROGRAMS: [&str; 5] = ["axes", "steps", "repeats", "time_limit", "report"];

impl Map {
    /// Keys that nothing reads are kept, and told of. One that is near to a known one is a slip of
    /// the pen, and what it was meant to say would not be done: nothing runs. A key that begins
    /// with `_` or `$` is a remark.
    pub(super) fn tell_of_unknown_keys(&mut self) {
        let unknown = |key: &str, known: &[&str], of: &str| {
            let is_remark = key.starts_with(['_', '$']);
            let problem = match did_you_mean(key, known.iter().copied()) {
                hint if hint.is_empty() => {
                    Problem::warning(format!("\"{key}\" means nothing in {of} and is left out"))
                }
                hint => Problem::error(format!(
                    "\"{key}\" means nothing in {of}{hint} Begin it with _ if it is a remark"
                )),
            };
            (!is_remark).then(|| problem.port(key))
        };
        let root = self.extra.keys().filter(|key| !KEYS.contains(&key.as_str()));
        let mut warnings: Vec<_> = root.filter_map(|key| unknown(key, &KEYS, "a map")).collect();
        for (name, node) in &self.nodes {
            let keys = node.extra.keys().filter_map(|key| unknown(key, &KEYS_OF_NODES, "a node"));
            warnings.extend(keys.map(|problem| problem.at(name)));
        }
        for (name, program) in &self.programs {
            let keys = program.extra.keys();
            let keys = keys.filter_map(|key| unknown(key, &KEYS_OF_PROGRAMS, "a program"));
            warnings.extend(keys.map(|problem| problem.in_program(name)));
        }
        self.problems.append(&mut warnings);
    }

    pub(super) fn fill(&mut self, object: JsonMap<String, Json>) {
        for (key, value) in object {
            match (key.as_str(), value) {
                ("title", Json::String(title)) => self.title = title,
                ("nodes", Json::Object(nodes)) => {
                    for (name, value) in nodes {
                        self.add_part("nodes", name, value, |map| &mut map.nodes);
                    }
                }
                ("layout", Json::Object(layout)) => {
                    for (name, value) in layout {
                        self.add_part("layout", name, value, |map| &mut map.layout);
                    }
                }
                ("programs", Json::Object(programs)) => {
                    for (name, value) in programs {
                        self.add_part("programs", name, value, |map| &mut map.programs);
                    }
                }
                ("links", Json::Array(links)) => links.into_iter().for_each(|l| self.add_link(l)),
                ("title" | "nodes" | "layout" | "programs" | "links", value) => {
                    let message =
                        format!("\"{key}\" is not what the format says; see `mve schema`");
                    self.problems.push(Problem::error(message));
                    self.leftovers.push(("", key, value));
                }
                (_, value) => {
                    self.extra.insert(key, value);
                }
            }
        }
    }

    fn add_part<T: for<'de> Deserialize<'de>>(
        &mut self,
        section: &'static str,
        name: String,
        value: Json,
        target: fn(&mut Self) -> &mut IndexMap<String, T>,
    ) {
        match T::deserialize(&value) {
            Ok(part) => {
                target(self).insert(name, part);
            }
            Err(_) => {
                let field = misunderstood::<T>(&value);
                let form = words::of_form(section, field);
                let given = field.and_then(|field| value.get(field)).unwrap_or(&value);
                let given = shown(given);
                let problem = match field {
                    // Of a program's problem the field is not shown before the message.
                    Some(field) if section == "programs" => {
                        Problem::error(format!("\"{field}\": {given} is not {form}")).port(field)
                    }
                    Some(field) => Problem::error(format!("{given} is not {form}")).port(field),
                    None if section == "nodes" && value.is_object() => {
                        let keys = value.as_object().into_iter().flatten();
                        let meant = keys.map(|(key, _)| key.as_str()).find_map(|key| {
                            let hint = did_you_mean("module", [key].into_iter());
                            (!hint.is_empty()).then(|| format!("; is \"{key}\" meant?"))
                        });
                        let meant = meant.unwrap_or_default();
                        Problem::error(format!("says no \"module\", which a node is{meant}"))
                    }
                    None => Problem::error(format!("{given} is not {form}")),
                };
                self.problems.push(match section {
                    "programs" => problem.in_program(&name),
                    _ => problem.at(&name),
                });
                self.leftovers.push((section, name, value));
            }
        }
    }

    fn add_link(&mut self, value: Json) {
        match value.as_str().map(Link::from_str) {
            Some(Ok(link)) => self.links.push(link),
            _ => {
                let message =
                    format!("link {value} is not of the form \"node.output -> node.input\"");
                self.problems.push(Problem::error(message));
                self.leftovers.push(("links", String::new(), value));
            }
        }
    }
}

/// The first field of an object that is not understood even alone.
fn misunderstood<T: for<'de> Deserialize<'de>>(value: &Json) -> Option<&str> {
    let is_bad = |(field, value): &(&String, &Json)| {
        // A node needs a module.
        let mut alone = JsonMap::from_iter([("module".to_owned(), Json::from("Any"))]);
        alone.insert((*field).clone(), (*value).clone());
        T::deserialize(Json::Object(alone)).is_err()
    };
    value.as_object()?.iter().find(is_bad).map(|(field, _)| field.as_str())
}
