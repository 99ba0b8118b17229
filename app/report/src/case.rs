//! One assignment of the varied parameters, and what its steps gave.

use std::sync::Arc;

use indexmap::IndexMap;
use mve_core::{NodeRecord, Scalar, StepRecord, StepStatus, brief, median};
use serde_json::Value as Json;

use crate::labels;
use crate::stats::{Estimate, estimate};

/// One assignment of the varied parameters.
pub struct Case {
    /// The parameters that it sets.
    pub params: IndexMap<String, Json>,
    /// Its steps, each once: one, or as many as there are repeats that differ.
    pub steps: Vec<StepOf>,
    /// The place of its value on each axis.
    pub at: Vec<usize>,
    /// For each measure, below what its values are rounding.
    pub rounding: Arc<IndexMap<String, f64>>,
}

/// A step of a case.
pub struct StepOf {
    /// Its id.
    pub id: String,
    /// What is kept of it, if it has ended.
    pub record: Option<Arc<StepRecord>>,
}

/// What stands in a cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing: the step has not ended, failed, or gives no such output.
    Empty,
    /// A number, or the mean of several.
    Number(Estimate),
    /// A text.
    Text(String),
}

/// How all numbers of a column are written, so that they compare at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberForm {
    /// `0.0014`.
    Plain,
    /// `1.4000e-3`, with as many decimals as the longest number of the column has.
    Exponent { decimals: usize },
}

impl NumberForm {
    /// With exponents where one of the cells needs one.
    pub fn of<'a>(cells: impl Iterator<Item = &'a Cell>) -> Self {
        let cells: Vec<&Cell> = cells.collect();
        if !cells.iter().any(|cell| cell.has_exponent()) {
            return Self::Plain;
        }
        let decimals = |number: f64| {
            let text = labels::with_exponent(number, DIGITS);
            let mantissa = text.split('e').next().unwrap_or_default().to_owned();
            mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len())
        };
        let numbers = cells.iter().filter_map(|cell| cell.number());
        Self::Exponent { decimals: numbers.map(decimals).max().unwrap_or(0) }
    }
}

/// Significant digits of a number that has no interval.
const DIGITS: usize = 5;

/// How many digits of a mean its interval leaves.
fn digits_beside(mean: f64, half: f64) -> usize {
    let digits = mean.abs().log10().floor() - half.log10().floor() + 2.0;
    if digits.is_finite() { digits.clamp(1.0, 17.0) as usize } else { 5 }
}

/// A mean with its interval, both with exponents.
fn in_exponents(Estimate { mean, half_width, .. }: &Estimate, form: NumberForm) -> String {
    match (half_width.filter(|half| *half > 0.0), form) {
        (Some(half), _) => {
            let mean = labels::with_exponent(*mean, digits_beside(*mean, half));
            format!("{mean} ± {}", labels::with_exponent(half, 2))
        }
        (None, NumberForm::Exponent { decimals }) if *mean != 0.0 => format!("{mean:.decimals$e}"),
        (None, _) => labels::with_exponent(*mean, DIGITS),
    }
}

impl Cell {
    /// The number in it.
    pub fn number(&self) -> Option<f64> {
        Some(self.estimate()?.mean)
    }

    /// The number in it with its interval.
    pub fn estimate(&self) -> Option<Estimate> {
        match self {
            Self::Number(estimate) => Some(*estimate),
            _ => None,
        }
    }

    /// Whether a number in it reads as `1.2e-4`.
    fn has_exponent(&self) -> bool {
        self.number().is_some_and(|number| brief(number).contains('e'))
    }

    /// The cell for reading, with the interval where there is one.
    pub fn shown(&self, form: NumberForm) -> String {
        match self {
            Self::Number(estimate) if form != NumberForm::Plain => in_exponents(estimate, form),
            Self::Empty => String::new(),
            Self::Text(text) => text.clone(),
            Self::Number(Estimate { mean, half_width: Some(half), .. }) if *half > 0.0 => {
                let mean = labels::rounded(*mean, digits_beside(*mean, *half));
                format!("{mean} ± {}", labels::rounded(*half, 2))
            }
            Self::Number(estimate) => brief(estimate.mean),
        }
    }
}

impl Case {
    /// Records of steps that have ended.
    pub fn records(&self) -> impl Iterator<Item = &StepRecord> {
        self.steps.iter().filter_map(|step| step.record.as_deref())
    }

    /// The finite numbers of a column, one a step; 0 where they are rounding.
    pub fn numbers(&self, column: &str) -> Vec<f64> {
        let rounding = self.rounding.get(column).copied().unwrap_or(0.0);
        let kept = |number: f64| if number.abs() < rounding { 0.0 } else { number };
        self.exact_numbers(column).into_iter().map(kept).collect()
    }

