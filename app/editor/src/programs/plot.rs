//! The results as a plot: one measure against another, a line for each value of a parameter.

use std::collections::{HashMap, HashSet};
use std::ops::RangeInclusive;

use eframe::egui::{self, Color32, ComboBox, Pos2, RichText, Ui};
use egui_plot::{
    GridInput, GridMark, Legend, Line, MarkerShape, Plot, PlotPoint, PlotPoints, Points,
};
use mve_core::brief;

use super::ProgramPanel;
use super::results::{Column, Sheet, Source, label};
use super::widgets::named;

/// How near the pointer must be to a point, in points of the screen.
const REACH: f32 = 12.0;
/// Height and width below which nothing is plotted.
const SMALLEST: f32 = 80.0;
/// Quotients of the largest and smallest number for which a logarithmic axis shows more. Beyond
/// them the smallest is a rounding error, which would take up most of the axis.
const WORTH_LOG: RangeInclusive<f64> = 20.0..=1e9;

/// Colors of lines that are told apart by eyes of all kinds (Okabe and Ito 2008), without the black
/// and the yellow, which one of the themes would hide.
const COLORS: [Color32; 7] = [
    Color32::from_rgb(86, 156, 214),
    Color32::from_rgb(230, 145, 40),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(204, 100, 150),
    Color32::from_rgb(213, 94, 0),
    Color32::from_rgb(140, 120, 200),
    Color32::from_rgb(130, 140, 150),
];

/// What a person chose to see; what is not chosen is found from the results.
#[derive(Clone, Default)]
pub struct PlotState {
    x: Option<String>,
    y: Option<String>,
    /// The parameter that gives the lines; an empty name stands for none.
    series: Option<String>,
    is_log_x: Option<bool>,
    is_log_y: Option<bool>,
}

/// What is plotted: places of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Choice {
    x: usize,
    y: usize,
    series: Option<usize>,
}

/// A line, its points in the order of their x.
#[derive(Clone, Debug, PartialEq)]
struct Curve {
    /// The value of the parameter that gives the lines.
    name: String,
    /// The same for all lines of one name.
    color: Color32,
    points: Vec<Spot>,
}

/// A step in the plot.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spot {
    x: f64,
    y: f64,
    row: usize,
}

impl ProgramPanel {
    /// Shows the plot and the choice of what it shows.
    pub(super) fn show_plot(&mut self, ui: &mut Ui) {
        let Some(choice) = self.plot.choice(&self.sheet) else {
            ui.weak("The plot stands here once a step has ended.");
            ui.allocate_space(ui.available_size());
            return;
        };
        // Without room there is nothing to see, and no way from numbers to points.
        if ui.available_height() < SMALLEST || ui.available_width() < SMALLEST {
            return;
        }
        let curves = curves(&self.sheet, choice);
        let log = self.plot.show_controls(ui, &self.sheet, choice, &curves);
        let selected = self.table.selected.as_deref();
        if let Some(row) = draw(ui, &self.sheet, choice, &curves, log, selected) {
            self.table.selected = self.sheet.step(row).map(|step| step.id.clone());
            self.table.is_to_be_seen = true;
        }
    }
}

impl PlotState {
    /// What is plotted; `None` while there are no numbers.
    fn choice(&self, sheet: &Sheet) -> Option<Choice> {
        let program = sheet.program.as_ref()?;
        let place =
            |name: &String| sheet.column(name).filter(|place| sheet.columns[*place].is_number);
        let chosen = |name: &Option<String>| name.as_ref().and_then(place);
        let series = match self.series.as_deref() {
            Some("") => None,
            Some(name) => sheet.column(name),
            None => default_series(sheet),
        };
        let x = chosen(&self.x)
            .or_else(|| program.report.against.iter().find_map(place))
            .or_else(|| default_x(sheet, series))?;
        let measures = program.report.measures.iter().map(|measure| &measure.column);
        let y = chosen(&self.y)
            .or_else(|| measures.filter_map(place).find(|place| *place != x))
            .or_else(|| default_y(sheet, x))?;
        Some(Choice { x, y, series: series.filter(|series| *series != x) })
    }

