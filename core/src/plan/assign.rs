//! Setting one parameter of a map by its dotted path, as programs and command lines do.

use serde_json::{Map as JsonMap, Value as Json};

use super::no_such_node;
use crate::map::Map;
use crate::param::{MODULE, ParamSpec, chosen};
use crate::problem::{Problem, did_you_mean};
use crate::registry::Registry;

/// Sets `node.param`, or a parameter nested under a choice: `simplify.cost.boundary_weight`.
///
/// Naming the entry that a choice has already keeps the parameters that the map gives it.
/// `node.module` stands for the module itself, so that a program can put one module in the place of
/// another: by its id, which keeps the node's parameters, or with parameters of its own, written as
/// the entry of a choice is, `{"ObjLoader": {"path": "a.obj"}}`.
pub fn assign(map: &mut Map, registry: &Registry, path: &str, value: Json) -> Result<(), Problem> {
    let Some((node_name, param_path)) = path.split_once('.') else {
        let message = format!("\"{path}\" is not a parameter; write node.param");
        return Err(Problem::error(message));
    };
    let Some(node) = map.nodes.get_mut(node_name) else {
        let missing = no_such_node(map, node_name);
        return Err(Problem::error(missing).at(node_name).port(param_path));
    };
    if param_path == MODULE {
        let Some((id, params)) = chosen(&value) else {
            let message = format!("{value} is neither the id of a module nor {{id: parameters}}");
            return Err(Problem::error(message).at(node_name).port(MODULE));
        };
        node.module = id.to_owned();
        if let Some(params) = params {
            node.params = params.clone();
        }
        return Ok(());
    }
    let info = registry.find(&node.module);
    let specs = info.map(|info| info.module.params);
    set(&mut node.params, specs, param_path, value)
        .map_err(|message| Problem::error(message).at(node_name).port(param_path))
}

/// Sets a parameter, or one nested under a choice, among those of a node.
pub(super) fn set(
    params: &mut JsonMap<String, Json>,
    specs: Option<&'static [ParamSpec]>,
    path: &str,
    value: Json,
) -> Result<(), String> {
    let (name, nested) = path.split_once('.').map_or((path, None), |(n, rest)| (n, Some(rest)));
    // The parameters of a module that is not there cannot be checked; the plan reports the module.
    let Some(specs) = specs else {
        params.insert(name.to_owned(), value);
        return Ok(());
    };
    let Some(spec) = specs.iter().find(|spec| spec.name == name) else {
        let hint = did_you_mean(name, specs.iter().map(|spec| spec.name));
        return Err(format!("there is no parameter \"{name}\"{hint}"));
    };
    let current = params.get(name).or(spec.preset).and_then(chosen);
    let Some(nested) = nested else {
        let names_the_same =
            spec.choice().is_some() && current.is_some_and(|(id, _)| value.as_str() == Some(id));
        if !names_the_same {
            params.insert(name.to_owned(), value);
        }
        return Ok(());
    };
    let Some(choice) = spec.choice() else {
        return Err(format!("\"{name}\" has no parameters of its own"));
    };
    let (id, inner) = current.unwrap_or((choice.default, None));
    let entry = choice.list.find(id).ok_or_else(|| format!("\"{name}\" has no entry \"{id}\""))?;
    let mut inner = inner.cloned().unwrap_or_default();
    set(&mut inner, Some(entry.params), nested, value).map_err(|why| {
        // In a map the entry stands between the choice and its parameters, and in a path not.
        let below = nested.strip_prefix(entry.id).and_then(|rest| rest.strip_prefix('.'));
        match below {
            Some(below) => format!("write {name}.{below}: a path names no entry of a choice"),
            None if nested.contains('.') => why,
            None => match why.split_once(';') {
                Some((what, hint)) => format!("{what} of {};{hint}", entry.id),
                None => format!("{why} of {}", entry.id),
            },
        }
    })?;
    let inner = JsonMap::from_iter([(entry.id.to_owned(), Json::Object(inner))]);
    params.insert(name.to_owned(), Json::Object(inner));
    Ok(())
}
