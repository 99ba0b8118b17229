//! Which links make sense: ports that exist, types that fit, no circles.

use std::collections::HashSet;

use mve_core::{DataType, Link, Map, Module, PortRef, Registry};

/// Why a link would not do, as a sentence about its ends; the link that its input has now would
/// give way to it.
pub fn fits(map: &Map, registry: &Registry, link: &Link) -> Result<(), String> {
    let given = output_type(module_of(map, registry, &link.from)?, &link.from)?;
    let wanted = input_type(module_of(map, registry, &link.to)?, &link.to)?;
    if !wanted.takes(given) {
        let (to, from) = (&link.to, &link.from);
        return Err(format!("{to} takes a {}, and {from} is a {}", wanted.id, given.id));
    }
    let is_many = is_many(map, registry, &link.to);
    let stays = |other: &&Link| is_many || other.to != link.to;
    if link.from.node == link.to.node || is_upstream(map, &link.to.node, &link.from.node, stays) {
        return Err(format!("a link from {} to {} would make a loop", link.from, link.to));
    }
    Ok(())
}

/// Whether an input takes any number of links.
pub fn is_many(map: &Map, registry: &Registry, to: &PortRef) -> bool {
    let module = module_of(map, registry, to).ok();
    let mut inputs = module.map_or(&[][..], |module| module.inputs).iter();
    inputs.any(|input| input.name == to.port && input.is_many)
}

/// The type that an output gives.
fn output_type(module: &Module, from: &PortRef) -> Result<DataType, String> {
    let found = module.outputs.iter().find(|output| output.name == from.port);
    found.map(|output| output.data_type).ok_or_else(|| {
        format!("{} has no output \"{}\": it is a {}", from.node, from.port, module.id)
    })
}

/// The type that an input or a parameter takes by link.
fn input_type(module: &Module, to: &PortRef) -> Result<DataType, String> {
    if let Some(input) = module.inputs.iter().find(|input| input.name == to.port) {
        return Ok(input.data_type);
    }
    let Some(param) = module.params.iter().find(|param| param.name == to.port) else {
        return Err(format!("{} has no input \"{}\": it is a {}", to.node, to.port, module.id));
    };
    param.link_type().ok_or_else(|| format!("{to} must be set in the map, not linked"))
}

fn module_of(map: &Map, registry: &Registry, end: &PortRef) -> Result<&'static Module, String> {
    let Some(node) = map.nodes.get(&end.node) else {
        return Err(format!("there is no node \"{}\"", end.node));
    };
    let info = registry.of(node);
    info.map(|info| info.module).ok_or_else(|| {
        format!("what {} takes and gives is unknown: there is no module {}", end.node, node.module)
    })
}

/// Whether `node` is above `other`: a way of links leads from it to `other`.
fn is_upstream(map: &Map, node: &str, other: &str, stays: impl Fn(&&Link) -> bool) -> bool {
    let mut known: HashSet<&str> = HashSet::from([node]);
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        for link in map.links.iter().filter(|link| link.from.node == node).filter(&stays) {
            if link.to.node == other {
                return true;
            }
            if known.insert(&link.to.node) {
                open.push(&link.to.node);
            }
        }
    }
    false
}