    /// Shows what can be chosen; which axes are logarithmic.
    fn show_controls(
        &mut self,
        ui: &mut Ui,
        sheet: &Sheet,
        choice: Choice,
        curves: &[Curve],
    ) -> [bool; 2] {
        let can_be =
            |of: fn(&Spot) -> f64| curves.iter().flat_map(|c| &c.points).all(|s| of(s) > 0.0);
        let (can_be_x, can_be_y) = (can_be(|spot| spot.x), can_be(|spot| spot.y));
        let mut log = [
            can_be_x && self.is_log_x.unwrap_or_else(|| is_wide(curves, |spot| spot.x)),
            can_be_y && self.is_log_y.unwrap_or_else(|| is_wide(curves, |spot| spot.y)),
        ];
        ui.horizontal_wrapped(|ui| {
            let numbers = |column: &&Column| column.is_number;
            let params = |column: &&Column| matches!(column.source, Source::Param(_));
            pick(ui, sheet, "Plot", Some(choice.y), &numbers, &mut self.y);
            log_switch(ui, can_be_y, log[1], "y", &mut self.is_log_y);
            pick(ui, sheet, "against", Some(choice.x), &numbers, &mut self.x);
            log_switch(ui, can_be_x, log[0], "x", &mut self.is_log_x);
            pick(ui, sheet, "a line for each", choice.series, &params, &mut self.series);
        });
        log[0] = can_be_x && self.is_log_x.unwrap_or(log[0]);
        log[1] = can_be_y && self.is_log_y.unwrap_or(log[1]);
        log
    }
}

fn log_switch(ui: &mut Ui, can_be: bool, is_log: bool, axis: &str, chosen: &mut Option<bool>) {
    let mut changed = is_log;
    let switch = ui.add_enabled(can_be, egui::Checkbox::new(&mut changed, "log"));
    let switch = switch.on_disabled_hover_text("only of numbers above 0");
    if named(switch, &format!("Logarithmic {axis} axis")).changed() {
        *chosen = Some(changed);
    }
}

/// A list of columns to choose from.
fn pick(
    ui: &mut Ui,
    sheet: &Sheet,
    what: &str,
    current: Option<usize>,
    is_wanted: &dyn Fn(&&Column) -> bool,
    chosen: &mut Option<String>,
) {
    ui.label(what);
    let name = |place: usize| sheet.columns[place].name.as_str();
    let current = current.map_or("", name);
    let text = if current.is_empty() { "one line" } else { current };
    let combo = ComboBox::from_id_salt(what).selected_text(text).height(320.0);
    let shown = combo.show_ui(ui, |ui| {
        // One line for all is a choice where lines are chosen, and nowhere else.
        let none = (what != "Plot" && what != "against").then_some("");
        let columns = sheet.columns.iter().filter(is_wanted).map(|column| column.name.as_str());
        for name in none.into_iter().chain(columns) {
            let text = if name.is_empty() { "one line" } else { name };
            if ui.selectable_label(name == current, text).clicked() {
                *chosen = Some(name.to_owned());
            }
        }
    });
    named(shown.response, &format!("{what}: {text}"));
}

/// The parameter that gives the lines: what the program says, else the last one that is no number,
/// else none.
fn default_series(sheet: &Sheet) -> Option<usize> {
    let program = sheet.program.as_ref()?;
    let said = program.report.series.as_ref().and_then(|name| sheet.column(name));
    let is_name = |place: &usize| {
        let column = &sheet.columns[*place];
        matches!(column.source, Source::Param(_))
            && !column.is_number
            && n_values(sheet, *place) > 1
    };
    said.or_else(|| (0..sheet.columns.len()).rev().find(is_name))
}

/// What measures are plotted against: how many faces there are where the numbers say so, else a
/// number that is varied, else the time.
fn default_x(sheet: &Sheet, series: Option<usize>) -> Option<usize> {
    let is_free = |place: &usize| {
        Some(*place) != series && sheet.columns[*place].is_number && n_values(sheet, *place) > 1
    };
    let free: Vec<usize> = (0..sheet.columns.len()).filter(is_free).collect();
    let counts_faces = |place: &&usize| {
        let column = &sheet.columns[**place];
        matches!(&column.source, Source::Output(_, name) if name == "faces" || name == "n_faces")
    };
    let is_varied = |place: &&usize| matches!(sheet.columns[**place].source, Source::Param(_));
    let faces = free.iter().rev().find(counts_faces);
    faces.or_else(|| free.iter().find(is_varied)).copied().or_else(|| sheet.column("seconds"))
}

/// What is plotted: the first chief output of the last node that has one, else the time.
fn default_y(sheet: &Sheet, x: usize) -> Option<usize> {
    let chief = |place: &usize| {
        let column = &sheet.columns[*place];
        let is_output = matches!(column.source, Source::Output(..));
        *place != x && is_output && column.is_number && column.is_chief
    };
    let node = |place: usize| match &sheet.columns[place].source {
        Source::Output(node, _) => Some(node),
        _ => None,
    };
    let chief: Vec<usize> = (0..sheet.columns.len()).filter(chief).collect();
    let last = chief.last().and_then(|place| node(*place));
    let first_of_last = chief.iter().find(|place| node(**place) == last).copied();
    first_of_last
        .or_else(|| sheet.column("seconds").filter(|place| sheet.columns[*place].is_number))
}

