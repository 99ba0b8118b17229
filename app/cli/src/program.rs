//! `mve program`: every step of a program, into a store.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use mve_core::{
    CancelToken, CommandScope, DiskCache, EventKind, Part, Patience, Problem, Program,
    ProgramEvent, ProgramOptions, ProgramOutcome, Retry, Shard, Sharing, Step, StepRecord,
    StepStatus, Store, TIMINGS, chosen, did_you_mean, is_steering, meant,
};
use mve_report::Report;
use serde::Serialize;
use serde_json::Value as Json;

use crate::exit::{Exit, Stop};
use crate::load::{CommandArgs, Loaded, MapArgs};
use crate::machine::{half_of_memory, parse_count, parse_size, set_threads};
use crate::out;
use crate::out::warning_mark;
use crate::program_report as report;
use crate::progress::{Progress, seconds};
use crate::run::open_cache;
use crate::stop::Signals;

/// Warnings that are said while steps run; all of them are in the logs of their steps.
const MOST_WARNINGS: usize = 20;

const STOPPING: &str = "stopping; finished steps are kept, run the same command to resume";

/// Run a program of a map: every combination of its parameters, into one table
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve program maps/classic_experiment.json costs
  mve program maps/classic_experiment.json costs --dry-run        list its steps
  mve program maps/classic_experiment.json costs --jobs 4 --time-limit 60
  mve program maps/classic_experiment.json costs --timing         seconds that can be compared
  mve program maps/classic_experiment.json costs --timing=9       from nine runs of each step
  mve program maps/classic_experiment.json costs --shard 1/8      one of eight processes
  mve program maps/classic_experiment.json costs --only simplify.cost=Quadric

Finished steps are kept and never run twice: the same command resumes. A step whose inputs, \
parameters or modules changed is another step. Failed steps are rows of the table; \
--retry-failed runs them again; steps that failed for want of space, a permission or a file run \
again by themselves. A step that was running when its process ended runs alone the next time; if \
that process ends too, the step is a row that says so, and the others go on.

The exit code is 5 where steps are missing that this process was to run and others hold or left; \
--wait waits for them. --set is a column: results with other settings stay in the table.

Values that take time are kept in the folder, in cache/, so that a module that is added to the map \
runs alone; `mve clean` removes them.

The folder holds results.csv and results.jsonl (all columns, every digit), summary.md, outputs/ \
(files that the steps wrote), steps/ (a record of each step, and what its modules said), and \
report.html (tables, plots, pictures and answers in one page; `mve report` writes it again).")]
pub struct Args {
    #[command(flatten)]
    map: MapArgs,
    /// Name of the program; may be left out where the map has only one
    name: Option<String>,
    /// Folder of the results [default: mve-out/MAP-NAME]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Steps that run at once [default: as many as threads]
    #[arg(short, long, value_name = "N", value_parser = parse_count)]
    jobs: Option<usize>,
    /// Run only part I of N, counted from 1; others run the other parts into the same folder
    #[arg(long, value_name = "I/N", value_parser = parse_shard)]
    shard: Option<Shard>,
    /// Share nothing and run one step at a time on one thread, in rounds of shuffled order after a
    /// run that does not count: seconds that can be compared. N runs of each step, 3 if not said;
    /// as many as the program has repeats where it has some
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true)]
    #[arg(value_parser = parse_count, conflicts_with_all = ["jobs", "cache", "cache_size"])]
    timing: Option<Option<usize>>,
    /// Run only steps that set a parameter so, by its value or by the id of an entry
    #[arg(long, value_name = "NODE.PARAM=VALUE", value_parser = parse_only)]
    only: Vec<(String, Json)>,
    /// Wait for steps that other processes are at, and run those that they leave
    #[arg(long)]
    wait: bool,
    /// List the steps and write nothing
    #[arg(long)]
    dry_run: bool,
    /// Threads to use [default: one a core; 1 with --timing]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    threads: Option<usize>,
    /// Memory that steps may take together: 8G, 512M [default: half of the machine's]
    ///
    /// A further step waits until less is in use, and a module that says beforehand how much it
    /// will take waits until that is free; neither counts against a time limit. What alone takes
    /// more than this runs alone.
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    memory: Option<usize>,
    /// Stop a step after this time, in place of the program's own limit
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    time_limit: Option<Duration>,
    /// Run failed steps again
    #[arg(long)]
    retry_failed: bool,
    /// Keep values in this folder, and take what it holds instead of making it again [default:
    /// cache/ in the folder of the results]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Bytes of values to keep: 20G [default: a tenth of the free disk; 16G in a folder of --cache]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    cache_size: Option<usize>,
    /// Keep no values for the next call
    #[arg(long, conflicts_with_all = ["cache", "cache_size"])]
    no_cache: bool,
    /// Write no report.html
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    commands: CommandArgs,
    /// Print every event as a line of JSON, and a summary as the last line
    #[arg(long)]
    json: bool,
}

