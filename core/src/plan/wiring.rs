//! Links of a map: what they join, whether it fits, and the order that they force.

use std::collections::BTreeSet;

use super::{Gate, PlanNode, Source, no_such_node};
use crate::data::DataType;
use crate::json::Step;
use crate::map::{Link, Map};
use crate::module::Module;
use crate::plan::opened::Opened;
use crate::port::{ANY, InputSpec};
use crate::problem::{LONGEST_NAME, Problem, did_you_mean, plain};
use crate::registry::{ModuleInfo, Registry};

/// An output of a node of the map, by place.
pub(super) type From = Source;

/// What the links of a map say, by the places of its nodes.
pub(super) struct Wiring {
    /// The modules of the nodes that have one.
    pub modules: Vec<Option<ModuleInfo>>,
    /// For each node and each of its inputs, where it comes from.
    inputs: Vec<Vec<Option<From>>>,
    /// For each node, the links into inputs that take many.
    many: Vec<Vec<(usize, From)>>,
    /// For each node, what loops say of whether it runs.
    gates: Vec<Vec<Gate>>,
    /// For each node, the parameters that come by link.
    pub linked: Vec<Vec<(usize, From)>>,
}

/// Resolves modules and links; whatever does not fit becomes a problem.
pub(super) fn wire(
    map: &Map,
    registry: &Registry,
    opened: Option<&Opened>,
    problems: &mut Vec<Problem>,
) -> Wiring {
    let modules: Vec<_> = map
        .nodes
        .iter()
        .map(|(name, node)| {
            let made = opened.and_then(|opened| opened.made.get(name)).copied();
            let info = made.or_else(|| registry.find(&node.module));
            // Of the file of a map that is not there, or is none, it was told why.
            if info.is_none() && !node.module.ends_with(".json") {
                let ids = registry.modules().iter().map(|info| info.module.id);
                let maps = registry.names_of_maps().chain(map.maps.keys().map(String::as_str));
                let hint = did_you_mean(&node.module, ids.chain(maps));
                let hint = if hint.is_empty() { "; `mve modules` lists them" } else { &hint };
                let module = plain(&node.module, LONGEST_NAME);
                let message = format!("there is no module \"{module}\"{hint}");
                problems.push(Problem::error(message).at(name));
            }
            info
        })
        .collect();
    let n_inputs = |info: &Option<ModuleInfo>| info.map_or(0, |info| info.module.inputs.len());
    let mut wiring = Wiring {
        inputs: modules.iter().map(|info| vec![None; n_inputs(info)]).collect(),
        many: vec![Vec::new(); modules.len()],
        gates: vec![Vec::new(); modules.len()],
        linked: vec![Vec::new(); modules.len()],
        modules,
    };
    for link in &map.links {
        add_link(map, link, &mut wiring, problems);
    }
    for (node, from, until) in opened.iter().flat_map(|opened| &opened.gates) {
        let source = || {
            let place = map.nodes.get_index_of(&from.node)?;
            let outputs = wiring.modules[place]?.module.outputs;
            let output = outputs.iter().position(|output| output.name == from.port)?;
            Some(Source { node: place, output })
        };
        let place = map.nodes.get_index_of(node);
        if let (Some(place), Some(source)) = (place, source()) {
            wiring.gates[place].push(Gate { source, until: until.clone() });
        }
    }
    check_required(map, &wiring, problems);
    wiring
}

/// What is wrong with the names of a map's nodes.
pub(super) fn check_names(map: &Map, problems: &mut Vec<Problem>) {
    for name in map.nodes.keys().filter(|name| !Map::can_name_a_node(name)) {
        let message = format!(
            "a node's name cannot be empty or longer than {LONGEST_NAME} letters, hold spaces, slashes, \
             invisible signs or any of . {{ }} >, or be \"seconds\", which stands for times"
        );
        problems.push(Problem::error(message).at(name));
    }
}

