//! The axes of a program: which part rows and plots, and which give columns and series.

use std::collections::HashSet;

use indexmap::{IndexMap, IndexSet};
use mve_core::{PlanFile, ReportSpec, Role, median};
use serde_json::Value as Json;

use crate::case::Case;
use crate::labels;

/// Series of which a reader still keeps apart the lines of a plot and the columns of a table. More
/// are only drawn where a map asks for them.
const MOST_SERIES: usize = 12;

/// The share by which sizes must differ along an axis that sets them.
const SIZED: f64 = 0.02;

/// Parameters that advance together.
#[derive(Debug)]
pub struct Axis {
    /// Their paths.
    pub paths: Vec<String>,
    /// Its name for a person.
    pub title: String,
    /// Their values, in the order of the program; `None` where a step leaves one as it is.
    pub values: Vec<Vec<Option<Json>>>,
    /// A short name of each value.
    pub labels: Vec<String>,
    /// Whether it sets how large results are, so that they are plotted along it.
    pub is_sizing: bool,
}

impl Axis {
    /// Whether its values are numbers, which have an order and can be plotted against.
    pub fn is_scale(&self) -> bool {
        self.values.iter().flatten().all(|value| value.as_ref().is_some_and(Json::is_number))
    }

    /// Whether it has more than one value.
    pub fn varies(&self) -> bool {
        self.values.len() > 1
    }
}

/// The axes, those of the rows first, and how many of the last ones give series. Each case learns
/// its place on them.
pub fn axes(plan: &PlanFile, spec: &ReportSpec, cases: &mut [Case]) -> (Vec<Axis>, usize) {
    let mut groups: Vec<Vec<String>> =
        plan.spec.axes.iter().map(|axis| axis.keys().cloned().collect()).collect();
    for path in varied(plan, cases) {
        if !groups.iter().flatten().any(|known| *known == path) {
            groups.push(vec![path]);
        }
    }
    let titles = titles(&groups);
    let mut all = Vec::new();
    for (paths, title) in groups.into_iter().zip(titles) {
        let mut places: IndexMap<String, Vec<Option<Json>>> = IndexMap::new();
        for case in cases.iter_mut() {
            let value: Vec<Option<Json>> =
                paths.iter().map(|path| case.params.get(path).cloned()).collect();
            // An assignment of nothing is not the same as none.
            let key = format!("{value:?}");
            let entry = places.entry(key);
            case.at.push(entry.index());
            entry.or_insert(value);
        }
        let values: Vec<_> = places.into_values().collect();
        let labels = labels::of_axis(&values);
        all.push(Axis { paths, title, values, labels, is_sizing: false });
    }
    let sizing = sizing(&all, plan, cases);
    if let Some(place) = sizing {
        all[place].is_sizing = true;
    }
    let series = series(&all, plan, spec);
    let order = order(&all, spec, &series);
    for case in cases.iter_mut() {
        case.at = order.iter().map(|place| case.at[*place]).collect();
    }
    let mut all: Vec<Option<Axis>> = all.into_iter().map(Some).collect();
    (order.iter().filter_map(|place| all[*place].take()).collect(), series.len())
}

/// The parameters that vary, also in stores whose plan does not list them.
pub fn varied(plan: &PlanFile, cases: &[Case]) -> Vec<String> {
    let mut varied: indexmap::IndexSet<String> = plan.varied.iter().cloned().collect();
    varied.extend(cases.iter().flat_map(|case| case.params.keys().cloned()));
    varied.into_iter().collect()
}

/// Names of axes for a person: the parameter, or the node of which only the module or the file
/// varies; the whole path where that would not tell them apart.
fn titles(groups: &[Vec<String>]) -> Vec<String> {
    let short = |paths: &Vec<String>| {
        let path = paths.first().map_or("", String::as_str);
        match path.rsplit_once('.') {
            Some((node, "module" | "path")) => node.to_owned(),
            Some((_, name)) => name.replace('_', " "),
            None => path.to_owned(),
        }
    };
    let all: Vec<String> = groups.iter().map(short).collect();
    let n_of = |title: &String| all.iter().filter(|other| *other == title).count();
    let whole = |paths: &Vec<String>| paths.first().cloned().unwrap_or_default();
    let told = |(title, paths)| if n_of(title) > 1 { whole(paths) } else { title.clone() };
    all.iter().zip(groups).map(told).collect()
}

