//! From the JSON of a file to the parts of a map: what fits, what is kept as it stands, and what is
//! said of it.

use std::str::FromStr;

use indexmap::IndexMap;
use serde::Deserialize;
use serde_json::{Map as JsonMap, Value as Json};

use super::{Link, Map, axes, words};
use crate::json::Step;
use crate::param::shown;
use crate::problem::{Problem, did_you_mean, nearest};

/// The keys that the format gives a meaning to. `canvas` is the window's.
const KEYS: [&str; 9] =
    ["mve", "title", "nodes", "links", "layout", "canvas", "programs", "parameters", "maps"];
const KEYS_OF_NODES: [&str; 4] = ["module", "mode", "repeat", "params"];
const KEYS_OF_PROGRAMS: [&str; 5] = ["axes", "steps", "repeats", "time_limit", "report"];
const KEYS_OF_LOOPS: [&str; 4] = ["times", "each", "feed", "until"];
const KEYS_OF_ENDS: [&str; 3] = ["output", "below", "above"];

/// Keys that nothing reads are kept, and told of. One that is near to a known one that is not there
/// is a slip of the pen, and what it was meant to say would not be done: nothing runs. A key that
/// begins with `_` or `$` is a remark.
fn unknown_keys(object: &JsonMap<String, Json>, known: &[&str], of: &str) -> Vec<Problem> {
    let is_unknown = |key: &&String| !known.contains(&key.as_str()) && !key.starts_with(['_', '$']);
    let absent = known.iter().copied().filter(|known| !object.contains_key(*known));
    let told = |key: &String| {
        let problem = match did_you_mean(key, absent.clone()) {
            hint if hint.is_empty() => {
                let near = nearest(key, known.iter().copied());
                let beside = near.map_or_else(String::new, |n| format!(", beside \"{n}\""));
                let message = format!("\"{key}\" means nothing in {of}{beside} and is left out");
                Problem::warning(message)
            }
            hint => Problem::error(format!(
                "\"{key}\" means nothing in {of}{hint} Begin it with _ if it is a remark"
            )),
        };
        problem.port(key)
    };
    object.keys().filter(is_unknown).map(told).collect()
}

/// What is said of the keys of a map, of its nodes and of its programs.
pub(super) fn unknown_keys_of_map(object: &JsonMap<String, Json>) -> Vec<Problem> {
    let parts = |section: &str| object.get(section).and_then(Json::as_object).into_iter().flatten();
    let mut problems = unknown_keys(object, &KEYS, "a map");
    for (name, node) in parts("nodes") {
        // One without a module is no node, which is told of elsewhere.
        let node = node.as_object().filter(|node| node.contains_key("module"));
        let unknown = node.map(|node| unknown_keys(node, &KEYS_OF_NODES, "a node"));
        problems.extend(unknown.into_iter().flatten().map(|problem| problem.at(name)));
    }
    for (name, program) in parts("programs") {
        let unknown = program.as_object();
        let unknown = unknown.map(|program| unknown_keys(program, &KEYS_OF_PROGRAMS, "a program"));
        problems.extend(unknown.into_iter().flatten().map(|problem| problem.in_program(name)));
    }
    problems
}

