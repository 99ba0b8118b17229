//! Drawing of plots with the crate kuva: for the page, in its colors of light and dark, and on
//! paper, standing alone.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

#[cfg(feature = "pdf")]
use kuva::backend::pdf::PdfBackend;
use kuva::backend::svg::SvgBackend;
use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::figure::Figure as Grid;
use kuva::render::layout::{AxisLabelOverlap, ComputedLayout, Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_multiple};
use kuva::render::render_utils::{generate_ticks, generate_ticks_log};
use kuva::render::theme::Theme;
use mve_core::brief;

use super::figure::{Figure, Panel, Point, Scale, scale, scale_of_means};
use super::style::{N_COLORS, SeriesStyle};
use crate::labels;

/// Width and height of a panel in points.
const SIZE: (f64, f64) = (400.0, 285.0);

/// Characters of a title that fit into the width, and into the height, of a panel.
const TITLE: usize = 46;
const SIDE_TITLE: usize = 34;

/// Marks of a scale, the size of their labels in points, and the width of one character of these,
/// digits being the widest, as a share of the size.
const TICKS: usize = 5;
const TICK_SIZE: u32 = 11;
const TICK_WIDTH: f64 = 0.64;

/// Panels beside each other on paper.
const ABREAST: usize = 3;

/// What a plot stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Canvas {
    /// The page, whose style sheet has the colors.
    Page,
    /// White paper.
    Paper,
}

impl Canvas {
    fn color(self, series: usize) -> String {
        const PAPER: [&str; N_COLORS] = [
            "#2563a8", "#c2571a", "#1f8a5b", "#a63a7d", "#8a6d00", "#3aa0c4", "#7a52c7", "#6b7280",
        ];
        match self {
            Self::Page => format!("var(--s{})", series % N_COLORS),
            Self::Paper => PAPER[series % N_COLORS].to_owned(),
        }
    }

    fn ink(self, page: &str, paper: &str) -> String {
        match self {
            Self::Page => format!("var(--{page})"),
            Self::Paper => paper.to_owned(),
        }
    }

    fn front(self) -> String {
        self.ink("front", "#d5dae0")
    }

    fn theme(self) -> Theme {
        let font = match self {
            Self::Page => "inherit",
            Self::Paper => "DejaVu Sans, Arial, Helvetica, sans-serif",
        };
        Theme {
            background: if self == Self::Page { "none" } else { "#ffffff" }.to_owned(),
            axis_color: self.ink("ink-2", "#444444"),
            grid_color: self.ink("line", "#e2e2e2"),
            tick_color: self.ink("ink-2", "#444444"),
            text_color: self.ink("ink", "#000000"),
            legend_bg: "none".to_owned(),
            legend_border: "none".to_owned(),
            font_family: Some(font.to_owned()),
            show_grid: true,
            ..Theme::light()
        }
    }
}

/// The panels of a figure as SVG, each for its place on the page. `number` counts them, so that
/// their names are their own there.
pub fn panels(figure: &Figure, number: &mut usize) -> Vec<String> {
    let one = |panel: &Panel| {
        *number += 1;
        // The drawing is plain code over finite numbers; should it fail, the others stand.
        let drawn = catch_unwind(AssertUnwindSafe(|| {
            let (plots, layout) = panel_parts(figure, panel, Canvas::Page);
            SvgBackend::new().render_scene(&render_multiple(plots, layout))
        }));
        drawn.ok().map(|svg| fitted(&svg, *number))
    };
    figure.panels.iter().filter_map(one).collect()
}

/// A panel that scales with its place on the page, and whose names are its own there.
fn fitted(svg: &str, number: usize) -> String {
    let size = format!("width=\"{}\" height=\"{}\"", SIZE.0, SIZE.1);
    let scaled = format!("viewBox=\"0 0 {} {}\"", SIZE.0, SIZE.1);
    svg.replacen(&size, &scaled, 1).replace("kuva-clip-", &format!("clip-{number}-"))
}