fn add_link(map: &Map, link: &Link, wiring: &mut Wiring, problems: &mut Vec<Problem>) {
    let mut ends = [&link.from, &link.to].map(|end| {
        let place = map.nodes.get_index_of(&end.node);
        // What is wrong with a node that could not be read is told once.
        if place.is_none() && !map.has_unread_node(&end.node) {
            let message = format!("link \"{link}\": {}", no_such_node(map, &end.node));
            problems.push(of_link(Problem::error(message).at(&end.node).port(&end.port), link));
        }
        place
    });
    let [Some(from_node), Some(to_node)] = &mut ends else { return };
    let (from_node, to_node) = (*from_node, *to_node);
    let (from_module, to_module) = (wiring.modules[from_node], wiring.modules[to_node]);
    let output = from_module.and_then(|info| {
        let found = info.module.outputs.iter().position(|o| o.name == link.from.port);
        if found.is_none() {
            problems.push(no_such_output(info.module, link));
        }
        Some((found?, info.module.outputs[found?].data_type))
    });
    let target = to_module.and_then(|info| {
        let found = find_target(info.module, &link.to.port);
        if found.is_none() {
            problems.push(no_such_input(info.module, link));
        }
        found
    });
    let (Some((output, given)), Some((target, wanted))) = (output, target) else { return };
    if !wanted.takes(given) {
        let message = format!(
            "takes {}, but \"{}\" gives {}; link an output that gives {}",
            wanted.id, link.from, given.id, wanted.id
        );
        let problem = Problem::error(message).at(&link.to.node).port(&link.to.port);
        problems.push(of_link(problem, link));
        return;
    }
    let source = Source { node: from_node, output };
    let is_taken = match target {
        Target::Input(place) if to_module.is_some_and(|info| info.module.inputs[place].is_many) => {
            wiring.many[to_node].push((place, source));
            false
        }
        Target::Input(place) => wiring.inputs[to_node][place].replace(source).is_some(),
        Target::Param(place) => {
            let linked = &mut wiring.linked[to_node];
            let is_taken = linked.iter().any(|(known, _)| *known == place);
            linked.push((place, source));
            is_taken
        }
    };
    if is_taken {
        let message = "has more than one link; keep one of them";
        let problem = Problem::error(message).at(&link.to.node).port(&link.to.port);
        problems.push(of_link(problem, link));
    }
}

#[derive(Clone, Copy)]
enum Target {
    Input(usize),
    Param(usize),
}

/// What a link to this port reaches, and the type that it must carry.
fn find_target(module: &Module, name: &str) -> Option<(Target, DataType)> {
    let input = module.inputs.iter().position(|input| input.name == name);
    let param = || {
        let place = module.params.iter().position(|param| param.name == name)?;
        Some((Target::Param(place), module.params[place].link_type()?))
    };
    input.map(|place| (Target::Input(place), module.inputs[place].data_type)).or_else(param)
}

fn no_such_output(module: &Module, link: &Link) -> Problem {
    let names = || module.outputs.iter().map(|output| output.name);
    let hint = did_you_mean(&link.from.port, names());
    let all = if names().next().is_none() {
        "it has none".to_owned()
    } else {
        format!("it has {}", names().collect::<Vec<_>>().join(", "))
    };
    let message = format!("link \"{link}\": {} has no such output; {all}{hint}", module.id);
    of_link(Problem::error(message).at(&link.from.node).port(&link.from.port), link)
}

/// A problem that stands where its link does.
fn of_link(problem: Problem, link: &Link) -> Problem {
    problem.along(["links".into(), Step::Text(link.to_string())])
}

pub(crate) fn no_such_input(module: &Module, link: &Link) -> Problem {
    let place = of_link(Problem::error("").at(&link.to.node).port(&link.to.port), link);
    if module.params.iter().any(|param| param.name == link.to.port) {
        let message = format!("link \"{link}\": this parameter must be set in the map, not linked");
        return Problem { message, ..place };
    }
    let params = module.params.iter().filter(|p| p.link_type().is_some()).map(|p| p.name);
    let names: Vec<_> = module.inputs.iter().map(|input| input.name).chain(params).collect();
    let hint = did_you_mean(&link.to.port, names.iter().copied());
    let all = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
    let message = format!("link \"{link}\": {} has no such input; it takes {all}{hint}", module.id);
    Problem { message, ..place }
}

fn check_required(map: &Map, wiring: &Wiring, problems: &mut Vec<Problem>) {
    for (place, (name, _)) in map.nodes.iter().enumerate() {
        let Some(info) = wiring.modules[place] else { continue };
        for (input, source) in info.module.inputs.iter().zip(&wiring.inputs[place]) {
            // A link that was refused has said so already.
            let is_named =
                || map.links.iter().any(|link| link.to.node == *name && link.to.port == input.name);
            let has_many = || {
                wiring.many[place].iter().any(|(to, _)| info.module.inputs[*to].name == input.name)
            };
            if input.is_required && source.is_none() && !has_many() && !is_named() {
                problems.push(nothing_linked(name, info.module, input));
            }
        }
    }
}

