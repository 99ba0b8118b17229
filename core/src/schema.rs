//! The JSON Schema of map files, drawn from the registry, so that text editors complete and check.

use serde_json::{Value as Json, json};

use crate::module::Module;
use crate::param::object_of;
use crate::problem::LONGEST_NAME;
use crate::registry::{ModuleInfo, Registry};

/// The schema, draft 2020-12.
pub fn schema(registry: &Registry) -> Json {
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A map of mve",
        "type": "object",
        "patternProperties": remarks(),
        "additionalProperties": false,
        "required": ["mve", "nodes"],
        "properties": {
            "mve": { "const": 1, "description": "Version of the format." },
            "title": { "type": "string", "description": "What the map is for." },
            "nodes": {
                "description": "Uses of modules, by name.",
                "type": "object",
                "propertyNames": {
                    "pattern": "^[^\\s./\\\\{}>]+$",
                    "maxLength": LONGEST_NAME,
                    "not": { "const": "seconds" }
                },
                "additionalProperties": node(registry)
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
            "programs": programs(),
            "parameters": parameters(),
            "maps": maps()
        }
    })
}

/// The schema of the parameters that a map has as a node of another one.
fn parameters() -> Json {
    json!({
        "description": "Parameters that the map has as a node of another one.",
        "type": "object",
        "additionalProperties": {
            "anyOf": [
                { "type": "string", "pattern": "^[^.]+\\..+$" },
                { "type": "array", "minItems": 1, "items": { "type": "string" } }
            ]
        }
    })
}

/// The schema of the maps that nodes may name.
fn maps() -> Json {
    json!({
        "description": "Maps that nodes may name as their module.",
        "type": "object",
        "propertyNames": { "pattern": "^[^\\sA-Z./\\\\{}>][^\\s./\\\\{}>]*$" },
        "additionalProperties": {
            "type": "object",
            "required": ["nodes"],
            "properties": { "nodes": { "$ref": "#/properties/nodes" } }
        }
    })
}

/// The schema of a node: the rule of its module says which parameters it has, so that a fault is
/// told of the parameter and not of every module that the node might have named.
fn node(registry: &Registry) -> Json {
    let rule = |info: &ModuleInfo| {
        let Module { id, summary, params, .. } = info.module;
        json!({
            "if": { "properties": { "module": { "const": id } }, "required": ["module"] },
            "then": { "description": summary, "properties": { "params": object_of(params) } }
        })
    };
    let modules = registry.modules();
    let ids: Vec<&str> = modules.iter().map(|info| info.module.id).collect();
    json!({
        "type": "object",
        "required": ["module"],
        "properties": {
            "module": {
                "anyOf": [
                    { "enum": ids },
                    {
                        "description": "A map as a node: the path of its file, or its name in \
                                        \"maps\".",
                        "type": "string",
                        "pattern": "\\.json$|^[^A-Z]"
                    }
                ]
            },
            "mode": mode(),
            "repeat": repeat(),
            "params": { "type": "object" }
        },
        "patternProperties": remarks(),
        "additionalProperties": false,
        "allOf": modules.iter().map(rule).collect::<Vec<_>>()
    })
}

/// Keys that mean nothing to mve and that no one warns of.
fn remarks() -> Json {
    json!({ "^[_$]": true })
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

/// The schema of how often a node runs.
fn repeat() -> Json {
    json!({
        "description": "The node runs more than once: \"times\" often, or once for each value.",
        "type": "object",
        "additionalProperties": false,
        "oneOf": [{ "required": ["times"] }, { "required": ["each"] }],
        "properties": {
            "times": { "type": "integer", "minimum": 1 },
            "each": {
                "description": "Values of parameters, one a round.",
                "type": "object",
                "minProperties": 1,
                "additionalProperties": {
                    "anyOf": [{ "type": "array", "minItems": 1, "items": true }, spread()]
                }
            },
            "feed": {
                "description": "The inputs that take an output of the round before, with the \
                                names of these outputs.",
                "type": "object",
                "additionalProperties": { "type": "string" }
            },
            "until": {
                "description": "The loop ends after a round with such a number.",
                "type": "object",
                "additionalProperties": false,
                "required": ["output"],
                "properties": {
                    "output": { "type": "string" },
                    "below": { "type": "number" },
                    "above": { "type": "number" }
                }
            }
        }
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
            "patternProperties": remarks(),
            "additionalProperties": false,
            "properties": {
                "axes": {
                    "description": "Axes multiply; the lists of one axis advance together.",
                    "type": "array",
                    "items": assignment(json!({ "anyOf": [
                        { "type": "array", "minItems": 1, "items": true },
                        spread()
                    ] }))
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

/// The schema of a value that stands for many in an axis.
fn spread() -> Json {
    let ends = |what: &str| {
        json!({
            "description": what,
            "type": "array",
            "prefixItems": [
                { "type": "number" }, { "type": "number" }, { "type": "integer", "minimum": 2 }
            ],
            "minItems": 3,
            "maxItems": 3
        })
    };
    json!({
        "type": "object",
        "minProperties": 1,
        "maxProperties": 1,
        "additionalProperties": false,
        "properties": {
            "glob": {
                "description": "Files by a pattern from the map's folder, in order of their names.",
                "type": "string"
            },
            "range": ends("From, to, and how many numbers at equal distances."),
            "log": ends("From, to, and how many numbers at equal ratios, to six digits.")
        }
    })
}

/// The schema of what a program says of its report.
fn report() -> Json {
    let column = json!({ "type": "string", "description": "node.output, seconds.node or seconds" });
    let columns = json!({ "type": "array", "items": column });
    let path = json!({ "type": "string", "description": "A parameter that the program varies." });
    let paths = json!({ "anyOf": [path, { "type": "array", "items": path }] });
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
                        "better": {
                            "description": "Where it is not as the module declares.",
                            "enum": ["lower", "higher", "neither"]
                        },
                        "title": { "type": "string" }
                    }
                }
            },
            "against": columns,
            "group": paths,
            "series": paths,
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
        let modules = &schema["properties"]["nodes"]["additionalProperties"]["allOf"];
        let module = |id: &str| {
            let mut all = modules.as_array().unwrap().iter();
            let is_it = |m: &&Json| m["if"]["properties"]["module"]["const"] == id;
            all.find(is_it).unwrap()["then"].clone()
        };
        let add = &module("Add")["properties"]["params"]["properties"]["amount"];
        assert_eq!((&add["minimum"], &add["default"]), (&json!(-100.0), &json!(1.0)));
        let pick = &module("Pick")["properties"]["params"]["properties"]["how"];
        assert_eq!(pick["then"]["oneOf"][0]["const"], "Scaled");
        assert_eq!(pick["else"]["properties"]["Scaled"]["properties"]["by"]["default"], 2.0);
    }
}
