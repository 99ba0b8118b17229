//! Charts of measures against faces or seconds: one chart a row group, one series a compared value,
//! and the Pareto front.
//!
//! Charts are drawn by the crate kuva as SVG. Their colors are variables of the page's style sheet,
//! so that one chart is readable in light and in dark.

use std::panic::{AssertUnwindSafe, catch_unwind};

use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::render_multiple;
use kuva::render::theme::Theme;
use mve_core::{Better, brief};

use crate::columns::MeasureColumn;
use crate::results::{Axis, Case, Results};
use crate::stats::{Estimate, estimate, geometric_mean, pareto_front};

/// Charts of one report, and points of one chart.
const MOST_CHARTS: usize = 120;
const MOST_POINTS: usize = 600;

/// A range that spans more than this factor has a logarithmic axis.
const WIDE: f64 = 100.0;

/// Larger numbers are no measurements, and would leave the range of a chart's arithmetic.
const LARGEST: f64 = 1e100;

/// Values that differ by less than this share of themselves give no axis.
const NARROW: f64 = 0.02;

/// Width and height of a chart in points.
const SIZE: (f64, f64) = (400.0, 285.0);

/// Markers of series, and the same as characters for the legend of the page.
const MARKERS: [(MarkerShape, char); 6] = [
    (MarkerShape::Circle, '●'),
    (MarkerShape::Square, '■'),
    (MarkerShape::Triangle, '▲'),
    (MarkerShape::Diamond, '◆'),
    (MarkerShape::TriangleDown, '▼'),
    (MarkerShape::Star, '★'),
];

/// Colors of the style sheet.
pub const N_COLORS: usize = 8;

/// The character of a series in a legend.
pub fn marker(series: usize) -> char {
    MARKERS[series % MARKERS.len()].1
}

/// Charts of one measure against one column.
pub struct ChartGroup {
    /// The column that the measure is plotted against.
    pub against: String,
    /// Charts as SVG.
    pub charts: Vec<String>,
}

/// Charts of one measure.
pub struct MeasureCharts {
    /// The measure's name for a person.
    pub title: String,
    /// By column.
    pub groups: Vec<ChartGroup>,
}

struct Point {
    series: usize,
    x: Estimate,
    y: Estimate,
    name: String,
}

/// The points of one chart.
struct ChartSet {
    title: String,
    points: Vec<Point>,
    /// Whether a line may lead from one point of a series to the next.
    is_line: bool,
}

/// Charts of all measures, and how many were left out.
pub fn charts(
    results: &Results,
    measures: &[MeasureColumn],
    against: &[String],
) -> (Vec<MeasureCharts>, usize) {
    let measures: Vec<&MeasureColumn> = measures.iter().filter(|m| m.is_there).collect();
    let quota = (MOST_CHARTS / (measures.len() * against.len()).max(1)).max(1);
    let (mut n_drawn, mut n_hidden) = (0, 0);
    let mut all = Vec::new();
    for measure in measures {
        let mut groups = Vec::new();
        for column in against.iter().filter(|column| **column != measure.column) {
            let mut sets = chart_sets(results, measure, column);
            n_hidden += sets.len().saturating_sub(quota);
            sets.truncate(quota);
            let mut charts = Vec::new();
            for set in &sets {
                n_drawn += 1;
                charts.extend(draw(results, set, column, measure).map(|svg| fitted(&svg, n_drawn)));
            }
            if !charts.is_empty() {
                groups.push(ChartGroup { against: column.clone(), charts });
            }
        }
        if !groups.is_empty() {
            all.push(MeasureCharts { title: measure.title.clone(), groups });
        }
    }
    (all, n_hidden)
}

/// A chart that scales with its place on the page, and whose names are its own there.
fn fitted(svg: &str, number: usize) -> String {
    let size = format!("width=\"{}\" height=\"{}\"", SIZE.0, SIZE.1);
    let scaled = format!("viewBox=\"0 0 {} {}\"", SIZE.0, SIZE.1);
    svg.replacen(&size, &scaled, 1).replace("kuva-clip-", &format!("clip-{number}-"))
}