fn n_values(sheet: &Sheet, column: usize) -> usize {
    let texts = sheet.rows.iter().map(|row| &row.cells[column].text);
    texts.filter(|text| !text.is_empty()).collect::<HashSet<_>>().len()
}

/// The lines of a plot. What is varied besides splits lines of one name, unless it changes along
/// with the number that moves along the line.
fn curves(sheet: &Sheet, choice: Choice) -> Vec<Curve> {
    let params: Vec<usize> = (0..sheet.columns.len())
        .filter(|place| matches!(sheet.columns[*place].source, Source::Param(_)))
        .collect();
    let along = match sheet.columns[choice.x].source {
        Source::Param(_) => Some(choice.x),
        _ => params
            .iter()
            .copied()
            .filter(|place| sheet.columns[*place].is_number && Some(*place) != choice.series)
            .max_by_key(|place| n_values(sheet, *place)),
    };
    let splits = |place: &usize| along.is_none_or(|along| !follows(sheet, along, *place));
    let splitting: Vec<usize> = params.into_iter().filter(splits).collect();
    let mut names: Vec<&str> = Vec::new();
    let mut found: HashMap<Vec<&str>, usize> = HashMap::new();
    let mut curves: Vec<Curve> = Vec::new();
    for (row, of_row) in sheet.rows.iter().enumerate() {
        let text = |place: usize| of_row.cells[place].text.as_str();
        let (Some(x), Some(y)) = (sheet.number(row, choice.x), sheet.number(row, choice.y)) else {
            continue;
        };
        if !x.is_finite() || !y.is_finite() {
            continue;
        }
        let name = choice.series.map_or("", text);
        let nth = names.iter().position(|known| *known == name).unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        });
        let key: Vec<&str> = splitting.iter().map(|place| text(*place)).chain([name]).collect();
        let place = *found.entry(key).or_insert_with(|| {
            let color = COLORS[nth % COLORS.len()];
            curves.push(Curve { name: name.to_owned(), color, points: Vec::new() });
            curves.len() - 1
        });
        curves[place].points.push(Spot { x, y, row });
    }
    curves.iter_mut().for_each(|curve| curve.points.sort_by(|a, b| a.x.total_cmp(&b.x)));
    curves
}

/// Whether one column is known where another is: they are one, or advance together.
fn follows(sheet: &Sheet, leader: usize, follower: usize) -> bool {
    let mut known = HashMap::new();
    sheet.rows.iter().all(|row| {
        let (from, to) = (&row.cells[leader].text, &row.cells[follower].text);
        known.insert(from, to).is_none_or(|before| before == to)
    })
}

fn is_wide(curves: &[Curve], of: fn(&Spot) -> f64) -> bool {
    let numbers = || curves.iter().flat_map(|curve| &curve.points).map(of);
    let (least, most) = (numbers().fold(f64::MAX, f64::min), numbers().fold(0.0, f64::max));
    least > 0.0 && WORTH_LOG.contains(&(most / least))
}

/// Draws the plot; the row whose point was clicked.
fn draw(
    ui: &mut Ui,
    sheet: &Sheet,
    choice: Choice,
    curves: &[Curve],
    log: [bool; 2],
    selected: Option<&str>,
) -> Option<usize> {
    let at = |spot: &Spot| [on_axis(spot.x, log[0]), on_axis(spot.y, log[1])];
    let names = [choice.x, choice.y].map(|place| sheet.columns[place].name.as_str());
    let spots = || curves.iter().flat_map(|curve| &curve.points);
    let is_selected =
        |spot: &&Spot| sheet.step(spot.row).is_some_and(|step| Some(step.id.as_str()) == selected);
    let strong = ui.visuals().strong_text_color();
    let ring = spots().find(is_selected).map(|spot| {
        let ring = Points::new("", PlotPoints::from(vec![at(spot)])).filled(false);
        ring.shape(MarkerShape::Circle).radius(7.0).color(strong).allow_hover(false)
    });
    let shown = empty_plot(names, log, spots().map(at)).show(ui, |plot| {
        for curve in curves {
            let points: Vec<[f64; 2]> = curve.points.iter().map(at).collect();
            let line = Line::new(&curve.name, PlotPoints::from(points.clone()));
            plot.line(line.color(curve.color).width(1.5));
            let dots = Points::new(&curve.name, PlotPoints::from(points));
            plot.points(dots.color(curve.color).radius(3.5));
        }
        ring.into_iter().for_each(|ring| plot.points(ring));
    });
    let response = named(shown.response, &format!("Plot of {} against {}", names[1], names[0]));
    let pointer: Pos2 = response.hover_pos()?;
    let screen = |spot: &Spot| {
        let [x, y] = at(spot);
        shown.transform.position_from_point(&PlotPoint::new(x, y))
    };
    let near = spots().map(|spot| (screen(spot).distance(pointer), spot));
    let (_, spot) =
        near.filter(|(distance, _)| *distance <= REACH).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let is_clicked = response.clicked();
    response.on_hover_ui_at_pointer(|ui| {
        ui.strong(sheet.step(spot.row).map(label).unwrap_or_default());
        ui.label(format!("{} {}\n{} {}", names[0], brief(spot.x), names[1], brief(spot.y)));
    });
    is_clicked.then_some(spot.row)
}

