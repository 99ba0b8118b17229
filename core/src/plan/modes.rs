//! Muted and bypassed nodes: the map as if they were not there.
//!
//! A muted node does not run, nor does any that needs a value of it; optional inputs are as if
//! unlinked. A bypassed node passes on, at each output, what is linked to its first input of that
//! type; without such an input it acts as muted. Each node that is left out is told as a warning,
//! and names of output files may still quote its parameters. Everything else in a plan is made from
//! the map that comes out of here, so keys, names and orders know nothing of modes.

use std::collections::HashMap;

use crate::data::DataType;
use crate::map::{Link, MAP_INPUT_ID, Map, Node, NodeMode, PortRef};
use crate::problem::Problem;
use crate::registry::Registry;

/// Where the value of an output comes from: behind bypassed nodes, what they pass on; `None` where
/// nothing gives it.
pub fn passed_on(map: &Map, registry: &Registry, output: &PortRef) -> Option<PortRef> {
    let wires = Wires::of(map, registry);
    wires.source(output, &wires.left_out()).ok().cloned()
}

/// The same in a map that is a node of another one.
pub(crate) fn passed_on_inside(
    map: &Map,
    registry: &Registry,
    output: &PortRef,
) -> Option<PortRef> {
    let wires = Wires { inputs: Inputs::FromOutside, ..Wires::of(map, registry) };
    wires.source(output, &wires.left_out()).ok().cloned()
}

/// Whether values come into a map where it has a node for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Inputs {
    /// The map is a node of another one.
    FromOutside,
    /// It runs alone: the defaults come in.
    Alone,
}

/// A map without the nodes that do not run.
pub(crate) struct ActiveMap {
    /// What runs.
    pub map: Map,
    /// The names of the nodes that do not.
    pub left_out: Vec<String>,
}

/// Takes the nodes out that do not run; `None` where all do. Each is told as a warning.
pub(crate) fn without_inactive(
    map: &Map,
    registry: &Registry,
    inputs: Inputs,
    problems: &mut Vec<Problem>,
) -> Option<ActiveMap> {
    let wires = Wires { inputs, ..Wires::of(map, registry) };
    if map.nodes.values().all(|node| wires.mode(node).is_active()) {
        return None;
    }
    let left_out = wires.left_out();
    for name in map.nodes.keys() {
        // What comes into a map that runs alone is nothing to tell of.
        let from = PortRef { node: name.clone(), port: String::new() };
        let is_input = map.nodes[name].module == MAP_INPUT_ID;
        if let Some(problem) = left_out.get(name.as_str())
            && !(is_input && wires.passed_on(&from).is_some())
        {
            problems.push(problem.clone());
        }
    }
    let mut settled = map.without_programs();
    settled.nodes.retain(|name, _| !left_out.contains_key(name.as_str()));
    settled.links.retain_mut(|link| {
        if !left_out.contains_key(link.to.node.as_str())
            && let Ok(from) = wires.source(&link.from, &left_out)
        {
            link.from = from.clone();
            return true;
        }
        false
    });
    if settled.nodes.is_empty() {
        let message = "no node runs: each is muted or bypassed, or needs one that is";
        problems.push(Problem::error(message).along(["nodes".into()]));
    }
    let left_out = map.nodes.keys().filter(|name| left_out.contains_key(name.as_str()));
    Some(ActiveMap { map: settled, left_out: left_out.cloned().collect() })
}

/// Nodes that do not run, each with the reason.
type LeftOut<'a> = HashMap<&'a str, Problem>;

/// The links of a map by their ends.
struct Wires<'a> {
    map: &'a Map,
    registry: &'a Registry,
    into: HashMap<(&'a str, &'a str), &'a PortRef>,
    inputs: Inputs,
}

impl<'a> Wires<'a> {
    fn of(map: &'a Map, registry: &'a Registry) -> Self {
        let ends = |link: &'a Link| ((link.to.node.as_str(), link.to.port.as_str()), &link.from);
        let into = map.links.iter().map(ends).collect();
        Self { map, registry, into, inputs: Inputs::Alone }
    }

    /// Whether a node runs. Where a map runs alone, what comes in is what is linked there.
    fn mode(&self, node: &Node) -> NodeMode {
        let is_input = self.inputs == Inputs::Alone && node.module == MAP_INPUT_ID;
        if is_input && node.mode.is_active() { NodeMode::Bypassed } else { node.mode }
    }

    /// The nodes that do not run: those that are set so, and then, until there are no more, those
    /// with a required input that comes from one of them.
    fn left_out(&self) -> LeftOut<'a> {
        let mut left_out = LeftOut::new();
        for (name, node) in &self.map.nodes {
            let message = match self.mode(node) {
                NodeMode::Active => continue,
                NodeMode::Muted => "is muted",
                NodeMode::Bypassed if node.mode.is_active() => {
                    "takes its value from outside, and here is none: link its default, or use the \
                     map in another one"
                }
                NodeMode::Bypassed => "is bypassed",
            };
            left_out.insert(name, Problem::warning(message).at(name));
        }
        loop {
            let n_before = left_out.len();
            for name in self.map.nodes.keys() {
                if !left_out.contains_key(name.as_str())
                    && let Some(problem) = self.lack(name, &left_out)
                {
                    left_out.insert(name, problem);
                }
            }
            if left_out.len() == n_before {
                return left_out;
            }
        }
    }

    /// What a node needs and does not get.
    fn lack(&self, name: &str, left_out: &LeftOut) -> Option<Problem> {
        let info = self.registry.of(self.map.nodes.get(name)?)?;
        let required = info.module.inputs.iter().filter(|input| input.is_required);
        required.into_iter().find_map(|input| {
            let from = self.into.get(&(name, input.name))?;
            let missing = self.source(from, left_out).err()?;
            let why = match self.map.nodes.get(&missing.node).map(|node| self.mode(node)) {
                Some(NodeMode::Muted) => "is muted",
                Some(NodeMode::Bypassed) => "is bypassed and has nothing to pass on",
                _ => "does not run either",
            };
            let message = format!("is left out: needs {missing}, which {why}");
            Some(Problem::warning(message).at(name).port(input.name))
        })
    }

    /// Where the value of an output comes from: behind bypassed nodes, what they pass on. The error
    /// is the output that has no value.
    fn source(&self, from: &'a PortRef, left_out: &LeftOut) -> Result<&'a PortRef, &'a PortRef> {
        let mut from = from;
        // A way that is longer than the map runs in a circle of bypassed nodes.
        for _ in 0..=self.map.nodes.len() {
            if !left_out.contains_key(from.node.as_str()) {
                return Ok(from);
            }
            from = self.passed_on(from).ok_or(from)?;
        }
        Err(from)
    }

    /// What a bypassed node passes on at an output: what is linked to its first input of that type.
    fn passed_on(&self, output: &PortRef) -> Option<&'a PortRef> {
        let node = self.map.nodes.get(&output.node)?;
        if self.mode(node) != NodeMode::Bypassed {
            return None;
        }
        if node.module == MAP_INPUT_ID {
            let info = self.registry.find(MAP_INPUT_ID)?;
            let default = info.module.inputs.first()?;
            return self.into.get(&(output.node.as_str(), default.name)).copied();
        }
        let module = self.registry.of(node)?.module;
        let given: DataType = module.outputs.iter().find(|o| o.name == output.port)?.data_type;
        let input = module.inputs.iter().find(|input| input.data_type == given)?;
        self.into.get(&(output.node.as_str(), input.name)).copied()
    }
}
