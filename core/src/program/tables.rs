//! The tables of a program's results, made from the records of its store.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use indexmap::IndexSet;
use serde_json::{Map as JsonMap, Value as Json, json};

use super::Program;
use super::record::StepRecord;
use super::report_spec::TIMES;
use super::store::{Store, StoreError};
use super::timing::{Timing, median};
use crate::data::Scalar;
use crate::problem::printable;
use crate::quantity::Role;

/// How many outputs of one node a person reads first.
const MOST_OF_A_NODE: usize = 4;

/// Writes `results.csv`, `results.jsonl` and `summary.md`.
pub(super) fn write(program: &Program, store: &Store) -> Result<(), StoreError> {
    store.with_lock(|| {
        store.sweep();
        let (header, rows) = table(program, store);
        store.write("results.csv", csv_table(&header, &rows).as_bytes())?;
        store.write("results.jsonl", json_lines(program, store).as_bytes())?;
        store.write("summary.md", summary(program, store, &header, &rows).as_bytes())
    })
}

fn finished(program: &Program, store: &Store) -> Vec<(usize, Arc<StepRecord>)> {
    let places = 0..program.steps.len();
    places.filter_map(|place| Some((place, program.record(store, place)?))).collect()
}

fn has_repeats(program: &Program) -> bool {
    program.steps.iter().any(|step| step.repeat > 0)
}

/// Header and rows: the step, what was varied, what came out, seconds, status.
pub(super) fn table(program: &Program, store: &Store) -> (Vec<String>, Vec<Vec<String>>) {
    let has_repeats = has_repeats(program);
    let records = finished(program, store);
    let outputs = outputs(program, &records);
    let mut header = vec!["step".to_owned()];
    header.extend(has_repeats.then(|| "repeat".to_owned()));
    header.extend(program.varied.iter().cloned());
    header.extend(outputs.iter().map(|(node, name)| format!("{node}.{name}")));
    header.push("seconds".to_owned());
    let is_timed = records.iter().any(|(_, record)| !record.timings.is_empty());
    header.extend(TIMES.iter().skip(1).filter(|_| is_timed).map(|name| (*name).to_owned()));
    let times = times(program, &records);
    header.extend(times.iter().map(|(node, phase)| match phase {
        None => format!("seconds.{node}"),
        Some(phase) => format!("seconds.{node}.{phase}"),
    }));
    header.extend(["missed", "warnings", "status", "reason"].map(str::to_owned));
    let row = |(place, record): &(usize, Arc<StepRecord>)| {
        let step = &program.steps[*place];
        let mut row = vec![step.id.clone()];
        row.extend(has_repeats.then(|| step.repeat.to_string()));
        row.extend(program.varied.iter().map(|p| step.params.get(p).map_or(String::new(), word)));
        row.extend(outputs.iter().map(|(node, name)| {
            let scalar = record.nodes.get(node).and_then(|node| node.scalars.get(name));
            scalar.map_or(String::new(), cell)
        }));
        row.push(exact(record.seconds));
        if is_timed {
            row.extend(spread(&record.timings).map(|time| time.map_or(String::new(), exact)));
        }
        row.extend(times.iter().map(|(node, phase)| {
            let seconds = record.nodes.get(node).and_then(|node| match phase {
                None => node.seconds,
                Some(phase) => node.phases.get(phase).copied(),
            });
            seconds.map_or(String::new(), exact)
        }));
        row.push(record.missed_in_words());
        row.push(record.warnings().count().to_string());
        row.push(record.status.word().to_owned());
        row.push(record.status.reason().unwrap_or_default().to_owned());
        row
    };
    (header, records.iter().map(row).collect())
}

/// Of the times of a step those that stand behind the mean, as [`TIMES`] names them: median and
/// least seconds, median of the processors' seconds, largest memory.
fn spread(timings: &[Timing]) -> [Option<f64>; 4] {
    let seconds: Vec<f64> = timings.iter().map(|timing| timing.seconds).collect();
    let cpu: Vec<f64> = timings.iter().filter_map(|timing| timing.cpu_seconds).collect();
    let bytes = timings.iter().filter_map(|timing| timing.peak_bytes).max();
    let least = seconds.iter().copied().reduce(f64::min);
    [median(&seconds), least, median(&cpu), bytes.map(|bytes| bytes as f64)]
}

