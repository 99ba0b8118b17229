//! `mve run`: one run of a map.

use std::path::{Path, PathBuf};
use std::time::Instant;

use indexmap::IndexMap;
use mve_core::{
    Cache, CancelToken, DiskCache, Event, EventKind, Keep, NodeOutcome, NodeRecord, NodeStatus,
    OutputScope, RunOptions, RunOutcome, Scalar, brief, is_of_round,
};
use serde::Serialize;

use crate::check::count;
use crate::exit::{Exit, Stop};
use crate::load::{CommandArgs, MapArgs};
use crate::machine::{parse_count, set_threads};
use crate::out;
use crate::out::warning_mark;
use crate::progress::{Progress, seconds};
use crate::stop::Signals;
use crate::table::TextTable;

const STOPPING: &str = "stopping; Ctrl-C again ends at once";

/// Run a map once
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mve run maps/simplify_and_measure.json
  mve run maps/obj_file.json --set load.path=bunny.obj --set simplify.cost=EdgeLength
  mve run maps/simplify_and_measure.json --out results --cache ~/.cache/mve
  mve run maps/simplify_and_measure.json --json | jq 'select(.event == \"ended\")'

Every problem of the map is listed before anything runs. A node that fails stops only the nodes \
that need it.")]
pub struct Args {
    #[command(flatten)]
    map: MapArgs,
    /// Folder for the files that the map writes
    #[arg(short, long, value_name = "DIR", default_value = "mve-out")]
    out: PathBuf,
    /// Threads to use [default: one a core]
    #[arg(long, value_name = "N", value_parser = parse_count)]
    threads: Option<usize>,
    /// Keep values in this folder, and take what it holds instead of making it again
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Let savers write outside the output folder, for maps of people that you trust
    #[arg(long)]
    allow_outside: bool,
    #[command(flatten)]
    commands: CommandArgs,
    /// Print every event as a line of JSON, and a summary as the last line
    #[arg(long)]
    json: bool,
}

/// Opens the folder of a disk cache of so many bytes.
pub fn open_cache(folder: &Path, budget: u64) -> Result<DiskCache, Stop> {
    DiskCache::open(folder, budget).map_err(|error| Stop::file(folder, &error))
}

/// Runs the command.
pub fn run(args: &Args, quiet: bool) -> Result<Exit, Stop> {
    let signals = Signals::listen(args.json)?;
    // Before anything else: a plan looks into files, on all threads where they are large.
    let threads = set_threads(args.threads)?;
    let loaded = args.map.load()?;
    let scope = if args.allow_outside { OutputScope::Anywhere } else { OutputScope::Folder };
    let plan = loaded
        .plan(Some(&args.out), scope, args.commands.scope())
        .map_err(|problems| loaded.refuse(&problems, args.json))?;
    loaded.report(&plan.warnings, args.json);
    if plan.nodes.iter().any(|node| !node.writes.is_empty()) {
        std::fs::create_dir_all(&args.out).map_err(|error| Stop::file(&args.out, &error))?;
    }
    // Values in memory would have no second reader within one run.
    let cache = args.cache.as_deref().map(|folder| open_cache(folder, DiskCache::USUAL_BYTES));
    let cache = cache.transpose()?.map(|disk| Cache::new(0, Some(disk)));
    let cancel = CancelToken::new();
    let progress = Progress::new("nodes", plan.nodes.len(), 0, !quiet && !args.json);
    signals.stop(&cancel, &progress, STOPPING);
    let start = Instant::now();
    if args.json {
        out::event(&serde_json::json!({"event": "began", "nodes": plan.nodes.len()}))?;
    }
    let options = RunOptions {
        output_folder: &args.out,
        threads,
        cache: cache.as_ref(),
        cancel: &cancel,
        observer: &|event| observe(event, &progress, args.json),
        keep: Keep::Scalars,
        memory: None,
        output_scope: scope,
    };
    let outcome = progress.watch(|| mve_core::run(&plan, &options));
    let took = start.elapsed().as_secs_f64();
    let exit = match &outcome {
        outcome if outcome.is_done() => Exit::Done,
        outcome if outcome.failures().next().is_some() => Exit::Failed,
        _ => Exit::Interrupted,
    };
    if args.json {
        print_json(&outcome, &args.out, exit, took)?;
    } else {
        out::print(&report(&outcome, &args.out, took))?;
    }
    conclude(&outcome, exit)
}

