//! What the paths of a program stand for: the declarations of parameters, and their values now.

use std::path::Path;

use mve_core::{Kind, Link, Map, ParamSpec, Registry};
use serde_json::{Map as JsonMap, Value as Json};

use crate::programs::setup::generate;

/// What stands for a node's module among its parameters.
const MODULE: &str = "module";

/// What a path may be set to.
#[derive(Clone, Copy)]
pub enum Declared<'a> {
    /// A parameter's values.
    Param(ParamSpec),
    /// Any module, with its parameters.
    Module(&'a Registry),
    /// Nothing that is known here: values are shown as they stand.
    Unknown,
}

/// An entry of a choice, or a module: what a value of several parts may name.
#[derive(Clone, Copy)]
pub struct Named {
    /// Its id.
    pub id: &'static str,
    /// What it is.
    pub summary: &'static str,
    /// Its own parameters.
    pub params: &'static [ParamSpec],
}

impl Declared<'_> {
    /// What a value may name; empty where it names nothing.
    pub fn options(&self) -> Vec<Named> {
        match self {
            Self::Param(ParamSpec { kind: Kind::Choice { list, .. }, .. }) => (0..list.len())
                .map(|place| list.spec(place))
                .map(|entry| Named { id: entry.id, summary: entry.summary, params: entry.params })
                .collect(),
            Self::Param(ParamSpec { kind: Kind::Enumeration { names, .. }, .. }) => {
                let option = |&(id, summary)| Named { id, summary, params: &[] };
                names.iter().map(option).collect()
            }
            Self::Module(registry) => {
                let modules = registry.modules().iter().map(|info| info.module);
                modules.map(|m| Named { id: m.id, summary: m.summary, params: m.params }).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The parameters that stand under what a value names.
    pub fn nested(&self, value: &Json) -> &'static [ParamSpec] {
        let id = chosen_id(value).unwrap_or_default();
        self.options().iter().find(|option| option.id == id).map_or(&[], |option| option.params)
    }

    /// The declaration, where there is one.
    pub fn spec(&self) -> Option<&ParamSpec> {
        match self {
            Self::Param(spec) => Some(spec),
            _ => None,
        }
    }
}

/// What a path of a program stands for.
pub fn declared<'a>(map: &Map, registry: &'a Registry, path: &str) -> Declared<'a> {
    let Some((node, param)) = path.split_once('.') else { return Declared::Unknown };
    if param == MODULE {
        return Declared::Module(registry);
    }
    let Some(node) = map.nodes.get(node) else { return Declared::Unknown };
    let specs = registry.find(&node.module).map(|info| info.module.params);
    let found = specs.and_then(|specs| find(specs, Some(&node.params), param));
    found.map_or(Declared::Unknown, Declared::Param)
}

/// The declaration at a dotted path below some parameters.
fn find(
    specs: &'static [ParamSpec],
    given: Option<&JsonMap<String, Json>>,
    path: &str,
) -> Option<ParamSpec> {
    let (name, nested) = path.split_once('.').map_or((path, None), |(n, rest)| (n, Some(rest)));
    let spec = specs.iter().find(|spec| spec.name == name)?;
    let Some(nested) = nested else { return Some(*spec) };
    let Kind::Choice { default, list } = spec.kind else { return None };
    let value = given.and_then(|given| given.get(name));
    let id = value.and_then(chosen_id).unwrap_or(default);
    let inner = value.and_then(|value| value.get(id)).and_then(Json::as_object);
    let of_map = list.find(id).and_then(|entry| find(entry.params, inner, nested));
    // The program may choose another entry than the map does.
    of_map.or_else(|| (0..list.len()).find_map(|place| find(list.spec(place).params, None, nested)))
}

