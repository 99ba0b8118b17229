//! `plan.json`: what a program runs, kept in its store, for whoever reads the results.

use std::collections::BTreeMap;
use std::time::{SystemTime, UNIX_EPOCH};

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::{Program, ProgramOptions, Sharing, Step};
use crate::fingerprint::Fingerprint;
use crate::machine::Machine;
use crate::map::{Map, MapError, ProgramSpec};
use crate::store::{Store, StoreError};

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
    /// Names of the nodes, in running order.
    #[serde(default)]
    pub nodes: Vec<String>,
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
}

impl PlanFile {
    /// The map with this one program, as the text of a map file.
    pub fn map_text(&self) -> Result<String, MapError> {
        let mut map = Map::parse(&self.map.to_string())?;
        map.programs.insert(self.program.clone(), self.spec.clone());
        Ok(map.to_text())
    }
}

impl Program {
    /// Writes `plan.json`, with a note of this call, if it runs anything, beside those of others.
    pub(super) fn write_plan(
        &self,
        store: &Store,
        note: Option<&RunNote>,
    ) -> Result<(), StoreError> {
        store.alone(|| {
            let mut runs = store.plan().map(|plan| plan.runs).unwrap_or_default();
            if let Some(note) = note {
                let is_other =
                    |run: &RunNote| (run.started, run.process) != (note.started, note.process);
                runs.retain(is_other);
                runs.push(note.clone());
                runs.drain(..runs.len().saturating_sub(MOST_RUNS));
            }
            let inputs = self.inputs.iter().map(|(path, hash)| (path.display().to_string(), *hash));
            let modules = self.modules.iter().map(|(id, version)| ((*id).to_owned(), *version));
            let file = PlanFile {
                program: self.name.clone(),
                mve: crate::VERSION.to_owned(),
                map_file: self.map_file.clone(),
                runs,
                inputs: inputs.collect(),
                modules: modules.collect(),
                varied: self.varied.clone(),
                nodes: self.nodes.clone(),
                spec: self.spec.clone(),
                map: self.map.to_json(),
                steps: self.steps.clone(),
            };
            // Plain data, which JSON can always say.
            let text = serde_json::to_string_pretty(&file).unwrap_or_default() + "\n";
            store.write("plan.json", text.as_bytes())
        })
    }
}
