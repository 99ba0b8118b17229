//! The results of a program as its store holds them: cases, axes and columns.
//!
//! A case is one assignment of the varied parameters with all its repeats. An axis is a list of
//! parameters that advance together. Nothing here knows what a column means.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use indexmap::{IndexMap, IndexSet};
use mve_core::{Better, PlanFile, ReportSpec, Role, StepRecord, StepStatus, Store};

use serde_json::Value as Json;

use crate::ReportError;
use crate::axes::{self, Axis};
use crate::case::{Case, StepOf};
use crate::labels::{self, node_of};

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
    /// The axes, those of the rows first, and those of the series last.
    pub axes: Vec<Axis>,
    /// How many of the last axes give series.
    n_series_axes: usize,
    /// Of each series the place on every axis that gives some. One without places where nothing is
    /// compared.
    pub series: Vec<Vec<usize>>,
    /// The column that says how large results are.
    pub size: Option<String>,
}

/// The part of the largest value of a measure, and of its scale, below which a value is rounding
/// and counts as 0: else distances of 10⁻¹⁶ and 10⁻¹⁷ would be ranked, averaged and plotted.
const ROUNDING: f64 = 1e-12;

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
            n_series_axes: 0,
            series: vec![Vec::new()],
            size: None,
        };
        results.arrange();
        Ok(results)
    }

    /// Takes another report in the place of the one that the store holds.
    pub fn ask(&mut self, spec: ReportSpec) {
        self.spec = spec;
        self.arrange();
    }

    /// Finds what follows from what the report says.
    fn arrange(&mut self) {
        self.cases.iter_mut().for_each(|case| case.at.clear());
        (self.axes, self.n_series_axes) = axes::axes(&self.plan, &self.spec, &mut self.cases);
        let series: BTreeSet<&[usize]> =
            self.cases.iter().map(|case| self.series_key(case)).collect();
        let series: Vec<Vec<usize>> = series.into_iter().map(<[_]>::to_vec).collect();
        if !series.is_empty() {
            self.series = series;
        }
        self.size = self.find_size();
        self.find_rounding();
    }

    /// Finds below what the values of each output are rounding.
    fn find_rounding(&mut self) {
        let largest = |column: &String| {
            let all = self.cases.iter().flat_map(|case| case.exact_numbers(column));
            all.fold(0.0, |largest: f64, number| largest.max(number.abs()))
        };
        let outputs = self.outputs();
        let rounding = outputs.iter().map(|column| {
            let largest = largest(column).max(self.scale(column, &outputs));
            (column.clone(), ROUNDING * largest)
        });
        let rounding: IndexMap<String, f64> = rounding.collect();
        let rounding = Arc::new(rounding);
        self.cases.iter_mut().for_each(|case| case.rounding = rounding.clone());
    }

    /// What the values of a measure are small or large against: 1 where it has no unit; for one in
    /// a unit that the model brings the least of what its node says of the model in that unit, such
    /// as a diagonal; else nothing that is known.
    fn scale(&self, column: &str, outputs: &[String]) -> f64 {
        let declared = |column: &str| self.plan.columns.find(column).into_iter().next();
        let Some(own) = declared(column).filter(|own| own.better != Better::Neither) else {
            return 0.0;
        };
        if !own.is_of_model {
            return if own.unit.is_empty() { 1.0 } else { 0.0 };
        }
        let is_yardstick = |other: &&String| {
            let declared = declared(other).filter(|_| node_of(other) == node_of(column));
            declared.is_some_and(|other| {
                other.better == Better::Neither && other.is_of_model && other.unit == own.unit
            })
        };
        let sizes = outputs
            .iter()
            .filter(is_yardstick)
            .flat_map(|other| self.cases.iter().flat_map(move |case| case.exact_numbers(other)));
        let least = sizes.filter(|size| *size > 0.0).reduce(f64::min);
        least.unwrap_or(0.0)
    }

    /// The column that says how large a result is: of the node whose parameter gives the series, or
    /// of one that runs after it; where there is none, as series are ways to measure, of any node.
    fn find_size(&self) -> Option<String> {
        let place = |node: &str| self.plan.nodes.iter().position(|known| known == node);
        let first = self.series_node().and_then(place).unwrap_or(0);
        let is_after = |column: &&String| place(node_of(column)).is_none_or(|place| place >= first);
        let outputs = self.outputs();
        let is_size = |column: &&String| self.plan.columns.role(column) == Role::Size;
        let is_there = |column: &&String| is_size(column) && self.has_numbers(column);
        let sizes: Vec<&String> = outputs.iter().filter(is_there).collect();
        // The first of those that differ from step to step.
        let telling = |sizes: &[&String]| {
            let differing = sizes.iter().find(|column| !self.is_constant(column));
            differing.or(sizes.first()).map(|column| (*column).clone())
        };
        let after: Vec<&String> = sizes.iter().copied().filter(is_after).collect();
        telling(&after).or_else(|| telling(&sizes))
    }

    /// Whether some step gave a number for a column.
    pub fn has_numbers(&self, column: &str) -> bool {
        self.cases.iter().any(|case| !case.exact_numbers(column).is_empty())
    }

    /// Whether all of several cases that have a number have the same.
    pub fn is_constant(&self, column: &str) -> bool {
        let mut numbers = self.cases.iter().filter_map(|case| case.estimate(column));
        let Some(first) = numbers.next() else { return true };
        self.cases.len() > 1 && numbers.all(|number| number.mean == first.mean)
    }

    /// Whether some value of one of these columns was rounding and counts as 0.
    pub fn has_rounding(&self, columns: &[&str]) -> bool {
        self.cases.iter().any(|case| {
            columns.iter().any(|column| {
                let kept = case.numbers(column).into_iter();
                kept.zip(case.exact_numbers(column)).any(|(kept, exact)| kept != exact)
            })
        })
    }

    /// The parameters that vary, also in stores whose plan does not list them.
    pub fn varied(&self) -> Vec<String> {
        axes::varied(&self.plan, &self.cases)
    }

    /// Whether something is compared: some axis gives series.
    pub fn has_series(&self) -> bool {
        self.n_series_axes > 0
    }

    fn n_row_axes(&self) -> usize {
        self.axes.len() - self.n_series_axes
    }

    /// The axis of the rows: the first that gives no series.
    pub fn group_axis(&self) -> Option<&Axis> {
        self.axes.first().filter(|_| self.n_row_axes() > 0)
    }

    /// The axes that give series.
    pub fn series_axes(&self) -> &[Axis] {
        &self.axes[self.n_row_axes()..]
    }

    /// The axes that give none.
    pub fn other_axes(&self) -> &[Axis] {
        &self.axes[..self.n_row_axes()]
    }

    /// The place of a case on the axis of the rows; 0 where there is none.
    pub fn group_of(&self, case: &Case) -> usize {
        if self.group_axis().is_some() { case.at[0] } else { 0 }
    }

    fn series_key<'a>(&self, case: &'a Case) -> &'a [usize] {
        &case.at[self.n_row_axes()..]
    }

    /// The place of a case among the series.
    pub fn series_of(&self, case: &Case) -> usize {
        let key = self.series_key(case);
        self.series.iter().position(|series| series == key).unwrap_or(0)
    }

    /// The names of a series, one for each axis that gives some.
    pub fn series_names(&self, series: &[usize]) -> Vec<String> {
        let axes = self.series_axes().iter().zip(series);
        axes.map(|(axis, place)| axis.labels[*place].clone()).collect()
    }

    /// The names of the series in a line each; one without a name where there are none.
    pub fn series_labels(&self) -> Vec<String> {
        self.series.iter().map(|series| self.series_names(series).join(" · ")).collect()
    }

    /// A value of a parameter in words, with the name of its axis where it does not say by itself
    /// what it is: `Quadric`, `flip angle 45`.
    pub fn name_of(&self, path: &str, value: &Json) -> String {
        let label = labels::of_value(value);
        let axis = self.axes.iter().find(|axis| axis.paths.iter().any(|known| known == path));
        match axis {
            Some(axis) if !value.is_string() && !value.is_object() => {
                format!("{} {label}", axis.title)
            }
            _ => label,
        }
    }

    /// The places of a case on all axes but those of the series.
    pub fn row_of<'a>(&self, case: &'a Case) -> &'a [usize] {
        &case.at[..self.n_row_axes()]
    }

    /// The places of the axes that tell rows apart: all but those of the series, without those of
    /// one value where another varies.
    pub fn row_axes(&self) -> Vec<usize> {
        let own = self.n_row_axes();
        let places: Vec<usize> = (0..own).filter(|place| self.axes[*place].varies()).collect();
        if places.is_empty() { (0..own).collect() } else { places }
    }

    /// The names of a row, one for each axis that tells rows apart.
    pub fn row_names(&self, row: &[usize]) -> Vec<String> {
        let part = |place: usize| self.axes[place].labels[row[place]].clone();
        self.row_axes().into_iter().map(part).collect()
    }

    /// The name of a row in a line.
    pub fn row_label(&self, row: &[usize]) -> String {
        self.row_names(row).join(" · ")
    }

    /// Rows in the order of their axes, each with its cases by series.
    pub fn rows(&self) -> BTreeMap<Vec<usize>, Vec<Option<&Case>>> {
        let series = &self.series;
        let mut rows: BTreeMap<Vec<usize>, Vec<Option<&Case>>> = BTreeMap::new();
        for case in &self.cases {
            let row = rows.entry(self.row_of(case).to_vec());
            let row = row.or_insert_with(|| vec![None; series.len()]);
            let key = self.series_key(case);
            if let Some(place) = series.iter().position(|series| series == key) {
                row[place] = Some(case);
            }
        }
        rows
    }

    /// How large the result of a case is; none where no column says so.
    pub fn size_of(&self, case: &Case) -> Option<f64> {
        Some(case.estimate(self.size.as_deref()?)?.mean)
    }

    /// Whether results can be compared: those that can be at all are of one size.
    pub fn are_alike(&self, cases: &[Option<&Case>]) -> bool {
        let compared = cases.iter().copied().flatten().filter(|case| case.is_comparable());
        mve_core::are_alike(compared.filter_map(|case| self.size_of(case)))
    }

    /// Whether an axis varies what the map starts from.
    pub fn is_input(&self, axis: &Axis) -> bool {
        axes::is_input(&self.plan, axis)
    }

    /// The node whose parameter gives the series: what is compared.
    pub fn series_node(&self) -> Option<&str> {
        self.series_axes().last()?.paths.first().map(|path| node_of(path))
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
        let are = if done == 1 { "is" } else { "are" };
        format!("{done} of {n} steps {are} done, {}: what follows is without those.", {
            parts.join(", ")
        })
    }

    /// Of all steps that are done, those that did not reach their target, in words; empty if all
    /// did.
    pub fn missed_in_words(&self) -> String {
        let done = || self.cases.iter().flat_map(|case| &case.steps);
        let ids: BTreeMap<&str, bool> = done()
            .filter_map(|step| Some((step.id.as_str(), step.record.as_ref()?)))
            .map(|(id, record)| (id, record.missed().next().is_some()))
            .collect();
        match (ids.values().filter(|is_missed| **is_missed).count(), ids.len()) {
            (0, _) => String::new(),
            (1, n) => format!("1 of {n} steps did not reach its target."),
            (missed, n) => format!("{missed} of {n} steps did not reach their target."),
        }
    }

    /// Whether all seconds were measured with nothing shared.
    pub fn is_timed(&self) -> bool {
        let mut records = self.cases.iter().flat_map(Case::records).peekable();
        records.peek().is_some() && records.all(|record| record.is_timed)
    }
}
