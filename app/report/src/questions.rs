//! The questions of a report: those that the program asks, else one for each axis of few values.

use indexmap::IndexMap;
use mve_core::{Better, Question, meant};
use serde_json::Value as Json;

use crate::axes::Axis;
use crate::case::Case;
use crate::columns::MeasureColumn;
use crate::results::Results;

/// Values of an axis beyond which nobody asks for each of them, and questions that are asked.
const MOST_VALUES: usize = 4;
const MOST_QUESTIONS: usize = 6;

/// The questions that a report answers.
pub fn questions(results: &Results, measures: &[MeasureColumn]) -> Vec<Question> {
    let is_asked = results.plan.spec.report.as_ref().is_some_and(|r| r.get("questions").is_some());
    if is_asked || !results.spec.questions.is_empty() {
        return results.spec.questions.clone();
    }
    let has_end = |measure: &&MeasureColumn| measure.is_there && measure.better != Better::Neither;
    let Some(measure) = measures.iter().find(has_end) else { return Vec::new() };
    let is_few =
        |axis: &&Axis| axis.paths.len() == 1 && axis.varies() && axis.values.len() <= MOST_VALUES;
    // Numbers are something to plot against, and models are not compared with each other.
    let all = results.series_axes().iter().filter(is_few).filter(|axis| !axis.is_scale());
    let all = all.filter(|axis| !measure.is_made_by(results, axis) && !results.is_input(axis));
    let all = all.flat_map(|axis| of_axis(results, axis, measure));
    all.take(MOST_QUESTIONS).collect()
}

/// How each value of an axis does against one of them.
fn of_axis(results: &Results, axis: &Axis, measure: &MeasureColumn) -> Vec<Question> {
    let path = &axis.paths[0];
    let values: Vec<_> = axis.values.iter().filter_map(|value| value.first()?.clone()).collect();
    let Some(reference) = reference(results, path, &values) else { return Vec::new() };
    let better = if measure.better == Better::Higher { "higher" } else { "lower" };
    let question = |other: &Json| Question {
        text: format!(
            "Is “{}” {better} with {} than with {}?",
            measure.title,
            results.name_of(path, other),
            results.name_of(path, reference)
        ),
        measure: measure.column.clone(),
        compare: IndexMap::from([(path.clone(), [other.clone(), reference.clone()])]),
        same: Vec::new(),
    };
    values.iter().filter(|value| *value != reference).map(question).collect()
}

/// The value that others are compared with: that without the program, else the first; of these the
/// first with which some step can be compared.
fn reference<'a>(results: &Results, path: &str, values: &'a [Json]) -> Option<&'a Json> {
    let default = results.plan.defaults.get(path);
    let default = default.and_then(|default| meant(default, values.iter()).into_iter().next());
    let is_comparable = |value: &&Json| {
        let of_value = results.cases.iter().filter(|case| case.params.get(path) == Some(*value));
        of_value.into_iter().any(Case::is_comparable)
    };
    let mut all = default.into_iter().chain(values);
    all.find(is_comparable).or(values.first())
}
