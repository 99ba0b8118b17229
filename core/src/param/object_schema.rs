//! The JSON Schema of a list of parameters.

use serde_json::{Map as JsonMap, Value as Json, json};

use super::ParamSpec;

/// The schema of the parameters of a module or of an entry of a choice.
pub(crate) fn object_of(params: &[ParamSpec]) -> Json {
    let properties: JsonMap<String, Json> =
        params.iter().map(|spec| (spec.name.to_owned(), of_param(spec))).collect();
    let is_needed = |spec: &&ParamSpec| spec.default_setting().is_none();
    let required: Vec<&str> = params.iter().filter(is_needed).map(|spec| spec.name).collect();
    json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false
    })
}

fn of_param(spec: &ParamSpec) -> Json {
    let mut schema = spec.kind.answers().schema();
    if spec.can_be_off {
        match schema["type"].clone() {
            Json::String(kind) => schema["type"] = json!([kind, "null"]),
            _ => schema = json!({ "anyOf": [schema, { "type": "null" }] }),
        }
    }
    let unit = if spec.unit.is_empty() { String::new() } else { format!(" Unit: {}.", spec.unit) };
    schema["description"] = Json::from(format!("{}{unit}", spec.doc));
    if let Some(default) = spec.default_setting() {
        schema["default"] = default.to_json();
    }
    schema
}
