//! A map with all maps that it names put in their places: nodes of modules alone.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::ends::{DEFAULT, INSIDE, MAP_INPUT, MAP_OUTPUT};
use super::interface::{port_name, stand_in};
use super::level::Level;
use super::paths;
use crate::map::{Link, Map, Node, NodeMode, PortRef, Until};
use crate::module::Module;
use crate::plan::opened::Opened;
use crate::plan::{Inputs, assign, no_such_input, nothing_linked, without_inactive};
use crate::problem::Problem;
use crate::registry::{ModuleInfo, OpenMap, Registry};

/// The most nodes that opening gives; it stops a slip in a loop from filling the memory.
pub(super) const MOST_NODES: usize = 100_000;

/// Where a value goes that comes to a port of a map.
#[derive(Clone)]
pub(super) enum Supply {
    /// It is what a node `MapInput` gives inside.
    Inside(PortRef),
    /// It goes to a node of a module.
    Link(PortRef),
}

/// What is known while maps are being opened.
pub(super) struct Opener<'p> {
    pub opened: Opened,
    registry: &'p Registry,
    /// Where the outermost map is.
    pub map_folder: &'p Path,
    pub problems: &'p mut Vec<Problem>,
    /// What an output is really given by.
    pub aliases: HashMap<PortRef, PortRef>,
    /// What it is given by where nothing else says so.
    defaults: HashMap<PortRef, PortRef>,
    /// Outputs of loops that give a value a round.
    pub lists: HashMap<PortRef, Vec<PortRef>>,
    /// Where values go that come to ports of maps and loops.
    pub supplies: HashMap<PortRef, Vec<Supply>>,
    /// Links by whole names, before it is known what gives their values.
    pub links: Vec<Link>,
    /// Whether it was told that there are too many nodes.
    is_told: bool,
}

pub(super) fn port(node: &str, port: &str) -> PortRef {
    PortRef { node: node.to_owned(), port: port.to_owned() }
}

/// Opens a map; `None` where there is nothing to open. `map` is without the nodes that do not run,
/// `registry` knows the maps that it names.
pub(crate) fn open(
    map: &Map,
    registry: &Registry,
    folder: &Path,
    problems: &mut Vec<Problem>,
) -> Option<Opened> {
    if !map.has_maps() {
        return None;
    }
    let opened = Opened { map: map.emptied(), made: HashMap::new(), gates: Vec::new() };
    let mut opener = Opener {
        opened,
        registry,
        map_folder: folder,
        problems,
        aliases: HashMap::new(),
        defaults: HashMap::new(),
        lists: HashMap::new(),
        supplies: HashMap::new(),
        links: Vec::new(),
        is_told: false,
    };
    let (prefix, folder) = (String::new(), PathBuf::new());
    let (given, gates) = (HashSet::new(), Vec::new());
    opener.level(&Level { map, registry, prefix, folder, given, gates });
    opener.join();
    Some(opener.opened)
}

