//! The results of a program as its store holds them: cases, axes and columns.
//!
//! A case is one assignment of the varied parameters with all its repeats. An axis is a list of
//! parameters that advance together. Nothing here knows what a column means.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use indexmap::{IndexMap, IndexSet};
use mve_core::{NodeRecord, PlanFile, ReportSpec, Scalar, StepRecord, StepStatus, Store, brief};
use serde_json::Value as Json;

use crate::ReportError;
use crate::labels;
use crate::stats::{Estimate, estimate};

/// What a store holds.
pub struct Results {
    /// Its folder.
    pub folder: PathBuf,
    /// What it says it holds.
    pub plan: PlanFile,
    /// What the program says of its report.
    pub spec: ReportSpec,
    /// Every assignment, in the order of the program.
    pub cases: Vec<Case>,
    /// The axes, those of the rows first, and the one of the series, if there is one, last.
    pub axes: Vec<Axis>,
    /// Whether the last axis gives series.
    pub has_series: bool,
}

/// One assignment of the varied parameters.
pub struct Case {
    /// The parameters that it sets.
    pub params: IndexMap<String, Json>,
    /// Its steps, each once: one, or as many as there are repeats that differ.
    pub steps: Vec<StepOf>,
    /// The place of its value on each axis.
    pub at: Vec<usize>,
    /// For each measure that the program names, below what its values are rounding.
    rounding: Arc<IndexMap<String, f64>>,
}

/// The part of the largest value of a measure below which a value is rounding and counts as 0: else
/// distances of 10⁻¹⁶ and 10⁻¹⁷ would be ranked, averaged and plotted.
const ROUNDING: f64 = 1e-12;

/// A step of a case.
pub struct StepOf {
    /// Its id.
    pub id: String,
    /// What is kept of it, if it has ended.
    pub record: Option<Arc<StepRecord>>,
}

/// Parameters that advance together.
#[derive(Debug)]
pub struct Axis {
    /// Their paths.
    pub paths: Vec<String>,
    /// Their values, in the order of the program; `null` where a step leaves one as it is.
    pub values: Vec<Vec<Json>>,
    /// A short name of each value.
    pub labels: Vec<String>,
}

