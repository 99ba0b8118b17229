//! Which columns a report shows: what the program names, else what modules declare as chief.
//!
//! Where there is neither, the outputs of nodes that measure are shown, [`measuring_nodes`]; if
//! there are none, those of all nodes but the one that is compared.
//! Constant and repeated columns say nothing, and of one node a few are enough. What modules do not
//! declare has no better end.

use std::collections::HashMap;

use mve_core::{Better, ColumnRecord, Role, TIMES};
use serde_json::Value as Json;

use crate::axes::Axis;
use crate::case::{Case, Cell};
use crate::labels::node_of;
use crate::results::Results;
use crate::stats::Estimate;

/// How many outputs of one node are shown, and how many measures are chosen.
const MOST_OF_A_NODE: usize = 4;
const MOST_MEASURES: usize = 8;

/// How many columns one table of all measures has, where nothing is compared.
const MOST_OF_A_TABLE: usize = 24;

/// A column that measures.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureColumn {
    /// Its name.
    pub column: String,
    /// Its name for a person.
    pub title: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// Whether its numbers mean the same for every model.
    pub is_of_model: bool,
    /// Which values are better.
    pub better: Better,
    /// The parameter and the value with which the column holds this, where it holds something else
    /// with others.
    only_with: Option<(String, String)>,
    /// Whether a module declares it as chief.
    is_chief: bool,
    /// Whether some step gave a number.
    pub is_there: bool,
}

impl MeasureColumn {
    /// Its name with its unit.
    pub fn title_with_unit(&self) -> String {
        match self.unit.as_str() {
            "" => self.title.clone(),
            unit => format!("{} [{unit}]", self.title),
        }
    }

    /// Whether the column holds this measure in a case.
    fn is_in(&self, results: &Results, case: &Case) -> bool {
        let Some((path, id)) = &self.only_with else { return true };
        let of_map = || {
            let (node, param) = path.split_once('.')?;
            let node = &results.plan.map["nodes"][node];
            Some(if param == "module" { &node["module"] } else { &node["params"][param] })
        };
        let value = case.params.get(path).or_else(of_map);
        let chosen = |value: &Json| mve_core::chosen(value).is_some_and(|(chosen, _)| chosen == id);
        value.is_some_and(chosen)
    }

    /// Whether an axis sets how it is measured: a parameter of the node that measures it. Values
    /// measured in different ways are no contestants, as those of different inputs are none.
    pub fn is_made_by(&self, results: &Results, axis: &Axis) -> bool {
        axis.paths.iter().any(|path| self.is_set_by(results, path))
    }

    /// The same of a parameter.
    pub fn is_set_by(&self, results: &Results, path: &str) -> bool {
        // What a node says of its own work, such as how much it rejected, may be compared.
        !is_time(&self.column)
            && node_of(path) == node_of(&self.column)
            && measuring_nodes(results).contains(&node_of(path))
    }

    /// The axes that set how it is measured.
    pub fn instruments(&self, results: &Results) -> Vec<usize> {
        let axes = 0..results.axes.len();
        axes.filter(|place| self.is_made_by(results, &results.axes[*place])).collect()
    }

    /// What a table shows of it.
    pub fn cell(&self, results: &Results, case: &Case) -> Cell {
        if self.is_in(results, case) { case.cell(&self.column) } else { Cell::Empty }
    }

    /// Its mean and interval.
    pub fn estimate(&self, results: &Results, case: &Case) -> Option<Estimate> {
        self.is_in(results, case).then(|| case.estimate(&self.column))?
    }

    /// Half of the interval that a single number of a case has by those that it is drawn from: the
    /// median and the least of a few timings vary as these do.
    pub fn spread(&self, case: &Case) -> Option<f64> {
        let is_drawn = ["seconds_median", "seconds_min"].contains(&self.column.as_str());
        is_drawn.then(|| case.estimate("seconds"))??.half_width
    }
}