/// A plot of these points without the points: its axes, grid and legend.
fn empty_plot<'a>(
    names: [&str; 2],
    [log_x, log_y]: [bool; 2],
    points: impl Iterator<Item = [f64; 2]> + Clone,
) -> Plot<'a> {
    let mut plot = Plot::new(("results", names, log_x, log_y))
        .legend(Legend::default())
        .x_axis_label(RichText::new(names[0]).small())
        .y_axis_label(RichText::new(names[1]).small())
        .x_axis_formatter(move |mark, range| axis_text(mark, range, log_x))
        .y_axis_formatter(move |mark, range| axis_text(mark, range, log_y))
        .label_formatter(|_| None)
        .show_crosshair(false)
        .allow_scroll(false);
    if let Some((from, to)) = room(points.clone().map(|[x, _]| x)) {
        plot = plot.include_x(from).include_x(to);
    }
    if let Some((from, to)) = room(points.map(|[_, y]| y)) {
        plot = plot.include_y(from).include_y(to);
    }
    if log_x {
        plot = plot.x_grid_spacer(decades);
    }
    if log_y {
        plot = plot.y_grid_spacer(decades);
    }
    plot
}

/// What an axis must show besides its numbers, where they differ by no more than rounding: a plot
/// of nothing else would magnify that, or have no extent at all.
fn room(numbers: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (from, to) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), number| {
        (from.min(number), to.max(number))
    });
    let size = from.abs().max(to.abs());
    let margin = if size == 0.0 { 1.0 } else { size * 1e-3 };
    (from <= to && to - from < size * 1e-6 + f64::MIN_POSITIVE)
        .then_some((from - margin, to + margin))
}

fn on_axis(number: f64, is_log: bool) -> f64 {
    if is_log { number.log10() } else { number }
}

fn axis_text(mark: GridMark, _: &RangeInclusive<f64>, is_log: bool) -> String {
    if is_log {
        // What comes out of the power has rounding errors that nobody wants to read.
        let number = 10_f64.powf(mark.value);
        return brief(format!("{number:.9e}").parse().unwrap_or(number));
    }
    let number = if mark.value.abs() < mark.step_size * 1e-6 { 0.0 } else { mark.value };
    // As many digits as tell one mark from the next.
    let digits = (-mark.step_size.log10()).ceil().clamp(0.0, 15.0) as usize;
    match (1e-4..1e6).contains(&number.abs()) {
        true => format!("{number:.digits$}"),
        false => brief(number),
    }
}

