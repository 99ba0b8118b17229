//! What a program gave, or would do, for a person.

use std::path::Path;
use std::sync::Arc;

use mve_core::{
    Part, Program, ProgramOutcome, Requirement, Step, StepRecord, StepStatus, Store, brief_value,
};
use mve_report::Report;
use serde::Serialize;
use serde_json::Value as Json;

use crate::check::count;
use crate::exit::{Exit, Stop};
use crate::out;
use crate::progress::seconds;
use crate::table::{TextTable, wrap};

/// Rows of a table on a terminal, where more would scroll away.
const MOST_ROWS: usize = 100;

/// The record of a step that is all that is asked of it.
pub fn finished<'a>(
    program: &'a Program,
    store: &'a Store,
    timings: Option<usize>,
) -> impl Fn(usize) -> Option<Arc<StepRecord>> + 'a {
    let requirement = Requirement::of(program, timings);
    move |place| program.record(store, place).filter(|record| requirement.is_met_by(record))
}

/// The parameters of a step in a line.
pub fn label(step: &Step) -> String {
    let word = |json: &Json| match json {
        Json::Null => brief_value(json),
        Json::String(text) => text.clone(),
        other => other.to_string(),
    };
    let params = step.params.iter().map(|(path, value)| format!("{path} = {}", word(value)));
    let repeat = (step.repeat > 0).then(|| format!("repeat {}", step.repeat));
    let all: Vec<_> = params.chain(repeat).collect();
    if all.is_empty() { "the map as it is".to_owned() } else { all.join(", ") }
}

/// A step of a dry run.
#[derive(Serialize)]
struct Row<'a> {
    event: &'static str,
    #[serde(flatten)]
    step: &'a Step,
    status: &'static str,
}

/// Lists the steps of a shard and what would become of them; writes nothing.
pub fn dry_run(
    program: &Program,
    store: Option<&Store>,
    folder: &Path,
    (part, timings): (&Part, Option<usize>),
    json: bool,
) -> Result<Exit, Stop> {
    let steps = program.places(part);
    let record = store.map(|store| finished(program, store, timings));
    let rows: Vec<_> = steps
        .iter()
        .map(|place| {
            let record = record.as_ref().and_then(|record| record(*place));
            let status = record.map_or("to do", |record| record.status.word());
            Row { event: "step", step: &program.steps[*place], status }
        })
        .collect();
    let n_of = |status: &str| rows.iter().filter(|row| row.status == status).count();
    let (todo, done) = (n_of("to do"), n_of("done"));
    let failed = rows.len() - todo - done;
    if json {
        for row in &rows {
            out::event(row)?;
        }
        return out::event(&serde_json::json!({
            "event": "finished", "status": "dry run", "steps": rows.len(), "done": done,
            "failed": failed, "to_do": todo, "varied": program.varied, "folder": folder,
            "commands": program.command_lines,
        }));
    }
    let cells =
        rows.iter().map(|row| vec![row.step.id.clone(), row.status.to_owned(), label(row.step)]);
    let header = ["step", "status", "parameters"].map(str::to_owned).to_vec();
    let table = TextTable { header, rows: cells.collect(), n_fixed: 0 };
    let (mut text, _) = table.render(out::width());
    let shard = part.shard;
    let part = match shard.count {
        1 => String::new(),
        n => format!(" in shard {}/{n}", shard.index + 1),
    };
    let steps = count(rows.len(), "step");
    text.push_str(&format!("\n{steps}{part}: {done} done, {failed} failed, {todo} to do\n"));
    let varied = program.varied.join(", ");
    text.push_str(&format!("varied:  {}\n", wrap(&varied, out::width(), 9)));
    for (node, line) in &program.command_lines {
        text.push_str(&format!("runs:    {node}: {}\n", wrap(line, out::width(), 9)));
    }
    if !program.command_lines.is_empty() {
        text.push_str("         outside programs run with --allow-commands alone\n");
    }
    let is_there = if store.is_some() { "" } else { " (not made yet)" };
    text.push_str(&format!("folder:  {}{is_there}\n", folder.display()));
    out::print(&text)
}

