//! What a map is as a node of another one: its ports and parameters, declared as those of a module.

use std::path::Path;

use serde_json::Value as Json;

use super::ends::{MAP_INPUT, MAP_OUTPUT, NAME};
use super::paths::with_files_of;
use crate::data::DataType;
use crate::error::ModuleError;
use crate::made::{Draft, params_of};
use crate::map::{Map, Node, PortRef};
use crate::module::Module;
use crate::param::{ParamSpec, chosen, declared_at, given_at};
use crate::plan::{nothing_linked, passed_on_inside};
use crate::port::{ANY, InputSpec, OutputSpec};
use crate::problem::{Problem, did_you_mean};
use crate::quantity::{Quantities, Quantity, Role};
use crate::registry::Registry;

/// The name of the port that a node is from outside.
pub(super) fn port_name<'a>(name: &'a str, node: &'a Node) -> &'a str {
    let given = node.params.get(NAME.spec.name).and_then(Json::as_str);
    given.filter(|given| !given.is_empty()).unwrap_or(name)
}

/// What a map is as a node: its ports and parameters. `registry` knows the maps that it names.
/// Its files are in `folder`, as seen from the map around it.
pub(super) fn interface(
    id: &str,
    map: &Map,
    registry: &Registry,
    folder: &Path,
) -> &'static Module {
    let mut draft = Draft {
        id: id.to_owned(),
        summary: if map.title.is_empty() { format!("The map {id}.") } else { map.title.clone() },
        inputs: Vec::new(),
        outputs: Vec::new(),
        params: Vec::new(),
        run: |_| Err(ModuleError::Bug("a map is opened before it runs".to_owned())),
    };
    for (name, node) in &map.nodes {
        let port = port_name(name, node);
        if node.module == MAP_INPUT.id {
            draft.inputs.extend(input(map, registry, name).map(|spec| (port.to_owned(), spec)));
        } else if node.module == MAP_OUTPUT.id {
            let from = map.links.iter().find(|link| link.to.node == *name).map(|link| &link.from);
            let spec = from.and_then(|from| output(map, registry, from));
            draft.outputs.extend(spec.map(|spec| (port.to_owned(), spec)));
        }
    }
    // Cells of two rows would meet under one name.
    let is_row = |spec: &OutputSpec| matches!(spec.quantities, Quantities::Row(_));
    if draft.outputs.iter().filter(|(_, spec)| is_row(spec)).count() > 1 {
        let rows = draft.outputs.iter_mut().filter(|(_, spec)| is_row(spec));
        rows.for_each(|(_, spec)| spec.quantities = Quantities::Plain);
    }
    for (name, promoted) in &map.parameters {
        let first = promoted.paths().first().and_then(|path| param(map, registry, path, folder));
        draft.params.extend(first.map(|(spec, preset)| (name.clone(), spec.doc, spec, preset)));
    }
    registry.interner().intern(draft)
}

/// What an input of a map takes: what the first node does that takes its value.
fn input(map: &Map, registry: &Registry, node: &str) -> Option<InputSpec> {
    let mut inside = map.links.iter().filter(|link| link.from.node == node);
    let mut is_required = false;
    let taker = inside.find_map(|link| {
        let info = registry.of(map.nodes.get(&link.to.node)?)?;
        let input = info.module.inputs.iter().find(|input| input.name == link.to.port);
        is_required |= input.is_some_and(|input| input.is_required);
        let of_param = || {
            let param = info.module.params.iter().find(|param| param.name == link.to.port)?;
            Some((param.link_type()?, param.doc))
        };
        let taken = input.map(|input| (input.data_type, input.doc)).or_else(of_param)?;
        (taken.0 != ANY).then_some(taken)
    });
    let default = map.links.iter().find(|link| link.to.node == node);
    let of_default = || Some(output(map, registry, &default?.from)?.data_type);
    let (data_type, doc) = match taker {
        Some(taker) => taker,
        None => (of_default().unwrap_or(ANY), "What comes in."),
    };
    let is_required = is_required && default.is_none();
    Some(InputSpec { name: "", doc, data_type, is_required, is_many: false })
}

