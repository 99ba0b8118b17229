//! The field that edits one value, whatever its kind: the one place in the window that tells the
//! kinds of parameters apart.

use std::cell::RefCell;
use std::path::Path;

use eframe::egui::emath::Numeric;
use eframe::egui::{self, DragValue, Id, Slider, SliderClamping, Ui};
use mve_core::{
    CommandLineSpec, Expression, Kind, ParamSpec, PointsSpec, Selection, brief_value, chosen,
};
use serde_json::Value as Json;

use super::paths::path_line;
use super::points::edit_points;
use super::widgets::{line, name_it, pick};
use super::{FormEvent, OFF, is_off};

/// Room for the buttons behind a field, in points.
const BACK_WIDTH: f32 = 28.0;
const BROWSE_WIDTH: f32 = 32.0;
/// Width of a field in a table, in points.
pub const CELL_WIDTH: f32 = 128.0;

/// Where a field stands.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum FieldPlace {
    /// In a row of a form, with all the room that is left.
    Row,
    /// In a cell of a table, on one line.
    Cell,
}

/// What edits the value of one parameter.
pub struct ParamField<'a> {
    /// Its declaration.
    pub spec: &'a ParamSpec,
    /// The parameter as a person reads it.
    pub name: String,
    /// Dotted path of the parameter within its node.
    pub path: &'a str,
    /// What the map says of it.
    pub given: Option<&'a Json>,
    /// Where it stands.
    pub place: FieldPlace,
    /// A value for one that was off, if one suggests itself.
    pub suggested: Option<Json>,
    /// The folder that paths are relative to; `None` offers no names in it.
    pub folder: Option<&'a Path>,
    /// What a person does in it.
    pub events: &'a mut Vec<FormEvent>,
}

