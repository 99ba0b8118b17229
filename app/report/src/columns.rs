//! Which columns a report shows: what the program names, else what looks like a measure.
//!
//! Where the program names none, the outputs of nodes that take several links are measures, since
//! what compares needs two things; if there are none, those of all nodes but the one that is
//! compared. Constant and repeated columns say nothing, and of one node a few are enough.

use std::collections::HashMap;

use mve_core::Better;

use crate::results::Results;

/// How many outputs of one node are shown, and how many measures are chosen.
const MOST_OF_A_NODE: usize = 4;
const MOST_MEASURES: usize = 8;

/// A column that measures.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureColumn {
    /// Its name.
    pub column: String,
    /// Its name for a person.
    pub title: String,
    /// Which values are better.
    pub better: Better,
    /// Whether some step gave a number.
    pub is_there: bool,
}

/// The measures of a report, the most important first.
pub fn measures(results: &Results) -> Vec<MeasureColumn> {
    let named = &results.spec.measures;
    let mut all: Vec<MeasureColumn> = Vec::new();
    for measure in named {
        if all.iter().all(|known| known.column != measure.column) {
            let title = &measure.title;
            let title = if title.is_empty() { title_of(&measure.column) } else { title.clone() };
            let is_there = has_numbers(results, &measure.column);
            let (column, better) = (measure.column.clone(), measure.better);
            all.push(MeasureColumn { column, title, better, is_there });
        }
    }
    if !named.is_empty() {
        return all;
    }
    let hidden = against(results);
    let comparing = comparing_nodes(results);
    let series_node = results.series_node();
    let chosen = chief(results, &|column| {
        let node = column.split('.').next().unwrap_or_default();
        let is_chosen = match comparing.is_empty() {
            true => Some(node) != series_node,
            false => comparing.iter().any(|known| known == node),
        };
        is_chosen && !hidden.iter().any(|known| known == column)
    });
    let chosen = match chosen.is_empty() {
        true => chief(results, &|column| !hidden.iter().any(|known| known == column)),
        false => chosen,
    };
    let measure = |column: String| {
        let (title, better) = (title_of(&column), Better::Lower);
        MeasureColumn { column, title, better, is_there: true }
    };
    chosen.into_iter().take(MOST_MEASURES).map(measure).collect()
}

/// The title of a measure, or of any column.
pub fn title(measures: &[MeasureColumn], column: &str) -> String {
    let measure = measures.iter().find(|measure| measure.column == column);
    measure.map_or_else(|| title_of(column), |measure| measure.title.clone())
}

fn title_of(column: &str) -> String {
    match column.strip_prefix("seconds.") {
        Some(node) => format!("seconds of {node}"),
        None => column.to_owned(),
    }
}

/// The columns that measures are plotted against: how many faces are left, and how long it took.
pub fn against(results: &Results) -> Vec<String> {
    if !results.spec.against.is_empty() {
        let named = results.spec.against.iter();
        return named.filter(|column| has_numbers(results, column)).cloned().collect();
    }
    let time = results.series_node().map(|node| format!("seconds.{node}"));
    let time = time.filter(|column| has_numbers(results, column));
    let time = time.unwrap_or_else(|| "seconds".to_owned());
    faces(results).into_iter().chain(Some(time)).collect()
}

/// The column that counts the faces of what is compared: of the node whose parameter gives the
/// series, or of one that runs after it.
pub fn faces(results: &Results) -> Option<String> {
    let place = |node: &str| results.plan.nodes.iter().position(|known| known == node);
    let first = results.series_node().and_then(place).unwrap_or(0);
    let is_after = |column: &&String| {
        let node = column.split('.').next().unwrap_or_default();
        place(node).is_none_or(|place| place >= first)
    };
    let outputs = results.outputs();
    let named = |is_named: fn(&str) -> bool| {
        let of_output =
            |column: &&String| column.split_once('.').is_some_and(|(_, output)| is_named(output));
        let found = outputs.iter().filter(of_output).filter(is_after);
        found.filter(|column| has_numbers(results, column)).max_by_key(|column| {
            // The first of those that differ from step to step.
            let nth = outputs.iter().position(|known| known == *column).unwrap_or(0);
            (!is_constant(results, column), usize::MAX - nth)
        })
    };
    named(|output| output == "faces" || output == "n_faces")
        .or_else(|| named(|output| output.ends_with("faces")))
        .cloned()
}

/// Outputs that a person reads, by a filter: the first few of each node that differ between cases
/// and from each other.
pub fn chief(results: &Results, is_wanted: &dyn Fn(&str) -> bool) -> Vec<String> {
    let mut n_of_node: HashMap<String, usize> = HashMap::new();
    let mut seen: Vec<Vec<Option<f64>>> = Vec::new();
    let mut chosen = Vec::new();
    for column in results.outputs() {
        if !is_wanted(&column) || is_constant(results, &column) {
            continue;
        }
        let numbers: Vec<_> =
            results.cases.iter().map(|case| case.estimate(&column).map(|e| e.mean)).collect();
        if numbers.iter().all(Option::is_none) || seen.contains(&numbers) {
            continue;
        }
        let node = column.split('.').next().unwrap_or_default();
        let n = n_of_node.entry(node.to_owned()).or_default();
        *n += 1;
        if *n <= MOST_OF_A_NODE {
            seen.push(numbers);
            chosen.push(column);
        }
    }
    chosen
}

/// The columns of the long table behind the parameters: measures, other chief outputs, seconds.
pub fn long_columns(results: &Results, measures: &[MeasureColumn]) -> Vec<String> {
    let mut columns: Vec<String> =
        measures.iter().filter(|m| m.is_there).map(|m| m.column.clone()).collect();
    let others = against(results).into_iter().chain(chief(results, &|_| true));
    let varied = results.varied();
    let others: Vec<String> = others.filter(|column| !varied.contains(column)).collect();
    for column in others.into_iter().chain(["seconds".to_owned()]) {
        if !columns.contains(&column) {
            columns.push(column);
        }
    }
    let (seconds, rest) = columns.into_iter().partition::<Vec<_>, _>(|column| {
        column.starts_with("seconds") && measures.iter().all(|m| m.column != *column)
    });
    rest.into_iter().chain(seconds).collect()
}

/// Nodes that more than one link ends in.
fn comparing_nodes(results: &Results) -> Vec<String> {
    let links = results.plan.map["links"].as_array().cloned().unwrap_or_default();
    let ends = links.iter().filter_map(|link| {
        let (_, to) = link.as_str()?.split_once("->")?;
        to.trim().split_once('.').map(|(node, _)| node.to_owned())
    });
    let ends: Vec<String> = ends.collect();
    let n_of = |node: &String| ends.iter().filter(|end| *end == node).count();
    results.plan.nodes.iter().filter(|node| n_of(node) > 1).cloned().collect()
}

fn has_numbers(results: &Results, column: &str) -> bool {
    results.cases.iter().any(|case| !case.numbers(column).is_empty())
}

/// Whether all of several cases that have a number have the same.
pub fn is_constant(results: &Results, column: &str) -> bool {
    let mut numbers = results.cases.iter().filter_map(|case| case.estimate(column));
    let Some(first) = numbers.next() else { return true };
    results.cases.len() > 1 && numbers.all(|number| number.mean == first.mean)
}
