//! Forms of parameters, drawn from their declarations alone.

use std::cell::RefCell;

use eframe::egui::emath::Numeric;
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::text_edit::TextEditState;
use eframe::egui::{self, ComboBox, DragValue, RichText, Slider, SliderClamping, Ui};
use mve_core::{ChoiceList, Kind, ParamSpec};
use serde_json::{Map as JsonMap, Value as Json};

/// Width of the names in front of the fields, in points.
const NAME_WIDTH: f32 = 118.0;
/// Room for the buttons behind a field, in points.
const BACK_WIDTH: f32 = 28.0;
const BROWSE_WIDTH: f32 = 32.0;

/// What the field of a parameter that is off shows.
const OFF: &str = "off";

/// What a person did in a form.
#[derive(Clone, Debug, PartialEq)]
pub enum FormEvent {
    /// A parameter got a value; `None` is back to its default.
    Set {
        /// Dotted path of the parameter within its node.
        path: String,
        /// The value.
        value: Option<Json>,
    },
    /// A file is to be looked for.
    Browse {
        /// Dotted path of the parameter within its node.
        path: String,
        /// Extensions that fit, without dots.
        extensions: &'static [&'static str],
    },
    /// What was typed is no value, in words for whoever typed it.
    NotUnderstood(String),
}

/// A form for some parameters.
pub struct Form<'a> {
    /// Tells one form from another that is shown at the same time.
    pub id: &'a str,
    /// What the map says of the parameters.
    pub given: &'a JsonMap<String, Json>,
    /// Whether the first field is to get the focus.
    pub wants_focus: bool,
    /// For a parameter with a link, the output that it comes from.
    pub link_of: &'a dyn Fn(&str) -> Option<String>,
}

impl Form<'_> {
    /// Shows a row for each parameter.
    pub fn show(&self, ui: &mut Ui, specs: &[ParamSpec]) -> Vec<FormEvent> {
        let mut events = Vec::new();
        if self.wants_focus {
            ui.data_mut(|data| data.insert_temp(focus_asked(), true));
        }
        for spec in specs {
            self.row(ui, spec, spec.name, self.given.get(spec.name), &mut events);
        }
        if self.wants_focus {
            // Where there was no field, no field elsewhere is to have it.
            ui.data_mut(|data| data.remove::<bool>(focus_asked()));
        }
        events
    }

    /// Shows the row of one parameter, and below a choice those of its entry.
    fn row(
        &self,
        ui: &mut Ui,
        spec: &ParamSpec,
        path: &str,
        given: Option<&Json>,
        events: &mut Vec<FormEvent>,
    ) {
        ui.horizontal(|ui| {
            let name = name_of(spec);
            let color = if given.is_some() {
                ui.visuals().strong_text_color()
            } else {
                ui.visuals().text_color()
            };
            let size = egui::vec2(NAME_WIDTH, ui.spacing().interact_size.y);
            let left = egui::Layout::left_to_right(egui::Align::Center);
            ui.allocate_ui_with_layout(size, left, |ui| {
                ui.set_min_width(NAME_WIDTH);
                let label = egui::Label::new(RichText::new(&name).color(color)).truncate();
                ui.add(label).on_hover_text(doc_of(spec));
            });
            if let Some(from) = (self.link_of)(path) {
                ui.label(RichText::new(format!("from {from}")).weak())
                    .on_hover_text("This parameter takes its value from a link.");
                return;
            }
            let mut field = Field { spec, name, path, given, events };
            if spec.can_be_off {
                field.switch(ui);
            }
            field.show(ui, &format!("{}/{path}", self.id));
            field.buttons(ui);
        });
        self.entry_rows(ui, spec, path, given, events);
    }

    /// The parameters of the entry that a choice names.
    fn entry_rows(
        &self,
        ui: &mut Ui,
        spec: &ParamSpec,
        path: &str,
        given: Option<&Json>,
        events: &mut Vec<FormEvent>,
    ) {
        let Kind::Choice { default, list } = spec.kind else { return };
        let id = given.and_then(chosen_id).unwrap_or(default);
        let Some(entry) = list.find(id).filter(|entry| !entry.params.is_empty()) else { return };
        let nested = given.and_then(|json| json.get(id));
        ui.indent((self.id, path), |ui| {
            for spec in entry.params {
                let path = format!("{path}.{}", spec.name);
                let given = nested.and_then(|params| params.get(spec.name));
                self.row(ui, spec, &path, given, events);
            }
        });
    }
}

/// What edits the value of one parameter.
struct Field<'a> {
    spec: &'a ParamSpec,
    /// The parameter as a person reads it.
    name: String,
    /// Dotted path of the parameter within its node.
    path: &'a str,
    /// What the map says of it.
    given: Option<&'a Json>,
    events: &'a mut Vec<FormEvent>,
}