impl Args {
    fn sharing(&self) -> Sharing {
        if self.timing.is_some() { Sharing::Timing } else { Sharing::Shared }
    }

    /// How often each step is to be timed, if at all.
    fn timings(&self) -> Option<usize> {
        self.timing.map(|n| n.unwrap_or(TIMINGS))
    }
}

fn parse_shard(text: &str) -> Result<Shard, String> {
    let numbers = text.split_once('/').map(|(i, n)| (i.trim().parse(), n.trim().parse()));
    match numbers {
        Some((Ok(index), Ok(count))) if (1..=count).contains(&index) => {
            Ok(Shard { index: index - 1, count })
        }
        _ => Err("write I/N with I from 1 to N, such as 1/8".to_owned()),
    }
}

pub fn parse_only(text: &str) -> Result<(String, Json), String> {
    let form = "write NODE.PARAM=VALUE, such as simplify.cost=Quadric";
    let (path, value) = text.split_once('=').ok_or(form)?;
    let value = serde_json::from_str(value).unwrap_or_else(|_| Json::from(value));
    Ok((path.trim().to_owned(), value))
}

fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| *seconds > 0.0);
    let duration = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    duration.ok_or_else(|| "write a number of seconds above 0".to_owned())
}

/// Runs the command.
pub fn run(args: &Args, quiet: bool) -> Result<Exit, Stop> {
    let signals = Signals::listen(args.json)?;
    // Before anything else: plans look into files, on all threads where they are large.
    let threads = set_threads(args.threads.or(args.timing.map(|_| 1)))?;
    let loaded = args.map.load()?;
    let is_named =
        |problem: &&Problem| problem.place.program.is_some() && problem.place.program == args.name;
    let problems: Vec<Problem> = loaded.map.problems().iter().filter(is_named).cloned().collect();
    if !problems.is_empty() {
        return Err(loaded.refuse(&problems, args.json));
    }
    let name = choose(&loaded, args.name.as_deref())?;
    if !loaded.complaints.is_empty() {
        return Err(loaded.refuse(&loaded.complaints, args.json));
    }
    let scope = match args.dry_run {
        true => CommandScope::All,
        false => args.commands.scope(),
    };
    let program = Program::allowing(scope, &loaded.map, name, &loaded.registry, loaded.folder());
    let mut program = program.map_err(|problems| loaded.refuse(&problems, args.json))?;
    program.map_file = loaded.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    program.map_path = std::path::absolute(&loaded.path).unwrap_or_default();
    loaded.report(&program.warnings, args.json);
    for path in args.map.set_paths().filter(|path| program.varied.iter().any(|v| v == path)) {
        let mark = warning_mark();
        out::tell(&format!("{mark} --set {path} has no effect: the program varies it"));
    }
    let folder = args.out.clone().unwrap_or_else(|| default_folder(&loaded, name));
    let part = part_of(args, &program)?;
    // What cannot be looked at is told below, when it is opened.
    let known = Store::look(&folder).ok().flatten();
    if let Some(other) = known.as_ref().and_then(|store| store.other_map(&program.map_path))
        && args.out.is_none()
    {
        return Err(Stop::usage(format!(
            "{}: holds the results of another map of this name, {}; name a folder for these with \
             --out, this one to go on in it",
            folder.display(),
            other.display()
        )));
    }
    program.set_apart(&args.map.settings(&loaded), known.as_ref());
    if args.dry_run {
        Store::look(&folder)?;
        let how = (&part, args.timings());
        return report::dry_run(&program, known.as_ref(), &folder, how, args.json);
    }
    let store = Store::open(&folder)?;
    let outcome = run_steps(args, quiet, &program, &store, (part, &signals, threads))?;
    // Whoever stops a program wants it to stop; `mve report` shows what is there.
    let is_wanted = !args.no_report && !outcome.is_stopped;
    let page = is_wanted.then(|| write_report(&folder)).flatten();
    if args.json {
        print_json(&outcome, &folder, exit_of(&outcome))?;
    } else {
        out::print(&report::results(&program, &store, &outcome, page.as_ref()))?;
    }
    conclude(&outcome)
}

/// The steps that are asked for.
fn part_of(args: &Args, program: &Program) -> Result<Part, Stop> {
    let shard = args.shard.unwrap_or(Shard { index: 0, count: 1 });
    let part = Part { shard, only: args.only.clone() };
    check_only(&part.only, &program.varied, &program.steps)?;
    Ok(part)
}

