//! From axes, explicit steps and repeats to a checked list of steps.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

use indexmap::IndexMap;
use serde_json::Value as Json;

use super::report_spec::About;

use super::steps::{Assignment, Steps, Sweep};
use super::{Program, ReportFault, ReportSpec};
use crate::files::FileHashes;
use crate::json::Step;
use crate::map::{Axis, Map, ProgramSpec};
use crate::param::{CommandScope, declared_at};
use crate::plan::{OutputScope, Plan, PlanOptions, PlanSeries};
use crate::problem::{HOLDS_NO_STEERING, Problem, did_you_mean, is_steering};
use crate::registry::Registry;
use crate::spread::{MOST_STEPS, SpreadAxis, Spreader};

impl Program {
    /// Checks a program of a map: every step is planned, and the files that steps write are
    /// compared. The error lists all problems; outside programs are among them.
    pub fn new(
        map: &Map,
        name: &str,
        registry: &Registry,
        map_folder: &Path,
    ) -> Result<Self, Vec<Problem>> {
        Self::allowing(CommandScope::Nothing, map, name, registry, map_folder)
    }

    /// The same, where steps may run outside programs.
    pub fn allowing(
        command_scope: CommandScope,
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
        if name.contains(is_steering) {
            let message = format!("the name of a program {HOLDS_NO_STEERING}; give it another one");
            return Err(vec![in_program(Problem::error(message))]);
        }
        let registry = &registry.with_maps_of(map, map_folder);
        let said = Said::of(map, name, spec, (registry, map_folder))?;
        let values = values_of(&said.assignments);
        let varied: Vec<String> = values.keys().cloned().collect();
        let (mut bare, files) = (map.without_programs(), FileHashes::new());
        bare.forget_other_programs(name);
        let options = plan_options(map_folder, &files, command_scope);
        let steps = Steps::plan(Sweep {
            map: &bare,
            registry,
            options,
            assignments: &said.assignments,
            repeats: spec.repeats.unwrap_or(1),
        });
        if steps.problems.iter().any(Problem::is_error) {
            return Err(steps.problems.into_iter().map(in_program).collect());
        }
        let shared = steps.shared_keys();
        let of_steps = steps.problems.into_iter();
        let of_steps = of_steps.map(|warning| match bare.problems().contains(&warning) {
            true => warning,
            false => in_program(warning),
        });
        let of_steps: Vec<Problem> = of_steps.collect();
        let mut program = Self {
            name: name.to_owned(),
            varied,
            report: said.report,
            map_file: String::new(),
            map_path: PathBuf::new(),
            spec: spec.clone(),
            map: bare,
            map_folder: map_folder.to_owned(),
            registry: registry.clone(),
            files,
            time_limit: said.time_limit,
            shared,
            steps: steps.steps,
            warnings: said.remarks.into_iter().chain(of_steps).collect(),
            columns: steps.columns,
            inputs: steps.inputs,
            modules: steps.modules,
            nodes: steps.nodes,
            command_lines: steps.command_lines,
        };
        program.columns.settle();
        let faults = program.faults_of_report(map, values);
        if faults.is_empty() { Ok(program) } else { Err(refused(faults, name)) }
    }

    /// What its report says of columns and parameters that are not there.
    fn faults_of_report(
        &self,
        map: &Map,
        values: IndexMap<String, Vec<&Json>>,
    ) -> Vec<ReportFault> {
        let idle = map.nodes.iter().filter(|(_, node)| !node.mode.is_active());
        self.report.faults(&About {
            columns: &self.columns,
            nodes: &self.nodes,
            idle: idle.map(|(name, _)| name.clone()).collect(),
            values,
        })
    }
}

impl Program {
    /// The plan of the map with these parameters.
    pub(super) fn plan(&self, params: &Assignment, repeat: u32) -> Result<Plan, Vec<Problem>> {
        self.series().plan(params, repeat).map(|planned| planned.plan.clone())
    }

    /// Plans of the map with other parameters.
    pub(super) fn series(&self) -> PlanSeries<'_> {
        // What its steps run was allowed when it was made.
        let options = plan_options(&self.map_folder, &self.files, CommandScope::All);
        PlanSeries::new(&self.map, &self.registry, options)
    }
}

/// What a program says, read and found to be in order by itself.
struct Said {
    assignments: Vec<Assignment>,
    /// What a person should know of its axes.
    remarks: Vec<Problem>,
    report: ReportSpec,
    time_limit: Option<Duration>,
}

impl Said {
    fn of(
        map: &Map,
        name: &str,
        spec: &ProgramSpec,
        (registry, folder): (&Registry, &Path),
    ) -> Result<Self, Vec<Problem>> {
        let in_program = |problem: Problem| problem.in_program(name);
        let is_whole = |path: &str| takes_whole_numbers(map, registry, path);
        let spreader = Spreader { folder, is_whole: &is_whole };
        let (mut remarks, mut problems) = (Vec::new(), Vec::new());
        let assignments = assignments(spec, &spreader, &mut remarks).unwrap_or_else(|faults| {
            problems.extend(faults.into_iter().map(in_program));
            Vec::new()
        });
        let report =
            spec.report.as_ref().map_or_else(|| Ok(ReportSpec::default()), ReportSpec::parse);
        let report = report.unwrap_or_else(|faults| {
            problems.extend(refused(faults, name));
            ReportSpec::default()
        });
        let time_limit = time_limit_of(spec).unwrap_or_else(|problem| {
            problems.push(in_program(problem));
            None
        });
        let remarks = remarks.into_iter().map(in_program).collect();
        if problems.is_empty() {
            Ok(Self { assignments, remarks, report, time_limit })
        } else {
            Err(problems)
        }
    }
}