impl Field<'_> {
    fn set(&mut self, value: Option<Json>) {
        self.events.push(FormEvent::Set { path: self.path.to_owned(), value });
    }

    /// Switches the parameter off and on.
    fn switch(&mut self, ui: &mut Ui) {
        let mut is_on = !is_off(self.spec, self.given);
        let switch = ui.checkbox(&mut is_on, "");
        if switch.on_hover_text(format!("whether {} is on", self.name)).changed() {
            self.set(Some(if is_on { some_value(self.spec) } else { Json::Null }));
        }
    }

    fn show(&mut self, ui: &mut Ui, salt: &str) {
        let given = self.given;
        match self.spec.kind {
            Kind::Flag { default } => {
                let mut flag = given.and_then(Json::as_bool).unwrap_or(default);
                if ui.checkbox(&mut flag, "").on_hover_text(&self.name).changed() {
                    self.set(Some(Json::from(flag)));
                }
            }
            Kind::Integer { default, hard, soft } => {
                let some = || some_value(self.spec).as_i64().unwrap_or(hard.0.max(0));
                let number = given.and_then(Json::as_i64).or(default).unwrap_or_else(some);
                self.number(ui, number, hard, soft);
            }
            Kind::Number { default, hard, soft } => {
                let some = || some_value(self.spec).as_f64().unwrap_or(hard.0.max(0.0));
                let number = given.and_then(Json::as_f64).or(default).unwrap_or_else(some);
                self.number(ui, number, hard, soft);
            }
            Kind::Seed { default } => {
                let seed = given.and_then(Json::as_u64).unwrap_or(u64::from(default));
                self.number(ui, seed, (0, u64::from(u32::MAX)), None);
            }
            Kind::Text { .. } | Kind::InputFile { .. } | Kind::OutputFile { .. } => {
                self.text(ui, salt);
            }
            Kind::Enumeration { default, names } => {
                let current = given.and_then(Json::as_str).unwrap_or(default);
                self.combo(ui, salt, current, &mut names.iter().copied());
            }
            Kind::Choice { default, list } => {
                let current = given.and_then(chosen_id).unwrap_or(default);
                self.combo(ui, salt, current, &mut entries(list));
            }
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
        let field = field.update_while_editing(false).custom_parser(read);
        let field = field.custom_formatter(|number, _| match is_off {
            true => OFF.to_owned(),
            false => exact_text(number),
        });
        let response = ui.add(field.suffix(if is_off { String::new() } else { suffix(self.spec) }));
        let range = range_text(hard.0.to_f64(), hard.1.to_f64(), self.spec);
        let response = response.on_hover_text(range);
        name_it(&response, &self.name, shown.chars().count());
        if let (Some((from, to)), false) = (soft, is_off) {
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
        let is_allowed = changed.to_f64().is_finite() && changed >= hard.0 && changed <= hard.1;
        if is_allowed && (changed != number || (is_off && typed.is_some())) {
            self.set(Some(changed.into()));
        }
    }

    fn combo<'e>(
        &mut self,
        ui: &mut Ui,
        salt: &str,
        current: &str,
        all: &mut dyn Iterator<Item = (&'e str, &'e str)>,
    ) {
        let combo = ComboBox::from_id_salt(salt)
            .selected_text(current)
            .width(ui.available_width().clamp(60.0, 150.0));
        let shown = combo.show_ui(ui, |ui| {
            for (id, summary) in all {
                if ui.selectable_label(id == current, id).on_hover_text(summary).clicked() {
                    self.set(Some(Json::from(id)));
                }
            }
        });
        let selected = format!("{}: {current}", self.name);
        shown
            .response
            .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, &selected));
    }

    /// A line of text; what is typed counts once the field is left or Enter is pressed.
    fn text(&mut self, ui: &mut Ui, salt: &str) {
        let written = self.given.and_then(Json::as_str).unwrap_or(match self.spec.kind {
            Kind::Text { default } => default,
            _ => "",
        });
        let id = ui.id().with(salt);
        let mut text =
            ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| written.to_owned());
        let hint = match self.spec.kind {
            Kind::InputFile { .. } => "path of a file",
            Kind::OutputFile { .. } => "name, or {node.parameter}",
            _ => "",
        };
        let is_input = matches!(self.spec.kind, Kind::InputFile { .. });
        let room = if is_input { BROWSE_WIDTH + BACK_WIDTH } else { BACK_WIDTH };
        let width = (ui.available_width() - room).max(60.0);
        let field = egui::TextEdit::singleline(&mut text).id(id).hint_text(hint);
        let response = ui.add(field.desired_width(width));
        name_it(&response, &self.name, written.chars().count());
        if response.has_focus() {
            ui.data_mut(|data| data.insert_temp(id, text));
            return;
        }
        let is_given_up = ui.input(|input| input.key_pressed(egui::Key::Escape));
        if response.lost_focus() && text != written && !is_given_up {
            self.set(Some(Json::from(text)));
        }
        ui.data_mut(|data| data.remove::<String>(id));
    }

    /// To look for a file, and to go back to the default.
    fn buttons(&mut self, ui: &mut Ui) {
        if let Kind::InputFile { extensions, .. } = self.spec.kind
            && ui.button("\u{1f4c2}").on_hover_text("Browse for a file").clicked()
        {
            self.events.push(FormEvent::Browse { path: self.path.to_owned(), extensions });
        }
        if self.given.is_some() && self.spec.default_setting().is_some() {
            let back = ui.small_button("\u{27f2}");
            if back.on_hover_text(format!("{}: back to the default", self.name)).clicked() {
                self.set(None);
            }
        }
    }
}