/// The points of each chart: means over all rows, then one chart for each value of the axis that
/// charts are parted by, where the column differs among its points.
///
/// Charts are parted by the first axis whose values are no numbers, as models of different sizes
/// have nothing to do in one chart; else by that of the rows. What the column does not tell apart
/// within the values of a scale it may tell apart between them: then one chart has all points.
fn chart_sets(results: &Results, measure: &MeasureColumn, column: &str) -> Vec<ChartSet> {
    let own = &results.axes[..results.axes.len() - usize::from(results.has_series)];
    let is_parting = |axis: &Axis| axis.values.len() > 1 && !axis.is_scale();
    let parting = own.iter().position(is_parting);
    let place = parting.or((!own.is_empty()).then_some(0));
    let set = |title: &str, part: Option<usize>| {
        let is_meant =
            |case: &&Case| place.zip(part).is_none_or(|(place, part)| case.at[place] == part);
        let cases = results.cases.iter().filter(is_meant);
        let points = cases.filter_map(|case| point(results, case, measure, column)).collect();
        // Only numbers have an order that a line can follow.
        let parted = part.and(place);
        let mut joined = own.iter().enumerate().filter(|(other, _)| Some(*other) != parted);
        let is_line = joined.all(|(_, axis)| axis.is_scale() || axis.values.len() < 2);
        ChartSet { title: title.to_owned(), points, is_line }
    };
    let names = place.map_or(vec![String::new()], |place| own[place].labels.clone());
    let parts = names.iter().enumerate().map(|(part, name)| set(name, Some(part)));
    let mut kept: Vec<ChartSet> = parts.filter(|set| differs(&set.points)).collect();
    if !kept.is_empty() {
        let means = overview(results, measure, column).filter(|_| names.len() > 1);
        kept.splice(..0, means.map(|(title, points)| ChartSet { title, points, is_line: false }));
    } else if parting.is_none() {
        kept.extend(Some(set("", None)).filter(|set| differs(&set.points)));
    }
    kept
}

fn point(results: &Results, case: &Case, measure: &MeasureColumn, column: &str) -> Option<Point> {
    let (x, y) = (case.estimate(column)?, case.estimate(&measure.column)?);
    if x.mean.abs() > LARGEST || y.mean.abs() > LARGEST {
        return None;
    }
    let name = results.axes.iter().zip(&case.at).map(|(axis, at)| axis.labels[*at].clone());
    let name = name.collect::<Vec<_>>().join(" · ");
    Some(Point { series: results.series_of(case), x, y, name })
}

/// Geometric means of each series over the rows in which every series has both numbers.
fn overview(
    results: &Results,
    measure: &MeasureColumn,
    column: &str,
) -> Option<(String, Vec<Point>)> {
    let labels = results.series_labels();
    let mut numbers: Vec<Vec<(f64, f64)>> = Vec::new();
    for cases in results.rows().into_values() {
        let both = |case: &Option<&Case>| {
            let case = (*case)?;
            Some((case.estimate(column)?.mean, case.estimate(&measure.column)?.mean))
        };
        numbers.extend(cases.iter().map(both).collect::<Option<Vec<_>>>());
    }
    let of_series = |series: usize| {
        let x: Vec<f64> = numbers.iter().map(|row| row[series].0).collect();
        let y: Vec<f64> = numbers.iter().map(|row| row[series].1).collect();
        let mean = |values: &[f64]| estimate(&[geometric_mean(values)?.ratio]);
        let (x, y, name) = (mean(&x)?, mean(&y)?, labels[series].clone());
        Some(Point { series, x, y, name })
    };
    let points: Vec<Point> = (0..labels.len()).map(of_series).collect::<Option<_>>()?;
    let title = format!("geometric means of {} rows", numbers.len());
    (numbers.len() > 1 && labels.len() > 1 && differs(&points)).then_some((title, points))
}

/// Whether there is something to see: two points, and not all above one place.
fn differs(points: &[Point]) -> bool {
    let low = points.iter().map(|point| point.x.mean).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|point| point.x.mean).fold(f64::NEG_INFINITY, f64::max);
    points.len() > 1 && high - low > NARROW * high.abs().max(low.abs())
}