/// What is said of an input that must be linked and is not.
pub(crate) fn nothing_linked(node: &str, module: &Module, input: &InputSpec) -> Problem {
    let (module, wanted) = (module.id, input.data_type.id);
    let message = match input.data_type == ANY {
        true => format!("nothing is linked here, and {module} needs a value"),
        false => format!("nothing is linked here, and {module} needs a {wanted}"),
    };
    Problem::error(message).at(node).port(input.name)
}

/// Places of the nodes in an order in which every link points forward; among nodes that are free
/// to run, the first of the map comes first. A cycle is a problem.
pub(super) fn order(map: &Map, wiring: &Wiring, problems: &mut Vec<Problem>) -> Vec<usize> {
    let n_nodes = map.nodes.len();
    let sources = |place: usize| {
        let inputs = wiring.inputs[place].iter().flatten().map(|s| s.node);
        let placed = wiring.many[place].iter().chain(&wiring.linked[place]);
        let gates = wiring.gates[place].iter().map(|gate| gate.source.node);
        inputs.chain(placed.map(|(_, s)| s.node)).chain(gates)
    };
    let mut waiting = vec![0_usize; n_nodes];
    let mut consumers = vec![Vec::new(); n_nodes];
    for (place, count) in waiting.iter_mut().enumerate() {
        for source in sources(place) {
            *count += 1;
            consumers[source].push(place);
        }
    }
    let mut free: BTreeSet<usize> = (0..n_nodes).filter(|place| waiting[*place] == 0).collect();
    let mut order = Vec::with_capacity(n_nodes);
    while let Some(place) = free.pop_first() {
        order.push(place);
        for &consumer in &consumers[place] {
            waiting[consumer] -= 1;
            if waiting[consumer] == 0 {
                free.insert(consumer);
            }
        }
    }
    if let Some(start) = (0..n_nodes).find(|place| waiting[*place] > 0) {
        let name = |place: usize| map.nodes.get_index(place).map_or("", |(name, _)| name.as_str());
        // Walking back along links that are still waited for, some node must come twice.
        let mut walk = vec![start];
        let cycle = loop {
            let last = walk[walk.len() - 1];
            let Some(before) = sources(last).find(|source| waiting[*source] > 0) else {
                break walk;
            };
            if let Some(place) = walk.iter().position(|seen| *seen == before) {
                break walk.split_off(place);
            }
            walk.push(before);
        };
        let mut names: Vec<_> = cycle.iter().rev().map(|place| name(*place)).collect();
        names.push(names[0]);
        let message = format!("the links run in a circle: {}", names.join(" -> "));
        problems.push(Problem::error(message).at(name(cycle[0])));
    }
    order
}

/// Puts the nodes in order and turns places in the map into places in the plan.
pub(super) fn arrange(
    mut nodes: Vec<Option<PlanNode>>,
    wiring: &Wiring,
    order: &[usize],
) -> Vec<PlanNode> {
    let mut place_of = vec![0; nodes.len()];
    for (new, &old) in order.iter().enumerate() {
        place_of[old] = new;
    }
    let moved = |source: &Source| Source { node: place_of[source.node], ..*source };
    let mut arranged: Vec<PlanNode> = Vec::with_capacity(nodes.len());
    for &old in order {
        let Some(mut node) = nodes[old].take() else { continue };
        let placed = |all: &[(usize, Source)]| -> Vec<(usize, Source)> {
            all.iter().map(|(place, source)| (*place, moved(source))).collect()
        };
        node.inputs = wiring.inputs[old].iter().map(|s| s.as_ref().map(moved)).collect();
        node.many = placed(&wiring.many[old]);
        node.linked = placed(&wiring.linked[old]);
        let gates = wiring.gates[old].iter();
        node.gates =
            gates.map(|gate| Gate { source: moved(&gate.source), ..gate.clone() }).collect();
        arranged.push(node);
    }
    for consumer in 0..arranged.len() {
        let sources: BTreeSet<usize> = arranged[consumer].sources().map(|s| s.node).collect();
        for source in sources {
            arranged[source].consumers.push(consumer);
        }
    }
    arranged
}