impl ParamField<'_> {
    fn set(&mut self, value: Option<Json>) {
        self.events.push(FormEvent::Set { path: self.path.to_owned(), value });
    }

    /// The value of one that was off.
    fn when_on(&self) -> Json {
        let suggested = self.suggested.clone().or_else(|| self.spec.value_when_on());
        suggested.unwrap_or_default()
    }

    /// Switches the parameter off and on.
    pub(super) fn switch(&mut self, ui: &mut Ui) {
        let mut is_on = !is_off(self.spec, self.given);
        let switch = ui.checkbox(&mut is_on, "");
        let name = format!("whether {} is on", self.name);
        ui.ctx().accesskit_node_builder(switch.id, |node| node.set_label(name.as_str()));
        if switch.on_hover_text(&name).changed() {
            self.set(Some(if is_on { self.when_on() } else { Json::Null }));
        }
    }

    /// Shows the field; `id` tells it from others.
    pub fn show(&mut self, ui: &mut Ui, id: Id) {
        let default = self.spec.default_json().unwrap_or_default();
        let value = self.given.unwrap_or(&default);
        let some = || self.when_on();
        match self.spec.kind {
            Kind::Flag(_) => self.flag(ui, value),
            Kind::Integer(spec) => {
                let number = whole(value).or(spec.default).or_else(|| whole(&some()));
                self.number(ui, number.unwrap_or(spec.hard.0), spec.hard, spec.soft);
            }
            Kind::Number(spec) => {
                let number = value.as_f64().or(spec.default).or_else(|| some().as_f64());
                self.number(ui, number.unwrap_or(spec.hard.0), spec.hard, spec.soft);
            }
            Kind::Seed(spec) => {
                let seed = whole(value).unwrap_or(i64::from(spec.default));
                self.number(ui, seed, (0, i64::from(u32::MAX)), None);
            }
            Kind::Text(_) => self.text(ui, id, value, ""),
            Kind::InputFile(spec) => self.path(ui, id, value, spec.extensions),
            Kind::OutputFile(_) => self.text(ui, id, value, "name, or {node.parameter}"),
            Kind::Enumeration(_) | Kind::Choice(_) => self.combo(ui, id, value),
            Kind::Points(spec) => self.points(ui, id, value, &spec),
            Kind::Selection(spec) => self.selection(ui, id, value, spec.domain.name()),
            Kind::Expression(spec) => self.expression(ui, id, value, spec.variables),
            Kind::CommandLine(spec) => self.command_line(ui, id, value, &spec),
        }
    }

    fn flag(&mut self, ui: &mut Ui, value: &Json) {
        let mut flag = value.as_bool().unwrap_or_default();
        let text = match self.place {
            FieldPlace::Row => "",
            FieldPlace::Cell if flag => "yes",
            FieldPlace::Cell => "no",
        };
        let response = ui.checkbox(&mut flag, text).on_hover_text(&self.name);
        match self.place {
            FieldPlace::Cell => name_it(&response, &self.name, 0),
            FieldPlace::Row => {
                let name = self.name.as_str();
                ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
            }
        }
        if response.changed() {
            self.set(Some(Json::from(flag)));
        }
    }

    /// A number to drag or to type, with a slider where its declaration says what is usual. What is
    /// off says so in the field: a number in its place switches it on, and `off` switches it off.
    fn number<N: Numeric + Into<Json>>(
        &mut self,
        ui: &mut Ui,
        number: N,
        hard: (N, N),
        soft: Option<(N, N)>,
    ) {
        let mut changed = number;
        let usual = soft.map(|(from, to)| (from.to_f64(), to.to_f64()));
        let speed = speed_of(usual, number.to_f64()).max(if N::INTEGRAL { 0.05 } else { 0.0 });
        let is_off = is_off(self.spec, self.given);
        let shown = if is_off { OFF.to_owned() } else { exact_text(number.to_f64()) };
        let typed = RefCell::new(None);
        let read = |text: &str| {
            typed.replace(Some(text.trim().to_owned()));
            read_number(text)
        };
        let field = DragValue::new(&mut changed).range(hard.0..=hard.1).speed(speed);
        // What a map says out of range stays until a person changes it; the check tells.
        let field = field.clamp_existing_to_range(false);
        let field = field.update_while_editing(false).custom_parser(read);
        let field = field.custom_formatter(|number, _| match is_off {
            true => OFF.to_owned(),
            false => exact_text(number),
        });
        let response = ui.add(field.suffix(if is_off { String::new() } else { suffix(self.spec) }));
        let range = range_text(hard.0.to_f64(), hard.1.to_f64(), self.spec);
        let response = response.on_hover_text(range);
        name_it(&response, &self.name, shown.chars().count());
        if let (Some((from, to)), false, FieldPlace::Row) = (soft, is_off, self.place) {
            ui.spacing_mut().slider_width = (ui.available_width() - BACK_WIDTH).clamp(30.0, 120.0);
            let slider = Slider::new(&mut changed, from..=to).show_value(false);
            let slider = slider.logarithmic(spans_decades(from.to_f64(), to.to_f64()));
            ui.add(slider.clamping(SliderClamping::Never));
        }
        let typed = typed.take().filter(|text| !text.is_empty() && *text != shown);
        if let Some(text) = &typed
            && self.spec.can_be_off
            && text.eq_ignore_ascii_case(OFF)
        {
            return self.set(Some(Json::Null));
        }
        if let Some(text) = typed.as_ref().filter(|text| read_number(text).is_none()) {
            let name = &self.name;
            let text = format!("{name}: \u{201c}{text}\u{201d} is no number; it stays {shown}");
            return self.events.push(FormEvent::NotUnderstood(text));
        }
        let wanted = typed.as_deref().and_then(read_number);
        if wanted.is_some_and(|wanted| wanted < hard.0.to_f64() || wanted > hard.1.to_f64()) {
            let [from, to] = [hard.0, hard.1].map(|end| exact_text(end.to_f64()));
            let (name, text) = (&self.name, typed.unwrap_or_default());
            let text = format!("{name}: {text} is not within {from} and {to}; it stays {shown}");
            return self.events.push(FormEvent::NotUnderstood(text));
        }
        let is_allowed = changed.to_f64().is_finite() && changed >= hard.0 && changed <= hard.1;
        if is_allowed && (changed != number || (is_off && typed.is_some())) {
            self.set(Some(changed.into()));
        }
    }

    /// One of the names that the value may be.
    fn combo(&mut self, ui: &mut Ui, id: Id, value: &Json) {
        let current = chosen(value).map_or("", |(id, _)| id);
        let (width, text) = match self.place {
            FieldPlace::Row => (ui.available_width().clamp(60.0, 150.0), current.to_owned()),
            FieldPlace::Cell => (CELL_WIDTH, brief_value(value)),
        };
        let picked = pick(ui, id, &self.name, (current, &text, width), &self.spec.options());
        // In a form, the entry that is there already says again what the map may leave out.
        if let Some(picked) = picked.filter(|id| self.place == FieldPlace::Row || *id != current) {
            self.set(Some(Json::from(picked)));
        }
    }

    /// A line of text.
    fn text(&mut self, ui: &mut Ui, id: Id, value: &Json, hint: &str) {
        let written = value.as_str().unwrap_or_default();
        if let (Some(text), _) = self.line(ui, id, written, hint) {
            self.set(Some(Json::from(text)));
        }
    }

    /// The path of a file, with the names that it may go on with.
    fn path(&mut self, ui: &mut Ui, id: Id, value: &Json, extensions: &'static [&'static str]) {
        const HINT: &str = "path of a file";
        let Some(folder) = self.folder else { return self.text(ui, id, value, HINT) };
        let named = (self.name.as_str(), value.as_str().unwrap_or_default());
        let form = (HINT, self.width(ui));
        if let Some(text) = path_line(ui, id, named, form, (folder, extensions)) {
            self.set(Some(Json::from(text)));
        }
    }

    /// Indices and ranges, and how many there are.
    fn selection(&mut self, ui: &mut Ui, id: Id, value: &Json, domain: &str) {
        let (written, n) = match Selection::from_json(value) {
            Ok(selection) => (selection.to_string(), selection.len().to_string()),
            Err(_) => (value.to_string(), "?".to_owned()),
        };
        ui.label(egui::RichText::new(&n).weak()).on_hover_text(format!("{n} {domain}"));
        match self.line(ui, id, &written, "3, 10-20").0.map(|text| Selection::from_text(&text)) {
            Some(Ok(selection)) => self.set(Some(selection.to_json())),
            Some(Err(why)) => {
                let text = format!("{}: {why}; it stays {written}", self.name);
                self.events.push(FormEvent::NotUnderstood(text));
            }
            None => {}
        }
    }

    /// A row for each point; in a table, and where they cannot be read, their JSON on a line.
    fn points(&mut self, ui: &mut Ui, id: Id, value: &Json, spec: &PointsSpec) {
        if let (Ok(points), FieldPlace::Row) = (spec.read(value), self.place) {
            if let Some(changed) = edit_points(ui, id, &self.name, spec, &points) {
                self.set(Some(spec.to_json(&changed)));
            }
        } else if let (Some(text), _) = self.line(ui, id, &value.to_string(), "[]") {
            self.set(Some(serde_json::from_str(&text).unwrap_or(Json::String(text))));
        }
    }

    /// A formula, and what is wrong with it, while it is typed too.
    fn expression(
        &mut self,
        ui: &mut Ui,
        id: Id,
        value: &Json,
        variables: &'static [(&'static str, &'static str)],
    ) {
        let written = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let names: Vec<_> = variables.iter().map(|(name, _)| *name).collect();
        let show = |ui: &mut Ui| {
            let (left, draft) = self.line(ui, id, &written, &names.join(", "));
            if let Err(why) = Expression::compile(&draft, variables) {
                let color = ui.visuals().error_fg_color;
                match self.place {
                    FieldPlace::Row => ui.colored_label(color, &why),
                    FieldPlace::Cell => ui.colored_label(color, "\u{26a0}").on_hover_text(&why),
                };
            }
            left
        };
        let left = match self.place {
            FieldPlace::Row => ui.vertical(show).inner,
            FieldPlace::Cell => show(ui),
        };
        // A formula with a fault is kept, as the check of the map tells of it too.
        if let Some(text) = left {
            self.set(Some(Json::from(text)));
        }
    }

    /// A program and its arguments as a shell would take them; what cannot be read stays.
    fn command_line(&mut self, ui: &mut Ui, id: Id, value: &Json, spec: &CommandLineSpec) {
        let shown = |json: &Json| spec.read(json).map(|line| line.to_string());
        let written = shown(value).unwrap_or_else(|_| match value {
            Json::Null => String::new(),
            other => other.as_str().map_or_else(|| other.to_string(), str::to_owned),
        });
        let hint = "program {in.mesh} {out.mesh}";
        let Some(text) = self.line(ui, id, &written, hint).0.map(Json::from) else { return };
        match spec.read(&text) {
            Ok(line) => self.set(Some(line.to_json())),
            Err(why) => {
                let text = format!("{}: {why}; it stays {written}", self.name);
                self.events.push(FormEvent::NotUnderstood(text));
            }
        }
    }

    /// A line of text, which counts once the field is left or Enter is pressed; also what stands in
    /// it now.
    fn line(&self, ui: &mut Ui, id: Id, written: &str, hint: &str) -> (Option<String>, String) {
        line(ui, id, &self.name, written, (hint, self.width(ui)))
    }

    /// Width of a line of text.
    fn width(&self, ui: &Ui) -> f32 {
        let is_input = self.spec.input_file().is_some();
        let room = if is_input { BROWSE_WIDTH + BACK_WIDTH } else { BACK_WIDTH };
        match self.place {
            FieldPlace::Row => (ui.available_width() - room).max(60.0),
            FieldPlace::Cell => CELL_WIDTH,
        }
    }

    /// To look for a file, and to go back to the default.
    pub(super) fn buttons(&mut self, ui: &mut Ui) {
        if let Some(file) = self.spec.input_file()
            && ui.button("\u{1f4c2}").on_hover_text("Browse for a file").clicked()
        {
            let (path, extensions) = (self.path.to_owned(), file.extensions);
            self.events.push(FormEvent::Browse { path, extensions });
        }
        if self.given.is_some() && self.spec.default_json().is_some() {
            let back = ui.small_button("\u{27f2}");
            if back.on_hover_text(format!("{}: back to the default", self.name)).clicked() {
                self.set(None);
            }
        }
    }
}