fn observe(event: &Event, progress: &Progress, json: bool) {
    if json {
        // A reader that is gone misses nothing else, and the run goes on.
        let _ = out::event(event);
        return;
    }
    let node = event.node;
    match &event.kind {
        EventKind::Started => progress.start(node, node.to_owned()),
        EventKind::Progress { share } => progress.update(node, "", Some(*share)),
        EventKind::Log { text } => say_log(progress, node, text),
        EventKind::Warning { text } => say_warning(progress, node, text),
        EventKind::Ended { record, .. } => {
            if record.cached.is_some() {
                for line in &record.log {
                    match line.is_warning {
                        true => say_warning(progress, node, &line.text),
                        false => say_log(progress, node, &line.text),
                    }
                }
            }
            let is_failed = matches!(record.status, NodeStatus::Failed { .. });
            progress.end(node, is_failed, |ended, total| {
                let time = record.seconds.map_or(String::new(), |s| format!(", {} s", seconds(s)));
                format!("[{ended}/{total}] {node}: {}{time}", word(record))
            });
        }
    }
}

/// What a node logs is a result: a person put it there to read it.
fn say_log(progress: &Progress, node: &str, text: &str) {
    let _ = progress.aside(|| out::print(&format!("{node}: {text}\n")));
}

fn say_warning(progress: &Progress, node: &str, text: &str) {
    progress.say(&format!("{} {node}: {text}", warning_mark()));
}

/// The status in a word.
fn word(record: &NodeRecord) -> &'static str {
    match &record.status {
        NodeStatus::Done if record.cached.is_some() => "cached",
        NodeStatus::Done => "done",
        NodeStatus::Failed { .. } => "failed",
        NodeStatus::Skipped { .. } => "skipped",
        NodeStatus::Stopped => "stopped",
        NodeStatus::Past => "past",
    }
}

#[derive(Serialize)]
struct Summary<'a> {
    event: &'static str,
    status: &'static str,
    seconds: f64,
    output_folder: &'a Path,
    nodes: IndexMap<&'a str, &'a NodeRecord>,
}

fn print_json(outcome: &RunOutcome, out: &Path, exit: Exit, seconds: f64) -> Result<Exit, Stop> {
    let status = match exit {
        Exit::Done => "done",
        Exit::Failed => "failed",
        _ => "stopped",
    };
    let nodes = outcome.nodes.iter().map(|(name, node)| (name.as_str(), &node.record)).collect();
    out::event(&Summary { event: "finished", status, seconds, output_folder: out, nodes })
}

/// A scalar for a person; `--json` and results tables have all digits.
fn cell(scalar: &Scalar) -> String {
    match scalar {
        Scalar::Number(x) if x.is_nan() => "not defined".to_owned(),
        Scalar::Number(x) => brief(*x),
        other => other.to_string(),
    }
}

/// From so many on, numbers of one name that count up (`rms_0`, `rms_1`, …) are told as one.
const FEWEST_TOLD_AS_ONE: usize = 4;

/// Names and values for a person, with long runs of numbers in a line.
fn brief_cells(scalars: &IndexMap<String, Scalar>) -> Vec<(String, String)> {
    let counted = |name: &str, n: usize| {
        let (stem, end) = name.rsplit_once('_')?;
        (end == n.to_string()).then(|| stem.to_owned())
    };
    let mut cells = Vec::new();
    let mut rest = scalars.iter().peekable();
    while let Some((name, scalar)) = rest.next() {
        let mut run = vec![(name, scalar)];
        if let Some(stem) = counted(name, 0) {
            let mut n = 1;
            let is_next =
                |n: usize, name: &str| counted(name, n).is_some_and(|other| other == stem);
            while let Some(next) = rest.next_if(|(name, _)| is_next(n, name)) {
                run.push(next);
                n += 1;
            }
        }
        let numbers = run.iter().map(|(_, scalar)| match scalar {
            Scalar::Number(number) if number.is_finite() => Some(*number),
            _ => None,
        });
        let numbers: Option<Vec<f64>> = numbers.collect();
        match numbers.filter(|numbers| numbers.len() >= FEWEST_TOLD_AS_ONE) {
            None => cells.extend(run.into_iter().map(|(name, s)| (name.clone(), cell(s)))),
            Some(numbers) => {
                let n = numbers.len();
                let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
                let high = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let mean = numbers.iter().sum::<f64>() / n as f64;
                let name = name.trim_end_matches('0');
                let (low, mean, high) = (brief(low), brief(mean), brief(high));
                let text = format!("{n} values, least {low}, mean {mean}, most {high}");
                cells.push((format!("{name}0 … {name}{}", n - 1), text));
            }
        }
    }
    cells
}