    /// The finite numbers of a column, one a step or a timing, as they were recorded. Seconds of
    /// what was taken from the cache are none, or repeats would have a mean of work and of reading.
    pub fn exact_numbers(&self, column: &str) -> Vec<f64> {
        if let Some(value) = self.params.get(column) {
            return value.as_f64().into_iter().collect();
        }
        let numbers = match column {
            "seconds_min" => {
                self.exact_numbers("seconds").into_iter().reduce(f64::min).into_iter().collect()
            }
            "seconds_median" => median(&self.exact_numbers("seconds")).into_iter().collect(),
            _ => self.records().flat_map(|record| numbers_of(record, column)).collect::<Vec<_>>(),
        };
        numbers.into_iter().filter(|number| number.is_finite()).collect()
    }

    /// Mean and interval of a column.
    pub fn estimate(&self, column: &str) -> Option<Estimate> {
        estimate(&self.numbers(column))
    }

    /// What a table shows of a column.
    pub fn cell(&self, column: &str) -> Cell {
        if let Some(estimate) = self.estimate(column) {
            return Cell::Number(estimate);
        }
        if let Some(value) = self.params.get(column) {
            return Cell::Text(labels::of_value(value));
        }
        match self.records().find_map(|record| scalar(record, column)) {
            None => Cell::Empty,
            Some(Scalar::Number(_)) => Cell::Text("not finite".to_owned()),
            Some(other) => Cell::Text(other.to_string()),
        }
    }

    /// How many of its steps are done.
    pub fn n_done(&self) -> usize {
        self.records().filter(|record| record.status == StepStatus::Done).count()
    }

    /// How its steps ended: the worst of them, `to do` where one has not.
    pub fn status(&self) -> &'static str {
        let word = |step: &StepOf| step.record.as_ref().map_or("to do", |r| r.status.word());
        let words = || self.steps.iter().map(word);
        words().find(|word| *word != "done").or(words().next()).unwrap_or("to do")
    }

    /// The target that a step did not reach, in words: `simplify: 144 of 126 faces`.
    pub fn missed(&self) -> Option<String> {
        self.records().map(StepRecord::missed_in_words).find(|words| !words.is_empty())
    }

    /// Whether it can be compared with others: it is done and reached its targets.
    pub fn is_comparable(&self) -> bool {
        self.n_done() > 0 && self.missed().is_none()
    }

    /// What its steps warned of, each once, with the node.
    pub fn warnings(&self) -> Vec<String> {
        let mut all: Vec<String> = Vec::new();
        for (node, text) in self.records().flat_map(StepRecord::warnings) {
            let line = format!("{node}: {text}");
            if !all.contains(&line) {
                all.push(line);
            }
        }
        all
    }
}

fn numbers_of(record: &StepRecord, column: &str) -> Vec<f64> {
    let timings = || record.timings.iter();
    let is_timed = !record.timings.is_empty();
    let place = column.strip_prefix("seconds.").filter(|place| is_time(record, place));
    match (column, place) {
        ("seconds", _) if is_timed => timings().map(|timing| timing.seconds).collect(),
        ("seconds", _) => is_work(record).then_some(record.seconds).into_iter().collect(),
        ("cpu_seconds", _) => timings().filter_map(|timing| timing.cpu_seconds).collect(),
        ("peak_bytes", _) => {
            timings().filter_map(|timing| Some(timing.peak_bytes? as f64)).collect()
        }
        (_, Some(place)) if is_timed => {
            timings().filter_map(|timing| timing.parts.get(place).copied()).collect()
        }
        (_, Some(place)) => time(record, place).into_iter().collect(),
        _ => match scalar(record, column) {
            Some(Scalar::Number(number)) => vec![*number],
            _ => Vec::new(),
        },
    }
}

/// Whether the seconds of a step are those of its work: it is done, and did more than read values
/// from the cache and write them to files.
fn is_work(record: &StepRecord) -> bool {
    let nodes = || record.nodes.values();
    let is_cached = nodes().any(|node| node.cached.is_some());
    let is_own = |node: &NodeRecord| {
        node.cached.is_none() && node.seconds.is_some() && node.files.is_empty()
    };
    record.status == StepStatus::Done && (!is_cached || nodes().any(is_own))
}

/// The node of `node` or `node.part`, the places behind `seconds.`.
fn node_of<'a>(record: &'a StepRecord, place: &str) -> Option<&'a NodeRecord> {
    record.nodes.get(place).or_else(|| record.nodes.get(place.rsplit_once('.')?.0))
}

fn is_time(record: &StepRecord, place: &str) -> bool {
    node_of(record, place).is_some()
}

/// Seconds of a node or of a part of its work.
fn time(record: &StepRecord, place: &str) -> Option<f64> {
    let node = node_of(record, place)?;
    match record.nodes.contains_key(place) {
        true => node.seconds,
        false => node.phases.get(place.rsplit_once('.')?.1).copied(),
    }
}

fn scalar<'a>(record: &'a StepRecord, column: &str) -> Option<&'a Scalar> {
    let (node, output) = column.split_once('.')?;
    record.nodes.get(node)?.scalars.get(output)
}
