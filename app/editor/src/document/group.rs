//! Nodes that become a map of their own, and a map that becomes nodes again.

use std::collections::HashMap;

use indexmap::IndexMap;
use mve_core::{Link, MAP_INPUT, MAP_OUTPUT, Map, Node, PortRef, Promoted, assign};
use serde_json::{Map as JsonMap, Value as Json};

use super::edit::{Edit, EditError};
use super::item::Item;
use super::names::free_name;
use super::rename::Renaming;
use super::transaction::{Transaction, check_name, offset, places_of_others};

/// How far from the nodes inside those stand by which values come and go.
const ASIDE: f64 = 280.0;
const BELOW: f64 = 90.0;

fn port(node: &str, port: &str) -> PortRef {
    PortRef { node: node.to_owned(), port: port.to_owned() }
}

/// A node by which values come into a map or leave it, for the port of this name.
fn end(module: &str, own: &str, name: &str) -> Node {
    let params = match own == name {
        true => JsonMap::new(),
        false => JsonMap::from_iter([("name".to_owned(), Json::from(name))]),
    };
    Node { module: module.to_owned(), params, ..Node::default() }
}

impl Transaction<'_> {
    /// Does an edit of the maps of this file.
    pub fn edit_maps(&mut self, edit: &Edit) -> Result<(), EditError> {
        match edit {
            Edit::MakeMap { nodes, name } => self.make_map(nodes, name.as_deref()),
            Edit::Unpack { node } => self.unpack(node),
            Edit::SetMap { name, .. } if !Map::can_name_a_map(name) => {
                Err(EditError::name(name, "the name of a map begins with a small letter"))
            }
            Edit::SetMap { name, map } => {
                self.map.maps.insert(name.clone(), (**map).clone());
                Ok(())
            }
            _ => Err(EditError::WrongKind("this is no edit of a map of this file")),
        }
    }

    /// Puts nodes into a map of their own, and a node for it in their place. Values that came from
    /// outside come in by its inputs; parameters that programs vary become its own.
    pub fn make_map(&mut self, nodes: &[String], name: Option<&str>) -> Result<(), EditError> {
        for node in nodes {
            self.node(node)?;
        }
        let stem = name.unwrap_or("group");
        check_name(stem)?;
        let name = free_name(stem, |name| {
            self.map.maps.contains_key(name) || self.map.nodes.contains_key(name)
        });
        if !Map::can_name_a_map(&name) {
            return Err(EditError::name(&name, "the name of a map begins with a small letter"));
        }
        let mut inner = Map::default();
        for node in nodes {
            let moved = self.map.nodes.shift_remove(node);
            inner.nodes.extend(moved.map(|moved| (node.clone(), moved)));
            let at = self.map.layout.shift_remove(node);
            inner.layout.extend(at.map(|at| (node.clone(), at)));
        }
        let places: Vec<[f64; 2]> = inner.layout.values().copied().collect();
        let middle =
            |k: usize| places.iter().map(|at| at[k]).sum::<f64>() / places.len().max(1) as f64;
        let at = offset([middle(0), middle(1)], [0.0, 0.0])?;
        let links = std::mem::take(&mut self.map.links);
        let is_inside = |end: &PortRef| inner.nodes.contains_key(&end.node);
        let (touching, others): (Vec<Link>, Vec<Link>) =
            links.into_iter().partition(|link| is_inside(&link.from) || is_inside(&link.to));
        self.map.links = others;
        self.extras.reroutes.retain(|_, reroute| !touching.contains(&reroute.link));
        self.extras.collapsed.retain(|node| !nodes.contains(node));
        self.extras.pictured.retain(|node| !nodes.contains(node));
        self.join_outside(&mut inner, touching, &name);
        self.promote(&mut inner, &name);
        let inside = nodes.iter().map(|node| (node.clone(), format!("{name}/{node}")));
        Renaming::new(inside).apply(&mut self.map, &mut self.extras, self.registry);
        self.map.maps.insert(name.clone(), inner);
        let node = Node { module: name.clone(), ..Node::default() };
        self.map.nodes.insert(name.clone(), node);
        self.map.layout.insert(name.clone(), at);
        self.applied.new_items.push(Item::Node(name));
        Ok(())
    }

    /// Turns the links of what has moved into those inside of the inner map and those of its node.
    fn join_outside(&mut self, inner: &mut Map, links: Vec<Link>, name: &str) {
        let mut ends: HashMap<PortRef, String> = HashMap::new();
        let mut outputs: HashMap<PortRef, String> = HashMap::new();
        let all = |k: usize, inner: &Map| inner.layout.values().map(|at| at[k]).collect::<Vec<_>>();
        let (xs, ys) = (all(0, inner), all(1, inner));
        let left = xs.iter().copied().fold(f64::INFINITY, f64::min) - ASIDE;
        let right = xs.iter().copied().fold(f64::NEG_INFINITY, f64::max) + ASIDE;
        let top = ys.iter().copied().fold(f64::INFINITY, f64::min);
        for link in links {
            let is_inside = |end: &PortRef| inner.nodes.contains_key(&end.node);
            match (is_inside(&link.from), is_inside(&link.to)) {
                (true, true) => inner.links.push(link),
                (false, _) => {
                    let known = ends.get(&link.from).cloned();
                    let own = known.unwrap_or_else(|| {
                        let own = free_name(&link.to.port, |name| inner.nodes.contains_key(name));
                        let input = end(MAP_INPUT.id, &own, &own);
                        let at = [left, top + BELOW * ends.len() as f64];
                        inner.nodes.insert(own.clone(), input);
                        inner.layout.insert(own.clone(), at);
                        self.map.links.push(Link { from: link.from.clone(), to: port(name, &own) });
                        ends.insert(link.from.clone(), own.clone());
                        own
                    });
                    inner.links.push(Link { from: port(&own, "value"), to: link.to });
                }
                (true, false) => {
                    let known = outputs.get(&link.from).cloned();
                    let outside = known.unwrap_or_else(|| {
                        let outside = free_name(&link.from.port, |name| {
                            outputs.values().any(|taken| taken == name)
                        });
                        let own = free_name(&outside, |name| inner.nodes.contains_key(name));
                        let at = [right, top + BELOW * outputs.len() as f64];
                        inner.nodes.insert(own.clone(), end(MAP_OUTPUT.id, &own, &outside));
                        inner.layout.insert(own.clone(), at);
                        let from = link.from.clone();
                        inner.links.push(Link { from, to: port(&own, "value") });
                        outputs.insert(link.from.clone(), outside.clone());
                        outside
                    });
                    self.map.links.push(Link { from: port(name, &outside), to: link.to });
                }
            }
        }
    }

    /// Makes parameters that programs vary known to the outside, and has the programs vary those.
    fn promote(&mut self, inner: &mut Map, name: &str) {
        let mut promoted: IndexMap<String, String> = IndexMap::new();
        let mut renamed = |path: &str| {
            let (node, param) = path.split_once('.')?;
            if !inner.nodes.contains_key(node) {
                return None;
            }
            let known = promoted.iter().find(|(_, known)| *known == path);
            let own = known.map(|(own, _)| own.clone()).unwrap_or_else(|| {
                let last = param.rsplit('.').next().unwrap_or(param);
                let own = free_name(last, |name| {
                    promoted.contains_key(name) || inner.nodes.contains_key(name)
                });
                promoted.insert(own.clone(), path.to_owned());
                own
            });
            Some(format!("{name}.{own}"))
        };
        for program in self.map.programs.values_mut() {
            for axis in &mut program.axes {
                let old = std::mem::take(axis);
                axis.extend(old.into_iter().map(|(path, v)| (renamed(&path).unwrap_or(path), v)));
            }
            for step in &mut program.steps {
                let old = std::mem::take(step);
                step.extend(old.into_iter().map(|(path, v)| (renamed(&path).unwrap_or(path), v)));
            }
        }
        let promoted = promoted.into_iter().map(|(own, path)| (own, Promoted::One(path)));
        inner.parameters.extend(promoted);
    }

    /// Puts the nodes of a map of this file in the place of a node that stands for it.
    pub fn unpack(&mut self, name: &str) -> Result<(), EditError> {
        let node = self.node(name)?.clone();
        let Some(mut inner) = self.map.maps.get(&node.module).cloned() else {
            let why = "only a map of this file can be unpacked; open that of another file";
            return Err(EditError::WrongKind(why));
        };
        if node.repeat.is_some() {
            return Err(EditError::WrongKind("a loop has no one round to unpack"));
        }
        let registry = self.registry.with_maps_of(&inner, std::path::Path::new(""));
        for (param, value) in &node.params {
            let paths = inner.parameters.get(param).map_or(&[][..], Promoted::paths).to_vec();
            for path in paths {
                assign(&mut inner, &registry, &path, value.clone())
                    .map_err(|problem| EditError::Param(problem.to_string()))?;
            }
        }
        let at = self.map.layout.get(name).copied().unwrap_or_default();
        let places = places_of_others(&inner, self.sizes);
        inner.layout.extend(places);
        let is_end = |node: &Node| [MAP_INPUT.id, MAP_OUTPUT.id].contains(&node.module.as_str());
        let mut names: HashMap<String, String> = HashMap::new();
        for own in inner.nodes.iter().filter(|(_, node)| !is_end(node)).map(|(own, _)| own) {
            let free = free_name(own, |free| {
                let is_new = names.values().any(|taken| taken == free);
                is_new || (free != name && self.map.nodes.contains_key(free))
            });
            names.insert(own.clone(), free);
        }
        Renaming::new(names.clone()).apply(&mut inner, &mut Default::default(), &registry);
        let origin = [0, 1].map(|k| {
            let all = inner.nodes.iter().filter(|(_, node)| !is_end(node));
            let all = all.filter_map(|(own, _)| inner.layout.get(own)).map(|at| at[k]);
            let least = all.fold(f64::INFINITY, f64::min);
            if least.is_finite() { least } else { 0.0 }
        });
        let (links, others): (Vec<Link>, Vec<Link>) = std::mem::take(&mut self.map.links)
            .into_iter()
            .partition(|link| link.from.node == name || link.to.node == name);
        self.map.links = others;
        self.extras.reroutes.retain(|_, reroute| !links.contains(&reroute.link));
        self.map.nodes.shift_remove(name);
        self.map.layout.shift_remove(name);
        let all = unpacked_links(&inner, &links, name);
        for (own, node) in inner.nodes.into_iter().filter(|(_, node)| !is_end(node)) {
            let place = inner.layout.get(&own).copied().unwrap_or(origin);
            let place = offset(place, [at[0] - origin[0], at[1] - origin[1]])?;
            self.map.layout.insert(own.clone(), place);
            self.map.nodes.insert(own.clone(), node);
            self.applied.new_items.push(Item::Node(own));
        }
        self.map.links.extend(all);
        // What programs vary, and what reports quote, has its place of before.
        self.vary_inside(name, &inner.parameters, &names);
        let inside = names.iter().map(|(own, new)| (format!("{name}/{own}"), new.clone()));
        Renaming::new(inside).apply(&mut self.map, &mut self.extras, self.registry);
        if !self.map.nodes.values().any(|other| other.module == node.module) {
            self.map.maps.shift_remove(&node.module);
        }
        Ok(())
    }

    /// Has programs vary the parameters of nodes that a map made known before.
    fn vary_inside(
        &mut self,
        name: &str,
        parameters: &IndexMap<String, Promoted>,
        names: &HashMap<String, String>,
    ) {
        let renamed = |path: String| {
            let of_map = path.strip_prefix(name).and_then(|rest| rest.strip_prefix('.'));
            let promoted = of_map.and_then(|param| parameters.get(param)?.paths().first());
            let inside = promoted.and_then(|path| path.split_once('.'));
            match inside {
                Some((node, param)) => {
                    format!("{}.{param}", names.get(node).map_or(node, String::as_str))
                }
                None => path,
            }
        };
        for program in self.map.programs.values_mut() {
            for axis in &mut program.axes {
                let old = std::mem::take(axis);
                axis.extend(old.into_iter().map(|(path, values)| (renamed(path), values)));
            }
            for step in &mut program.steps {
                let old = std::mem::take(step);
                step.extend(old.into_iter().map(|(path, value)| (renamed(path), value)));
            }
        }
    }
}

