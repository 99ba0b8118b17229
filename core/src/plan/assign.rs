//! Setting one parameter of a map by its dotted path, as programs and command lines do.

use serde_json::{Map as JsonMap, Value as Json};

use super::no_such_node;
use crate::map::Map;
use crate::param::{Kind, ParamSpec};
use crate::problem::{Problem, did_you_mean};
use crate::registry::Registry;

/// What stands for a node's module among its parameters; no parameter has this name.
pub(crate) const MODULE: &str = "module";

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
    let missing = no_such_node(map, node_name);
    let Some(node) = map.nodes.get_mut(node_name) else {
        return Err(Problem::error(missing).at(node_name).port(param_path));
    };
    if param_path == MODULE {
        let Some(id) = chosen_id(&value) else {
            let message = format!("{value} is neither the id of a module nor {{id: parameters}}");
            return Err(Problem::error(message).at(node_name).port(MODULE));
        };
        node.module = id.to_owned();
        if let Json::Object(object) = &value {
            node.params = match object.values().next() {
                Some(Json::Object(params)) => params.clone(),
                other => {
                    let found = other.unwrap_or(&Json::Null);
                    let message = format!("{found} is no object of parameters");
                    return Err(Problem::error(message).at(node_name).port(MODULE));
                }
            };
        }
        return Ok(());
    }
    let info = registry.find(&node.module);
    let specs = info.map(|info| info.module.params);
    set(&mut node.params, specs, param_path, value)
        .map_err(|message| Problem::error(message).at(node_name).port(param_path))
}

fn set(
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
    let current = params.get(name).and_then(chosen_id).map(str::to_owned);
    let Some(nested) = nested else {
        let is_same = matches!(spec.kind, Kind::Choice { .. })
            && current.is_some()
            && value.as_str() == current.as_deref();
        if !is_same {
            params.insert(name.to_owned(), value);
        }
        return Ok(());
    };
    let Kind::Choice { default, list } = spec.kind else {
        return Err(format!("\"{name}\" has no parameters of its own"));
    };
    let id = current.unwrap_or_else(|| default.to_owned());
    let entry = list.find(&id).ok_or_else(|| format!("\"{name}\" has no entry \"{id}\""))?;
    let mut inner = match params.get(name).and_then(|json| json.get(&id)) {
        Some(Json::Object(inner)) => inner.clone(),
        _ => JsonMap::new(),
    };
    set(&mut inner, Some(entry.params), nested, value)
        .map_err(|why| format!("{why}, of {}", entry.id))?;
    params.insert(name.to_owned(), Json::Object(JsonMap::from_iter([(id, Json::Object(inner))])));
    Ok(())
}

/// The id in the JSON of a choice.
fn chosen_id(json: &Json) -> Option<&str> {
    match json {
        Json::String(id) => Some(id),
        Json::Object(object) if object.len() == 1 => object.keys().next().map(String::as_str),
        _ => None,
    }
}
