//! The JSON Schema of map files, drawn from the registry, so that text editors complete and check.

use serde_json::{Value as Json, json};

use crate::param::object_of;
use crate::registry::Registry;

/// The schema, draft 2020-12.
pub fn schema(registry: &Registry) -> Json {
    let modules: Vec<Json> = registry
        .modules()
        .iter()
        .map(|info| {
            json!({
                "properties": {
                    "module": { "const": info.module.id, "description": info.module.summary },
                    "params": object_of(info.module.params),
                }
            })
        })
        .collect();
    let ids: Vec<&str> = registry.modules().iter().map(|info| info.module.id).collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A map of mve",
        "type": "object",
        "required": ["mve", "nodes"],
        "properties": {
            "mve": { "const": 1, "description": "Version of the format." },
            "title": { "type": "string", "description": "What the map is for." },
            "nodes": {
                "description": "Uses of modules, by name.",
                "type": "object",
                "propertyNames": { "pattern": "^[^\\s./\\\\{}>]+$" },
                "additionalProperties": {
                    "type": "object",
                    "required": ["module"],
                    "properties": {
                        "module": { "type": "string", "examples": ids },
                        "mode": mode()
                    },
                    "anyOf": modules
                }
            },
            "links": {
                "description": "\"node.output -> node.input\"",
                "type": "array",
                "items": { "type": "string", "pattern": "^[^.]+\\.\\S+\\s*->\\s*[^.]+\\.\\S+$" }
            },
            "layout": {
                "description": "Where each node is drawn.",
                "type": "object",
                "additionalProperties": {
                    "type": "array",
                    "items": { "type": "number" },
                    "minItems": 2,
                    "maxItems": 2
                }
            },
            "canvas": {
                "description": "Frames, notes and the like, drawn by the editor; no run reads them.",
                "type": "object"
            },
            "programs": programs()
        }
    })
}

/// The schema of whether a node runs.
fn mode() -> Json {
    json!({
        "description": "Active nodes run. A muted node does not, nor do those that need it; a \
                        bypassed one passes on what comes to its inputs.",
        "enum": ["active", "muted", "bypassed"],
        "default": "active"
    })
}

/// The schema of the section of programs.
fn programs() -> Json {
    let assignment = |values: Json| {
        json!({
            "type": "object",
            "propertyNames": { "pattern": "^[^.]+\\..+$" },
            "additionalProperties": values
        })
    };
    json!({
        "description": "Sweeps of the map, by name.",
        "type": "object",
        "additionalProperties": {
            "type": "object",
            "properties": {
                "axes": {
                    "description": "Axes multiply; the lists of one axis advance together.",
                    "type": "array",
                    "items": assignment(json!({ "type": "array", "minItems": 1 }))
                },
                "steps": { "type": "array", "items": assignment(json!(true)) },
                "repeats": { "type": "integer", "minimum": 1 },
                "time_limit": {
                    "description": "Seconds after which a step is stopped.",
                    "type": "number",
                    "exclusiveMinimum": 0
                },
                "report": report()
            }
        }
    })
}

/// The schema of what a program says of its report.
fn report() -> Json {
    let column = json!({ "type": "string", "description": "node.output, seconds.node or seconds" });
    let columns = json!({ "type": "array", "items": column });
    let path = json!({ "type": "string", "description": "A parameter that the program varies." });
    json!({
        "description": "What the report shows, and the questions that it answers.",
        "type": "object",
        "additionalProperties": false,
        "properties": {
            "measures": {
                "description": "The columns that measure, the most important first.",
                "type": "array",
                "items": {
                    "type": "object",
                    "required": ["column"],
                    "additionalProperties": false,
                    "properties": {
                        "column": column,
                        "better": { "enum": ["lower", "higher"], "default": "lower" },
                        "title": { "type": "string" }
                    }
                }
            },
            "against": columns,
            "group": path,
            "series": path,
            "questions": {
                "type": "array",
                "items": {
                    "type": "object",
                    "required": ["text", "measure", "compare"],
                    "additionalProperties": false,
                    "properties": {
                        "text": { "type": "string" },
                        "measure": column,
                        "compare": {
                            "description": "One varied parameter and its two values.",
                            "type": "object",
                            "minProperties": 1,
                            "maxProperties": 1,
                            "additionalProperties": {
                                "type": "array", "minItems": 2, "maxItems": 2
                            }
                        },
                        "same": columns
                    }
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::registry;

    #[test]
    fn says_ranges_defaults_and_nested_choices() {
        let schema = schema(&registry());
        let modules = &schema["properties"]["nodes"]["additionalProperties"]["anyOf"];
        let module = |id: &str| {
            let all = modules.as_array().unwrap().iter();
            all.clone().find(|m| m["properties"]["module"]["const"] == id).unwrap().clone()
        };
        let add = &module("Add")["properties"]["params"]["properties"]["amount"];
        assert_eq!((&add["minimum"], &add["default"]), (&json!(-100.0), &json!(1.0)));
        let pick = &module("Pick")["properties"]["params"]["properties"]["how"]["anyOf"];
        assert_eq!(pick[0]["const"], "Scaled");
        assert_eq!(pick[1]["properties"]["Scaled"]["properties"]["by"]["default"], 2.0);
    }
}