/// Marks of a logarithmic axis: 1, 2 and 5 of each decade, the others thin. On an axis shorter than
/// a third of a decade the marks are as far from each other as on a linear one.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (from, to) = input.bounds;
    let span = to - from;
    if !(from.is_finite() && to.is_finite()) || span > 600.0 || span <= 0.0 {
        return Vec::new();
    }
    if span < 0.35 {
        let step_size = 10_f64.powf((span / 2.0).log10().floor());
        let marks = (from / step_size).ceil() as i64..=(to / step_size).floor() as i64;
        let mark = |place: i64| GridMark { value: place as f64 * step_size, step_size };
        return marks.map(mark).collect();
    }
    // On a long axis only some decades have room for their number.
    let every = (span / 6.0).ceil().max(1.0) as i32;
    let mut marks = Vec::new();
    for decade in from.floor() as i32..=to.ceil() as i32 {
        for digit in 1..10_i32 {
            let value = f64::from(decade) + f64::from(digit).log10();
            let step_size = match digit {
                1 if decade.rem_euclid(every) == 0 => f64::from(every),
                1 => 0.9,
                2 | 5 => 0.3,
                _ => 0.08,
            };
            if (from..=to).contains(&value) && step_size >= input.base_step_size {
                marks.push(GridMark { value, step_size });
            }
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::super::results::{Cell, Row, State};
    use super::*;

    fn sheet(columns: &[(&str, Source)], rows: &[&[&str]]) -> Sheet {
        let cell = |text: &&str| Cell { text: (*text).to_owned(), number: text.parse().ok() };
        let rows: Vec<Row> = (0..rows.len())
            .map(|place| {
                let cells = rows[place].iter().map(cell).collect();
                Row { place, state: State::Done, cells }
            })
            .collect();
        let column = |(place, (name, source)): (usize, &(&str, Source))| Column {
            name: (*name).to_owned(),
            source: source.clone(),
            is_chief: true,
            is_number: rows.iter().all(|row| row.cells[place].number.is_some()),
            better: None,
            best: None,
        };
        Sheet { program: None, columns: columns.iter().enumerate().map(column).collect(), rows }
    }

    fn param(name: &'static str) -> (&'static str, Source) {
        (name, Source::Param(name.to_owned()))
    }

    fn output(name: &'static str) -> (&'static str, Source) {
        let (node, output) = name.split_once('.').unwrap();
        (name, Source::Output(node.to_owned(), output.to_owned()))
    }

    #[test]
    fn a_line_for_each_value_and_each_other_axis() {
        let columns =
            [param("a.file"), param("b.n"), param("b.way"), output("c.faces"), output("c.rms")];
        let rows: [&[&str]; 6] = [
            &["p", "2", "A", "20", "1"],
            &["p", "1", "A", "10", "2"],
            &["p", "1", "B", "10", "3"],
            &["p", "2", "B", "20", "2"],
            &["q", "1", "A", "11", "5"],
            &["q", "2", "A", "21", "4"],
        ];
        let sheet = sheet(&columns, &rows);
        let choice = Choice { x: 3, y: 4, series: Some(2) };
        let found: Vec<_> = curves(&sheet, choice)
            .iter()
            .map(|curve| {
                (curve.name.clone(), curve.points.iter().map(|s| s.row).collect::<Vec<_>>())
            })
            .collect();
        let expected = [("A", vec![1, 0]), ("B", vec![2, 3]), ("A", vec![4, 5])];
        assert_eq!(found, expected.map(|(name, rows)| (name.to_owned(), rows)));
        assert_eq!(default_x(&sheet, Some(2)), Some(3));
        assert_eq!(default_y(&sheet, 3), Some(4));
    }

    #[test]
    fn parameters_that_advance_together_do_not_split_a_line() {
        let columns = [param("a.n"), param("b.m"), output("c.rms")];
        let rows: [&[&str]; 3] = [&["1", "10", "3"], &["2", "20", "2"], &["3", "30", "1"]];
        let sheet = sheet(&columns, &rows);
        assert_eq!(curves(&sheet, Choice { x: 0, y: 2, series: None }).len(), 1);
    }

    #[test]
    fn numbers_that_differ_by_rounding_get_room() {
        assert_eq!(room([0.0, 0.0].into_iter()), Some((-1.0, 1.0)));
        let (from, to) = room([2.0, 2.0 + 1e-12].into_iter()).unwrap();
        assert!(from < 1.999 && to > 2.001);
        assert_eq!(room([2.0, 2.1].into_iter()), None);
        assert_eq!(room(std::iter::empty()), None);
    }

    #[test]
    fn logarithmic_axes_are_marked_at_1_2_and_5() {
        let input = GridInput { bounds: (2.0, 3.5), base_step_size: 0.1 };
        let texts: Vec<_> =
            decades(input).into_iter().map(|mark| axis_text(mark, &(0.0..=1.0), true)).collect();
        assert_eq!(texts, ["100", "200", "500", "1000", "2000"]);
        let long = decades(GridInput { bounds: (-17.0, 0.0), base_step_size: 0.5 });
        let far = long.iter().filter(|mark| mark.step_size > 2.0).count();
        assert_eq!((long.len(), far), (18, 6));
        let text = |value, step_size| axis_text(GridMark { value, step_size }, &(0.0..=1.0), false);
        assert_eq!(
            [text(1.0002, 1e-4), text(0.3, 0.1), text(4000.0, 1e3)],
            ["1.0002", "0.3", "4000"]
        );
    }
}