/// The entries of a list, each with its summary.
fn entries(list: &'static dyn ChoiceList) -> impl Iterator<Item = (&'static str, &'static str)> {
    (0..list.len()).map(|place| list.spec(place)).map(|entry| (entry.id, entry.summary))
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

/// Gives a field of so many letters the name that a screen reader says, and the focus if it is
/// asked for: then all of its text is selected, and what is typed takes its place.
fn name_it(response: &egui::Response, name: &str, n_letters: usize) {
    let is_asked = response.ctx.data_mut(|data| data.remove_temp::<bool>(focus_asked()));
    if is_asked.is_some() {
        response.request_focus();
        select_all(response, n_letters);
    }
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// Selects the text of a field of so many letters.
pub fn select_all(field: &egui::Response, n_letters: usize) {
    let mut state = TextEditState::default();
    let all = CCursorRange::two(CCursor::new(0), CCursor::new(n_letters));
    state.cursor.set_char_range(Some(all));
    state.store(&field.ctx, field.id);
}

/// Where it is kept that the next field is to get the focus.
fn focus_asked() -> egui::Id {
    egui::Id::new("form wants focus")
}

/// `target_faces` as a person reads it.
pub fn name_of(spec: &ParamSpec) -> String {
    spec.name.replace('_', " ")
}

fn doc_of(spec: &ParamSpec) -> String {
    let unit = if spec.unit.is_empty() { String::new() } else { format!("\nUnit: {}", spec.unit) };
    format!("{}{unit}\nIn maps: {}", spec.doc, spec.name)
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

fn is_off(spec: &ParamSpec, given: Option<&Json>) -> bool {
    let is_off_by_default = match spec.kind {
        Kind::Integer { default, .. } => default.is_none(),
        Kind::Number { default, .. } => default.is_none(),
        _ => false,
    };
    given.map_or(is_off_by_default, Json::is_null)
}

/// A value for a parameter that is switched on: its default, or the middle of what a slider shows.
fn some_value(spec: &ParamSpec) -> Json {
    match spec.kind {
        Kind::Integer { default, hard, soft } => {
            let (from, to) = soft.unwrap_or((hard.0.max(0), hard.1.min(1000)));
            Json::from(default.unwrap_or(middle(from as f64, to as f64).round() as i64))
        }
        Kind::Number { default, hard, soft } => {
            let (from, to) = soft.unwrap_or((hard.0.max(0.0), hard.1.min(1.0)));
            Json::from(default.unwrap_or(middle(from, to)))
        }
        _ => Json::Null,
    }
}

/// The middle of a range: the geometric one where it spans decades.
fn middle(from: f64, to: f64) -> f64 {
    if spans_decades(from, to) { (from * to).sqrt() } else { from + (to - from) / 2.0 }
}

fn spans_decades(from: f64, to: f64) -> bool {
    from > 0.0 && to > 100.0 * from
}

/// The id in the JSON of a choice.
pub fn chosen_id(json: &Json) -> Option<&str> {
    match json {
        Json::String(id) => Some(id),
        Json::Object(object) => object.keys().next().map(String::as_str),
        _ => None,
    }
}

/// A parameter's value in a few characters, as a node shows it.
pub fn value_text(spec: &ParamSpec, given: Option<&Json>) -> String {
    if is_off(spec, given) {
        return OFF.to_owned();
    }
    let number = |x: f64| mve_core::brief(x);
    let text = match spec.kind {
        Kind::Flag { default } => {
            let flag = given.and_then(Json::as_bool).unwrap_or(default);
            if flag { "yes" } else { "no" }.to_owned()
        }
        Kind::Integer { default, .. } => {
            given.and_then(Json::as_i64).or(default).map(|n| n.to_string()).unwrap_or_default()
        }
        Kind::Number { default, .. } => {
            given.and_then(Json::as_f64).or(default).map(number).unwrap_or_default()
        }
        Kind::Seed { default } => {
            given.and_then(Json::as_u64).unwrap_or(u64::from(default)).to_string()
        }
        Kind::Text { default } => given.and_then(Json::as_str).unwrap_or(default).to_owned(),
        Kind::Enumeration { default, .. } => {
            given.and_then(Json::as_str).unwrap_or(default).to_owned()
        }
        Kind::Choice { default, .. } => given.and_then(chosen_id).unwrap_or(default).to_owned(),
        Kind::OutputFile { .. } => given.and_then(Json::as_str).unwrap_or("").to_owned(),
        Kind::InputFile { .. } => {
            let path = given.and_then(Json::as_str).unwrap_or("");
            path.rsplit(['/', '\\']).next().unwrap_or(path).to_owned()
        }
    };
    // What does not fit its declaration is shown as it stands.
    match given {
        Some(json) if text.is_empty() && !json.is_string() => json.to_string(),
        _ => text,
    }
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
