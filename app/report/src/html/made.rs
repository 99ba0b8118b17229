//! The section that says how the results were made: map, program, versions, inputs, machines.

use std::fmt::Write;

use chrono::DateTime;
use mve_core::RunNote;

use super::{Page, address, count, cut, escape};
use crate::labels;

/// Texts are cut to this many characters, and lists to this many entries.
const LONGEST_MAP: usize = 400_000;
const MOST_ENTRIES: usize = 500;
const MOST_RUNS: usize = 10;

/// How it was made.
pub(super) fn made(page: &Page) -> String {
    let plan = &page.results.plan;
    let mut text = "<dl>\n".to_owned();
    let mut entry = |name: &str, value: &str| {
        if !value.is_empty() {
            let _ = writeln!(text, "<dt>{name}</dt><dd>{value}</dd>");
        }
    };
    entry("map", &escape(&plan.map_file));
    entry("program", &escape(&plan.program));
    entry("mve", &escape(&plan.mve));
    let machines = plan.runs.iter().map(machine).collect::<indexmap::IndexSet<_>>();
    entry("machine", &machines.iter().cloned().collect::<Vec<_>>().join("<br>"));
    let runs = plan.runs.iter().rev().take(MOST_RUNS).rev().map(ran);
    let mut runs: Vec<_> = runs.collect();
    let n_runs = plan.runs.len().saturating_sub(MOST_RUNS);
    if n_runs > 0 {
        runs.insert(0, format!("{} before", count(n_runs, "run")));
    }
    entry("runs", &runs.join("<br>"));
    let timing = match page.results.is_timed() {
        true => "one step at a time with nothing shared, so that seconds can be compared",
        false => "steps shared their work and the machine: seconds are no measure",
    };
    entry("seconds", timing);
    let link = |name: &str, is_folder: bool| {
        let slash = if is_folder { "/" } else { "" };
        let path = address(page.store, &format!("{name}{slash}"));
        page.results.folder.join(name).exists().then(|| format!("<a href=\"{path}\">{name}</a>"))
    };
    let files = [("results.csv", false), ("results.jsonl", false), ("summary.md", false)];
    let files = files.into_iter().chain([("plan.json", false), ("outputs", true), ("steps", true)]);
    let files: Vec<_> = files.filter_map(|(name, is_folder)| link(name, is_folder)).collect();
    entry("files", &files.join(", "));
    text.push_str("</dl>\n");
    let inputs = plan.inputs.iter().map(|(path, hash)| (path.as_str(), hash.to_string()));
    text.push_str(&hashes("input file", inputs));
    let modules = plan.modules.iter().map(|(id, version)| (id.as_str(), version.to_string()));
    text.push_str(&hashes("module", modules));
    if let Ok(map) = plan.map_text() {
        let _ = write!(
            text,
            "<details><summary>The map with this program</summary>\n<pre>{}</pre></details>\n",
            escape(&cut(&map, LONGEST_MAP))
        );
    }
    text
}

fn machine(run: &RunNote) -> String {
    let machine = &run.machine;
    let memory = machine.memory as f64 / f64::from(1 << 30);
    let parts = [
        machine.cpu.clone(),
        if machine.cores > 0 { count(machine.cores, "core") } else { String::new() },
        if memory > 0.0 { format!("{} GiB", labels::rounded(memory, 2)) } else { String::new() },
        machine.system.clone(),
    ];
    let parts: Vec<_> = parts.iter().filter(|part| !part.is_empty()).map(|p| escape(p)).collect();
    parts.join(", ")
}

fn ran(run: &RunNote) -> String {
    let date = i64::try_from(run.started).ok().and_then(|s| DateTime::from_timestamp(s, 0));
    let date = date.map_or(String::new(), |date| date.format("%Y-%m-%d %H:%M UTC").to_string());
    let took = match run.seconds {
        Some(seconds) => format!("{} in {}", count(run.ran, "step"), labels::duration(seconds)),
        None => "not ended".to_owned(),
    };
    let jobs = format!("{} at once, {}", count(run.jobs, "step"), count(run.threads, "thread"));
    format!("{date}: {took}, {jobs}")
}

/// Names with the hashes of their content, folded.
fn hashes<'a>(what: &str, entries: impl Iterator<Item = (&'a str, String)>) -> String {
    let all: Vec<_> = entries.collect();
    if all.is_empty() {
        return String::new();
    }
    let mut text = format!("<details><summary>{}</summary>\n<pre>", count(all.len(), what));
    for (name, hash) in all.iter().take(MOST_ENTRIES) {
        let _ = writeln!(text, "{}  {}", escape(hash), escape(&cut(name, 400)));
    }
    if all.len() > MOST_ENTRIES {
        let _ = writeln!(text, "… and {} more", all.len() - MOST_ENTRIES);
    }
    text.push_str("</pre></details>\n");
    text
}