/// What is wrong with the report of a program.
fn refused(faults: Vec<ReportFault>, program: &str) -> Vec<Problem> {
    let problem = |fault: ReportFault| {
        let mut problem = Problem::error(fault.to_string()).in_program(program);
        problem.place.path = Some([vec!["report".into()], fault.path].concat().into());
        problem
    };
    faults.into_iter().map(problem).collect()
}

fn plan_options<'a>(
    map_folder: &'a Path,
    files: &'a FileHashes,
    command_scope: CommandScope<'a>,
) -> PlanOptions<'a> {
    PlanOptions {
        map_folder,
        output_folder: None,
        output_scope: OutputScope::Step,
        command_scope,
        repeat: 0,
        files,
    }
}

/// The time that the program gives a step.
fn time_limit_of(spec: &ProgramSpec) -> Result<Option<Duration>, Problem> {
    let is_limit = |seconds: &f64| *seconds > 0.0 && *seconds < 1e9;
    if let Some(seconds) = spec.time_limit.filter(|seconds| !is_limit(seconds)) {
        let message = format!("\"time_limit\": {seconds} is not a number of seconds above 0");
        return Err(Problem::error(message).along(["time_limit".into()]));
    }
    Ok(spec.time_limit.map(Duration::from_secs_f64))
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
                slips.push(Problem::error(message).along(in_axis(place, path)));
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
            slips.push(Problem::error(message).along(at_axis(place)));
        }
    }
    slips
}

fn at_axis(place: usize) -> [Step; 2] {
    ["axes".into(), Step::Item(place)]
}

fn in_axis(place: usize, path: &str) -> [Step; 3] {
    ["axes".into(), Step::Item(place), path.into()]
}

/// Whether a parameter takes whole numbers alone, by the module that the map has there.
fn takes_whole_numbers(map: &Map, registry: &Registry, path: &str) -> bool {
    let spec = path.split_once('.').and_then(|(node, param)| {
        let node = map.nodes.get(node)?;
        declared_at(registry.find(&node.module)?.module.params, Some(&node.params), param)
    });
    spec.is_some_and(|spec| spec.integer().is_some() || spec.seed().is_some())
}

/// The axes with every value written out.
fn spread(
    spec: &ProgramSpec,
    spreader: &Spreader,
    remarks: &mut Vec<Problem>,
) -> Result<Vec<Axis>, Vec<Problem>> {
    let mut problems = Vec::new();
    let mut axes = Vec::new();
    for (place, axis) in spec.axes.iter().enumerate() {
        match spreader.spread(axis) {
            Ok(SpreadAxis { axis, remarks: own }) => {
                axes.push(axis);
                remarks.extend(own.into_iter().map(|(path, text)| {
                    let message = format!("axis {}: {text}", place + 1);
                    Problem::warning(message).along(in_axis(place, &path))
                }));
            }
            Err((path, why)) => {
                let message = format!("axis {}: {why}", place + 1);
                problems.push(Problem::error(message).along(in_axis(place, &path)));
            }
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    Ok(axes)
}

/// All assignments of a program: the product of its axes, then its explicit steps. What a person
/// should know of them goes to `remarks`.
fn assignments(
    spec: &ProgramSpec,
    spreader: &Spreader,
    remarks: &mut Vec<Problem>,
) -> Result<Vec<Assignment>, Vec<Problem>> {
    let axes = spread(spec, spreader, remarks)?;
    let mut problems = slips_of(&axes);
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
            problems.push(Problem::error(message).along(at_axis(place)));
        } else if length == 0 {
            let message = format!("axis {} is empty: give it a list of values", place + 1);
            problems.push(Problem::error(message).along(at_axis(place)));
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
        problems.push(Problem::error(message).along(["axes".into()]));
    }
    if spec.repeats == Some(0) {
        let message = "\"repeats\" is 0: nothing would run";
        problems.push(Problem::error(message).along(["repeats".into()]));
    }
    all.extend(spec.steps.iter().cloned());
    if problems.is_empty() { Ok(all) } else { Err(problems) }
}

#[cfg(test)]
mod tests {
    use super::super::steps::shown;
    use super::*;

    fn spec(json: &str) -> ProgramSpec {
        serde_json::from_str(json).unwrap()
    }

    fn of(json: &str) -> Result<Vec<Assignment>, Vec<Problem>> {
        all_of(&spec(json))
    }

    fn all_of(spec: &ProgramSpec) -> Result<Vec<Assignment>, Vec<Problem>> {
        let spreader = Spreader { folder: Path::new(""), is_whole: &|_| false };
        assignments(spec, &spreader, &mut Vec::new())
    }

    #[test]
    fn axes_multiply_and_lists_advance_together() {
        let spec = spec(
            r#"{"axes": [{"a.x": [1, 2], "a.y": ["p", "q"]}, {"b.z": [5, 6, 7]}],
                "steps": [{"a.x": 9}]}"#,
        );
        let all = all_of(&spec).unwrap();
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
        assert!(all_of(&uneven).unwrap_err()[0].message.contains("equally long"));
        let list = (0..1000).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
        let axis = |name: &str| format!("{{\"a.{name}\": [{list}]}}");
        let huge = spec(&format!("{{\"axes\": [{}, {}, {}]}}", axis("x"), axis("y"), axis("z")));
        assert!(all_of(&huge).unwrap_err()[0].message.contains("1000000000 steps"));
    }
}