/// The value that a path has in the map.
pub fn current(map: &Map, registry: &Registry, path: &str) -> Json {
    let Some((node_name, param)) = path.split_once('.') else { return Json::Null };
    let Some(node) = map.nodes.get(node_name) else { return Json::Null };
    if param == MODULE {
        return Json::from(node.module.as_str());
    }
    let mut given = Some(&node.params);
    let mut value = None;
    for name in param.split('.') {
        value = given.and_then(|given| given.get(name));
        let inner = value.and_then(|value| value.get(chosen_id(value)?));
        given = inner.and_then(Json::as_object);
    }
    let spec = declared(map, registry, path);
    value.cloned().or_else(|| spec.spec().map(default_of)).unwrap_or_default()
}

/// What a parameter is where a map says nothing, as a file would say it.
pub fn default_of(spec: &ParamSpec) -> Json {
    match spec.kind {
        Kind::Flag { default } => Json::from(default),
        Kind::Integer { default, .. } => default.map_or(Json::Null, Json::from),
        Kind::Number { default, .. } => default.map_or(Json::Null, Json::from),
        Kind::Seed { default } => Json::from(default),
        Kind::Text { default }
        | Kind::Enumeration { default, .. }
        | Kind::Choice { default, .. } => Json::from(default),
        Kind::InputFile { .. } | Kind::OutputFile { .. } => Json::from(""),
    }
}

/// A number for a parameter that was off.
pub fn some_number(spec: &ParamSpec) -> Json {
    match spec.kind {
        Kind::Integer { default, hard, soft } => {
            let (from, to) = soft.unwrap_or((hard.0.max(1), hard.1.min(1000)));
            Json::from(default.unwrap_or(from + (to - from) / 2))
        }
        Kind::Number { default, hard, soft } => {
            let (from, to) = soft.unwrap_or((hard.0.max(0.0), hard.1.min(1.0)));
            Json::from(default.unwrap_or(from + (to - from) / 2.0))
        }
        _ => default_of(spec),
    }
}

/// A second value worth comparing with a first: the double, the next name, another file.
pub fn second(declared: &Declared, first: &Json, map_folder: &Path) -> Json {
    let options = declared.options();
    if let Some(id) = chosen_id(first).filter(|_| !options.is_empty()) {
        let place = options.iter().position(|option| option.id == id);
        let next = place.map_or(0, |place| (place + 1) % options.len());
        return Json::from(options[next].id);
    }
    let Some(spec) = declared.spec() else { return first.clone() };
    match (spec.kind, first) {
        (Kind::Integer { .. } | Kind::Number { .. }, Json::Null) => some_number(spec),
        (Kind::Flag { .. }, _) => Json::from(!first.as_bool().unwrap_or_default()),
        (Kind::Integer { hard, .. }, _) => {
            let number = first.as_i64().unwrap_or_default();
            let double = if number == 0 { 1 } else { number.saturating_mul(2) };
            let is_allowed = (hard.0..=hard.1).contains(&double);
            Json::from(if is_allowed { double } else { (number / 2).clamp(hard.0, hard.1) })
        }
        (Kind::Number { hard, .. }, _) => {
            let number = first.as_f64().unwrap_or_default();
            let double = if number == 0.0 { 1.0 } else { number * 2.0 };
            let is_allowed = (hard.0..=hard.1).contains(&double);
            Json::from(if is_allowed { double } else { (number / 2.0).clamp(hard.0, hard.1) })
        }
        (Kind::Seed { .. }, _) => Json::from(first.as_u64().unwrap_or_default() + 1),
        (Kind::InputFile { .. }, _) => {
            let text = first.as_str().unwrap_or_default();
            let folder = text.rsplit_once('/').map_or("", |(folder, _)| folder);
            let all = generate::files(map_folder, folder, &generate::pattern_of(spec));
            let other = all.unwrap_or_default().into_iter().find(|file| file != first);
            other.unwrap_or_else(|| first.clone())
        }
        _ => first.clone(),
    }
}