/// Why there is no PDF in most builds: the crates behind it take as long to build as all of mve.
#[cfg(not(feature = "pdf"))]
const NO_PDF: &str = "this build of mve writes no PDF; write SVG (--format svg), or install mve with \
                      `cargo install --path app/cli --features pdf`";

/// A whole figure for a paper, as SVG or as PDF.
///
/// # Errors
/// If the crate that draws fails, with what it says.
pub fn draw(figure: &Figure, is_pdf: bool) -> Result<Vec<u8>, String> {
    let drawn = catch_unwind(AssertUnwindSafe(|| {
        let scene = grid(figure);
        match is_pdf {
            #[cfg(feature = "pdf")]
            true => PdfBackend::new().render_scene(&scene),
            #[cfg(not(feature = "pdf"))]
            true => Err(NO_PDF.to_owned()),
            false => Ok(SvgBackend::new().render_scene(&scene).into_bytes()),
        }
    }));
    drawn.unwrap_or_else(|_| Err("the plot could not be drawn".to_owned()))
}

fn grid(figure: &Figure) -> Scene {
    let parts = figure.panels.iter().map(|panel| panel_parts(figure, panel, Canvas::Paper));
    let (plots, layouts): (Vec<_>, Vec<_>) = parts.unzip();
    let columns = plots.len().clamp(1, ABREAST);
    let layouts = aligned(layouts);
    let grid = Grid::new(plots.len().div_ceil(columns).max(1), columns)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(SIZE.0, SIZE.1);
    let entry = |style: &SeriesStyle| LegendEntry {
        label: labels::shortened(&style.label),
        color: Canvas::Paper.color(style.color),
        shape: LegendShape::Marker(style.marker()),
        dasharray: None,
    };
    let styles = figure.styles.iter().filter(|_| figure.styles.len() > 1);
    let mut entries: Vec<LegendEntry> = styles.map(entry).collect();
    if figure.panels.iter().any(|panel| panel.front.len() > 1) {
        let color = Canvas::Paper.front();
        let label = "Pareto front".to_owned();
        entries.push(LegendEntry { label, color, shape: LegendShape::Rect, dasharray: None });
    }
    if entries.is_empty() {
        return grid.render();
    }
    grid.with_shared_legend().with_shared_legend_entries(entries).render()
}

/// Panels whose scales begin and end below each other, however wide the labels of their ticks are.
fn aligned(layouts: Vec<Layout>) -> Vec<Layout> {
    let computed: Vec<_> = layouts.iter().map(ComputedLayout::from_layout).collect();
    let left = computed.iter().map(|own| own.margin_left).fold(0.0, f64::max);
    let right = computed.iter().map(|own| own.margin_right).fold(0.0, f64::max);
    layouts.into_iter().map(|layout| layout.with_force_margins(left, right)).collect()
}

fn panel_parts(figure: &Figure, panel: &Panel, canvas: Canvas) -> (Vec<Plot>, Layout) {
    let points = || panel.points.iter();
    let scales = [
        figure.scales[0].or_else(|| scale_of_means(points().map(|point| &point.x))),
        figure.scales[1].or_else(|| scale(points().map(|point| &point.y))),
    ];
    let mut plots: Vec<Plot> = Vec::new();
    plots.extend(front(panel, canvas));
    for (series, style) in figure.styles.iter().enumerate() {
        let own = panel.points.iter().filter(|point| point.series == series);
        let mut own: Vec<&Point> = own.collect();
        own.sort_by(|a, b| a.x.mean.total_cmp(&b.x.mean));
        let is_log = scales[1].is_some_and(|scale| scale.is_log);
        plots.extend(series_plots(style, &own, Look { is_line: panel.is_line, is_log, canvas }));
    }
    let mut layout = Layout::auto_from_plots(&plots)
        .with_title(labels::shortened_to(&panel.title, TITLE))
        .with_x_label(labels::shortened_to(&figure.titles[0], TITLE))
        .with_y_label(labels::shortened_to(&figure.titles[1], SIDE_TITLE))
        .with_theme(canvas.theme())
        .with_width(SIZE.0)
        .with_height(SIZE.1)
        .with_title_size(13)
        .with_label_size(12)
        .with_tick_size(TICK_SIZE)
        .with_ticks(TICKS)
        .with_x_label_overlap(AxisLabelOverlap::Thin);
    if let Some(Scale { low, high, is_log }) = scales[0] {
        layout = layout.with_x_axis_min(low).with_x_axis_max(high);
        layout = layout.with_x_tick_format(tick_format(&scales[0]));
        layout = if is_log { layout.with_log_x() } else { layout };
    }
    if let Some(Scale { low, high, is_log }) = scales[1] {
        layout = layout.with_y_axis_min(low).with_y_axis_max(high);
        layout = layout.with_y_tick_format(tick_format(&scales[1]));
        layout = if is_log { layout.with_log_y() } else { layout };
    }
    (plots, beside_ticks(layout, &scales[1]))
}

