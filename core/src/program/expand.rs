//! From axes, explicit steps and repeats to a checked list of steps.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::Duration;

use indexmap::IndexMap;
use serde_json::Value as Json;

use super::columns::Columns;
use super::report_spec::About;
use super::spread::{MOST_STEPS, spread};
use super::{Program, ReportSpec, Step};
use crate::files::FileHashes;
use crate::fingerprint::Fingerprint;
use crate::map::{Axis, Map, ProgramSpec};
use crate::param::{MODULE, Setting};
use crate::plan::{Plan, assign, no_file, one_case};
use crate::problem::{Problem, did_you_mean};
use crate::registry::Registry;

/// Problems of single steps that are listed; more say nothing new.
const MOST_PROBLEMS: usize = 20;

type Assignment = IndexMap<String, Json>;

static NO_ASSIGNMENT: LazyLock<Assignment> = LazyLock::new(Assignment::new);

impl Program {
    /// Checks a program of a map: every step is planned, and the files that steps write are
    /// compared. The error lists all problems.
    pub fn new(
        map: &Map,
        name: &str,
        registry: &Registry,
        map_folder: &Path,
    ) -> Result<Self, Vec<Problem>> {
        let Some(spec) = map.programs.get(name) else {
            let hint = did_you_mean(name, map.programs.keys().map(String::as_str));
            let all: Vec<_> = map.programs.keys().map(String::as_str).collect();
            let all = if all.is_empty() { "no programs".to_owned() } else { all.join(", ") };
            let message = format!("the map has no such program; it has {all}{hint}");
            return Err(vec![Problem::error(message).in_program(name)]);
        };
        let in_program = |problem: Problem| problem.in_program(name);
        let assignments = assignments(spec, map_folder)
            .map_err(|p| p.into_iter().map(in_program).collect::<Vec<_>>())?;
        let values = values_of(&assignments);
        let varied: Vec<String> = values.keys().cloned().collect();
        let refused = |faults: Vec<String>| {
            faults.into_iter().map(Problem::error).map(in_program).collect::<Vec<_>>()
        };
        let report = spec.report.as_ref().map(ReportSpec::parse).transpose().map_err(refused)?;
        let time_limit = time_limit_of(spec).map_err(|problem| vec![in_program(problem)])?;
        let mut program = Self {
            name: name.to_owned(),
            steps: Vec::with_capacity(assignments.len()),
            varied,
            warnings: Vec::new(),
            report: report.unwrap_or_default(),
            columns: Columns::default(),
            map_file: String::new(),
            map_path: PathBuf::new(),
            spec: spec.clone(),
            map: map.without_programs(),
            map_folder: map_folder.to_owned(),
            registry: registry.clone(),
            files: FileHashes::new(),
            time_limit,
            shared: HashSet::new(),
            inputs: IndexMap::new(),
            modules: BTreeMap::new(),
            nodes: Vec::new(),
        };
        let mut checker = Checker::default();
        for assignment in &assignments {
            for repeat in 0..spec.repeats.unwrap_or(1) {
                program.add_step(assignment, repeat, &mut checker);
            }
        }
        program.shared = checker.keys.into_iter().filter(|(_, n)| *n > 1).map(|(k, _)| k).collect();
        let n_hidden = checker.problems.len().saturating_sub(MOST_PROBLEMS);
        checker.problems.truncate(MOST_PROBLEMS);
        if n_hidden > 0 {
            let message = format!("{n_hidden} more problems of this kind");
            checker.problems.push(Problem::error(message));
        }
        if checker.problems.iter().any(Problem::is_error) {
            return Err(checker.problems.into_iter().map(in_program).collect());
        }
        program.warnings = checker.problems;
        program.columns.settle();
        let faults = program.faults_of_report(map, values);
        if faults.is_empty() { Ok(program) } else { Err(refused(faults)) }
    }

    /// What its report says of columns and parameters that are not there.
    fn faults_of_report(&self, map: &Map, values: IndexMap<String, Vec<&Json>>) -> Vec<String> {
        let idle = map.nodes.iter().filter(|(_, node)| !node.mode.is_active());
        self.report.faults(&About {
            columns: &self.columns,
            nodes: &self.nodes,
            idle: idle.map(|(name, _)| name.clone()).collect(),
            values,
        })
    }