/// What an output of a node inside of a map gives.
fn output(map: &Map, registry: &Registry, from: &PortRef) -> Option<OutputSpec> {
    let from = passed_on_inside(map, registry, from)?;
    let node = map.nodes.get(&from.node)?;
    if node.module == MAP_INPUT.id {
        let taken = input(map, registry, &from.node)?.data_type;
        return any_output(registry, taken);
    }
    let module = registry.of(node)?.module;
    let spec = module.outputs.iter().find(|output| output.name == from.port)?;
    let quantities = settled(spec, module, node);
    Some(OutputSpec { quantities, ..*spec })
}

/// An output of this type of any module.
fn any_output(registry: &Registry, data_type: DataType) -> Option<OutputSpec> {
    let all = registry.modules().iter().flat_map(|info| info.module.outputs);
    let mut fitting = all.filter(|output| output.data_type == data_type);
    let doc = "What comes in.";
    fitting.next().map(|output| OutputSpec { doc, quantities: Quantities::Plain, ..*output })
}

/// The numbers of an output where those of a choice are known: by the entry that its node names.
fn settled(spec: &OutputSpec, module: &Module, node: &Node) -> Quantities {
    let Some(name) = spec.quantities.choice() else { return spec.quantities };
    let choice = module.params.iter().find(|param| param.name == name);
    let entry = choice.and_then(|param| {
        let choice = param.choice()?;
        let given = node.params.get(name).or(param.preset);
        choice.list.find(given.and_then(chosen).map_or(choice.default, |(id, _)| id))
    });
    let all = entry.map_or(&[][..], |entry| entry.quantities);
    match (spec.quantities, all.first()) {
        (Quantities::FirstOfChoice(_), Some(first)) => {
            Quantities::One(Quantity { name: spec.name, role: Role::Detail, ..*first })
        }
        (Quantities::OfChoice(_), Some(_)) => Quantities::Row(all),
        _ => Quantities::Plain,
    }
}

/// The parameter of a node at a dotted path, and what the map says there.
fn param(
    map: &Map,
    registry: &Registry,
    path: &str,
    folder: &Path,
) -> Option<(ParamSpec, Option<Json>)> {
    let (node, param) = path.split_once('.')?;
    let node = map.nodes.get(node)?;
    let specs = registry.of(node)?.module.params;
    let spec = declared_at(specs, Some(&node.params), param)?;
    let params = with_files_of(folder, specs, &node.params);
    Some((spec, given_at(&params, param).cloned().or(spec.preset.cloned())))
}

/// Whether a parameter has no effect outside of mve.
fn has_no_effect(spec: &ParamSpec) -> bool {
    !spec.writes_files() && !spec.runs_programs()
}

/// The node that stands for a map or a loop once that is opened: it takes what was made inside, and
/// gives it as its own. It writes no file itself.
pub(super) fn stand_in(module: &'static Module, registry: &Registry) -> &'static Module {
    let input = |spec: &OutputSpec| InputSpec {
        name: "",
        doc: spec.doc,
        data_type: spec.data_type,
        is_required: false,
        is_many: false,
    };
    let inputs = module.outputs.iter().map(|spec| (spec.name.to_owned(), input(spec)));
    let plain = |spec: &OutputSpec| match spec.quantities.choice() {
        Some(_) => OutputSpec { quantities: Quantities::Plain, ..*spec },
        None => *spec,
    };
    let params = params_of(module);
    registry.interner().intern(Draft {
        id: module.id.to_owned(),
        summary: module.summary.to_owned(),
        inputs: inputs.collect(),
        outputs: module.outputs.iter().map(|spec| (spec.name.to_owned(), plain(spec))).collect(),
        params: params.into_iter().filter(|(_, _, spec, _)| has_no_effect(spec)).collect(),
        run: |io| io.pass_on(),
    })
}

/// The node that gives the newer of two values of a type, where it is there.
pub(super) fn newer(spec: &OutputSpec, registry: &Registry) -> &'static Module {
    let input = |name: &str| {
        let (doc, data_type) = ("A value.", spec.data_type);
        let spec = InputSpec { name: "", doc, data_type, is_required: false, is_many: false };
        (name.to_owned(), spec)
    };
    let plain = OutputSpec { quantities: Quantities::Plain, ..*spec };
    registry.interner().intern(Draft {
        id: format!("Newer {}", spec.data_type.id),
        summary: "The value of the last round that ran.".to_owned(),
        inputs: vec![input(OLD), input(NEW)],
        outputs: vec![(NEWER.to_owned(), plain)],
        params: Vec::new(),
        run: |io| io.pass_newest(),
    })
}