/// The measures of a report, the most important first.
pub fn measures(results: &Results) -> Vec<MeasureColumn> {
    let named = &results.spec.measures;
    let mut all: Vec<MeasureColumn> = Vec::new();
    for measure in named {
        if all.iter().any(|known| known.column == measure.column) {
            continue;
        }
        let mut of_column = of_column(results, &measure.column);
        for known in &mut of_column {
            known.better = measure.better.unwrap_or(known.better);
            if !measure.title.is_empty() {
                known.title.clone_from(&measure.title);
                // Who names a measure says its unit as well, or wants none.
                known.unit.clear();
            }
        }
        all.extend(of_column);
    }
    if named.is_empty() {
        let chosen = chosen(results);
        let is_chief = |column: &str| results.plan.columns.role(column) == Role::Chief;
        all.extend(chosen.iter().flat_map(|column| {
            let all = of_column(results, column).into_iter();
            all.filter(|measure| measure.is_chief || !is_chief(column))
        }));
        all.retain(|measure| measure.is_there);
    }
    told_apart(&mut all);
    all
}

/// The columns of measures that nobody has named.
fn chosen(results: &Results) -> Vec<String> {
    let outputs = results.outputs();
    let declared = outputs.iter().filter(|column| results.plan.columns.role(column) == Role::Chief);
    let mut chosen: Vec<String> = declared.cloned().collect();
    if chosen.is_empty() {
        chosen = undeclared(results);
    }
    chosen.truncate(if results.has_series() { MOST_MEASURES } else { MOST_OF_A_TABLE });
    if results.is_timed() {
        let times = TIMES.iter().filter(|name| **name != "seconds");
        chosen.extend(times.map(|name| (*name).to_owned()));
    }
    chosen
}

/// What looks like a measure; where nothing is compared all that says how things are, be it the
/// same everywhere.
fn undeclared(results: &Results) -> Vec<String> {
    if !results.has_series() {
        let telling = few_of_each(results, MOST_OF_A_TABLE, &|_| true);
        let all = || results.outputs().into_iter().filter(|column| results.has_numbers(column));
        return if telling.is_empty() { all().take(MOST_OF_A_TABLE).collect() } else { telling };
    }
    let hidden = against(results);
    let measuring = measuring_nodes(results);
    let series_node = results.series_node();
    let chosen = few_of_each(results, MOST_OF_A_NODE, &|column| {
        let node = node_of(column);
        let is_chosen = match measuring.is_empty() {
            true => Some(node) != series_node,
            false => measuring.contains(&node),
        };
        is_chosen && !hidden.iter().any(|known| known == column)
    });
    match chosen.is_empty() {
        true => few_of_each(results, MOST_OF_A_NODE, &|column| {
            !hidden.iter().any(|known| known == column)
        }),
        false => chosen,
    }
}

/// What a column measures; several things where it holds others in other steps.
pub fn of_column(results: &Results, column: &str) -> Vec<MeasureColumn> {
    let mut records = results.plan.columns.find(column);
    if records.is_empty() {
        records.push(of_time(results, column));
    }
    let measure = |record: ColumnRecord| {
        let title = if record.title.is_empty() { plain(column) } else { record.title };
        let mut measure = MeasureColumn {
            column: column.to_owned(),
            title,
            unit: record.unit,
            is_of_model: record.is_of_model,
            better: record.better,
            only_with: record.only_with,
            is_chief: record.role == Role::Chief,
            is_there: false,
        };
        measure.is_there =
            results.cases.iter().any(|case| measure.estimate(results, case).is_some());
        measure
    };
    records.into_iter().map(measure).collect()
}

