//! `plan.json`: what a program runs, kept in its store, for whoever reads the results.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::columns::Columns;
use super::report_spec::About;
use super::{Program, ProgramOptions, ReportFault, ReportSpec, Sharing, Step};
use crate::fingerprint::Fingerprint;
use crate::machine::Machine;
use crate::map::{Map, MapError, ProgramSpec};
use crate::param::MODULE;

/// Notes of runs that are kept, the last ones.
const MOST_RUNS: usize = 100;

/// What stands in `plan.json`. Fields that older versions did not write are empty.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlanFile {
    /// Name of the program.
    pub program: String,
    /// Version of mve.
    pub mve: String,
    /// Name of the map's file.
    #[serde(default)]
    pub map_file: String,
    /// Where that file is; empty where it is not known.
    #[serde(default)]
    pub map_path: PathBuf,
    /// Calls that ran steps, each with its machine, the oldest first.
    #[serde(default)]
    pub runs: Vec<RunNote>,
    /// Input files with the fingerprints of their content.
    pub inputs: IndexMap<String, Fingerprint>,
    /// Modules that some step runs, with their versions.
    pub modules: BTreeMap<String, Fingerprint>,
    /// The dotted paths of the parameters that vary.
    #[serde(default)]
    pub varied: Vec<String>,
    /// Of the parameters that vary the value without the program, where it is known: what the map
    /// says, else the default of the module.
    #[serde(default)]
    pub defaults: IndexMap<String, Json>,
    /// Names of the nodes, in running order.
    #[serde(default)]
    pub nodes: Vec<String>,
    /// The columns of numbers that its steps give, as modules declare them; empty if not known.
    #[serde(default)]
    pub columns: Columns,
    /// The program as the map says it.
    #[serde(default)]
    pub spec: ProgramSpec,
    /// The map without its programs.
    pub map: Json,
    /// All steps, in the order of the results.
    pub steps: Vec<Step>,
}

/// One call that ran steps of a program.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RunNote {
    /// When it began, in seconds since 1970 (UTC).
    pub started: u64,
    /// How long it took; none if it did not come to its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Steps that it ran.
    pub ran: usize,
    /// Steps at once.
    pub jobs: usize,
    /// Threads that modules share.
    pub threads: usize,
    /// Whether steps ran one at a time with nothing shared.
    pub is_timing: bool,
    /// Where.
    pub machine: Machine,
    /// Number of its process, to tell calls apart.
    process: u32,
}

impl RunNote {
    /// The note of a call that begins now.
    pub(super) fn begin(options: &ProgramOptions) -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let is_timing = options.sharing == Sharing::Timing;
        Self {
            started: now.as_secs(),
            seconds: None,
            ran: 0,
            jobs: if is_timing { 1 } else { options.jobs },
            threads: options.threads,
            is_timing,
            machine: Machine::this(),
            process: std::process::id(),
        }
    }

    /// Adds this note to those of other calls, in the place of an older one of the same call.
    pub(super) fn add_to(&self, runs: &mut Vec<Self>) {
        runs.retain(|run| (run.started, run.process) != (self.started, self.process));
        runs.push(self.clone());
        runs.drain(..runs.len().saturating_sub(MOST_RUNS));
    }
}

impl Program {
    /// The values of the parameters that vary as they are without the program.
    fn defaults(&self) -> IndexMap<String, Json> {
        let of_path = |path: &String| {
            let (node, param) = path.split_once('.')?;
            let node = self.map.nodes.get(node)?;
            if param == MODULE {
                return Some((path.clone(), Json::from(node.module.as_str())));
            }
            let of_module = || {
                let module = self.registry.find(&node.module)?.module;
                module.params.iter().find(|spec| spec.name == param)?.default_json()
            };
            let value = node.params.get(param).cloned().or_else(of_module)?;
            Some((path.clone(), value))
        };
        self.varied.iter().filter_map(of_path).collect()
    }
}

impl PlanFile {
    /// What a program runs, and the notes of calls that ran it.
    pub(super) fn of(program: &Program, runs: Vec<RunNote>) -> Self {
        let inputs = program.inputs.iter().map(|(path, hash)| (path.display().to_string(), *hash));
        let modules = program.modules.iter().map(|(id, version)| ((*id).to_owned(), *version));
        Self {
            program: program.name.clone(),
            mve: crate::VERSION.to_owned(),
            map_file: program.map_file.clone(),
            map_path: program.map_path.clone(),
            runs,
            inputs: inputs.collect(),
            modules: modules.collect(),
            varied: program.varied.clone(),
            defaults: program.defaults(),
            nodes: program.nodes.clone(),
            columns: program.columns.clone(),
            spec: program.spec.clone(),
            map: program.map.to_json(),
            steps: program.steps.clone(),
        }
    }

    /// What in a report does not fit these results.
    pub fn faults(&self, report: &ReportSpec) -> Vec<ReportFault> {
        let mut values: IndexMap<String, Vec<&Json>> = IndexMap::new();
        for (path, value) in self.steps.iter().flat_map(|step| &step.params) {
            let known = values.entry(path.clone()).or_default();
            if !known.contains(&value) {
                known.push(value);
            }
        }
        report.faults(&About {
            columns: &self.columns,
            nodes: &self.nodes,
            idle: Vec::new(),
            values,
        })
    }

    /// The map with this one program, as the text of a map file.
    pub fn map_text(&self) -> Result<String, MapError> {
        let mut map = Map::parse(&self.map.to_string())?;
        map.programs.insert(self.program.clone(), self.spec.clone());
        Ok(map.to_text())
    }
}