/// Every node, and behind it the parts of its work that some step has seconds of.
fn times(program: &Program, records: &[(usize, Arc<StepRecord>)]) -> Vec<(String, Option<String>)> {
    let of_node = |node: &String| {
        let mut phases = IndexSet::new();
        let found = records.iter().filter_map(|(_, record)| record.nodes.get(node));
        found.for_each(|record| phases.extend(record.phases.keys().cloned()));
        let parts = phases.into_iter().map(Some);
        let named = std::iter::once(None).chain(parts);
        named.map(|phase| (node.clone(), phase)).collect::<Vec<_>>()
    };
    program.nodes.iter().flat_map(of_node).collect()
}

/// Node and name of every scalar that some step gave, in running order, but for the names of
/// parameters that are varied. Which scalars there are may hang on a parameter: two metrics
/// measure different things.
fn outputs(program: &Program, records: &[(usize, Arc<StepRecord>)]) -> Vec<(String, String)> {
    let mut outputs = Vec::new();
    for node in &program.nodes {
        let mut names = IndexSet::new();
        let of_node = records.iter().filter_map(|(_, record)| record.nodes.get(node));
        of_node.for_each(|record| names.extend(record.scalars.keys()));
        let is_output = |name: &&&String| !program.varied.contains(&format!("{node}.{name}"));
        outputs.extend(names.iter().filter(is_output).map(|name| (node.clone(), (*name).clone())));
    }
    outputs
}

/// The columns of a table that a person reads first, numbers cut to five significant digits and
/// times to milliseconds: the first outputs of each node, no ids, reasons or seconds of single
/// nodes, no output that is the same in every row or the same as the one of another column.
pub(super) fn brief_table(
    program: &Program,
    header: &[String],
    rows: &[Vec<String>],
) -> (Vec<String>, Vec<Vec<String>>) {
    let column = |place: usize| rows.iter().map(move |row| &row[place]);
    let is_timed = header.iter().any(|name| name == "seconds_median");
    let says_something = |place: usize| {
        let name = header[place].as_str();
        if program.varied.iter().any(|path| path == name)
            || name == if is_timed { "seconds_median" } else { "seconds" }
            || name == "status"
            || program.report.measures.iter().any(|measure| measure.column == name)
        {
            return true;
        }
        if name == "missed" {
            return column(place).any(|cell| !cell.is_empty());
        }
        let differs = rows.len() < 2 || column(place).any(|cell| *cell != rows[0][place]);
        let is_new = (0..place).all(|other| column(other).ne(column(place)));
        let is_hidden = ["step", "reason", "warnings", "seconds"].contains(&name)
            || name.starts_with("seconds.");
        differs && (is_new || rows.is_empty()) && !is_hidden
    };
    let mut shown: Vec<usize> = (0..header.len()).filter(|place| says_something(*place)).collect();
    // Modules put out the most important first.
    let node =
        |place: usize| program.nodes.iter().find(|n| header[place].split('.').next() == Some(n));
    let is_output =
        |place: usize| !program.varied.contains(&header[place]) && node(place).is_some();
    let mut n_of_node = HashMap::new();
    let has_chief = header.iter().any(|name| program.columns.role(name) == Role::Chief);
    shown.retain(|&place| {
        let n = n_of_node.entry(node(place)).or_insert(0);
        *n += usize::from(is_output(place));
        let is_measure = program.report.measures.iter().any(|m| m.column == header[place]);
        let is_chief = match has_chief {
            true => program.columns.role(&header[place]) != Role::Detail,
            false => *n <= MOST_OF_A_NODE,
        };
        !is_output(place) || is_measure || is_chief
    });
    // The measures that the program names stand before the other outputs, in its order.
    let rank = |place: usize| {
        let measure = program.report.measures.iter().position(|m| m.column == header[place]);
        let behind = program.report.measures.len();
        if is_output(place) || measure.is_some() { measure.unwrap_or(behind) + 1 } else { 0 }
    };
    let first = shown.iter().position(|place| is_output(*place)).unwrap_or(shown.len());
    let end = shown.iter().rposition(|place| is_output(*place)).map_or(first, |last| last + 1);
    shown[first..end].sort_by_key(|place| rank(*place));
    let short = |place: usize, cell: &String| match cell.parse::<f64>() {
        Ok(number) if header[place].starts_with("seconds") => format!("{number:.3}"),
        Ok(number) => brief(number),
        Err(_) if cell.starts_with('{') => {
            serde_json::from_str(cell).map_or_else(|_| cell.clone(), |json| brief_value(&json))
        }
        Err(_) => cell.clone(),
    };
    let row = |row: &Vec<String>| shown.iter().map(|&place| short(place, &row[place])).collect();
    let names = shown.iter().map(|place| header[*place].clone()).collect();
    (names, rows.iter().map(row).collect())
}