/// About where a scale is marked.
fn ticks(scale: &Option<Scale>) -> Vec<f64> {
    match *scale {
        Some(Scale { low, high, is_log: true }) => generate_ticks_log(low, high),
        Some(Scale { low, high, is_log: false }) => generate_ticks(low, high, TICKS),
        None => Vec::new(),
    }
}

/// All marks of a scale in one form: with exponents where one of them needs one.
fn tick_format(scale: &Option<Scale>) -> TickFormat {
    let has_exponent = ticks(scale).iter().any(|tick| labels::rounded(*tick, 4).contains('e'));
    TickFormat::Custom(Arc::new(move |value| match has_exponent {
        true => labels::with_exponent(value, 4),
        false => labels::rounded(value, 4),
    }))
}

/// Moves the title of the upright scale beside the labels of its marks. The crate takes their width
/// from the data and a form of its own, where scale and form are ours.
fn beside_ticks(layout: Layout, scale: &Option<Scale>) -> Layout {
    let format = tick_format(scale);
    let longest = ticks(scale).iter().map(|tick| format.format(*tick).chars().count()).max();
    let width = longest.unwrap_or(0) as f64 * f64::from(TICK_SIZE) * TICK_WIDTH;
    let computed = ComputedLayout::from_layout(&layout);
    let more = (width - computed.y_tick_label_px).max(0.0);
    let (left, right) = (computed.margin_left + more, computed.margin_right);
    layout.with_force_margins(left, right).with_y_label_offset(-more, 0.0)
}

/// The line that joins the points of the front, behind the series.
fn front(panel: &Panel, canvas: Canvas) -> Option<Plot> {
    let place = |place: &usize| {
        let point = &panel.points[*place];
        (point.x.mean, point.y.mean)
    };
    let line: Vec<(f64, f64)> = panel.front.iter().map(place).collect();
    let is_line = line.len() > 1;
    let plot = LinePlot::new().with_data(line).with_color(canvas.front());
    is_line.then(|| plot.with_stroke_width(6.0).into())
}

/// How a series is drawn.
#[derive(Clone, Copy)]
struct Look {
    /// Whether a line joins its points.
    is_line: bool,
    /// Whether the upright scale is logarithmic.
    is_log: bool,
    canvas: Canvas,
}

/// The line and the marks of a series, with a ring where a target was missed and error bars where
/// there are repeats.
fn series_plots(style: &SeriesStyle, points: &[&Point], look: Look) -> Vec<Plot> {
    let color = look.canvas.color(style.color);
    let (missed, reached): (Vec<&Point>, Vec<&Point>) =
        points.iter().copied().partition(|point| point.is_missed);
    let mut plots: Vec<Plot> = Vec::new();
    if look.is_line && reached.len() > 1 {
        let data = reached.iter().map(|point| (point.x.mean, point.y.mean));
        let line = LinePlot::new().with_data(data.collect::<Vec<_>>()).with_color(&color);
        plots.push(line.with_stroke_width(1.2).with_line_style(style.line()).into());
    }
    if !missed.is_empty() {
        let rings = missed.iter().map(|point| (point.x.mean, point.y.mean));
        let rings = ScatterPlot::new().with_data(rings.collect::<Vec<_>>()).with_color(&color);
        plots.push(
            rings.with_size(8.0).with_marker_opacity(0.0).with_marker_stroke_width(1.2).into(),
        );
    }
    if !points.is_empty() {
        plots.push(marks(style, points, look).into());
    }
    plots
}

