//! Plots of measures: small multiples, one panel for each model or other thing that is treated, one
//! series for each thing that is compared, on scales that all panels share.

use std::collections::{BTreeMap, HashSet};

use mve_core::{Better, Role};

use crate::case::Case;
use crate::columns::{self, MeasureColumn, is_time};
use crate::results::Results;
use crate::stats::{Estimate, estimate, geometric_mean, pareto_front};

use super::style::{SeriesStyle, series_styles};

/// Panels of one report, and points of one panel.
const MOST_PANELS: usize = 120;
const MOST_POINTS: usize = 600;

/// Values that span at least this factor are plotted on a logarithmic scale.
const DECADE: f64 = 10.0;

/// Larger numbers are no measurements, and would leave the range of a plot's arithmetic; of smaller
/// ones a logarithmic scale has no ticks.
const LARGEST: f64 = 1e100;
const SMALLEST_LOG: f64 = 1e-9;

/// Values that differ by less than this share of themselves give no scale.
const NARROW: f64 = 0.02;

/// A measure plotted against a column: panels with shared scales.
pub struct Figure {
    /// The column of the measure, and the one that it is plotted against.
    pub columns: [String; 2],
    /// Titles of the scales, x first.
    pub titles: [String; 2],
    /// The panels.
    pub panels: Vec<Panel>,
    /// Ranges and kinds of the scales, x first, where all panels share them.
    pub scales: [Option<Scale>; 2],
    /// How each series is drawn.
    pub styles: Vec<SeriesStyle>,
}

/// The points of one panel.
pub struct Panel {
    /// What all of them have in common.
    pub title: String,
    /// The points.
    pub points: Vec<Point>,
    /// Places of the points on the Pareto front, by x; none where no end of a scale is better.
    pub front: Vec<usize>,
    /// Whether a line may lead from one point of a series to the next.
    pub is_line: bool,
}

/// A case in a plot.
pub struct Point {
    /// Its series.
    pub series: usize,
    /// Where it is.
    pub x: Estimate,
    /// See above.
    pub y: Estimate,
    /// What it is.
    pub name: String,
    /// Whether it did not reach its target.
    pub is_missed: bool,
}

/// A scale: its ends, and whether it is logarithmic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// Whether equal ratios are equally far.
    pub is_log: bool,
}

impl Figure {
    /// A name for its file: `compare.rms-by-simplify.faces`.
    pub fn file_name(&self) -> String {
        let name = self.columns.join("-by-");
        let plain = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '-' };
        name.chars().map(plain).collect()
    }
}

/// Plots of all measures, and how many panels were left out.
pub fn figures(results: &Results, measures: &[MeasureColumn]) -> (Vec<Figure>, usize) {
    let against = columns::against(results);
    let drawn = columns::drawn(results, measures);
    let quota = (MOST_PANELS / (drawn.len() * against.len()).max(1)).max(1);
    let mut n_hidden = 0;
    let mut all = Vec::new();
    for measure in drawn {
        let others = against.iter().filter(|column| **column != measure.column);
        // Times against times of their own step say nothing.
        let others = others.filter(|column| !(is_time(column) && is_time(&measure.column)));
        for column in others {
            let mut panels = panels_of(results, measure, column);
            n_hidden += panels.len().saturating_sub(quota);
            panels.truncate(quota);
            if panels.is_empty() {
                continue;
            }
            let x = columns::title(results, measures, column);
            let points = || panels.iter().flat_map(|panel| &panel.points);
            let scales = [
                scale_of_means(points().map(|point| &point.x)),
                scale(points().map(|point| &point.y)).filter(|_| !measure.is_of_model),
            ];
            all.push(Figure {
                columns: [measure.column.clone(), column.clone()],
                titles: [x, measure.title_with_unit()],
                scales,
                styles: series_styles(results),
                panels,
            });
        }
    }
    (all, n_hidden)
}

/// The range of some means, whose intervals are not drawn.
pub(super) fn scale_of_means<'a>(values: impl Iterator<Item = &'a Estimate>) -> Option<Scale> {
    let means: Vec<Estimate> =
        values.map(|value| Estimate { half_width: None, ..*value }).collect();
    scale(means.iter())
}

