//! The steps of a program: each planned, and all compared.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use indexmap::IndexMap;
use serde_json::Value as Json;

use super::Step;
use super::columns::{Columns, deciders};
use crate::fingerprint::Fingerprint;
use crate::map::Map;
use crate::param::{MODULE, Setting};
use crate::plan::{
    Plan, PlanNode, PlanOptions, PlanSeries, SeriesPlan, is_of_round, no_file, one_case,
};
use crate::problem::Problem;
use crate::registry::Registry;

/// Values of parameters by their dotted paths.
pub(super) type Assignment = IndexMap<String, Json>;

/// Problems of single steps that are listed; more say nothing new.
const MOST_PROBLEMS: usize = 20;

/// What to do where repeats write one file.
const ADVICE_REPEATS: &str = "put {repeat} into the name";

static NO_ASSIGNMENT: LazyLock<Assignment> = LazyLock::new(Assignment::new);

/// What the steps of a program are: a map with each assignment, as often as it is repeated.
#[derive(Clone, Copy)]
pub(super) struct Sweep<'a> {
    pub map: &'a Map,
    pub registry: &'a Registry,
    pub options: PlanOptions<'a>,
    pub assignments: &'a [Assignment],
    pub repeats: u32,
}

/// All steps, and what is the case for them together.
#[derive(Default)]
pub(super) struct Steps {
    /// Those that can be planned, in order.
    pub steps: Vec<Step>,
    /// Names of the nodes, in running order.
    pub nodes: Vec<String>,
    /// Input files with the fingerprints of their content.
    pub inputs: IndexMap<PathBuf, Fingerprint>,
    /// Modules that some step runs, with their versions.
    pub modules: BTreeMap<&'static str, Fingerprint>,
    pub columns: Columns,
    /// The outside programs that steps run, each with its node.
    pub command_lines: BTreeSet<(String, String)>,
    /// Each once, with the step where it was first seen.
    pub problems: Vec<Problem>,
    /// In how many different steps each key occurs; 2 stands for more.
    keys: HashMap<Fingerprint, u32, BuildHasherDefault<FirstBytes>>,
    ids: HashSet<String>,
    /// How many different steps each draft of the series gave.
    drafts: HashMap<usize, u32>,
    /// Nodes whose columns are known: the draft, the place there, and what decides them.
    known: HashSet<(usize, usize, Vec<&'static str>)>,
    /// The step that writes each path, in one case.
    writers: HashMap<String, usize>,
    /// A step that needs each folder.
    folders: HashMap<String, usize>,
    reported: HashSet<String>,
}

impl Steps {
    /// Plans every assignment as often as it is repeated.
    pub fn plan(sweep: Sweep) -> Self {
        let Sweep { map, registry, options, assignments, repeats } = sweep;
        let mut steps = Self::default();
        let n_steps = assignments.len().saturating_mul(repeats as usize);
        steps.steps.reserve(n_steps);
        steps.ids.reserve(n_steps);
        steps.keys.reserve(n_steps);
        let mut series = PlanSeries::new(map, registry, options);
        for params in assignments {
            for repeat in 0..repeats {
                let problems = match series.plan(params, repeat) {
                    Ok(planned) => steps.add(&planned, params, repeat),
                    Err(problems) => problems,
                };
                for problem in problems {
                    let is_of_map = map.problems().contains(&problem);
                    steps.report(problem, if is_of_map { &NO_ASSIGNMENT } else { params });
                }
            }
        }
        steps.cut_problems();
        steps
    }

    /// Keys of nodes that more than one step runs.
    pub fn shared_keys(&self) -> HashSet<Fingerprint> {
        self.keys.iter().filter(|(_, n)| **n > 1).map(|(key, _)| *key).collect()
    }

    /// Adds a step; gives the warnings that were not there before.
    fn add(&mut self, planned: &SeriesPlan, params: &Assignment, repeat: u32) -> Vec<Problem> {
        let plan = planned.plan;
        let id = plan.id.short();
        if self.nodes.is_empty() {
            let names = plan.nodes.iter().map(|node| &node.name);
            self.nodes = names.filter(|name| !is_of_round(name)).cloned().collect();
        }
        let is_new = self.ids.insert(id.clone());
        let n_before = self.drafts.get(&planned.draft).copied();
        if is_new {
            // What did not change between the first two has been counted twice, which is enough.
            if n_before.unwrap_or(0) < 2 {
                *self.drafts.entry(planned.draft).or_default() += 1;
                (0..plan.nodes.len()).for_each(|place| self.enter(planned, place, params));
            } else {
                planned.changed.iter().for_each(|place| self.enter(planned, *place, params));
            }
        }
        self.steps.push(Step { id, repeat, params: params.clone() });
        // Those of one draft are the same.
        if n_before.is_none() { plan.warnings.clone() } else { Vec::new() }
    }