/// All paths that a program of this map can vary, in the order of the map.
pub fn paths(map: &Map, registry: &Registry) -> Vec<String> {
    let mut all = Vec::new();
    for (name, node) in &map.nodes {
        let Some(info) = registry.find(&node.module) else { continue };
        let is_linked = |param: &str| {
            let ends_here = |link: &Link| link.to.node == *name && link.to.port == param;
            map.links.iter().any(ends_here)
        };
        for spec in info.module.params.iter().filter(|spec| !is_linked(spec.name)) {
            add_paths(spec, node.params.get(spec.name), &format!("{name}.{}", spec.name), &mut all);
        }
    }
    all
}

fn add_paths(spec: &ParamSpec, given: Option<&Json>, path: &str, all: &mut Vec<String>) {
    if matches!(spec.kind, Kind::OutputFile { .. }) {
        return;
    }
    all.push(path.to_owned());
    let Kind::Choice { default, list } = spec.kind else { return };
    let id = given.and_then(chosen_id).unwrap_or(default);
    let Some(entry) = list.find(id) else { return };
    for spec in entry.params {
        let given = given.and_then(|given| given.get(id)).and_then(|inner| inner.get(spec.name));
        add_paths(spec, given, &format!("{path}.{}", spec.name), all);
    }
}

/// The id in the JSON of a choice or a module.
pub fn chosen_id(json: &Json) -> Option<&str> {
    match json {
        Json::String(id) => Some(id),
        Json::Object(object) if object.len() == 1 => object.keys().next().map(String::as_str),
        _ => None,
    }
}

/// A choice's JSON with one parameter of its entry set, or left to its default.
pub fn with_nested(choice: &Json, name: &str, value: Option<Json>) -> Json {
    let Some(id) = chosen_id(choice) else { return choice.clone() };
    let mut params = choice.get(id).and_then(Json::as_object).cloned().unwrap_or_default();
    match value {
        Some(value) => drop(params.insert(name.to_owned(), value)),
        None => drop(params.shift_remove(name)),
    }
    match params.is_empty() {
        true => Json::from(id),
        false => Json::Object(JsonMap::from_iter([(id.to_owned(), Json::Object(params))])),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn map() -> Map {
        let text = json!({
            "mve": 1,
            "nodes": {
                "make": {"module": "Box", "params": {"segments": 8}},
                "cut": {
                    "module": "Simplificator",
                    "params": {"cost": {"Quadric": {"boundary_weight": 3.0}}},
                },
                "odd": {"module": "NoSuchModule", "params": {"x": [1]}},
            },
            "links": ["make.mesh -> cut.mesh"],
        });
        Map::parse(&text.to_string()).unwrap()
    }

    #[test]
    fn values_come_from_the_map_or_the_declaration() {
        let (map, registry) = (map(), mve_modules::registry());
        let value = |path: &str| current(&map, &registry, path);
        assert_eq!(value("make.segments"), json!(8));
        assert_eq!(value("make.size_x"), json!(1.0));
        assert_eq!(value("cut.cost"), json!({"Quadric": {"boundary_weight": 3.0}}));
        assert_eq!(value("cut.cost.boundary_weight"), json!(3.0));
        assert_eq!(value("make.module"), json!("Box"));
        assert_eq!(value("odd.x"), json!([1]));
        assert_eq!(value("nowhere.x"), json!(null));
    }

    #[test]
    fn every_path_that_is_offered_is_declared() {
        let (map, registry) = (map(), mve_modules::registry());
        let all = paths(&map, &registry);
        assert!(all.contains(&"cut.cost.boundary_weight".to_owned()), "{all:?}");
        for path in &all {
            let found = declared(&map, &registry, path);
            let spec = found.spec().unwrap_or_else(|| panic!("{path}"));
            let first = current(&map, &registry, path);
            let other = second(&found, &first, Path::new("."));
            let is_text = matches!(spec.kind, Kind::Text { .. } | Kind::InputFile { .. });
            assert!(is_text || first != other, "{path}: {first}");
        }
    }

    #[test]
    fn nested_parameters_leave_no_empty_objects() {
        let set = with_nested(&json!("A"), "x", Some(json!(1)));
        assert_eq!(set, json!({"A": {"x": 1}}));
        assert_eq!(with_nested(&set, "x", None), json!("A"));
    }
}