/// What is known of times and memory. Only what was measured with nothing shared can be compared.
fn of_time(results: &Results, column: &str) -> ColumnRecord {
    let title = match column {
        "seconds" => "time of a step".to_owned(),
        "seconds_min" => "time of a step, minimum".to_owned(),
        "seconds_median" => "time of a step, median".to_owned(),
        "cpu_seconds" => "time of the processors".to_owned(),
        "peak_bytes" => "peak memory".to_owned(),
        _ => match column.strip_prefix("seconds.") {
            Some(node) => format!("time of {node}"),
            None => return ColumnRecord::default(),
        },
    };
    let unit = if column == "peak_bytes" { "bytes" } else { "s" }.to_owned();
    let better = if results.is_timed() { Better::Lower } else { Better::Neither };
    ColumnRecord { title, unit, better, ..ColumnRecord::default() }
}

/// A column's own name for a person: of an output the output's.
fn plain(column: &str) -> String {
    column.split_once('.').map_or(column, |(_, output)| output).replace('_', " ")
}

/// Puts the name of the node behind titles that several measures have, the whole column where they
/// are of one node.
fn told_apart(measures: &mut [MeasureColumn]) {
    let alike = |measure: &MeasureColumn, other: &MeasureColumn| {
        measure.title == other.title && measure.unit == other.unit
    };
    let all = measures.to_vec();
    for measure in measures {
        let alike: Vec<&MeasureColumn> = all.iter().filter(|other| alike(measure, other)).collect();
        let node = node_of(&measure.column);
        let n_of_node = alike.iter().filter(|other| node_of(&other.column) == node).count();
        if alike.len() > 1 {
            let place = if n_of_node > 1 { &measure.column } else { node };
            measure.title = format!("{}, {place}", measure.title);
        }
    }
}

/// The title of a measure, or of any column.
pub fn title(results: &Results, measures: &[MeasureColumn], column: &str) -> String {
    if let Some(measure) = measures.iter().find(|measure| measure.column == column) {
        return measure.title_with_unit();
    }
    let of_axis = |axis: &&Axis| axis.paths.iter().any(|path| path == column);
    match results.axes.iter().find(of_axis) {
        Some(axis) if axis.paths.len() == 1 => return axis.title.clone(),
        Some(_) => return plain(column),
        None => {}
    }
    let mut titles: Vec<String> =
        of_column(results, column).iter().map(MeasureColumn::title_with_unit).collect();
    titles.dedup();
    titles.join(" or ")
}

/// Whether a column holds what a step or a node took.
pub fn is_time(column: &str) -> bool {
    TIMES.contains(&column) || column.starts_with("seconds.")
}

/// That no measure differs between several cases, in words; empty where one does, and where things
/// are compared, of which the answers and the tables say it.
pub fn equal_in_words(results: &Results, measures: &[MeasureColumn]) -> String {
    let columns =
        || measures.iter().filter(|measure| measure.is_there && !is_time(&measure.column));
    let n_all = results.cases.len();
    let has_all = |measure: &MeasureColumn| {
        let of_case = |case: &Case| measure.estimate(results, case).is_some();
        results.cases.iter().all(of_case) && results.is_constant(&measure.column)
    };
    let is_compared = results.has_series();
    match n_all > 1 && !is_compared && columns().next().is_some() && columns().all(has_all) {
        true => format!("All {n_all} cases gave the same: no measure differs between them."),
        false => String::new(),
    }
}

/// The measures that are plotted: those that the report names, else the first few.
pub fn drawn<'a>(results: &Results, measures: &'a [MeasureColumn]) -> Vec<&'a MeasureColumn> {
    let is_drawn = |m: &&MeasureColumn| m.is_there && (results.is_timed() || !is_time(&m.column));
    let is_named = !results.spec.measures.is_empty();
    let most = if is_named { usize::MAX } else { MOST_MEASURES + TIMES.len() };
    measures.iter().filter(is_drawn).take(most).collect()
}