fn marks(style: &SeriesStyle, points: &[&Point], look: Look) -> ScatterPlot {
    let tip = |point: &&Point| {
        let mark = if point.is_missed { ", target not reached" } else { "" };
        format!("{}: {}, {}{mark}", point.name, brief(point.x.mean), brief(point.y.mean))
    };
    let data: Vec<(f64, f64)> = points.iter().map(|point| (point.x.mean, point.y.mean)).collect();
    let mut marks = ScatterPlot::new()
        .with_data(data)
        .with_color(look.canvas.color(style.color))
        .with_size(4.5)
        .with_marker(style.marker())
        .with_tooltip_labels(points.iter().map(tip));
    if points.iter().any(|point| point.y.half_width.is_some_and(|half| half > 0.0)) {
        // A logarithmic scale has no place for an interval that reaches 0.
        let below = |point: &&Point, half: f64| {
            if look.is_log { half.min(0.99 * point.y.mean) } else { half }
        };
        marks = marks.with_y_err_asymmetric(points.iter().map(|point| {
            let half = point.y.half_width.unwrap_or(0.0);
            (below(point, half), half)
        }));
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_a_scale_have_one_form() {
        let shown = |low: f64, high: f64| {
            let scale = Some(Scale { low, high, is_log: true });
            let format = tick_format(&scale);
            ticks(&scale).iter().map(|tick| format.format(*tick)).collect::<Vec<_>>()
        };
        let mixed = shown(1e-5, 1e-1);
        assert!(mixed.len() > 3 && mixed.iter().all(|text| text.contains('e')), "{mixed:?}");
        let plain = shown(0.01, 100.0);
        assert!(plain.iter().all(|text| !text.contains('e')), "{plain:?}");
    }

    #[test]
    fn the_title_of_a_scale_is_beside_the_labels_of_its_marks() {
        // One value in a scale that other panels share: the marks are longer than the value says.
        let point = Point {
            series: 0,
            x: crate::stats::estimate(&[1.0]).unwrap(),
            y: crate::stats::estimate(&[0.002]).unwrap(),
            name: String::new(),
            is_missed: false,
        };
        let panel =
            Panel { title: String::new(), points: vec![point], front: Vec::new(), is_line: false };
        let figure = Figure {
            columns: [String::new(), String::new()],
            titles: ["x".to_owned(), "y".to_owned()],
            panels: Vec::new(),
            scales: [None, Some(Scale { low: 0.0019, high: 0.0042, is_log: false })],
            styles: Vec::new(),
        };
        let (_, layout) = panel_parts(&figure, &panel, Canvas::Paper);
        let computed = ComputedLayout::from_layout(&layout);
        // From the axis outwards: 8 points, "0.0025" of the widest digits of DejaVu Sans (0.636 of
        // the size), a gap of 5, half of the title's 12.
        let outer = 8.0 + 6.0 * 0.636 * 11.0 + 5.0 + 6.0;
        let title = 8.0 + computed.y_tick_label_px + 5.0 + 6.0 - layout.y_label_offset.0;
        assert!(title >= outer, "{title} {outer}");
        assert!(computed.margin_left >= title + 6.0, "{} {title}", computed.margin_left);
    }

    #[test]
    fn panels_below_each_other_begin_at_one_place() {
        let panel =
            |high: f64| Layout::new((0.0, 1.0), (0.0, high)).with_width(SIZE.0).with_height(SIZE.1);
        let left = |layout: &Layout| ComputedLayout::from_layout(layout).margin_left;
        let (narrow, wide) = (left(&panel(9.0)), left(&panel(123_456.0)));
        assert!(narrow < wide, "labels of ticks are what makes them differ");
        let all = aligned(vec![panel(9.0), panel(123_456.0)]);
        assert_eq!([left(&all[0]), left(&all[1])], [wide; 2]);
    }
}