impl Opener<'_> {
    /// Puts the nodes of a map in, and notes its links.
    fn level(&mut self, level: &Level) {
        for (name, node) in &level.map.nodes {
            if self.is_full(name) {
                return;
            }
            let full = format!("{}{name}", level.prefix);
            let is_end = [MAP_INPUT.id, MAP_OUTPUT.id].contains(&node.module.as_str());
            if is_end && !level.prefix.is_empty() {
                continue;
            }
            let params = paths::from_outside(level, name, node);
            let mut node = Node { params, ..node.clone() };
            let info = level.registry.of(&node).filter(|_| node.repeat.is_some() || node.is_map());
            let Some(info) = info else {
                self.put(full, node, None, &level.gates);
                continue;
            };
            if self.lacks_input(level, name, info.module) {
                self.put_stand_in(&full, &node, info.module, level);
                continue;
            }
            match &node.repeat {
                Some(repeat) => {
                    let first = self.rounds(&full, &node, repeat, info.module, level);
                    // What stands in for all rounds lacks nothing that each of them is given.
                    node.params.extend(first);
                }
                None => self.inside(&full, &node, level, &level.gates),
            }
            self.put_stand_in(&full, &node, info.module, level);
            for output in info.module.outputs {
                let own = port(&full, output.name);
                // What the stand-in takes is the last of a list.
                let last = self.lists.get(&own).and_then(|all| all.last()).cloned();
                let from = last.or_else(|| self.aliases.get(&own).cloned());
                self.links.extend(from.map(|from| Link { from, to: own }));
            }
        }
        level.map.links.iter().for_each(|link| self.link(level, link));
    }

    /// Whether there are too many nodes; the first time it is told.
    pub(super) fn is_full(&mut self, name: &str) -> bool {
        let is_full = self.opened.map.nodes.len() >= MOST_NODES;
        if is_full && !std::mem::replace(&mut self.is_told, true) {
            let message = format!("loops and maps give more than {MOST_NODES} nodes");
            self.problems.push(Problem::error(message).at(name));
        }
        is_full
    }

    /// Puts one node in.
    pub(super) fn put(
        &mut self,
        full: String,
        node: Node,
        made: Option<ModuleInfo>,
        gates: &[(PortRef, Until)],
    ) {
        let of_node = gates.iter().map(|(from, until)| (full.clone(), from.clone(), until.clone()));
        self.opened.gates.extend(of_node);
        self.opened.made.extend(made.map(|info| (full.clone(), info)));
        self.opened.map.nodes.insert(full, Node { mode: NodeMode::Active, repeat: None, ..node });
    }

    /// Puts the node in that gives what a map or a loop gives, under its own name.
    fn put_stand_in(&mut self, full: &str, node: &Node, module: &'static Module, level: &Level) {
        let whole = module;
        let module = stand_in(whole, level.registry);
        let version = crate::Fingerprint::of(b"mve: what a map gives");
        let made = ModuleInfo { module, category: "structure", version };
        let has = |module: &Module, name: &str| module.params.iter().any(|spec| spec.name == name);
        // It has none that names a file to write; what nobody has is a slip to tell of.
        let is_own = |name: &String| has(module, name) || !has(whole, name);
        let params = node.params.iter().filter(|(name, _)| is_own(name));
        let params = params.map(|(name, value)| (name.clone(), value.clone())).collect();
        self.put(full.to_owned(), Node { params, ..node.clone() }, Some(made), &level.gates);
    }

    /// Tells of the inputs of a map or loop that must be linked and are not.
    fn lacks_input(&mut self, level: &Level, name: &str, module: &Module) -> bool {
        let full = format!("{}{name}", level.prefix);
        let is_linked = |port: &str| {
            level.map.links.iter().any(|link| link.to.node == name && link.to.port == port)
        };
        let required = module.inputs.iter().filter(|input| input.is_required);
        let missing: Vec<_> = required.filter(|input| !is_linked(input.name)).collect();
        let said = missing.iter().map(|input| nothing_linked(&full, module, input));
        self.problems.extend(said);
        !missing.is_empty()
    }

    /// Puts the inside of a map in, as the node of this name.
    pub(super) fn inside(
        &mut self,
        full: &str,
        node: &Node,
        level: &Level,
        gates: &[(PortRef, Until)],
    ) {
        let Some(open) = level.registry.open_map(&node.module) else { return };
        let OpenMap { info, map, registry, folder } = &**open;
        let mut map = map.clone();
        let mut given = HashSet::new();
        for (name, promoted) in &map.parameters.clone() {
            for path in promoted.paths() {
                let Some((inner, param)) = path.split_once('.') else { continue };
                if !param.contains('.') {
                    let to = Supply::Link(port(&format!("{full}/{inner}"), param));
                    self.supplies.entry(port(full, name)).or_default().push(to);
                }
                // A value that does not fit is told of where it was given.
                let spec = info.module.params.iter().find(|spec| spec.name == name);
                let value = node.params.get(name);
                let value = value.filter(|json| spec.is_some_and(|spec| spec.read(json).is_ok()));
                let Some(value) = value.cloned() else { continue };
                if assign(&mut map, registry, path, value).is_ok() {
                    given.insert((inner.to_owned(), param.to_owned()));
                }
            }
        }
        let mut said = Vec::new();
        let active = without_inactive(&map, registry, Inputs::FromOutside, &mut said);
        let said = said.into_iter().map(|problem| super::within(full, problem));
        self.problems.extend(said);
        let map = active.map_or(map, |active| active.map);
        for (name, inner) in map.nodes.iter().filter(|(_, inner)| inner.module == MAP_INPUT.id) {
            let inside = Supply::Inside(port(&format!("{full}/{name}"), INSIDE.name));
            self.supplies.entry(port(full, port_name(name, inner))).or_default().push(inside);
        }
        let folder = level.folder.join(folder);
        let (prefix, gates) = (format!("{full}/"), gates.to_vec());
        self.level(&Level { map: &map, registry, prefix, folder, given, gates });
    }

    /// Notes where the values of a link of a map go.
    fn link(&mut self, level: &Level, link: &Link) {
        let whole = |end: &PortRef| port(&format!("{}{}", level.prefix, end.node), &end.port);
        let (from, to) = (whole(&link.from), whole(&link.to));
        let target = level.map.nodes.get(&link.to.node);
        let is_inner = !level.prefix.is_empty();
        match target {
            Some(node) if is_inner && node.module == MAP_INPUT.id => {
                if link.to.port == DEFAULT.name {
                    self.defaults.insert(port(&to.node, INSIDE.name), from);
                }
            }
            Some(node) if is_inner && node.module == MAP_OUTPUT.id => {
                let outside = level.prefix.trim_end_matches('/');
                self.aliases.insert(port(outside, port_name(&link.to.node, node)), from);
            }
            Some(node) if node.repeat.is_some() || node.is_map() => match self.supplies.get(&to) {
                Some(supplies) => {
                    let supplies = supplies.clone();
                    supplies.into_iter().for_each(|supply| self.supply(from.clone(), supply));
                }
                None => {
                    let module = level.registry.of(node).map(|info| info.module);
                    let is_known = module
                        .is_none_or(|module| module.inputs.iter().any(|i| i.name == link.to.port));
                    if let Some(module) = module.filter(|_| !is_known) {
                        self.problems.push(no_such_input(module, link));
                    }
                }
            },
            _ => self.links.push(Link { from, to }),
        }
    }

    pub(super) fn supply(&mut self, from: PortRef, supply: Supply) {
        match supply {
            Supply::Inside(inside) => drop(self.aliases.insert(inside, from)),
            Supply::Link(to) => self.links.push(Link { from, to }),
        }
    }

    /// Finds what gives the values of all links.
    fn join(&mut self) {
        for link in std::mem::take(&mut self.links) {
            let is_many = self.takes_many(&link.to);
            let Some((found, is_list)) = self.sources(&link.from) else { continue };
            if is_list && !is_many {
                let message = format!(
                    "\"{}\" gives a value for each round; link it into an input that takes many, or \
                     use the loop's table",
                    link.from
                );
                let problem = Problem::error(message).at(&link.to.node).port(&link.to.port);
                self.problems.push(problem);
                continue;
            }
            let links = found.into_iter().map(|from| Link { from, to: link.to.clone() });
            self.opened.map.links.extend(links);
        }
        let gates = std::mem::take(&mut self.opened.gates);
        self.opened.gates = gates
            .into_iter()
            .filter_map(|(node, from, until)| Some((node, self.sources(&from)?.0.pop()?, until)))
            .collect();
    }

    /// Whether an input takes any number of links.
    fn takes_many(&self, to: &PortRef) -> bool {
        let node = self.opened.map.nodes.get(&to.node);
        let module = node.and_then(|node| self.registry.find(&node.module));
        let mut inputs = module.map_or(&[][..], |info| info.module.inputs).iter();
        inputs.any(|input| input.name == to.port && input.is_many)
    }

    /// What gives the values of an output, and whether it is one a round; `None` where nothing
    /// comes from outside, or where a problem has been told.
    fn sources(&mut self, from: &PortRef) -> Option<(Vec<PortRef>, bool)> {
        let mut at = from.clone();
        for _ in 0..=self.aliases.len() + self.defaults.len() {
            if let Some(list) = self.lists.get(&at).cloned() {
                let all =
                    list.iter().filter_map(|from| self.sources(from)).flat_map(|(all, _)| all);
                return Some((all.collect(), true));
            }
            let Some(next) = self.aliases.get(&at).or_else(|| self.defaults.get(&at)) else {
                let is_there = self.opened.map.nodes.contains_key(&at.node);
                return is_there.then(|| (vec![at], false));
            };
            at = next.clone();
        }
        let message = format!("the links run in a circle through \"{from}\"");
        self.problems.push(Problem::error(message).at(&from.node));
        None
    }
}