    fn add_step(&mut self, params: &Assignment, repeat: u32, checker: &mut Checker) {
        match self.plan(params, repeat) {
            Err(problems) => self.report(problems, params, checker),
            Ok(plan) => {
                self.report(plan.warnings.clone(), params, checker);
                if self.nodes.is_empty() {
                    self.nodes = plan.nodes.iter().map(|node| node.name.clone()).collect();
                }
                let id = plan.id.short();
                checker.check_outputs(&plan, &id, params);
                let missing = no_file();
                for node in &plan.nodes {
                    let reads = node.reads.iter().filter(|(_, content)| *content != missing);
                    self.inputs.extend(reads.cloned());
                    self.modules.insert(node.info.module.id, node.info.version);
                    self.columns.add(node);
                }
                self.steps.push(Step { id, repeat, params: params.clone() });
            }
        }
    }
}

impl Program {
    /// Reports the problems of a step; those of the map itself are of no step, and those of other
    /// programs none of this one.
    fn report(&self, problems: Vec<Problem>, params: &Assignment, checker: &mut Checker) {
        for problem in problems {
            let program = problem.place.program.as_ref();
            if program.is_none_or(|name| *name == self.name) {
                let is_of_map = self.map.problems().contains(&problem);
                checker.report(problem, if is_of_map { &NO_ASSIGNMENT } else { params });
            }
        }
    }

    /// The plan of the map with these parameters.
    pub(super) fn plan(&self, params: &Assignment, repeat: u32) -> Result<Plan, Vec<Problem>> {
        let mut map = self.map.clone();
        for (path, value) in in_order(params) {
            assign(&mut map, &self.registry, path, value.clone()).map_err(|p| vec![p])?;
        }
        Plan::new(&map, &self.registry, &self.plan_options(repeat))
    }
}

/// The time that the program gives a step.
fn time_limit_of(spec: &ProgramSpec) -> Result<Option<Duration>, Problem> {
    let is_limit = |seconds: &f64| *seconds > 0.0 && *seconds < 1e9;
    if let Some(seconds) = spec.time_limit.filter(|seconds| !is_limit(seconds)) {
        let message = format!("\"time_limit\": {seconds} is not a number of seconds above 0");
        return Err(Problem::error(message));
    }
    Ok(spec.time_limit.map(Duration::from_secs_f64))
}

/// Modules first, then shorter paths first, so that a module is there before its parameters are set
/// and a choice is made before its own.
fn in_order(params: &Assignment) -> Vec<(&String, &Json)> {
    let mut sorted: Vec<_> = params.iter().collect();
    let is_module = |path: &str| path.split_once('.').is_some_and(|(_, param)| param == MODULE);
    sorted.sort_by_key(|(path, _)| (!is_module(path), path.split('.').count()));
    sorted
}

/// What to do where repeats write one file.
const ADVICE_REPEATS: &str = "put {repeat} into the name";

/// What is remembered of the steps so far to check the next.
#[derive(Default)]
struct Checker {
    /// The parameters of the step that writes each path.
    writers: BTreeMap<PathBuf, Assignment>,
    /// Those of a step that needs each folder.
    folders: BTreeMap<PathBuf, Assignment>,
    /// In how many different steps each key occurs.
    keys: HashMap<Fingerprint, u32>,
    ids: HashSet<String>,
    problems: Vec<Problem>,
    reported: HashSet<String>,
}

impl Checker {
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

    fn check_outputs(&mut self, plan: &Plan, id: &str, params: &Assignment) {
        if !self.ids.insert(id.to_owned()) {
            return;
        }
        for node in &plan.nodes {
            *self.keys.entry(node.key).or_default() += 1;
            // A file beside another one, such as the materials of a mesh, is no second fault.
            let mut is_told = false;
            for path in &node.writes {
                let other = self.writers.insert(one_case(path), params.clone());
                // Of a file and a folder of one name, whichever comes second finds the other.
                let folder = one_case(path).ancestors().skip(1).find_map(|f| self.writers.get(f));
                let inside = self.folders.get(&one_case(path)).cloned();
                if let Some(other) = other.or(folder.cloned()).or(inside)
                    && !std::mem::replace(&mut is_told, true)
                    && self.reported.insert(format!("write {}", one_case(path).display()))
                {
                    let message = clash(plan, path, &other, params);
                    self.problems.push(Problem::error(message).at(&node.name));
                }
                for folder in one_case(path).ancestors().skip(1) {
                    self.folders.insert(folder.to_owned(), params.clone());
                }
            }
        }
    }
}