fn draw(
    results: &Results,
    set: &ChartSet,
    column: &str,
    measure: &MeasureColumn,
) -> Option<String> {
    let points = &set.points[..set.points.len().min(MOST_POINTS)];
    let names = results.series_labels();
    let axis = |value: fn(&Point) -> f64| {
        let all = || points.iter().map(value);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        low > 0.0 && high / low > WIDE
    };
    let (log_x, log_y) = (axis(|point| point.x.mean), axis(|point| point.y.mean));
    let mut plots: Vec<Plot> = Vec::new();
    plots.extend(front(points, measure.better));
    for series in 0..names.len() {
        let mut own: Vec<&Point> = points.iter().filter(|point| point.series == series).collect();
        own.sort_by(|a, b| a.x.mean.total_cmp(&b.x.mean));
        if !own.is_empty() {
            plots.extend(series_plots(series, &own, Look { is_line: set.is_line, is_log: log_y }));
        }
    }
    let format = TickFormat::Custom(std::sync::Arc::new(|value| crate::labels::rounded(value, 4)));
    // The drawing is plain code over finite numbers; should it fail, the other charts stand.
    let drawn = catch_unwind(AssertUnwindSafe(|| {
        let mut layout = Layout::auto_from_plots(&plots)
            .with_title(&set.title)
            .with_x_label(axis_title(column))
            .with_y_label(&measure.title)
            .with_theme(theme())
            .with_width(SIZE.0)
            .with_height(SIZE.1)
            .with_title_size(13)
            .with_label_size(12)
            .with_tick_size(11)
            .with_ticks(5)
            .with_tick_format(format);
        if log_x {
            layout = layout.with_log_x();
        }
        if log_y {
            layout = layout.with_log_y();
        }
        SvgBackend::new().render_scene(&render_multiple(plots, layout))
    }));
    drawn.ok()
}

fn axis_title(column: &str) -> String {
    match column.strip_prefix("seconds") {
        Some("") => "time of a step, s".to_owned(),
        Some(node) => format!("time of {}, s", node.trim_start_matches('.')),
        None => column.to_owned(),
    }
}

/// The line that joins the points of the front, behind the series.
fn front(points: &[Point], better: Better) -> Option<Plot> {
    let sign = if better == Better::Lower { 1.0 } else { -1.0 };
    let places: Vec<(f64, f64)> =
        points.iter().map(|point| (point.x.mean, sign * point.y.mean)).collect();
    let front = pareto_front(&places);
    let line: Vec<(f64, f64)> = front.iter().map(|i| (places[*i].0, sign * places[*i].1)).collect();
    let plot = LinePlot::new().with_data(line).with_color("var(--front)").with_stroke_width(6.0);
    (front.len() > 1).then(|| plot.into())
}

/// How a series is drawn.
#[derive(Clone, Copy)]
struct Look {
    /// Whether a line joins its points.
    is_line: bool,
    /// Whether the upright axis is logarithmic.
    is_log: bool,
}

/// The line and the markers of a series, with error bars where there are repeats.
fn series_plots(series: usize, points: &[&Point], look: Look) -> Vec<Plot> {
    let color = format!("var(--s{})", series % N_COLORS);
    let data: Vec<(f64, f64)> = points.iter().map(|point| (point.x.mean, point.y.mean)).collect();
    let tip = |point: &&Point| {
        format!("{}: {}, {}", point.name, brief(point.x.mean), brief(point.y.mean))
    };
    let mut plots: Vec<Plot> = Vec::new();
    if look.is_line && data.len() > 1 {
        let line = LinePlot::new().with_data(data.clone()).with_color(&color);
        plots.push(line.with_stroke_width(1.2).into());
    }
    let mut dots = ScatterPlot::new()
        .with_data(data)
        .with_color(&color)
        .with_size(4.5)
        .with_marker(MARKERS[series % MARKERS.len()].0)
        .with_tooltip_labels(points.iter().map(tip));
    if points.iter().any(|point| point.y.half_width.is_some_and(|half| half > 0.0)) {
        // A logarithmic axis has no place for an interval that reaches 0.
        let below = |point: &&Point, half: f64| {
            if look.is_log { half.min(0.99 * point.y.mean) } else { half }
        };
        dots = dots.with_y_err_asymmetric(points.iter().map(|point| {
            let half = point.y.half_width.unwrap_or(0.0);
            (below(point, half), half)
        }));
    }
    plots.push(dots.into());
    plots
}

fn theme() -> Theme {
    let name = |name: &str| format!("var(--{name})");
    Theme {
        background: "none".to_owned(),
        axis_color: name("ink-2"),
        grid_color: name("line"),
        tick_color: name("ink-2"),
        text_color: name("ink"),
        legend_bg: "none".to_owned(),
        legend_border: "none".to_owned(),
        font_family: Some("inherit".to_owned()),
        show_grid: true,
        ..Theme::light()
    }
}