/// A whole number, also where it is written as `300.0`.
fn whole(value: &Json) -> Option<i64> {
    value.as_i64().or_else(|| value.as_f64().filter(|x| x.fract() == 0.0).map(|x| x as i64))
}

/// A number as a person types it: spaces and underscores part thousands.
fn read_number(text: &str) -> Option<f64> {
    let is_digit = |c: &char| !c.is_whitespace() && *c != '_';
    let text: String = text.chars().filter(is_digit).collect();
    text.replace('\u{2212}', "-").parse().ok().filter(|number: &f64| number.is_finite())
}

/// A number with as many digits as it takes to read the same number again.
fn exact_text(number: f64) -> String {
    match number.abs() {
        size if size != 0.0 && !(1e-6..1e15).contains(&size) => format!("{number:e}"),
        _ => number.to_string(),
    }
}

fn suffix(spec: &ParamSpec) -> String {
    if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) }
}

fn range_text(from: f64, to: f64, spec: &ParamSpec) -> String {
    let end = |x: f64| if x.abs() < 1e15 { format!("{x}") } else { "any".to_owned() };
    format!("{} ({} to {}); drag, or click to type", spec.doc, end(from), end(to))
}

fn speed_of(soft: Option<(f64, f64)>, number: f64) -> f64 {
    match soft {
        Some((from, to)) => (to - from) / 400.0,
        None => (number.abs() / 100.0).max(1e-3),
    }
}

/// Whether a slider is better logarithmic.
fn spans_decades(from: f64, to: f64) -> bool {
    from > 0.0 && to > 100.0 * from
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_write_them() {
        let cases = [("1000", 1000.0), (" 1 000 ", 1000.0), ("1_000", 1000.0), ("1e-3", 1e-3)];
        for (text, number) in cases.into_iter().chain([("\u{2212}2.5", -2.5)]) {
            assert_eq!(read_number(text), Some(number), "{text}");
        }
        for text in ["", "abc", "1,5", "nan", "inf", "1e999"] {
            assert_eq!(read_number(text), None, "{text}");
        }
    }

    #[test]
    fn a_shown_number_is_the_number() {
        for number in [0.0, 0.5, 1e-5, -3.25, 1e-9, 0.1 + 0.2, 4_294_967_295.0, 1e300] {
            assert_eq!(read_number(&exact_text(number)), Some(number));
        }
        assert_eq!(exact_text(0.00001), "0.00001");
        assert_eq!(exact_text(10.0), "10");
        assert_eq!(exact_text(1e300), "1e300");
    }
}
