//! `mve check`: all problems of a map and of its programs.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::PathBuf;

use mve_core::{CommandScope, Map, OutputScope, Place, Problem, Program, ProgramSpec, Severity};

use crate::exit::{Exit, Stop};
use crate::load::{Loaded, SetArgs};
use crate::out;

/// List all problems of maps and of their programs
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve check maps/classic_experiment.json
  mve check maps/*.json
  mve check maps/obj_file.json --set simplify.target_faces=300
  mve check --json - < map.json

Nothing is run and nothing is written; outside programs that the map would run are listed. The \
exit code is 3 where there are errors; warnings alone give 0.")]
pub struct Args {
    /// The maps' files; - for standard input
    #[arg(required = true, value_name = "MAP")]
    maps: Vec<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
    /// Allow savers to write outside the output folder
    #[arg(long)]
    allow_outside: bool,
    /// Print a line of JSON a problem, and one a map
    #[arg(long)]
    json: bool,
}

/// The problems of the map, or of one program.
struct Group {
    title: String,
    problems: Vec<Problem>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    let mut worst = Ok(Exit::Done);
    for (place, map) in args.maps.iter().enumerate() {
        let checked = args.set.load(map).and_then(|loaded| check(&loaded, args));
        match checked {
            Ok(_) => {}
            Err(stop) if place + 1 == args.maps.len() => worst = Err(stop),
            Err(stop) => {
                out::complain(&stop.message);
                worst = Err(Stop { message: String::new(), ..stop });
            }
        }
    }
    worst
}

/// Checks one map.
fn check(loaded: &Loaded, args: &Args) -> Result<Exit, Stop> {
    let scope = if args.allow_outside { OutputScope::Anywhere } else { OutputScope::Folder };
    let mut commands = BTreeSet::new();
    let problems = match loaded.plan(None, scope, CommandScope::All) {
        Ok(plan) => {
            for node in &plan.nodes {
                let lines = node.command_lines().into_iter();
                commands.extend(lines.map(|(_, line)| (node.name.clone(), line.to_string())));
            }
            plan.warnings
        }
        Err(problems) => problems,
    };
    let problems: Vec<_> =
        problems.into_iter().map(|problem| of_programs_alone(&loaded.map, problem)).collect();
    let known = problems.clone();
    let (mut own, of_programs): (Vec<_>, Vec<_>) =
        problems.into_iter().partition(|problem| problem.place.program.is_none());
    own.dedup();
    let mut facts = Vec::new();
    let mut groups = vec![Group { title: loaded.path.display().to_string(), problems: own }];
    for name in loaded.map.programs.keys() {
        let (map, registry) = (&loaded.map, &loaded.registry);
        let checked = Program::allowing(CommandScope::All, map, name, registry, loaded.folder());
        let problems = match checked {
            Ok(program) => {
                commands.extend(program.command_lines);
                facts.push(format!("{name}: {}", count(program.steps.len(), "step")));
                program.warnings
            }
            Err(problems) => problems,
        };
        let mut problems: Vec<_> =
            problems.into_iter().filter(|problem| !is_known(problem, &known)).collect();
        if problems.iter().all(Problem::counts_others) {
            // Those that it counts are of the map, and have been told.
            problems.clear();
        }
        let is_own = |problem: &&Problem| problem.place.program.as_ref() == Some(name);
        problems.extend(of_programs.iter().filter(is_own).cloned());
        groups.push(Group { title: format!("program \"{name}\""), problems });
    }
    for problem in of_programs {
        // A program that could not even be read is not among those of the map.
        let name = problem.place.program.clone().unwrap_or_default();
        if !loaded.map.programs.contains_key(&name) {
            let title = format!("program \"{name}\"");
            match groups.iter_mut().find(|group| group.title == title) {
                Some(group) => group.problems.push(problem),
                None => groups.push(Group { title, problems: vec![problem] }),
            }
        }
    }
    match args.json {
        true => report_json(loaded, &groups, &commands),
        false => report(loaded, &groups, &facts, &commands),
    }
}

/// A line a problem, then one for the map.
fn report_json(
    loaded: &Loaded,
    groups: &[Group],
    commands: &BTreeSet<(String, String)>,
) -> Result<Exit, Stop> {
    let all = || groups.iter().flat_map(|group| &group.problems);
    for problem in all() {
        out::json(&loaded.problem_line(problem))?;
    }
    for (node, command) in commands {
        out::json(&serde_json::json!({ "event": "command", "node": node, "command": command }))?;
    }
    let errors = all().filter(|problem| problem.is_error()).count();
    let warnings = all().count() - errors;
    let status = if errors == 0 { "fine" } else { "refused" };
    out::json(&serde_json::json!({
        "event": "checked", "map": loaded.path, "status": status, "errors": errors,
        "warnings": warnings
    }))?;
    if errors == 0 { Ok(Exit::Done) } else { Err(Stop::refused("")) }
}

/// A problem as a warning where it is of a parameter that the map leaves open and every program
/// sets: that is no fault, as long as it is a program that runs.
fn of_programs_alone(map: &Map, problem: Problem) -> Problem {
    let Place { node: Some(node), port: Some(port), program: None, .. } = &problem.place else {
        return problem;
    };
    let first = port.split('.').next().unwrap_or_default();
    if map.nodes.get(node).is_none_or(|node| node.params.contains_key(first)) {
        return problem;
    }
    let path = format!("{node}.{port}");
    let sets = |program: &ProgramSpec| {
        let (axes, steps) = (&program.axes, &program.steps);
        (!axes.is_empty() || !steps.is_empty())
            && (axes.is_empty() || axes.iter().any(|axis| axis.contains_key(&path)))
            && steps.iter().all(|step| step.contains_key(&path))
    };
    if map.programs.is_empty() || !map.programs.values().all(sets) || !problem.is_error() {
        return problem;
    }
    let message = format!("{}; only programs, which set it, can run this map", problem.message);
    Problem { severity: Severity::Warning, message, ..problem }
}

/// Whether the map alone has this problem of a step. What a program adds to it stands behind it.
fn is_known(problem: &Problem, known: &[Problem]) -> bool {
    known.iter().any(|known| {
        (&known.place.node, &known.place.port) == (&problem.place.node, &problem.place.port)
            && problem.message.starts_with(&known.message)
    })
}

fn report(
    loaded: &Loaded,
    groups: &[Group],
    facts: &[String],
    commands: &BTreeSet<(String, String)>,
) -> Result<Exit, Stop> {
    let all = || groups.iter().flat_map(|group| &group.problems);
    let n_errors = all().filter(|problem| problem.is_error()).count();
    let n_warnings = all().count() - n_errors;
    let mut text = String::new();
    for group in groups.iter().filter(|group| !group.problems.is_empty()) {
        let _ = writeln!(text, "{}", out::styled(&group.title, out::Style::Bold));
        for problem in &group.problems {
            let mut line = problem.clone();
            // The title says which program it is.
            line.place.program = None;
            let mark = match problem.is_error() {
                true => out::error_mark(),
                false => out::warning_mark(),
            };
            let place = match loaded.map.position_of(problem) {
                Some(position) => format!("{position}: "),
                None => String::new(),
            };
            let _ = writeln!(text, "  {mark} {place}{line}");
        }
    }
    if n_errors == 0 {
        let map = &loaded.map;
        let mut line = vec![count(map.nodes.len(), "node"), count(map.links.len(), "link")];
        line.push(match facts.is_empty() {
            true => "no programs".to_owned(),
            false => format!("{} ({})", count(facts.len(), "program"), facts.join(", ")),
        });
        let found = match n_warnings {
            0 => "no problems".to_owned(),
            n => format!("no errors, {}", count(n, "warning")),
        };
        let _ = writeln!(text, "{}: {found}; {}", loaded.path.display(), line.join(", "));
    }
    if !commands.is_empty() {
        let _ = writeln!(text, "runs outside programs, with --allow-commands alone:");
    }
    for (node, command) in commands {
        let _ = writeln!(text, "  {node}: {command}");
    }
    out::print(&text)?;
    if n_errors == 0 {
        return Ok(Exit::Done);
    }
    let warnings =
        if n_warnings > 0 { format!(", {}", count(n_warnings, "warning")) } else { String::new() };
    let path = loaded.path.display();
    Err(Stop::refused(format!("{path}: {}{warnings}", count(n_errors, "problem"))))
}

/// `1 step`, `2 steps`.
pub fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
