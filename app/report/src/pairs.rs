//! Pairs of steps that agree in all but one parameter.

use indexmap::IndexMap;
use mve_core::meant;
use serde_json::{Map as JsonMap, Value as Json};

use crate::case::Case;
use crate::columns::MeasureColumn;
use crate::labels;
use crate::results::Results;

/// Numbers closer than this share of themselves are equal.
const ALIKE: f64 = 1e-12;

/// Two steps that differ in one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// What both have in common.
    pub label: String,
    /// The place on the axis of the rows.
    pub group: usize,
    /// The two values.
    pub values: [f64; 2],
    /// The first value in units of the second, where both are above 0.
    pub ratio: Option<f64>,
    /// For each column that should be the same: both values.
    pub same: Vec<Option<[f64; 2]>>,
}

/// Sign of the difference of a pair.
pub fn order(pair: &Pair) -> i32 {
    let [a, b] = pair.values;
    if (a - b).abs() <= ALIKE * a.abs().max(b.abs()) {
        return 0;
    }
    if a < b { -1 } else { 1 }
}

/// The cases that a side means.
pub fn side<'a>(results: &'a Results, path: &str, side: &Json) -> Vec<&'a Case> {
    let value = |case: &'a Case| case.params.get(path);
    let values = meant(side, results.cases.iter().filter_map(value));
    let is_meant = |case: &&'a Case| value(case).is_some_and(|value| values.contains(&value));
    results.cases.iter().filter(is_meant).collect()
}

/// All pairs of the cases of two sides.
pub fn pairs<'a>(
    path: &str,
    sides: &[Json; 2],
    [first, second]: &[Vec<&'a Case>; 2],
) -> Vec<(&'a Case, &'a Case)> {
    let rest = |case: &Case| {
        let mut params = case.params.clone();
        params.shift_remove(path);
        labels::canonical(&params)
    };
    let mut partners: IndexMap<String, Vec<&Case>> = IndexMap::new();
    second.iter().for_each(|case| partners.entry(rest(case)).or_default().push(case));
    let own = |case: &Case, side: &Json| own_params(side, &case.params[path]);
    let mut found = Vec::new();
    for a in first {
        let Some(candidates) = partners.get(&rest(a)) else { continue };
        let params = own(a, &sides[0]);
        let exact = candidates.iter().find(|b| own(b, &sides[1]) == params);
        let mut fitting = candidates.iter().filter(|b| {
            let others = own(b, &sides[1]);
            others.iter().all(|(name, value)| params.get(name).is_none_or(|p| p == value))
        });
        // What one side alone can be set to must leave one partner, or the pair would be a guess.
        let only = fitting.next().filter(|_| fitting.next().is_none());
        if let Some(b) = exact.or(only) {
            found.push((*a, *b));
        }
    }
    found
}

/// The parameters of the entry that a value chooses, where a side names the entry alone.
fn own_params(side: &Json, value: &Json) -> JsonMap<String, Json> {
    if side == value {
        return JsonMap::new();
    }
    let params = side.as_str().and_then(|id| value.get(id)).and_then(Json::as_object);
    params.cloned().unwrap_or_default()
}

/// The values of two cases; `None` where one has none.
pub fn pair(
    results: &Results,
    cases: [&Case; 2],
    path: &str,
    measure: &MeasureColumn,
    same: &[String],
) -> Option<Pair> {
    let mean = |case: &Case, column: &str| Some(case.estimate(column)?.mean);
    let both = |column: &str| Some([mean(cases[0], column)?, mean(cases[1], column)?]);
    let value = |case: &Case| Some(measure.estimate(results, case)?.mean);
    let values = [value(cases[0])?, value(cases[1])?];
    let is_positive = values.iter().all(|value| *value > 0.0);
    let ratio = is_positive.then(|| values[0] / values[1]).filter(|ratio| ratio.is_normal());
    let same = same.iter().map(|column| both(column)).collect();
    // What is compared is not what both have in common, but its own parameters are.
    let mut label = Vec::new();
    for (place, axis) in cases[0].at.iter().zip(&results.axes) {
        if !axis.paths.iter().any(|known| known == path) {
            label.push(axis.labels[*place].clone());
        } else if let Some(Json::Object(value)) = cases[0].params.get(path) {
            let own = value.values().filter_map(Json::as_object).flatten();
            label.extend(own.map(|(name, value)| format!("{name} {}", labels::of_value(value))));
        }
    }
    let group = results.group_of(cases[0]);
    Some(Pair { label: label.join(" · "), group, values, ratio, same })
}
