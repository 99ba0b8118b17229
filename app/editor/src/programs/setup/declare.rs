//! What the paths of a program stand for: the declarations of parameters, and their values now.

use std::path::Path;

use mve_core::{Link, MODULE, Map, OptionSpec, ParamSpec, Registry, chosen, declared_at, given_at};
use serde_json::Value as Json;

use crate::programs::setup::generate;

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

impl Declared<'_> {
    /// What a value may name; empty where it names nothing.
    pub fn options(&self) -> Vec<OptionSpec> {
        match self {
            Self::Param(spec) => spec.options(),
            Self::Module(registry) => {
                let modules = registry.modules().iter().map(|info| info.module);
                let option = |m: &mve_core::Module| OptionSpec {
                    id: m.id,
                    summary: m.summary,
                    params: m.params,
                };
                modules.map(option).collect()
            }
            Self::Unknown => Vec::new(),
        }
    }

    /// The parameters that stand under what a value names.
    pub fn nested(&self, value: &Json) -> &'static [ParamSpec] {
        let id = chosen(value).map_or("", |(id, _)| id);
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
    let specs = registry.of(node).map(|info| info.module.params);
    let found = specs.and_then(|specs| declared_at(specs, Some(&node.params), param));
    found.map_or(Declared::Unknown, Declared::Param)
}

/// The value that a path has in the map.
pub fn current(map: &Map, registry: &Registry, path: &str) -> Json {
    let Some((node_name, param)) = path.split_once('.') else { return Json::Null };
    let Some(node) = map.nodes.get(node_name) else { return Json::Null };
    if param == MODULE {
        return Json::from(node.module.as_str());
    }
    let given = given_at(&node.params, param).cloned();
    given.unwrap_or_else(|| match declared(map, registry, path).spec() {
        Some(spec) => default_of(spec),
        // Below a parameter that is not known nothing is understood; the value stands as it is.
        None => Json::Null,
    })
}

/// What a parameter is where a map says nothing, as a file would say it; a file is not named then.
pub fn default_of(spec: &ParamSpec) -> Json {
    spec.default_json().unwrap_or_else(|| Json::from(""))
}

/// A second value worth comparing with a first: the double, the next name, another file.
pub fn second(declared: &Declared, first: &Json, map_folder: &Path) -> Json {
    let options = declared.options();
    if let Some((id, _)) = chosen(first).filter(|_| !options.is_empty()) {
        let place = options.iter().position(|option| option.id == id);
        let next = place.map_or(0, |place| (place + 1) % options.len());
        return Json::from(options[next].id);
    }
    let Some(spec) = declared.spec() else { return first.clone() };
    if spec.input_file().is_none() {
        return spec.another(first);
    }
    let text = first.as_str().unwrap_or_default();
    let folder = text.rsplit_once('/').map_or("", |(folder, _)| folder);
    let all = generate::files(map_folder, folder, &generate::pattern_of(spec));
    let other = all.unwrap_or_default().into_iter().find(|file| file != first);
    other.unwrap_or_else(|| first.clone())
}

/// All paths that a program of this map can vary, in the order of the map.
pub fn paths(map: &Map, registry: &Registry) -> Vec<String> {
    let mut all = Vec::new();
    for (name, node) in &map.nodes {
        let Some(info) = registry.of(node) else { continue };
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
    if spec.output_file().is_some() {
        return;
    }
    all.push(path.to_owned());
    let Some(choice) = spec.choice() else { return };
    let (id, inner) = given.and_then(chosen).unwrap_or((choice.default, None));
    let Some(entry) = choice.list.find(id) else { return };
    for spec in entry.params {
        let given = inner.and_then(|inner| inner.get(spec.name));
        add_paths(spec, given, &format!("{path}.{}", spec.name), all);
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
            let is_text = spec.is_text() || spec.input_file().is_some();
            assert!(is_text || first != other, "{path}: {first}");
        }
    }
}