/// The columns that measures are plotted against: those that the report names, else how large
/// results are and how long they took. Times count where they were measured with nothing shared.
pub fn against(results: &Results) -> Vec<String> {
    if !results.spec.against.is_empty() {
        let named = results.spec.against.iter().filter(|column| results.has_numbers(column));
        return named.filter(|column| results.is_timed() || !is_time(column)).cloned().collect();
    }
    let time = || {
        let of_node = results.series_node().map(|node| format!("seconds.{node}"));
        let of_node = of_node.filter(|column| results.has_numbers(column));
        of_node.unwrap_or_else(|| "seconds".to_owned())
    };
    results.size.iter().cloned().chain(results.is_timed().then(time)).collect()
}

/// Outputs for the table of all steps: those that modules declare as chief, else a few of each
/// node.
pub fn chief(results: &Results) -> Vec<String> {
    let outputs = results.outputs();
    let is_chief = |column: &&String| results.plan.columns.role(column) != Role::Detail;
    let chief: Vec<String> = outputs.iter().filter(is_chief).cloned().collect();
    if chief.is_empty() { few_of_each(results, MOST_OF_A_NODE, &|_| true) } else { chief }
}

/// Outputs by a filter: the first few of each node that differ between cases and from each other.
fn few_of_each(results: &Results, most: usize, is_wanted: &dyn Fn(&str) -> bool) -> Vec<String> {
    let mut n_of_node: HashMap<String, usize> = HashMap::new();
    let mut seen: Vec<Vec<Option<f64>>> = Vec::new();
    let mut chosen = Vec::new();
    for column in results.outputs() {
        if !is_wanted(&column) || results.is_constant(&column) {
            continue;
        }
        let numbers: Vec<_> =
            results.cases.iter().map(|case| case.estimate(&column).map(|e| e.mean)).collect();
        if numbers.iter().all(Option::is_none) || seen.contains(&numbers) {
            continue;
        }
        let n = n_of_node.entry(node_of(&column).to_owned()).or_default();
        *n += 1;
        if *n <= most {
            seen.push(numbers);
            chosen.push(column);
        }
    }
    chosen
}

/// The columns of the long table behind the parameters: measures, other chief outputs, seconds.
pub fn long_columns(results: &Results, measures: &[MeasureColumn]) -> Vec<String> {
    let mut columns: Vec<String> = Vec::new();
    let varied = results.varied();
    let others = against(results).into_iter().chain(chief(results));
    let others = others.filter(|column| !varied.contains(column));
    let named = measures.iter().filter(|m| m.is_there).map(|m| m.column.clone());
    for column in named.chain(others).chain(["seconds".to_owned()]) {
        if !columns.contains(&column) {
            columns.push(column);
        }
    }
    let (seconds, rest) = columns.into_iter().partition::<Vec<_>, _>(|column| {
        column.starts_with("seconds") && measures.iter().all(|m| m.column != *column)
    });
    rest.into_iter().chain(seconds).collect()
}

/// Nodes that measure what others made: those of which a module declares a number as chief. Of one
/// that declares neither a direction nor a size the links tell: what compares takes two things, and
/// leads nowhere.
fn measuring_nodes(results: &Results) -> Vec<&str> {
    let links = results.plan.map["links"].as_array().into_iter().flatten();
    let links = links.filter_map(|link| link.as_str()?.split_once("->"));
    let ends: Vec<[&str; 2]> =
        links.map(|(from, to)| [from, to].map(|end| node_of(end.trim()))).collect();
    let measures = |node: &&str| {
        let columns = results.plan.columns.0.iter().filter(|(column, _)| node_of(column) == *node);
        let records: Vec<&ColumnRecord> = columns.flat_map(|(_, records)| records).collect();
        let is_chief = records.iter().any(|record| record.role == Role::Chief);
        let says_more =
            |record: &&ColumnRecord| record.role == Role::Size || record.better != Better::Neither;
        let is_end = ends.iter().filter(|[_, to]| to == node).count() > 1
            && !ends.iter().any(|[from, _]| from == node);
        is_chief || (is_end && !records.iter().any(says_more))
    };
    results.plan.nodes.iter().map(String::as_str).filter(measures).collect()
}
