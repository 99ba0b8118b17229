//! The parts of a map: nodes, parameters that are made known, and programs.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::{Map as JsonMap, Value as Json};

use super::axes::{self, Axis};
use super::repeat::Repeat;

/// The module of the nodes by which values come into a map.
pub(crate) const MAP_INPUT_ID: &str = "MapInput";

/// One use of a module.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(expecting = "an object with a \"module\"")]
pub struct Node {
    /// Id of the module.
    pub module: String,
    /// Whether it runs.
    #[serde(default, skip_serializing_if = "NodeMode::is_active")]
    pub mode: NodeMode,
    /// Whether it runs more than once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeat: Option<Repeat>,
    /// Parameters that differ from their defaults.
    #[serde(default, skip_serializing_if = "JsonMap::is_empty")]
    pub params: JsonMap<String, Json>,
    /// Fields that this version does not know.
    #[serde(flatten)]
    pub extra: JsonMap<String, Json>,
}

/// Whether a node runs, and what becomes of those that need it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NodeMode {
    /// It runs.
    #[default]
    Active,
    /// It does not run, and neither does any node that needs a value of it.
    Muted,
    /// It does not run; each output passes on what comes to the first input of the same type.
    Bypassed,
}

impl Node {
    /// Whether its module is a map: the name of one in `maps`, or the path of a map's file. Names
    /// of modules begin with a capital.
    pub fn is_map(&self) -> bool {
        let is_file = self.module.ends_with(".json");
        is_file || self.module.starts_with(|c: char| !c.is_uppercase())
    }
}

impl NodeMode {
    /// Whether the node runs.
    pub fn is_active(&self) -> bool {
        *self == Self::Active
    }
}

/// Where the value of a parameter of a whole map goes: `"simplify.ratio"`, or a list of such paths.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Promoted {
    /// To one parameter.
    One(String),
    /// To several, of which the first says what values there are.
    Many(Vec<String>),
}

impl Promoted {
    /// The dotted paths of the parameters.
    pub fn paths(&self) -> &[String] {
        match self {
            Self::One(path) => std::slice::from_ref(path),
            Self::Many(paths) => paths,
        }
    }
}

/// A named sweep of the map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(expecting = "an object with \"axes\" or \"steps\"")]
pub struct ProgramSpec {
    /// Axes multiply; within an axis the lists are equally long and advance together. The last
    /// axis varies fastest.
    ///
    /// A value may stand for many, `{"glob": "scans/*.obj"}`, `{"range": [0.1, 0.5, 5]}` or
    /// `{"log": [0.02, 0.5, 5]}`; alone, it stands in the file without the brackets of a list.
    #[serde(default, skip_serializing_if = "Vec::is_empty", with = "axes")]
    pub axes: Vec<Axis>,
    /// Explicit assignments, after those of the axes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<IndexMap<String, Json>>,
    /// How often each assignment runs, with seeds that differ from one to the next.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeats: Option<u32>,
    /// Seconds after which a step is stopped.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_limit: Option<f64>,
    /// What the report shows and answers; see [`crate::ReportSpec`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub report: Option<Json>,
    /// Fields that this version does not know.
    #[serde(flatten)]
    pub extra: JsonMap<String, Json>,
}