impl Axis {
    /// Whether its values are numbers, which have an order and can be plotted against.
    pub fn is_scale(&self) -> bool {
        self.values.iter().flatten().all(Json::is_number)
    }
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

impl Cell {
    /// The number in it.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(estimate) => Some(estimate.mean),
            _ => None,
        }
    }

    /// The cell for reading, with the interval where there is one.
    pub fn shown(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Text(text) => text.clone(),
            Self::Number(Estimate { mean, half_width: Some(half), .. }) if *half > 0.0 => {
                format!("{} ± {}", brief(*mean), labels::rounded(*half, 2))
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

    /// The finite numbers of a column, one a step, as they were recorded. Seconds of what was taken
    /// from the cache are none, or repeats would have a mean of work and of reading.
    pub fn exact_numbers(&self, column: &str) -> Vec<f64> {
        if let Some(value) = self.params.get(column) {
            return value.as_f64().into_iter().collect();
        }
        let of = |record: &StepRecord| match column {
            "seconds" => is_work(record).then_some(record.seconds),
            _ => match column.strip_prefix("seconds.") {
                Some(place) if is_time(record, place) => time(record, place),
                _ => match scalar(record, column) {
                    Some(Scalar::Number(number)) => Some(*number),
                    _ => None,
                },
            },
        };
        self.records().filter_map(of).filter(|number| number.is_finite()).collect()
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
}

/// Whether the seconds of a step are those of its work: it is done, and did more than read values
/// from the cache and write them to files.
fn is_work(record: &StepRecord) -> bool {
    let nodes = || record.nodes.values();
    let is_cached = nodes().any(|node| node.cached.is_some());
    let is_own = |node: &NodeRecord| node.seconds.is_some() && node.files.is_empty();
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

impl Results {
    /// Reads a store.
    pub fn read(folder: &Path) -> Result<Self, ReportError> {
        let store = Store::look(folder)?;
        let store = store.ok_or_else(|| ReportError::Missing(folder.to_owned()))?;
        if !folder.join("plan.json").exists() {
            return Err(ReportError::Missing(folder.to_owned()));
        }
        let plan = store.plan()?;
        let spec = match &plan.spec.report {
            None => ReportSpec::default(),
            // A store tells as much as it can, whatever stands there.
            Some(json) => ReportSpec::parse(json).unwrap_or_default(),
        };
        let mut cases: IndexMap<String, Case> = IndexMap::new();
        for step in &plan.steps {
            let key = labels::canonical(&step.params);
            let new = || Case {
                params: step.params.clone(),
                steps: Vec::new(),
                at: Vec::new(),
                rounding: Arc::default(),
            };
            let case = cases.entry(key).or_insert_with(new);
            // Repeats of what has no seed are one and the same step.
            if case.steps.iter().all(|known| known.id != step.id) {
                let record = store.record(&step.id);
                case.steps.push(StepOf { id: step.id.clone(), record });
            }
        }
        let mut results = Self {
            folder: folder.to_owned(),
            plan,
            spec,
            cases: cases.into_values().collect(),
            axes: Vec::new(),
            has_series: false,
        };
        results.find_axes();
        results.find_rounding();
        Ok(results)
    }

    /// Finds below what the values of each measure are rounding.
    fn find_rounding(&mut self) {
        let asked = self.spec.questions.iter().map(|question| &question.measure);
        let columns = self.spec.measures.iter().map(|measure| &measure.column).chain(asked);
        let largest = |column: &String| {
            let all = self.cases.iter().flat_map(|case| case.numbers(column));
            all.fold(0.0, |largest: f64, number| largest.max(number.abs()))
        };
        let rounding: IndexMap<String, f64> =
            columns.map(|column| (column.clone(), ROUNDING * largest(column))).collect();
        let rounding = Arc::new(rounding);
        self.cases.iter_mut().for_each(|case| case.rounding = rounding.clone());
    }

    /// Whether some value of a measure was rounding and counts as 0.
    pub fn has_rounding(&self) -> bool {
        self.cases.iter().any(|case| {
            let columns = case.rounding.iter();
            columns.filter(|(_, least)| **least > 0.0).any(|(column, least)| {
                let numbers = case.exact_numbers(column);
                numbers.iter().any(|number| *number != 0.0 && number.abs() < *least)
            })
        })
    }

    /// The parameters that vary, also in stores whose plan does not list them.
    pub fn varied(&self) -> Vec<String> {
        let mut varied: IndexSet<String> = self.plan.varied.iter().cloned().collect();
        varied.extend(self.cases.iter().flat_map(|case| case.params.keys().cloned()));
        varied.into_iter().collect()
    }

    fn find_axes(&mut self) {
        let varied = self.varied();
        let mut groups: Vec<Vec<String>> = Vec::new();
        for axis in &self.plan.spec.axes {
            groups.push(axis.keys().cloned().collect());
        }
        for path in varied {
            if !groups.iter().flatten().any(|known| *known == path) {
                groups.push(vec![path]);
            }
        }
        let holds = |axis: &Vec<String>, path: &Option<String>| {
            path.as_ref().is_some_and(|path| axis.contains(path))
        };
        // The axis of the rows goes to the front and the one of the series to the end.
        groups.sort_by_key(|axis| !holds(axis, &self.spec.group));
        groups.sort_by_key(|axis| holds(axis, &self.spec.series));
        for paths in groups {
            let of = |case: &Case| -> Vec<Json> {
                paths
                    .iter()
                    .map(|path| case.params.get(path).cloned().unwrap_or_default())
                    .collect()
            };
            let mut places: IndexMap<String, Vec<Json>> = IndexMap::new();
            for case in &mut self.cases {
                let value = of(case);
                let key = Json::from(value.clone()).to_string();
                let entry = places.entry(key);
                case.at.push(entry.index());
                entry.or_insert(value);
            }
            let values: Vec<Vec<Json>> = places.into_values().collect();
            let labels = labels::of_axis(&values);
            self.axes.push(Axis { paths, values, labels });
        }
        self.move_constant_axes();
        let varying = || self.axes.iter().filter(|axis| axis.values.len() > 1);
        // Numbers alone are something to plot against, not to tell apart.
        self.has_series = varying().count() > 1
            || self.spec.series.is_some()
            || varying().any(|axis| !axis.is_scale());
        self.has_series &= !self.axes.is_empty();
    }

    /// An axis with one value tells no series and no groups apart: where the program does not name
    /// it, one that varies takes its place at either end.
    fn move_constant_axes(&mut self) {
        let n = self.axes.len();
        let mut order: Vec<usize> = (0..n).collect();
        let varies = |place: &usize| self.axes[*place].values.len() > 1;
        if self.spec.series.is_none()
            && let Some(place) = order.iter().rposition(varies)
        {
            order[place..].rotate_left(1);
        }
        let n_others = n.saturating_sub(1);
        if self.spec.group.is_none()
            && let Some(place) = order.iter().take(n_others).position(varies)
        {
            order[..=place].rotate_right(1);
        }
        let mut axes: Vec<Option<Axis>> = self.axes.drain(..).map(Some).collect();
        self.axes = order.iter().filter_map(|place| axes[*place].take()).collect();
        for case in &mut self.cases {
            case.at = order.iter().map(|place| case.at[*place]).collect();
        }
    }

    /// The axis of the rows: the first that gives no series.
    pub fn group_axis(&self) -> Option<&Axis> {
        self.axes.first().filter(|_| self.axes.len() > usize::from(self.has_series))
    }

    /// The axis that gives series.
    pub fn series_axis(&self) -> Option<&Axis> {
        self.axes.last().filter(|_| self.has_series)
    }

    /// The place of a case on the axis of the rows; 0 where there is none.
    pub fn group_of(&self, case: &Case) -> usize {
        if self.group_axis().is_some() { case.at[0] } else { 0 }
    }

    /// The place of a case among the series; 0 where there are none.
    pub fn series_of(&self, case: &Case) -> usize {
        if self.has_series { case.at.last().copied().unwrap_or(0) } else { 0 }
    }

    /// The names of the series; one without a name where there are none.
    pub fn series_labels(&self) -> Vec<String> {
        self.series_axis().map_or(vec![String::new()], |axis| axis.labels.clone())
    }

    /// The places of a case on all axes but the one of the series.
    pub fn row_of<'a>(&self, case: &'a Case) -> &'a [usize] {
        &case.at[..case.at.len() - usize::from(self.has_series)]
    }

    /// The places of the axes that tell rows apart: all but that of the series, without those of
    /// one value where another varies.
    pub fn row_axes(&self) -> Vec<usize> {
        let own = self.axes.len() - usize::from(self.has_series);
        let varying = |place: &usize| self.axes[*place].values.len() > 1;
        let places: Vec<usize> = (0..own).filter(varying).collect();
        if places.is_empty() { (0..own).collect() } else { places }
    }

    /// The name of a row, and its parts behind the group's.
    pub fn row_label(&self, row: &[usize]) -> String {
        let part = |place: usize| self.axes[place].labels[row[place]].clone();
        self.row_axes().into_iter().map(part).collect::<Vec<_>>().join(" · ")
    }

    /// Rows in the order of the program, each with its cases by series.
    pub fn rows(&self) -> IndexMap<Vec<usize>, Vec<Option<&Case>>> {
        let n_series = self.series_labels().len();
        let mut rows: IndexMap<Vec<usize>, Vec<Option<&Case>>> = IndexMap::new();
        for case in &self.cases {
            let row = rows.entry(self.row_of(case).to_vec());
            row.or_insert_with(|| vec![None; n_series])[self.series_of(case)] = Some(case);
        }
        rows
    }

    /// The node whose parameter gives the series: what is compared.
    pub fn series_node(&self) -> Option<&str> {
        self.series_axis()?.paths.first()?.split('.').next()
    }

    /// Every output that some step gave, in running order, without the parameters that vary.
    pub fn outputs(&self) -> Vec<String> {
        let mut by_node: IndexMap<&str, IndexSet<&str>> = IndexMap::new();
        for node in &self.plan.nodes {
            by_node.insert(node, IndexSet::new());
        }
        for record in self.cases.iter().flat_map(Case::records) {
            for (node, record) in &record.nodes {
                let names = by_node.entry(node).or_default();
                names.extend(record.scalars.keys().map(String::as_str));
            }
        }
        let varied = self.varied();
        let columns = by_node
            .into_iter()
            .flat_map(|(node, names)| names.into_iter().map(move |name| format!("{node}.{name}")));
        columns.filter(|column| !varied.contains(column)).collect()
    }

    /// How many steps there are, each counted once: all, done, failed.
    pub fn counts(&self) -> (usize, usize, usize) {
        let steps: IndexMap<&str, Option<&StepRecord>> = self
            .cases
            .iter()
            .flat_map(|case| &case.steps)
            .map(|step| (step.id.as_str(), step.record.as_deref()))
            .collect();
        let ended = || steps.values().flatten();
        let done = ended().filter(|record| record.status == StepStatus::Done).count();
        (steps.len(), done, ended().count() - done)
    }

    /// What is missing in all that is said of the steps: those that failed or are to do. Empty if
    /// nothing is.
    pub fn missing_in_words(&self) -> String {
        let (n, done, failed) = self.counts();
        let mut parts = Vec::new();
        parts.extend((failed > 0).then(|| format!("{failed} failed")));
        parts.extend((n > done + failed).then(|| format!("{} to do", n - done - failed)));
        if parts.is_empty() {
            return String::new();
        }
        format!("{done} of {n} steps are done, {}: what follows is without those.", {
            parts.join(", ")
        })
    }

    /// Whether all seconds were measured with nothing shared.
    pub fn is_timed(&self) -> bool {
        self.cases.iter().flat_map(Case::records).all(|record| record.is_timed)
    }
}
