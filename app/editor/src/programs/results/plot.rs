//! The results as a plot: one measure against another, a line for each value of a parameter.

use std::ops::RangeInclusive;
use std::time::Instant;

use eframe::egui::{self, ComboBox, Pos2, RichText, Ui};
use egui_plot::{
    GridInput, GridMark, Legend, Line, MarkerShape, Plot, PlotPoint, PlotPoints, Points,
};
use mve_core::brief;

use crate::programs::ProgramPanel;
use crate::programs::results::curves::{
    Choice, Curve, Spot, can_be_log, curves, default_series, default_x, default_y, is_wide, room,
};
use crate::programs::results::sheet::{ColumnSource, Sheet, SheetColumn, label};
use crate::programs::widgets::named;
use crate::views::make_room;

/// How near the pointer must be to a point, in points of the screen.
const REACH: f32 = 12.0;
/// Width that a list of columns takes with its name and what follows it, in points.
const ROOM_OF_LIST: f32 = 230.0;
/// Height and width below which nothing is plotted.
const SMALLEST: f32 = 80.0;
/// What is plotted, and its lines.
type Found = (Choice, Vec<Curve>);

/// What a person chose to see; what is not chosen is found from the results.
#[derive(Clone, Default)]
pub struct PlotState {
    x: Option<String>,
    y: Option<String>,
    /// The parameter that gives the lines; an empty name stands for none.
    series: Option<String>,
    is_log_x: Option<bool>,
    is_log_y: Option<bool>,
    /// What was found for the sheet made at this time, as long as nothing else is chosen.
    found: Option<(Instant, Option<Found>)>,
}

impl ProgramPanel {
    /// Shows the plot and the choice of what it shows.
    pub(in crate::programs) fn show_plot(&mut self, ui: &mut Ui) {
        let found = self.plot.found.take().filter(|(made, _)| *made == self.sheet_made);
        let (made, found) = found.unwrap_or_else(|| {
            let choice = self.plot.choice(&self.sheet);
            let found = choice.map(|choice| (choice, curves(&self.sheet, choice)));
            (self.sheet_made, found)
        });
        let is_high = ui.available_height() >= SMALLEST && ui.available_width() >= SMALLEST;
        match &found {
            None => {
                ui.weak("The plot stands here once a step has ended.");
                ui.allocate_space(ui.available_size());
            }
            // Without room there is nothing to see, and no way from numbers to points.
            Some(_) if !is_high => {}
            Some((choice, curves)) => {
                let log = self.plot.log(curves);
                let is_changed = self.plot.show_controls(ui, &self.sheet, *choice, curves, log);
                let selected = self.table.selected.as_deref();
                if let Some(row) = draw(ui, &self.sheet, *choice, curves, log, selected) {
                    self.table.selected = self.sheet.step(row).map(|step| step.id.clone());
                    self.table.is_to_be_seen = true;
                }
                if is_changed {
                    return;
                }
            }
        }
        self.plot.found = Some((made, found));
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

    /// Which axes are logarithmic, x first.
    fn log(&self, curves: &[Curve]) -> [bool; 2] {
        let is_log = |chosen: Option<bool>, of: fn(&Spot) -> f64| {
            can_be_log(curves, of) && chosen.unwrap_or_else(|| is_wide(curves, of))
        };
        [is_log(self.is_log_x, |spot| spot.x), is_log(self.is_log_y, |spot| spot.y)]
    }

    /// Shows what can be chosen; whether a person chose something.
    fn show_controls(
        &mut self,
        ui: &mut Ui,
        sheet: &Sheet,
        choice: Choice,
        curves: &[Curve],
        [log_x, log_y]: [bool; 2],
    ) -> bool {
        let before = [self.x.clone(), self.y.clone(), self.series.clone()];
        ui.horizontal_wrapped(|ui| {
            let numbers = |column: &&SheetColumn| column.is_number;
            let params = |column: &&SheetColumn| matches!(column.source, ColumnSource::Param(_));
            pick(ui, sheet, "Plot", Some(choice.y), &numbers, &mut self.y);
            let can_be = can_be_log(curves, |spot| spot.y);
            log_switch(ui, can_be, log_y, "y", &mut self.is_log_y);
            pick(ui, sheet, "against", Some(choice.x), &numbers, &mut self.x);
            let can_be = can_be_log(curves, |spot| spot.x);
            log_switch(ui, can_be, log_x, "x", &mut self.is_log_x);
            pick(ui, sheet, "a line for each", choice.series, &params, &mut self.series);
        });
        before != [self.x.clone(), self.y.clone(), self.series.clone()]
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
    is_wanted: &dyn Fn(&&SheetColumn) -> bool,
    chosen: &mut Option<String>,
) {
    make_room(ui, ROOM_OF_LIST);
    ui.label(what);
    let current = current.map(|place| &sheet.columns[place]);
    let text = current.map_or_else(|| "one line".to_owned(), SheetColumn::shown);
    let combo = ComboBox::from_id_salt(what).selected_text(text.as_str()).height(320.0);
    let shown = combo.show_ui(ui, |ui| {
        // One line for all is a choice where lines are chosen, and nowhere else.
        if what != "Plot"
            && what != "against"
            && ui.selectable_label(current.is_none(), "one line").clicked()
        {
            *chosen = Some(String::new());
        }
        for column in sheet.columns.iter().filter(is_wanted) {
            let is_current = current.is_some_and(|current| current.name == column.name);
            let option = ui.selectable_label(is_current, column.shown());
            if option.on_hover_text(&column.name).clicked() {
                *chosen = Some(column.name.clone());
            }
        }
    });
    named(shown.response, &format!("{what}: {text}"));
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
    let names = [choice.x, choice.y].map(|place| sheet.columns[place].shown());
    let names = [names[0].as_str(), names[1].as_str()];
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
        ui.label(format!("{} = {}\n{} = {}", names[0], brief(spot.x), names[1], brief(spot.y)));
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
    use super::*;

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