/// The range of some values with room around it, so that no mark is cut; `None` of no values.
pub(super) fn scale<'a>(values: impl Iterator<Item = &'a Estimate>) -> Option<Scale> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut least = f64::INFINITY;
    for value in values {
        let half = value.half_width.unwrap_or(0.0);
        least = least.min(value.mean);
        high = high.max(value.mean + half);
        // A logarithmic scale has no place for an interval that reaches 0.
        low = low.min(if value.mean - half > 0.0 { value.mean - half } else { value.mean });
    }
    if low > high {
        return None;
    }
    if least > SMALLEST_LOG && high / least >= DECADE {
        let room = (high / low).powf(0.06);
        return Some(Scale { low: low / room, high: high * room, is_log: true });
    }
    let room = 0.06 * (high - low);
    let room = if room > 0.0 { room } else { 0.1 * high.abs().max(1e-300) };
    let floor = if low >= 0.0 { 0.0 } else { f64::NEG_INFINITY };
    Some(Scale { low: (low - room).max(floor), high: high + room, is_log: false })
}

/// The panels of a measure against a column: means over all panels, then one for each combination
/// of what is treated, where the column differs among its points.
///
/// Panels are parted by the axes whose values are no numbers, as models of different sizes have
/// nothing to do in one panel; else by the first that does not set the size, along which they are
/// plotted. What the column does not tell apart within the
/// values of a scale it may tell apart between them: then one panel has all points.
fn panels_of(results: &Results, measure: &MeasureColumn, column: &str) -> Vec<Panel> {
    let own = results.other_axes();
    let texts = (0..own.len()).filter(|place| own[*place].varies() && !own[*place].is_scale());
    let texts: Vec<usize> = texts.collect();
    let other = (0..own.len()).find(|place| !own[*place].is_sizing);
    let parting = if texts.is_empty() { other.into_iter().collect() } else { texts.clone() };
    let mut parts: BTreeMap<Vec<usize>, Vec<&Case>> = BTreeMap::new();
    for case in &results.cases {
        let part = parting.iter().map(|place| case.at[*place]).collect();
        parts.entry(part).or_default().push(case);
    }
    // Only numbers have an order that a line can follow.
    let is_line = |parted: &[usize]| {
        let mut joined = own.iter().enumerate().filter(|(place, _)| !parted.contains(place));
        joined.all(|(_, axis)| axis.is_scale() || !axis.varies())
    };
    let front = Front::of(results, measure, column);
    let panel = |title: String, cases: &[&Case], parted: &[usize]| {
        let points = cases.iter().filter_map(|case| point(results, case, measure, column));
        front.panel(title, points.take(MOST_POINTS).collect(), is_line(parted))
    };
    let n_parts = parts.len();
    let named = parts.iter().map(|(part, cases)| {
        let names = parting.iter().zip(part).map(|(axis, at)| own[*axis].labels[*at].clone());
        panel(names.collect::<Vec<_>>().join(" · "), cases, &parting)
    });
    let mut kept: Vec<Panel> = named.filter(|panel| differs(&panel.points)).collect();
    if kept.is_empty() && texts.is_empty() {
        let all: Vec<&Case> = results.cases.iter().collect();
        kept.extend(Some(panel(String::new(), &all, &[])).filter(|panel| differs(&panel.points)));
    } else if !kept.is_empty() && n_parts > 1 && !texts.is_empty() {
        let points = overview(results, measure, column, &parting);
        if differs(&points) {
            let title = format!("geometric means of {n_parts}");
            kept.insert(0, front.panel(title, points, is_line(&parting)));
        }
    }
    kept
}

fn point(results: &Results, case: &Case, measure: &MeasureColumn, column: &str) -> Option<Point> {
    let (x, y) = (case.estimate(column)?, measure.estimate(results, case)?);
    if x.mean.abs() > LARGEST || y.mean.abs() > LARGEST {
        return None;
    }
    let name = results.axes.iter().zip(&case.at).map(|(axis, at)| axis.labels[*at].clone());
    let name = name.collect::<Vec<_>>().join(" · ");
    let is_missed = case.missed().is_some();
    Some(Point { series: results.series_of(case), x, y, name, is_missed })
}