    /// Enters a node of the step that is about to be added.
    fn enter(&mut self, planned: &SeriesPlan, place: usize, params: &Assignment) {
        let node = &planned.plan.nodes[place];
        let count = self.keys.entry(node.key).or_default();
        *count = (*count + 1).min(2);
        self.check_outputs(planned.plan, node, params);
        let missing = no_file();
        let reads = node.reads.iter().filter(|(_, content)| *content != missing);
        self.inputs.extend(reads.cloned());
        if node.info.module.runs_programs() {
            let lines = node.command_lines().into_iter();
            self.command_lines.extend(lines.map(|(_, line)| (node.name.clone(), line.to_string())));
        }
        if self.known.insert((planned.draft, place, deciders(node))) {
            self.modules.insert(node.info.module.id, node.info.version);
            if !is_of_round(&node.name) {
                self.columns.add(node);
            }
        }
    }

    /// Finds files of other steps where the node of the next one writes.
    fn check_outputs(&mut self, plan: &Plan, node: &PlanNode, params: &Assignment) {
        // A file beside another one, such as the materials of a mesh, is no second fault.
        let mut is_told = false;
        let this = self.steps.len();
        for path in &node.writes {
            // As text, which is hashed faster than a path.
            let written = one_case(path).to_string_lossy().into_owned();
            // Of a file and a folder of one name, whichever comes second finds the other.
            let above = || Path::new(&written).ancestors().skip(1).filter_map(Path::to_str);
            let folder = above().find_map(|folder| self.writers.get(folder)).copied();
            let inside = self.folders.get(&written).copied();
            for folder in above() {
                match self.folders.get_mut(folder) {
                    Some(step) => *step = this,
                    None => drop(self.folders.insert(folder.to_owned(), this)),
                }
            }
            let other = self.writers.insert(written, this);
            if let Some(other) = other.or(folder).or(inside)
                && !std::mem::replace(&mut is_told, true)
                && self.reported.insert(format!("write {}", one_case(path).display()))
            {
                let other = self.steps.get(other).map_or(params, |step| &step.params);
                let message = clash(plan, (node, path), other, params);
                self.problems.push(Problem::error(message).at(&node.name));
            }
        }
    }

    /// Reports a problem once, with the step where it was first seen.
    fn report(&mut self, problem: Problem, params: &Assignment) {
        if self.reported.insert(problem.to_string()) {
            let step = shown(params);
            let message = match step.is_empty() {
                true => problem.message.clone(),
                false => format!("{} (with {step})", problem.message),
            };
            self.problems.push(Problem { message, ..problem });
        }
    }

    fn cut_problems(&mut self) {
        let hidden = self.problems.split_off(self.problems.len().min(MOST_PROBLEMS));
        if let Some(first) = hidden.first() {
            let severity =
                hidden.iter().find(|problem| problem.is_error()).unwrap_or(first).severity;
            self.problems.push(Problem { severity, ..Problem::more(hidden.len()) });
        }
    }
}

/// Takes the first eight bytes of a fingerprint, which is a hash already, for its hash.
#[derive(Default)]
struct FirstBytes(u64);

impl Hasher for FirstBytes {
    fn write(&mut self, bytes: &[u8]) {
        if let Some(first) = bytes.first_chunk() {
            self.0 = u64::from_le_bytes(*first);
        }
    }

    // How many bytes there are is the same of all.
    fn write_usize(&mut self, _: usize) {}

    fn finish(&self) -> u64 {
        self.0
    }
}

/// Says that two steps, or two repeats of one, write one path, and what to put into its name.
fn clash(
    plan: &Plan,
    (node, path): (&PlanNode, &Path),
    other: &Assignment,
    params: &Assignment,
) -> String {
    let (path, step) = (path.display(), shown(params));
    match (other == params, step.is_empty()) {
        (true, true) => return format!("two repeats write \"{path}\": {ADVICE_REPEATS}"),
        (true, false) => return format!("two repeats write \"{path}\" ({step}): {ADVICE_REPEATS}"),
        (false, _) => {}
    }
    let files = node.settings.files(node.info.module.params);
    let is_named =
        |reference: &str| files.iter().any(|(_, _, written)| written.contains(reference));
    let mut references: Vec<String> = Vec::new();
    for (name, value) in params.iter().chain(other) {
        let reference = reference_to(plan, name);
        let quoted = [reference.clone(), format!("{{{name}}}"), format!("{{{name}.")];
        if (params.get(name), other.get(name)) != (Some(value), Some(value))
            && !references.contains(&reference)
            && !quoted.iter().any(|quoted| is_named(quoted))
        {
            references.push(reference);
        }
    }
    // Values may differ and their words not: scans of one name in two folders.
    let advice = if references.is_empty() { "{step}".to_owned() } else { references.join(" and ") };
    format!("two steps write \"{path}\": {}; and {step}. Put {advice} into the name", shown(other))
}

/// What names the value of a parameter in the name of a file: where that is a module or a file,
/// what comes from it.
fn reference_to(plan: &Plan, path: &str) -> String {
    let mut parts = path.split('.');
    let (node, param) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    let planned = plan.nodes.iter().find(|planned| planned.name == node);
    let setting = planned.and_then(|planned| planned.settings.find(param));
    match setting {
        _ if param == MODULE => format!("{{{node}.source}}"),
        Some(Setting::File { .. }) => format!("{{{node}.source}}"),
        _ => format!("{{{node}.{param}}}"),
    }
}

/// An assignment in a line.
pub(super) fn shown(params: &Assignment) -> String {
    params.iter().map(|(path, value)| format!("{path} = {value}")).collect::<Vec<_>>().join(", ")
}