/// Says that two steps, or two repeats of one, write one path, and what to put into its name.
fn clash(plan: &Plan, path: &Path, other: &Assignment, params: &Assignment) -> String {
    let (path, step) = (path.display(), shown(params));
    match (other == params, step.is_empty()) {
        (true, true) => return format!("two repeats write \"{path}\": {ADVICE_REPEATS}"),
        (true, false) => return format!("two repeats write \"{path}\" ({step}): {ADVICE_REPEATS}"),
        (false, _) => {}
    }
    let mut references: Vec<String> = Vec::new();
    for (name, value) in params.iter().chain(other) {
        let is_known = |reference: &String| references.contains(reference);
        let reference = reference_to(plan, name);
        if (params.get(name), other.get(name)) != (Some(value), Some(value))
            && !is_known(&reference)
        {
            references.push(reference);
        }
    }
    let references = references.join(" and ");
    format!(
        "two steps write \"{path}\": {}; and {step}. Put {references} into the name",
        shown(other)
    )
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
fn shown(params: &Assignment) -> String {
    params.iter().map(|(path, value)| format!("{path} = {value}")).collect::<Vec<_>>().join(", ")
}

/// The different values of each parameter that is varied, in their order.
fn values_of(assignments: &[Assignment]) -> IndexMap<String, Vec<&Json>> {
    let mut values: IndexMap<String, Vec<&Json>> = IndexMap::new();
    let mut known = HashSet::new();
    for (path, value) in assignments.iter().flatten() {
        if known.insert((path, value.to_string())) {
            values.entry(path.clone()).or_default().push(value);
        }
    }
    values
}

/// The values that stand more than once in an axis, and the parameters that an earlier axis varies
/// already: of either only one step would be left.
fn slips_of(axes: &[Axis]) -> Vec<Problem> {
    let mut slips = Vec::new();
    let mut axis_of = HashMap::new();
    for (place, axis) in axes.iter().enumerate() {
        for path in axis.keys() {
            if let Some(earlier) = axis_of.insert(path, place + 1) {
                let message = format!(
                    "axes {earlier} and {} both vary \"{path}\", and the last would count; put \
                     all its values into one",
                    place + 1
                );
                slips.push(Problem::error(message));
            }
        }
        let length = axis.values().map(Vec::len).min().unwrap_or(0);
        let mut known = HashSet::new();
        let values = |i: usize| axis.iter().map(move |(p, list)| format!("{p} = {}", list[i]));
        let all = (0..length).map(|i| values(i).collect::<Vec<_>>().join(", "));
        if let Some(doubled) = all.into_iter().find(|values| !known.insert(values.clone())) {
            let message = format!(
                "axis {} has {doubled} twice; \"repeats\" runs each step more than once",
                place + 1
            );
            slips.push(Problem::error(message));
        }
    }
    slips
}

/// All assignments of a program: the product of its axes, then its explicit steps. Files are looked
/// for from `folder`.
fn assignments(spec: &ProgramSpec, folder: &Path) -> Result<Vec<Assignment>, Vec<Problem>> {
    let mut problems = Vec::new();
    let mut axes = Vec::new();
    for (place, axis) in spec.axes.iter().enumerate() {
        match spread(axis, folder) {
            Ok(axis) => axes.push(axis),
            Err(why) => problems.push(Problem::error(format!("axis {}: {why}", place + 1))),
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    problems.extend(slips_of(&axes));
    let mut all = vec![Assignment::new()];
    let mut total = 1_usize;
    for (place, axis) in axes.iter().enumerate() {
        let lengths: Vec<String> =
            axis.iter().map(|(path, list)| format!("{path} has {}", list.len())).collect();
        let length = axis.values().map(Vec::len).min().unwrap_or(0);
        if axis.values().any(|list| list.len() != length) {
            let message = format!(
                "axis {}: lists that advance together must be equally long, but {}; lists that \
                 should multiply go into axes of their own",
                place + 1,
                lengths.join(", ")
            );
            problems.push(Problem::error(message));
        } else if length == 0 {
            let message = format!("axis {} is empty: give it a list of values", place + 1);
            problems.push(Problem::error(message));
        }
        total = total.saturating_mul(length);
        if !problems.is_empty() || total > MOST_STEPS {
            continue;
        }
        let values =
            |i: usize| axis.iter().map(move |(path, list)| (path.clone(), list[i].clone()));
        all = all
            .iter()
            .flat_map(|before| (0..length).map(move |i| (before, i)))
            .map(|(before, i)| before.clone().into_iter().chain(values(i)).collect())
            .collect();
    }
    if spec.axes.is_empty() && !spec.steps.is_empty() {
        all.clear();
    }
    total =
        total.saturating_add(spec.steps.len()).saturating_mul(spec.repeats.unwrap_or(1) as usize);
    if total > MOST_STEPS {
        let message = format!("the program has {total} steps; the most is {MOST_STEPS}");
        problems.push(Problem::error(message));
    }
    if spec.repeats == Some(0) {
        problems.push(Problem::error("\"repeats\" is 0: nothing would run"));
    }
    all.extend(spec.steps.iter().cloned());
    if problems.is_empty() { Ok(all) } else { Err(problems) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(json: &str) -> ProgramSpec {
        serde_json::from_str(json).unwrap()
    }

    fn of(json: &str) -> Result<Vec<Assignment>, Vec<Problem>> {
        assignments(&spec(json), Path::new(""))
    }

    #[test]
    fn axes_multiply_and_lists_advance_together() {
        let spec = spec(
            r#"{"axes": [{"a.x": [1, 2], "a.y": ["p", "q"]}, {"b.z": [5, 6, 7]}],
                "steps": [{"a.x": 9}]}"#,
        );
        let all = assignments(&spec, Path::new("")).unwrap();
        assert_eq!(all.len(), 2 * 3 + 1);
        assert_eq!(shown(&all[0]), "a.x = 1, a.y = \"p\", b.z = 5");
        assert_eq!(shown(&all[4]), "a.x = 2, a.y = \"q\", b.z = 6");
        assert_eq!(shown(&all[6]), "a.x = 9");
    }

    #[test]
    fn steps_alone_do_not_add_the_map_as_it_is() {
        assert_eq!(of(r#"{"steps": [{"a.x": 1}]}"#).unwrap().len(), 1);
        assert_eq!(of("{}").unwrap().len(), 1);
    }

    #[test]
    fn a_parameter_has_one_axis_and_a_value_one_place_in_it() {
        let said = |json: &str| of(json).unwrap_err()[0].message.clone();
        let two = said(r#"{"axes": [{"a.x": [1, 2]}, {"b.y": [1]}, {"a.x": [3]}]}"#);
        assert!(two.starts_with("axes 1 and 3 both vary \"a.x\""), "{two}");
        let doubled = said(r#"{"axes": [{"a.x": [1, 2, 1], "a.y": [1, 2, 1]}]}"#);
        assert!(doubled.starts_with("axis 1 has a.x = 1, a.y = 1 twice"), "{doubled}");
        let fine = r#"{"axes": [{"a.x": [1, 2, 1], "a.y": [1, 2, 3]}]}"#;
        assert_eq!(of(fine).unwrap().len(), 3);
    }

    #[test]
    fn slips_are_reported_before_they_cost_memory() {
        let uneven = spec(r#"{"axes": [{"a.x": [1, 2], "a.y": [1]}]}"#);
        assert!(
            assignments(&uneven, Path::new("")).unwrap_err()[0].message.contains("equally long")
        );
        let list = (0..1000).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
        let axis = |name: &str| format!("{{\"a.{name}\": [{list}]}}");
        let huge = spec(&format!("{{\"axes\": [{}, {}, {}]}}", axis("x"), axis("y"), axis("z")));
        assert!(
            assignments(&huge, Path::new("")).unwrap_err()[0].message.contains("1000000000 steps")
        );
    }
}