/// Refuses what `--only` names and no step has.
pub fn check_only(only: &[(String, Json)], varied: &[String], steps: &[Step]) -> Result<(), Stop> {
    for (path, value) in only {
        if !varied.contains(path) {
            let hint = did_you_mean(path, varied.iter().map(String::as_str));
            let all = varied.join(", ");
            return Err(Stop::usage(format!(
                "--only {path}: the program does not vary it; it varies {all}{hint}"
            )));
        }
        let known = steps.iter().filter_map(|step| step.params.get(path));
        let known: Vec<&Json> = known.collect();
        if meant(value, known.iter().copied()).is_empty() {
            let ids = known.into_iter().filter_map(|value| chosen(value).map(|(id, _)| id));
            let hint = value.as_str().map(|value| did_you_mean(value, ids)).unwrap_or_default();
            let message = format!("--only {path}: no step has it as {value}{hint}");
            return Err(Stop::usage(message));
        }
    }
    Ok(())
}

/// The values that outlive the call.
fn cache_of(args: &Args, store: &Store) -> Result<Option<DiskCache>, Stop> {
    let asked = args.cache_size.map(|bytes| bytes as u64);
    match &args.cache {
        _ if args.no_cache || args.timing.is_some() => Ok(None),
        Some(folder) => open_cache(folder, asked.unwrap_or(DiskCache::USUAL_BYTES)).map(Some),
        None => Ok(store.disk_cache(asked).map(Some)?),
    }
}

/// The program that is meant.
fn choose<'a>(loaded: &'a Loaded, name: Option<&'a str>) -> Result<&'a str, Stop> {
    let path = loaded.path.display();
    let names: Vec<&str> = loaded.map.programs.keys().map(String::as_str).collect();
    let list = names.join(", ");
    match (name, names.as_slice()) {
        (_, []) => Err(Stop::usage(format!(
            "{path}: the map has no programs; `mve run` runs the map itself"
        ))),
        (None, [only]) => Ok(only),
        (None, _) => Err(Stop::usage(format!(
            "{path}: the map has {} programs; name one of {list}",
            names.len()
        ))),
        (Some(name), names) if names.contains(&name) => Ok(name),
        (Some(name), names) => {
            let hint = did_you_mean(name, names.iter().copied());
            let message =
                format!("{path}: there is no program \"{name}\"; the map has {list}{hint}");
            Err(Stop::usage(message))
        }
    }
}

/// Writes the page of the results. The results are there without it, so trouble is a warning.
fn write_report(folder: &Path) -> Option<Report> {
    let page = crate::report::write_page(folder);
    page.map_err(|stop| out::tell(&format!("{} no report: {}", warning_mark(), stop.message))).ok()
}

fn default_folder(loaded: &Loaded, name: &str) -> PathBuf {
    let stem = loaded.path.file_stem().map_or("map".into(), |stem| stem.to_string_lossy());
    let plain = |c: char| if is_steering(c) || "/\\:*?\"<>|".contains(c) { '-' } else { c };
    let folder: String = format!("{stem}-{name}").chars().map(plain).collect();
    Path::new("mve-out").join(folder)
}

fn run_steps(
    args: &Args,
    quiet: bool,
    program: &Program,
    store: &Store,
    (part, signals, threads): (Part, &Signals, usize),
) -> Result<ProgramOutcome, Stop> {
    let disk_cache = cache_of(args, store)?;
    let places = program.places(&part);
    let finished = report::finished(program, store, args.timings());
    let is_found = |place: &&usize| {
        finished(**place).is_some_and(|r| !args.retry_failed || r.status == StepStatus::Done)
    };
    let found = places.iter().filter(is_found).count();
    let progress = Progress::new("steps", places.len(), found, !quiet && !args.json);
    let cancel = CancelToken::new();
    signals.stop(&cancel, &progress, STOPPING);
    let warned = Mutex::new(HashSet::new());
    let options = ProgramOptions {
        jobs: args.jobs.unwrap_or(threads),
        threads,
        part,
        sharing: args.sharing(),
        timings: args.timings().unwrap_or(TIMINGS),
        memory: args.memory.unwrap_or_else(half_of_memory),
        disk_cache,
        time_limit: args.time_limit,
        retry: if args.retry_failed { Retry::Failed } else { Retry::Nothing },
        patience: if args.wait { Patience::Wait } else { Patience::None },
        cancel: &cancel,
        observer: &|event| match args.json {
            // A reader that is gone misses nothing that the store does not have.
            true => drop(out::event(event)),
            false => observe(event, program, &progress, &warned),
        },
    };
    Ok(progress.watch(|| mve_core::run_program(program, store, &options))?)
}