/// The result for a person: what every node gave, and the files.
fn report(outcome: &RunOutcome, out: &Path, took: f64) -> String {
    let header = ["node", "status", "seconds", "output", "value"].map(str::to_owned).to_vec();
    let mut rows = Vec::new();
    let is_past = |node: &NodeOutcome| node.record.status == NodeStatus::Past;
    // What a round gave the loop has in its table, unless it failed.
    let is_told = |name: &str, node: &NodeOutcome| {
        let is_failed = matches!(node.record.status, NodeStatus::Failed { .. });
        is_failed || !(is_past(node) || is_of_round(name))
    };
    for (name, node) in outcome.nodes.iter().filter(|(name, node)| is_told(name, node)) {
        let record = &node.record;
        let scalars = brief_cells(&record.scalars);
        let values = record.values.iter().map(|(output, text)| (output.clone(), text.clone()));
        let mut outputs: Vec<_> = values.chain(scalars).collect();
        if outputs.is_empty() {
            let why = match &record.status {
                NodeStatus::Skipped { because_of } => format!("needs {because_of}, which failed"),
                _ => String::new(),
            };
            outputs.push((String::new(), why));
        }
        let time = record.seconds.map_or(String::new(), seconds);
        let mut own = [name.clone(), word(record).to_owned(), time];
        for (output, value) in outputs {
            rows.push(own.iter_mut().map(std::mem::take).chain([output, value]).collect());
        }
    }
    let (mut text, _) = TextTable { header, rows, n_fixed: 0 }.render(out::width());
    out::part_from_progress(&mut text);
    let done = outcome.nodes.values().filter(|node| node.record.status == NodeStatus::Done);
    let written: Vec<_> = done.flat_map(|node| &node.record.files).collect();
    if !written.is_empty() {
        text.push_str("\nfiles:\n");
        for file in &written {
            text.push_str(&format!("  {}\n", out.join(file).display()));
        }
    }
    let n_done = outcome.nodes.values().filter(|n| n.record.status == NodeStatus::Done).count();
    let n_past = outcome.nodes.values().filter(|node| is_past(node)).count();
    let nodes = count(outcome.nodes.len() - n_past, "node");
    let past = match n_past {
        0 => String::new(),
        n => format!("; {} of rounds behind the end of a loop did not run", count(n, "node")),
    };
    text.push_str(&format!("\n{n_done} of {nodes} done in {} s{past}\n", seconds(took)));
    text
}

fn conclude(outcome: &RunOutcome, exit: Exit) -> Result<Exit, Stop> {
    if exit == Exit::Interrupted {
        return Err(Stop { exit, message: "stopped before all nodes were done".to_owned() });
    }
    let failures: Vec<_> =
        outcome.failures().map(|(name, error)| format!("{name}: {error}")).collect();
    let Some((last, others)) = failures.split_last() else { return Ok(exit) };
    others.iter().for_each(|failure| out::complain(failure));
    Err(Stop { exit, message: last.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_count_up_are_told_as_one() {
        let told = |names: &[&str]| {
            let scalars = names.iter().zip(1..).map(|(name, n)| {
                let name: &str = name;
                (name.to_owned(), Scalar::Number(f64::from(n)))
            });
            brief_cells(&scalars.collect()).into_iter().map(|(name, _)| name).collect::<Vec<_>>()
        };
        let all = ["rms", "rms_0", "rms_1", "rms_2", "rms_3", "value"];
        assert_eq!(told(&all), ["rms", "rms_0 … rms_3", "value"]);
        assert_eq!(told(&all[..4]), all[..4], "a few stand for themselves");
        assert_eq!(told(&["a_1", "a_2", "a_3", "a_4", "a_5"]), ["a_1", "a_2", "a_3", "a_4", "a_5"]);
        let scalars = ["x_0", "x_1", "x_2", "x_3"].into_iter().zip([4.0, 1.0, 2.0, 1.0]);
        let scalars = scalars.map(|(name, x)| (name.to_owned(), Scalar::Number(x))).collect();
        assert_eq!(brief_cells(&scalars)[0].1, "4 values, least 1, mean 2, most 4");
    }
}
