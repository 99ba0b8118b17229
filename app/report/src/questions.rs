//! The questions of a report: those that the program asks, else one for each axis of few values.

use indexmap::IndexMap;
use mve_core::{Better, Question};

use crate::axes::Axis;
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
    let all = all.filter(|axis| !measure.is_made_by(results, axis));
    let all = all.flat_map(|axis| of_axis(results, axis, measure));
    all.take(MOST_QUESTIONS).collect()
}

/// How each value of an axis does against its first.
fn of_axis(results: &Results, axis: &Axis, measure: &MeasureColumn) -> Vec<Question> {
    let values: Vec<_> = axis.values.iter().filter_map(|value| value.first()?.clone()).collect();
    let better = if measure.better == Better::Higher { "higher" } else { "lower" };
    let question = |other: &serde_json::Value| Question {
        text: format!(
            "Is “{}” {better} with {} than with {}?",
            measure.title,
            results.name_of(&axis.paths[0], other),
            results.name_of(&axis.paths[0], &values[0])
        ),
        measure: measure.column.clone(),
        compare: IndexMap::from([(axis.paths[0].clone(), [other.clone(), values[0].clone()])]),
        same: Vec::new(),
    };
    values.iter().skip(1).map(question).collect()
}