fn observe(
    event: &ProgramEvent,
    program: &Program,
    progress: &Progress,
    warned: &Mutex<HashSet<String>>,
) {
    match event {
        ProgramEvent::Began { .. } | ProgramEvent::StepFound { .. } => {}
        ProgramEvent::StepStarted { place, step } => {
            progress.start(&place.to_string(), report::label(step));
        }
        ProgramEvent::Node { place, node_event } => {
            let (key, node) = (place.to_string(), node_event.node);
            match &node_event.kind {
                EventKind::Started => progress.update(&key, node, None),
                EventKind::Progress { share } => progress.update(&key, node, Some(*share)),
                EventKind::Warning { text } => {
                    let Ok(mut warned) = warned.lock() else { return };
                    let text = format!("{node}: {text}");
                    if warned.len() < MOST_WARNINGS && warned.insert(text.clone()) {
                        let step = &program.steps[*place];
                        let with = report::label(step);
                        progress.say(&format!("{} {text} (first with {with})", warning_mark()));
                    }
                }
                EventKind::Log { .. } | EventKind::Ended { .. } => {}
            }
        }
        ProgramEvent::StepEnded { place, record } => {
            let is_failed = record.status != StepStatus::Done;
            progress.end(&place.to_string(), is_failed, |ended, total| {
                format!("[{ended}/{total}] {}", ended_line(record, &program.steps[*place]))
            });
        }
    }
}

fn ended_line(record: &StepRecord, step: &mve_core::Step) -> String {
    let (word, time) = (record.status.word(), seconds(record.seconds));
    let reason = record.status.reason().map_or(String::new(), |reason| format!(": {reason}"));
    format!("{word}, {time} s, {}{reason}", report::label(step))
}

fn exit_of(outcome: &ProgramOutcome) -> Exit {
    match outcome {
        outcome if outcome.is_stopped && outcome.missing > 0 => Exit::Interrupted,
        outcome if outcome.missing_of_part > 0 => Exit::Incomplete,
        outcome if outcome.failed > 0 => Exit::Failed,
        _ => Exit::Done,
    }
}

#[derive(Serialize)]
struct Summary<'a> {
    event: &'static str,
    status: &'static str,
    folder: &'a Path,
    #[serde(flatten)]
    outcome: &'a ProgramOutcome,
}

fn print_json(outcome: &ProgramOutcome, folder: &Path, exit: Exit) -> Result<Exit, Stop> {
    let status = match exit {
        Exit::Done => "done",
        Exit::Failed => "failed",
        Exit::Incomplete => "incomplete",
        _ => "stopped",
    };
    out::event(&Summary { event: "finished", status, folder, outcome })
}

fn conclude(outcome: &ProgramOutcome) -> Result<Exit, Stop> {
    let ProgramOutcome { steps, failed, missing, missing_of_part, .. } = *outcome;
    let exit = exit_of(outcome);
    if exit == Exit::Interrupted {
        let message =
            format!("stopped; {missing} of {steps} steps remain, the same command resumes");
        return Err(Stop { exit, message });
    }
    if exit == Exit::Incomplete {
        let message = format!(
            "{missing_of_part} of {steps} steps are with other processes, or were left by them; \
             --wait waits for them"
        );
        return Err(Stop { exit, message });
    }
    if missing > 0 {
        let whose = "for other shards or calls";
        out::tell(&format!("this process is done; {missing} of {steps} steps remain {whose}"));
    }
    match exit {
        Exit::Failed => {
            let message =
                format!("{failed} of {steps} steps failed; --retry-failed runs them again");
            Err(Stop { exit, message })
        }
        exit => Ok(exit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_count_from_one() {
        assert_eq!(parse_shard("1/1"), Ok(Shard { index: 0, count: 1 }));
        assert_eq!(parse_shard("8/8"), Ok(Shard { index: 7, count: 8 }));
        for bad in ["0/3", "4/3", "1", "a/b", "1/0", "-1/3"] {
            assert!(parse_shard(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn steps_are_chosen_by_json_or_text() {
        assert_eq!(parse_only("a.x=Quadric"), Ok(("a.x".to_owned(), "Quadric".into())));
        assert_eq!(parse_only("a.x=0.5"), Ok(("a.x".to_owned(), 0.5.into())));
        assert!(parse_only("a.x").is_err());
    }

    #[test]
    fn limits_are_positive_seconds() {
        assert_eq!(parse_seconds("0.5"), Ok(Duration::from_millis(500)));
        for bad in ["0", "-1", "inf", "NaN", "1 s"] {
            assert!(parse_seconds(bad).is_err(), "{bad}");
        }
    }
}