/// The table of results, and where everything is.
pub fn results(
    program: &Program,
    store: &Store,
    outcome: &ProgramOutcome,
    page: Option<&Report>,
) -> String {
    let (header, mut rows) = program.brief_table(store);
    let n_rows = rows.len();
    if out::width().is_some() {
        rows.truncate(MOST_ROWS);
    }
    let n_left = n_rows - rows.len();
    let (mut text, n_hidden) = match n_rows {
        0 => (String::new(), 0),
        _ => {
            let has_repeats = program.steps.iter().any(|step| step.repeat > 0);
            let n_fixed = usize::from(has_repeats) + program.varied.len();
            TextTable { header, rows, n_fixed }.render(out::width())
        }
    };
    out::part_from_progress(&mut text);
    let hidden = [(n_left, "row"), (n_hidden, "column")];
    let hidden = hidden.iter().filter(|(n, _)| *n > 0).map(|(n, what)| count(*n, what));
    let hidden = hidden.collect::<Vec<_>>().join(" and ");
    if !hidden.is_empty() {
        text.push_str(&format!("… {hidden} more in results.csv\n"));
    }
    text.push_str(&failures(program, store));
    if let Some(answers) = page.map(crate::report::answers).filter(|answers| !answers.is_empty()) {
        text.push_str(&format!("\n{}", answers.trim_end_matches('\n')));
        text.push('\n');
    }
    let ProgramOutcome { steps, ran, found, failed, missing, missed, others, .. } = *outcome;
    let mut parts = vec![format!("{} done", steps - missing - failed)];
    parts.extend((failed > 0).then(|| format!("{failed} failed")));
    parts.extend((missing > 0).then(|| format!("{missing} to do")));
    let (all, time) = (count(steps, "step"), seconds(outcome.seconds));
    text.push_str(&format!("\n{all}: {}; {ran} run now in {time} s", parts.join(", ")));
    text.push_str(&if found > 0 { format!(", {found} found\n") } else { "\n".to_owned() });
    if missed > 0 {
        let all = count(steps, "step");
        text.push_str(&format!("{missed} of {all} did not reach their target; see missed\n"));
    }
    if others > 0 {
        let others = count(others, "step");
        text.push_str(&format!("{others} of earlier versions of the program stay in the folder\n"));
    }
    if outcome.damaged > 0 {
        let records = count(outcome.damaged, "record");
        let line = "could not be read or changed since they were written; their steps ran again";
        text.push_str(&format!("{records} {line}\n"));
    }
    let folder = store.folder();
    let mut place = |what: &str, name: &str| {
        if folder.join(name).exists() {
            text.push_str(&format!("{what:8} {}\n", folder.join(name).display()));
        }
    };
    if page.is_some() {
        place("report", crate::report::PAGE);
    }
    place("results", "results.csv");
    place("summary", "summary.md");
    place("outputs", "outputs");
    place("steps", "steps");
    text
}

/// Failed steps with their reasons.
fn failures(program: &Program, store: &Store) -> String {
    let records = program.places(&Part::default()).into_iter().filter_map(|place| {
        let record = program.record(store, place)?;
        (record.status != StepStatus::Done).then_some((place, record))
    });
    let records: Vec<_> = records.collect();
    let mut text = String::new();
    for (place, record) in records.iter().take(MOST_ROWS) {
        if text.is_empty() {
            text.push_str("\nfailed:\n");
        }
        let reason = record.status.reason().unwrap_or_default();
        let line = format!("{}: {reason}", label(&program.steps[*place]));
        text.push_str(&format!("  {}  {}\n", record.id, wrap(&line, out::width(), 4)));
    }
    if records.len() > MOST_ROWS {
        text.push_str(&format!("  … {} more in results.csv\n", records.len() - MOST_ROWS));
    }
    text
}