/// The links of the nodes of a map once they stand in the map around it: those inside, and those
/// of its node to what takes or gives their values inside.
fn unpacked_links(inner: &Map, links: &[Link], name: &str) -> Vec<Link> {
    let outside = |own: &str, node: &Node| {
        let given = node.params.get("name").and_then(Json::as_str).filter(|name| !name.is_empty());
        given.unwrap_or(own).to_owned()
    };
    let module = |end: &PortRef| inner.nodes.get(&end.node).map_or("", |node| &*node.module);
    // What gives the value of an output inside; from outside where it comes in.
    let source = |from: &PortRef| {
        let mut from = from.clone();
        for _ in 0..=inner.nodes.len() {
            if module(&from) != MAP_INPUT.id {
                return Some(from);
            }
            let own = outside(&from.node, &inner.nodes[&from.node]);
            let given = links.iter().find(|link| link.to.node == name && link.to.port == own);
            if let Some(link) = given {
                return Some(link.from.clone());
            }
            let default = inner.links.iter().find(|link| link.to.node == from.node)?;
            from = default.from.clone();
        }
        None
    };
    let mut all = Vec::new();
    for link in &inner.links {
        if module(&link.to) != MAP_INPUT.id && module(&link.to) != MAP_OUTPUT.id {
            all.extend(source(&link.from).map(|from| Link { from, to: link.to.clone() }));
        }
    }
    for link in links.iter().filter(|link| link.from.node == name) {
        let end = inner.nodes.iter().find(|(own, node)| {
            node.module == MAP_OUTPUT.id && outside(own, node) == link.from.port
        });
        let given = end.and_then(|(own, _)| inner.links.iter().find(|link| link.to.node == *own));
        let from = given.and_then(|given| source(&given.from));
        all.extend(from.map(|from| Link { from, to: link.to.clone() }));
    }
    // A number may come to several parameters of the inside by one link.
    for link in links.iter().filter(|link| link.to.node == name) {
        let promoted = inner.parameters.get(&link.to.port).map_or(&[][..], Promoted::paths);
        let to = promoted.iter().filter_map(|path| path.split_once('.'));
        let to = to.filter(|(_, param)| !param.contains('.'));
        all.extend(to.map(|(node, param)| Link { from: link.from.clone(), to: port(node, param) }));
    }
    all
}