/// A JSON value without quotes where it is a text; `off` where it is none.
fn word(json: &Json) -> String {
    match json {
        Json::Null => brief_value(json),
        Json::String(text) => text.clone(),
        other => other.to_string(),
    }
}

fn cell(scalar: &Scalar) -> String {
    match scalar {
        Scalar::Number(value) => exact(*value),
        other => other.to_string(),
    }
}

/// The shortest text that reads back as the number, with an exponent where it is long.
pub fn exact(value: f64) -> String {
    // Where there is no number, there is an empty cell.
    if value.is_nan() {
        return String::new();
    }
    let is_plain = value == 0.0 || (1e-5..1e16).contains(&value.abs()) || !value.is_finite();
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

/// A cell that no spreadsheet computes: what begins like a formula and is no number gets a quote
/// before it, as spreadsheets write a text.
fn inert(cell: &str) -> Cow<'_, str> {
    let is_formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']);
    match is_formula && cell.parse::<f64>().is_err() {
        true => Cow::Owned(format!("'{cell}")),
        false => Cow::Borrowed(cell),
    }
}

/// A table as CSV: RFC 4180, lines ended by a line feed, no cell a formula. Rows are as long as the
/// header.
pub fn csv_table(header: &[String], rows: &[Vec<String>]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in std::iter::once(header).chain(rows.iter().map(Vec::as_slice)) {
        // Writing equally long rows to memory cannot fail.
        let _ = writer.write_record(row.iter().map(|cell| inert(cell).into_owned()));
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

fn json_lines(program: &Program, store: &Store) -> String {
    let mut text = String::new();
    for (place, record) in finished(program, store) {
        let step = &program.steps[place];
        let mut outputs = JsonMap::new();
        let mut seconds = JsonMap::new();
        for (name, node) in &record.nodes {
            for (output, scalar) in &node.scalars {
                let value = serde_json::to_value(scalar).unwrap_or(Json::Null);
                outputs.insert(format!("{name}.{output}"), value);
            }
            if let Some(own) = node.seconds {
                seconds.insert(name.clone(), Json::from(own));
            }
            for (phase, part) in &node.phases {
                seconds.insert(format!("{name}.{phase}"), Json::from(*part));
            }
        }
        let row = json!({
            "step": step.id,
            "repeat": step.repeat,
            "params": step.params,
            "outputs": outputs,
            "seconds": record.seconds,
            "seconds_by_node": seconds,
            "timings": record.timings,
            "missed": record.missed().map(|(node, missed)| json!({ "node": node, "target": missed }))
                .collect::<Vec<_>>(),
            "warnings": record.warnings().map(|(node, text)| format!("{node}: {text}"))
                .collect::<Vec<_>>(),
            "status": record.status.word(),
            "reason": record.status.reason(),
        });
        text.push_str(&row.to_string());
        text.push('\n');
    }
    text
}

/// The results for a person, in Markdown.
fn summary(program: &Program, store: &Store, header: &[String], rows: &[Vec<String>]) -> String {
    let records = finished(program, store);
    let failed: Vec<_> = records.iter().filter(|(_, r)| r.status.reason().is_some()).collect();
    let title = if program.map.title.is_empty() { "Results" } else { &program.map.title };
    let (title, name) = (markdown(title), markdown(&program.name));
    let mut text = format!("# {title}\n\nProgram {name}: ");
    text.push_str(&format!(
        "{} of {} steps finished, {} failed. Made by mve {}.\n\n",
        records.len(),
        program.steps.len(),
        failed.len(),
        crate::VERSION
    ));
    let n_missed = records.iter().filter(|(_, record)| record.missed().next().is_some()).count();
    if n_missed > 0 {
        let n = records.len();
        text.push_str(&format!("{n_missed} of {n} steps did not reach their target.\n\n"));
    }
    let (header, rows) = brief_table(program, header, rows);
    let line = |cells: &[String]| {
        let cells: Vec<_> = cells.iter().map(|cell| markdown(cell)).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    text.push_str(&line(&header));
    text.push_str(&format!("|{}\n", "---|".repeat(header.len())));
    rows.iter().for_each(|row| text.push_str(&line(row)));
    if !failed.is_empty() {
        text.push_str("\n## Failed steps\n\n");
        for (_, record) in failed {
            let reason = record.status.reason().unwrap_or_default();
            let params: Vec<_> = record.params.iter().map(|(p, v)| format!("{p} = {v}")).collect();
            let (params, reason) = (markdown(&params.join(", ")), markdown(reason));
            text.push_str(&format!("- `{}` ({params}): {reason}\n", record.id));
        }
    }
    text.push_str(
        "\nAll columns, with every digit: `results.csv`. Meshes and other files: `outputs/`. What \
         exactly ran: `plan.json` and `steps/`.\n",
    );
    text
}

/// A text of a map or a file as Markdown shows it: signs that mean something there are written out,
/// and so is what would steer a terminal.
fn markdown(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in printable(text).chars() {
        match c {
            '<' => shown.push_str("&lt;"),
            '&' => shown.push_str("&amp;"),
            '\\' | '`' | '*' | '[' | ']' | '|' => shown.extend(['\\', c]),
            c => shown.push(c),
        }
    }
    shown
}

/// Without zeros at the end of the fraction.
fn trimmed(number: &str) -> String {
    match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => number.to_owned(),
    }
}

/// A parameter's value for a person: `ImageMse (resolution 256)`, `cow.obj`, `off`. A file is named
/// for itself.
pub fn brief_value(value: &Json) -> String {
    match value {
        Json::Null => "off".to_owned(),
        Json::String(text) => text.clone(),
        Json::Object(fields) if fields.len() == 1 => {
            let inner = fields.iter().next();
            inner.map_or_else(String::new, |(id, params)| brief_entry(id, params))
        }
        other => other.to_string(),
    }
}

fn brief_entry(id: &str, params: &Json) -> String {
    let Json::Object(params) = params else { return format!("{id} {}", brief_value(params)) };
    let is_path = |text: &str| text.contains('/') && Path::new(text).extension().is_some();
    match params.iter().collect::<Vec<_>>().as_slice() {
        [] => id.to_owned(),
        [(_, Json::String(text))] if is_path(text) => {
            let name = Path::new(text).file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        }
        params => {
            let params =
                params.iter().map(|(name, value)| format!("{name} {}", brief_value(value)));
            format!("{id} ({})", params.collect::<Vec<_>>().join(", "))
        }
    }
}

/// A number to five significant digits, for reading.
pub fn brief(value: f64) -> String {
    let size = value.abs();
    if value == value.trunc() && size < 1e15 {
        value.to_string()
    } else if (1e-3..1e6).contains(&size) {
        let digits = (4.0 - size.log10().floor()).clamp(0.0, 8.0) as usize;
        trimmed(&format!("{value:.digits$}"))
    } else {
        let text = format!("{value:.4e}");
        text.split_once('e').map_or(text.clone(), |(number, e)| format!("{}e{e}", trimmed(number)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_exactly() {
        for value in [0.0, 0.1, 1e-300, 1e300, 123_456.0, -1.5e-7, f64::MIN_POSITIVE] {
            assert_eq!(exact(value).parse::<f64>().unwrap(), value);
            assert!(exact(value).len() < 25);
        }
        assert_eq!(exact(f64::NAN), "");
    }

    #[test]
    fn brief_numbers_keep_five_digits() {
        let numbers = [(0.0123456, "0.012346"), (6945.0, "6945"), (2.66e-5, "2.66e-5")];
        numbers.iter().for_each(|(value, text)| assert_eq!(brief(*value), *text));
    }

    #[test]
    fn csv_quotes_what_needs_it() {
        let row = vec!["a,b".to_owned(), "say \"x\"".to_owned()];
        let table = csv_table(&["h".into(), "i".into()], &[row]);
        assert_eq!(table, "h,i\n\"a,b\",\"say \"\"x\"\"\"\n");
    }

    #[test]
    fn no_cell_is_a_formula_and_numbers_stay_numbers() {
        for (cell, shown) in [("=1+1", "'=1+1"), ("@x", "'@x"), ("-a", "'-a"), ("+", "'+")] {
            assert_eq!(inert(cell), shown);
        }
        for cell in ["-1.5", "+2", "-inf", "1e-9", "a=b", ""] {
            assert_eq!(inert(cell), cell);
        }
    }

    #[test]
    fn markdown_shows_what_a_map_says() {
        let text = "a|b <img> [x](y) \u{1b}]0;pwn\u{7}\u{202e}";
        let shown = "a\\|b &lt;img> \\[x\\](y) \\\\u{1b}\\]0;pwn\\\\u{7}\\\\u{202e}";
        assert_eq!(markdown(text), shown);
    }
}