/// Ports of [`newer`].
pub(super) const OLD: &str = "old";
pub(super) const NEW: &str = "new";
pub(super) const NEWER: &str = "value";

/// What is wrong with the ports and parameters that a map has as a node.
pub(super) fn faults(map: &Map, registry: &Registry) -> Vec<Problem> {
    let mut faults = Vec::new();
    let mut known: Vec<(&str, &str)> = Vec::new();
    let ends = map
        .nodes
        .iter()
        .filter(|(_, node)| [MAP_INPUT.id, MAP_OUTPUT.id].contains(&node.module.as_str()));
    for (name, node) in ends {
        let port = (node.module.as_str(), port_name(name, node));
        if known.contains(&port) {
            let message = format!("another {} is named \"{}\", too", port.0, port.1);
            faults.push(Problem::error(message).at(name).port(NAME.spec.name));
        }
        known.push(port);
        let is_linked = map.links.iter().any(|link| link.to.node == *name);
        if node.module == MAP_OUTPUT.id && !is_linked {
            faults.push(nothing_linked(name, &MAP_OUTPUT, &MAP_OUTPUT.inputs[0]));
        }
    }
    let told = parameter_faults(map, registry).into_iter();
    faults.extend(told.map(|(name, message)| of_parameter(Problem::error(message), &name)));
    faults
}

/// What is wrong with the parameters that a map would have as a node: told of where it is checked
/// alone, and no reason not to run it, which needs none of them.
pub(crate) fn parameter_warnings(map: &Map, registry: &Registry) -> Vec<Problem> {
    let warning = |(name, message): (String, String)| {
        let message = format!("{message}; as a node of another map, this one would not run");
        of_parameter(Problem::warning(message), &name)
    };
    parameter_faults(map, registry).into_iter().map(warning).collect()
}

fn of_parameter(problem: Problem, name: &str) -> Problem {
    problem.at(name).along(["parameters".into(), name.into()])
}

/// The names of parameters of a map with what is wrong with them.
fn parameter_faults(map: &Map, registry: &Registry) -> Vec<(String, String)> {
    let is_input = |(name, node): (&String, &Node), promoted: &str| {
        node.module == MAP_INPUT.id && port_name(name, node) == promoted
    };
    let mut faults = Vec::new();
    for (name, promoted) in &map.parameters {
        let mut told = |message: String| faults.push((name.clone(), message));
        if map.nodes.iter().any(|node| is_input(node, name)) {
            told("an input of the map has this name, too".to_owned());
        }
        for path in promoted.paths() {
            let Some((node, inside)) = path.split_once('.').filter(|(node, _)| !node.is_empty())
            else {
                told(format!("\"{path}\" is not of the form node.parameter"));
                continue;
            };
            let Some(known) = map.nodes.get(node) else {
                let hint = did_you_mean(node, map.nodes.keys().map(String::as_str));
                told(format!("\"{path}\": the map has no node \"{node}\"{hint}"));
                continue;
            };
            // A module that is not there is told of at its node.
            let Some(info) = registry.of(known) else { continue };
            if param(map, registry, path, Path::new("")).is_none() {
                let hint = did_you_mean(inside, info.module.params.iter().map(|spec| spec.name));
                told(format!("\"{path}\" is no parameter of {}{hint}", info.module.id));
            }
        }
        if promoted.paths().is_empty() {
            told("names no parameter of a node".to_owned());
        }
    }
    faults
}
