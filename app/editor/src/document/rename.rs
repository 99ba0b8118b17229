//! New names of nodes, wherever a map says the old ones.

use std::collections::HashMap;

use indexmap::IndexMap;
use mve_core::{Link, Map, ParamSpec, ProgramSpec, Registry, all_given, declared_at, given_at_mut};
use serde_json::Value as Json;

use super::extras::Extras;

/// What stands before the name of a node in a column that times it.
const SECONDS: &str = "seconds.";

/// Old names with the new ones. All are replaced at once, so names may be swapped.
pub(super) struct Renaming(HashMap<String, String>);

impl Renaming {
    /// Names that change: the old, the new.
    pub fn new(names: impl IntoIterator<Item = (String, String)>) -> Self {
        Self(names.into_iter().filter(|(old, new)| old != new).collect())
    }

    /// What a node is called from now on.
    pub fn node(&self, name: &str) -> String {
        self.0.get(name).map_or(name, String::as_str).to_owned()
    }

    /// The link between nodes of the new names.
    pub fn link(&self, link: &Link) -> Link {
        let mut link = link.clone();
        link.from.node = self.node(&link.from.node);
        link.to.node = self.node(&link.to.node);
        link
    }

    /// Renames throughout a map.
    pub fn apply(&self, map: &mut Map, extras: &mut Extras, registry: &Registry) {
        // Modules say which parameters are names of files, so they are looked up by the old names.
        for program in map.programs.values_mut() {
            self.program(program, |path| is_template(&map.nodes, registry, path));
        }
        for node in map.nodes.values_mut() {
            let info = registry.of(node);
            let specs = info.map_or(&[][..], |info| info.module.params);
            let is_declared = |name: &String| specs.iter().any(|spec| spec.name == name);
            let unknown = node.params.keys().filter(|name| !is_declared(name)).cloned();
            let files = all_given(specs, &node.params).into_iter();
            let files = files.filter(|(_, spec, _)| spec.output_file().is_some());
            let paths: Vec<String> = unknown.chain(files.map(|(path, ..)| path)).collect();
            for path in paths {
                if let Some(value) = given_at_mut(&mut node.params, &path) {
                    self.templates(value);
                }
            }
        }
        map.nodes = self.keys(std::mem::take(&mut map.nodes));
        map.layout = self.keys(std::mem::take(&mut map.layout));
        map.links = map.links.iter().map(|link| self.link(link)).collect();
        for names in [&mut extras.collapsed, &mut extras.pictured] {
            *names = names.iter().map(|name| self.node(name)).collect();
        }
        for reroute in extras.reroutes.values_mut() {
            reroute.link = self.link(&reroute.link);
        }
    }

    fn keys<T>(&self, parts: IndexMap<String, T>) -> IndexMap<String, T> {
        parts.into_iter().map(|(name, part)| (self.node(&name), part)).collect()
    }

    fn program(&self, program: &mut ProgramSpec, is_template: impl Fn(&str) -> bool) {
        for axis in &mut program.axes {
            *axis = self.assignments(std::mem::take(axis), |path, values| {
                values.iter_mut().filter(|_| is_template(path)).for_each(|v| self.templates(v));
            });
        }
        for step in &mut program.steps {
            *step = self.assignments(std::mem::take(step), |path, value| {
                if is_template(path) {
                    self.templates(value);
                }
            });
        }
        if let Some(report) = &mut program.report {
            self.report(report);
        }
    }

    /// Values by the paths of parameters; `visit` is given the old path.
    fn assignments<T>(
        &self,
        assignments: IndexMap<String, T>,
        visit: impl Fn(&str, &mut T),
    ) -> IndexMap<String, T> {
        let renamed = assignments.into_iter().map(|(path, mut value)| {
            visit(&path, &mut value);
            (self.path(&path), value)
        });
        renamed.collect()
    }

    /// `node.param`, and whatever follows.
    fn path(&self, path: &str) -> String {
        match path.split_once('.') {
            Some((node, rest)) => format!("{}.{rest}", self.node(node)),
            None => path.to_owned(),
        }
    }

    /// A column of the table of results: `node.output` or `seconds.node`.
    fn column(&self, column: &str) -> String {
        match column.strip_prefix(SECONDS) {
            Some(node) => format!("{SECONDS}{}", self.node(node)),
            None => self.path(column),
        }
    }

    /// What a program says of its report, by the fields that [`mve_core::ReportSpec`] names.
    fn report(&self, json: &mut Json) {
        match json {
            Json::Object(fields) => {
                for (key, value) in fields.iter_mut() {
                    match (key.as_str(), value) {
                        ("column" | "against" | "measure" | "same", value) => {
                            strings(value, &|text| self.column(text));
                        }
                        ("group" | "series", value) => strings(value, &|text| self.path(text)),
                        ("compare", Json::Object(compared)) => {
                            let old = std::mem::take(compared);
                            compared.extend(old.into_iter().map(|(p, v)| (self.path(&p), v)));
                        }
                        (_, value) => self.report(value),
                    }
                }
            }
            Json::Array(items) => items.iter_mut().for_each(|item| self.report(item)),
            _ => {}
        }
    }

    /// `{node.param}` in all the texts of a value.
    fn templates(&self, json: &mut Json) {
        strings(json, &|text| self.template(text));
    }

    fn template(&self, text: &str) -> String {
        let mut renamed = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(place) = rest.find('{') {
            let (before, from) = rest.split_at(place + 1);
            renamed.push_str(before);
            rest = from;
            if let Some((node, _)) = rest.split_once('.')
                && let Some(new) = self.0.get(node)
            {
                renamed.push_str(new);
                rest = &rest[node.len()..];
            }
        }
        renamed + rest
    }
}

/// Whether the values of a parameter may name output files: those that are known to be something
/// else may not.
fn is_template(nodes: &IndexMap<String, mve_core::Node>, registry: &Registry, path: &str) -> bool {
    let spec = || -> Option<ParamSpec> {
        let (node, param) = path.split_once('.')?;
        let node = nodes.get(node)?;
        declared_at(registry.of(node)?.module.params, Some(&node.params), param)
    };
    spec().is_none_or(|spec| spec.output_file().is_some())
}

/// Changes every text of a value.
fn strings(json: &mut Json, change: &dyn Fn(&str) -> String) {
    match json {
        Json::String(text) => *text = change(text),
        Json::Array(items) => items.iter_mut().for_each(|item| strings(item, change)),
        Json::Object(fields) => fields.values_mut().for_each(|value| strings(value, change)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_templates_are_whole_words() {
        let renaming = Renaming::new([("a".to_owned(), "b".to_owned()), ("b".into(), "a".into())]);
        assert_eq!(
            renaming.template("{a.x}-a.x-{ab.x}{b.y.stem}{step}"),
            "{b.x}-a.x-{ab.x}{a.y.stem}{step}"
        );
        assert_eq!(renaming.template("{a"), "{a");
        assert_eq!(renaming.column("seconds.a"), "seconds.b");
        assert_eq!(renaming.column("seconds"), "seconds");
        assert_eq!(renaming.column("a.rms"), "b.rms");
    }
}
