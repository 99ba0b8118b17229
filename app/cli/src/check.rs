//! `mve check`: all problems of a map and of its programs.

use std::fmt::Write;

use mve_core::{OutputScope, Problem, Program};

use crate::exit::{Exit, Stop};
use crate::load::{Loaded, MapArgs};
use crate::out;

/// List all problems of a map and of its programs
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve check maps/vase.json
  mve check maps/vase.json --set simplify.target_faces=300

Nothing is run and nothing is written. The exit code is 3 where there are errors; warnings alone \
give 0.")]
pub struct Args {
    #[command(flatten)]
    map: MapArgs,
    /// Allow savers to write outside the output folder
    #[arg(long)]
    allow_outside: bool,
}

/// The problems of the map, or of one program.
struct Group {
    title: String,
    problems: Vec<Problem>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Exit, Stop> {
    let loaded = args.map.load()?;
    let scope = if args.allow_outside { OutputScope::Anywhere } else { OutputScope::Folder };
    let problems = loaded.plan(None, scope).map_or_else(|problems| problems, |plan| plan.warnings);
    let known = problems.clone();
    let (mut own, of_programs): (Vec<_>, Vec<_>) =
        problems.into_iter().partition(|problem| problem.place.program.is_none());
    own.dedup();
    let mut facts = Vec::new();
    let mut groups = vec![Group { title: loaded.path.display().to_string(), problems: own }];
    for name in loaded.map.programs.keys() {
        let problems = match Program::new(&loaded.map, name, &loaded.registry, loaded.folder()) {
            Ok(program) => {
                facts.push(format!("{name}: {}", count(program.steps.len(), "step")));
                program.warnings
            }
            Err(problems) => problems,
        };
        let problems = problems.into_iter().filter(|problem| !is_known(problem, &known));
        let title = format!("program \"{name}\"");
        groups.push(Group { title, problems: problems.collect() });
    }
    for problem in of_programs {
        // A program that could not even be read is not among those of the map.
        let title = format!("program \"{}\"", problem.place.program.as_deref().unwrap_or_default());
        groups.push(Group { title, problems: vec![problem] });
    }
    report(&loaded, &groups, &facts)
}

/// Whether the map alone has this problem of a step. What a program adds to it stands behind it.
fn is_known(problem: &Problem, known: &[Problem]) -> bool {
    known.iter().any(|known| {
        (&known.place.node, &known.place.port) == (&problem.place.node, &problem.place.port)
            && problem.message.starts_with(&known.message)
    })
}

fn report(loaded: &Loaded, groups: &[Group], facts: &[String]) -> Result<Exit, Stop> {
    let all = || groups.iter().flat_map(|group| &group.problems);
    let n_errors = all().filter(|problem| problem.is_error()).count();
    let n_warnings = all().count() - n_errors;
    let mut text = String::new();
    for group in groups.iter().filter(|group| !group.problems.is_empty()) {
        let _ = writeln!(text, "{}", console::style(&group.title).bold());
        for problem in &group.problems {
            let mut line = problem.clone();
            // The title says which program it is.
            line.place.program = None;
            let mark = match problem.is_error() {
                true => console::style("error:").red().bold(),
                false => console::style("warning:").yellow().bold(),
            };
            let _ = writeln!(text, "  {mark} {line}");
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