/// The places of the axes that give series.
fn series(axes: &[Axis], plan: &PlanFile, spec: &ReportSpec) -> Vec<usize> {
    let named = named(axes, &spec.series);
    if !named.is_empty() {
        return named;
    }
    let is_free = |place: &usize| !holds(&axes[*place], &spec.group);
    let varying: Vec<usize> = (0..axes.len()).filter(|place| axes[*place].varies()).collect();
    let free: Vec<usize> = varying.iter().copied().filter(is_free).collect();
    let texts: Vec<usize> = free.iter().copied().filter(|place| !axes[*place].is_scale()).collect();
    // What is compared is what is done to models, not the models.
    let fed = fed(plan);
    let is_done = |place: &usize| {
        axes[*place].paths.first().is_some_and(|path| fed.contains(labels::node_of(path)))
    };
    let done: Vec<usize> = texts.iter().copied().filter(is_done).collect();
    // One table has a row for each model where nothing is done to them in several ways.
    let is_alone = |place: &usize| varying.len() == 1 && is_input(plan, &axes[*place]);
    let last = texts.last().copied().filter(|place| !is_alone(place));
    let mut chosen = if done.is_empty() { last.into_iter().collect() } else { done };
    let n_series = |places: &[usize]| -> usize {
        places.iter().map(|place| axes[*place].values.len()).product()
    };
    while chosen.len() > 1 && (n_series(&chosen) > MOST_SERIES || chosen.len() == varying.len()) {
        chosen.remove(0);
    }
    // Numbers alone are something to plot against, not to tell apart, above all those that say how
    // large results become.
    if chosen.is_empty() && varying.len() > 1 {
        let other = free.iter().rfind(|place| !axes[**place].is_sizing);
        chosen.extend(other.or(free.last()));
    }
    chosen
}

/// The axis of numbers by which the size of results differs most, all else being equal.
fn sizing(axes: &[Axis], plan: &PlanFile, cases: &[Case]) -> Option<usize> {
    let names = cases.iter().flat_map(Case::records).flat_map(|record| &record.nodes);
    let columns = names
        .flat_map(|(node, record)| record.scalars.keys().map(move |name| format!("{node}.{name}")));
    let is_size = |column: &String| plan.columns.role(column) == Role::Size;
    let sizes: IndexSet<String> = columns.filter(is_size).collect();
    let spread_of = |place: &usize| {
        let spread = |column: &String| median(&spreads(cases, *place, column)).unwrap_or(0.0);
        sizes.iter().map(spread).fold(0.0, f64::max)
    };
    let scales = (0..axes.len()).filter(|place| axes[*place].varies() && axes[*place].is_scale());
    let all = scales.map(|place| (place, spread_of(&place))).filter(|(_, spread)| *spread > SIZED);
    all.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(place, _)| place)
}

/// By how much a column differs along an axis, as a share, for each assignment of all others.
fn spreads(cases: &[Case], axis: usize, column: &str) -> Vec<f64> {
    let mut ends: IndexMap<Vec<usize>, (f64, f64)> = IndexMap::new();
    for case in cases {
        let Some(size) = case.estimate(column).map(|size| size.mean) else { continue };
        let mut others = case.at.clone();
        others.remove(axis);
        let (low, high) = ends.entry(others).or_insert((size, size));
        (*low, *high) = (low.min(size), high.max(size));
    }
    let share = |(low, high): &(f64, f64)| (high - low) / high.abs().max(low.abs()).max(1e-300);
    ends.values().map(share).collect()
}

/// Whether an axis varies what the map starts from: files that it reads, or nodes that take nothing
/// from others. Whether one model comes out better than another one is nothing to ask.
pub fn is_input(plan: &PlanFile, axis: &Axis) -> bool {
    let fed = fed(plan);
    let is_source = |path: &String| !fed.is_empty() && !fed.contains(labels::node_of(path));
    let is_read = |text: &str| {
        let rest = |file: &String| file.strip_suffix(text).map(|rest| rest.to_owned());
        let mut rests = plan.inputs.keys().filter_map(rest);
        !text.is_empty() && rests.any(|rest| rest.is_empty() || rest.ends_with('/'))
    };
    let first = |value: &Vec<Option<Json>>| value.first().cloned().flatten();
    let mut values = axis.values.iter().filter_map(first);
    axis.paths.first().is_some_and(is_source)
        || values.any(|value| value.as_str().is_some_and(is_read))
}

/// Nodes that take a value from another one.
fn fed(plan: &PlanFile) -> HashSet<&str> {
    let links = plan.map["links"].as_array().into_iter().flatten();
    let ends = links.filter_map(|link| link.as_str()?.split_once("->"));
    ends.map(|(_, to)| labels::node_of(to.trim())).collect()
}

fn holds(axis: &Axis, paths: &[String]) -> bool {
    paths.iter().any(|path| axis.paths.contains(path))
}

/// The axes of some parameters, each once.
fn named(axes: &[Axis], paths: &[String]) -> Vec<usize> {
    let mut places = Vec::new();
    for path in paths {
        let place = axes.iter().position(|axis| axis.paths.contains(path));
        places.extend(place.filter(|place| !places.contains(place)));
    }
    places
}

/// Rows first: those that the program names, then models and other texts, then numbers, then what
/// has one value and tells nothing apart. The series last.
fn order(axes: &[Axis], spec: &ReportSpec, series: &[usize]) -> Vec<usize> {
    let mut rows: Vec<usize> = (0..axes.len()).filter(|place| !series.contains(place)).collect();
    let group = named(axes, &spec.group);
    rows.sort_by_key(|place| {
        let axis = &axes[*place];
        let rank = group.iter().position(|named| named == place).unwrap_or(group.len());
        (rank, !axis.varies(), axis.is_scale())
    });
    rows.into_iter().chain(series.iter().copied()).collect()
}