impl Map {
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
                ("parameters", Json::Object(parameters)) => {
                    for (name, value) in parameters {
                        self.add_part("parameters", name, value, |map| &mut map.parameters);
                    }
                }
                ("maps", Json::Object(maps)) => {
                    maps.into_iter().for_each(|(name, map)| self.add_map(name, map));
                }
                ("links", Json::Array(links)) => {
                    links.into_iter().enumerate().for_each(|(i, link)| self.add_link(i, link));
                }
                (
                    "title" | "nodes" | "layout" | "programs" | "links" | "parameters" | "maps",
                    value,
                ) => {
                    let message =
                        format!("\"{key}\" is not what the format says; see `mve schema`");
                    let place = [key.as_str().into()];
                    self.problems.push(Problem::error(message).along(place));
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
                let fields = misunderstood::<T>(&value);
                let problems = match fields.is_empty() {
                    true => vec![misfit(section, &value)],
                    false => fields.iter().map(|field| misfit_at(section, field, &value)).collect(),
                };
                self.problems.extend(problems.into_iter().map(|problem| match section {
                    "programs" => problem.in_program(&name),
                    "layout" | "parameters" => {
                        problem.at(&name).along([section.into(), name.as_str().into()])
                    }
                    _ => problem.at(&name),
                }));
                self.leftovers.push((section, name, value));
            }
        }
    }

    fn add_map(&mut self, name: String, value: Json) {
        let problem = |message: &str| {
            let path = ["maps".into(), name.as_str().into()];
            Problem::error(message).at(&name).along(path)
        };
        match value {
            Json::Object(object) if Self::can_name_a_map(&name) => {
                self.maps.insert(name, Self::inner(object));
            }
            value => {
                self.problems.push(match value.is_object() {
                    true => problem(
                        "a map in \"maps\" has a name that begins with a small letter, without \
                         spaces, slashes or dots",
                    ),
                    false => problem("is not a map: an object with \"nodes\""),
                });
                self.leftovers.push(("maps", name, value));
            }
        }
    }

    fn add_link(&mut self, place: usize, value: Json) {
        match value.as_str().map(Link::from_str) {
            Some(Ok(link)) => self.links.push(link),
            _ => {
                let message =
                    format!("link {value} is not of the form \"node.output -> node.input\"");
                let path = ["links".into(), Step::Item(place)];
                self.problems.push(Problem::error(message).along(path));
                self.leftovers.push(("links", String::new(), value));
            }
        }
    }
}

/// What is wrong with a part as a whole.
fn misfit(section: &'static str, value: &Json) -> Problem {
    let keys = value.as_object().filter(|_| section == "nodes");
    let Some(keys) = keys.map(|object| object.keys()) else {
        return Problem::error(format!(
            "{} is not {}",
            shown(value),
            words::of_form(section, None)
        ));
    };
    let meant = keys.map(String::as_str).find_map(|key| {
        let hint = did_you_mean("module", [key].into_iter());
        (!hint.is_empty()).then(|| format!("; did you mean \"module\" by \"{key}\"?"))
    });
    let meant = meant.unwrap_or_default();
    Problem::error(format!("names no \"module\", which every node does{meant}"))
}

/// What is wrong with a field of a part.
fn misfit_at(section: &'static str, field: &str, value: &Json) -> Problem {
    let (given, form) = (shown(&value[field]), words::of_form(section, Some(field)));
    match axes::misfit(&value["axes"]).filter(|_| field == "axes") {
        Some((place, path, message)) => {
            let path = path.map(|path| path.as_str().into());
            let way = ["axes".into(), Step::Item(place)].into_iter().chain(path);
            let mut problem = Problem::error(message);
            problem.place.path = Some(way.collect());
            problem
        }
        // Of a program's problem the field is not shown before the message.
        None if section == "programs" => {
            Problem::error(format!("\"{field}\": {given} is not {form}")).port(field)
        }
        None => {
            let unknown = (field == "repeat").then(|| unknown_of_loop(&value[field])).flatten();
            let message = unknown.unwrap_or_else(|| format!("{given} is not {form}"));
            Problem::error(message).port(field)
        }
    }
}

/// What is said of the first key of a loop, or of its end, that means nothing. A loop without what
/// it was meant to say would be another one, so it is none.
fn unknown_of_loop(value: &Json) -> Option<String> {
    let unknown = |value: &Json, known: &[&str], of: &str| {
        let object = value.as_object()?;
        let key = object.keys().find(|key| !known.contains(&key.as_str()))?;
        let absent = known.iter().copied().filter(|known| !object.contains_key(*known));
        let hint = match did_you_mean(key, absent) {
            hint if hint.is_empty() => format!("; there are {}", known.join(", ")),
            hint => hint,
        };
        Some(format!("\"{key}\" means nothing in {of}{hint}"))
    };
    unknown(value, &KEYS_OF_LOOPS, "a loop")
        .or_else(|| unknown(&value["until"], &KEYS_OF_ENDS, "the end of a loop"))
}

/// The fields of an object that are not understood even alone.
fn misunderstood<T: for<'de> Deserialize<'de>>(value: &Json) -> Vec<String> {
    let is_bad = |(field, value): &(&String, &Json)| {
        // A node needs a module.
        let mut alone = JsonMap::from_iter([("module".to_owned(), Json::from("Any"))]);
        alone.insert((*field).clone(), (*value).clone());
        T::deserialize(Json::Object(alone)).is_err()
    };
    let fields = value.as_object().into_iter().flatten().filter(is_bad);
    fields.map(|(field, _)| field.clone()).collect()
}