/// Geometric means over the parts, of what all of them have and all series reached.
fn overview(
    results: &Results,
    measure: &MeasureColumn,
    column: &str,
    parting: &[usize],
) -> Vec<Point> {
    let labels = results.series_labels();
    let mut rest: BTreeMap<Vec<usize>, Vec<Vec<(f64, f64)>>> = BTreeMap::new();
    let mut parts: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    for (row, cases) in results.rows() {
        let both = |case: &Option<&Case>| {
            let case = (*case).filter(|case| case.missed().is_none())?;
            Some((case.estimate(column)?.mean, measure.estimate(results, case)?.mean))
        };
        let part: Vec<usize> = parting.iter().map(|place| row[*place]).collect();
        *parts.entry(part).or_default() += 1;
        let Some(numbers) = cases.iter().map(both).collect::<Option<Vec<_>>>() else { continue };
        let others = (0..row.len()).filter(|place| !parting.contains(place));
        rest.entry(others.map(|place| row[place]).collect()).or_default().push(numbers);
    }
    let mut points = Vec::new();
    for numbers in rest.values().filter(|numbers| numbers.len() == parts.len()) {
        for (series, label) in labels.iter().enumerate() {
            let mean = |value: fn(&(f64, f64)) -> f64| {
                let values: Vec<f64> = numbers.iter().map(|row| value(&row[series])).collect();
                estimate(&[geometric_mean(&values)?.ratio])
            };
            let (Some(x), Some(y)) = (mean(|point| point.0), mean(|point| point.1)) else {
                return Vec::new();
            };
            points.push(Point { series, x, y, name: label.clone(), is_missed: false });
        }
    }
    points
}

/// Whether there is something to see: two points, and not all above one place.
fn differs(points: &[Point]) -> bool {
    let low = points.iter().map(|point| point.x.mean).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|point| point.x.mean).fold(f64::NEG_INFINITY, f64::max);
    points.len() > 1 && high - low > NARROW * high.abs().max(low.abs())
}

/// Whether a panel has a front, and which end of its upright scale is better.
struct Front {
    sign: Option<f64>,
}

impl Front {
    fn of(results: &Results, measure: &MeasureColumn, column: &str) -> Self {
        let is_size = results.plan.columns.role(column) == Role::Size;
        let of_column = columns::of_column(results, column);
        let is_lower = is_size || of_column.iter().all(|known| known.better == Better::Lower);
        let sign = match measure.better {
            Better::Lower => Some(1.0),
            Better::Higher => Some(-1.0),
            Better::Neither => None,
        };
        // Values measured in different ways beat none another.
        let instruments = measure.instruments(results);
        let ways: HashSet<Vec<usize>> = (results.cases.iter())
            .filter(|case| !instruments.is_empty() && measure.estimate(results, case).is_some())
            .map(|case| instruments.iter().map(|axis| case.at[*axis]).collect())
            .collect();
        Self { sign: sign.filter(|_| is_lower && ways.len() < 2) }
    }

    fn panel(&self, title: String, points: Vec<Point>, is_line: bool) -> Panel {
        let front = self.sign.map_or(Vec::new(), |sign| {
            let compared: Vec<usize> =
                (0..points.len()).filter(|place| !points[*place].is_missed).collect();
            let places: Vec<(f64, f64)> = compared
                .iter()
                .map(|place| (points[*place].x.mean, sign * points[*place].y.mean))
                .collect();
            let front = pareto_front(&places);
            // Points of one place give no line.
            let is_line = front.iter().any(|place| places[*place] != places[front[0]]);
            let front = front.into_iter().filter(|_| is_line);
            front.map(|place| compared[place]).collect()
        });
        Panel { title, points, front, is_line }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale_of(values: &[f64]) -> Option<Scale> {
        let all: Vec<Estimate> = values.iter().filter_map(|value| estimate(&[*value])).collect();
        scale(all.iter())
    }

    #[test]
    fn a_decade_is_logarithmic_and_less_is_not() {
        assert!(scale_of(&[1.0, 10.0]).unwrap().is_log);
        assert!(!scale_of(&[1.0, 9.9]).unwrap().is_log && !scale_of(&[0.0, 50.0]).unwrap().is_log);
        assert_eq!(scale_of(&[]), None);
    }

    #[test]
    fn what_is_not_drawn_takes_no_room() {
        let wide = [1.0, 2.0].map(|mean| Estimate { n: 2, mean, half_width: Some(50.0) });
        let range = scale_of_means(wide.iter()).unwrap();
        assert!(range.low > 0.5 && range.high < 2.5 && !range.is_log, "{range:?}");
        assert!(scale(wide.iter()).unwrap().high > 50.0);
    }

    #[test]
    fn scales_leave_room_for_marks() {
        let linear = scale_of(&[2.0, 4.0]).unwrap();
        assert!(linear.low < 2.0 && linear.high > 4.0, "{linear:?}");
        let log = scale_of(&[1.0, 100.0]).unwrap();
        assert!(log.low < 1.0 && log.low > 0.5 && log.high > 100.0, "{log:?}");
        let one = scale_of(&[5.0]).unwrap();
        assert!(one.low < 5.0 && one.high > 5.0, "{one:?}");
    }
}
