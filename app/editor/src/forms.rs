//! Forms of parameters, drawn from their declarations alone.

mod field;
mod paths;
mod points;
mod suggest;
mod widgets;

use std::path::Path;

use eframe::egui::{self, RichText, Ui};
pub use field::{CELL_WIDTH, FieldPlace, ParamField};
use mve_core::{ParamSpec, Repeat, chosen};
use serde_json::{Map as JsonMap, Value as Json};
pub use suggest::{Counts, halves, known_count};
use widgets::focus_asked;
pub use widgets::{line, pick, select_all};

/// Width of the names in front of the fields, in points.
const NAME_WIDTH: f32 = 118.0;

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
    /// Where the value of a parameter comes from that is not set here: a link, or rounds.
    pub link_of: &'a dyn Fn(&str) -> Option<String>,
    /// How many of a unit there are in the inputs of the node.
    pub counts: &'a [(&'static str, usize)],
    /// The folder that paths are relative to.
    pub folder: &'a Path,
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
            // Paths are long: they get the room that their names leave.
            let width = if spec.input_file().is_some() { 0.5 * NAME_WIDTH } else { NAME_WIDTH };
            let size = egui::vec2(width, ui.spacing().interact_size.y);
            let left = egui::Layout::left_to_right(egui::Align::Center);
            ui.allocate_ui_with_layout(size, left, |ui| {
                ui.set_min_width(width);
                let label = egui::Label::new(RichText::new(&name).color(color)).truncate();
                ui.add(label).on_hover_text(doc_of(spec));
            });
            if let Some(from) = (self.link_of)(path) {
                ui.label(RichText::new(from).weak())
                    .on_hover_text("A link or the rounds of a loop give this parameter its value.");
                return;
            }
            let place = FieldPlace::Row;
            let suggested = halves(spec, self.counts, 1).pop();
            let folder = Some(self.folder);
            let mut field =
                ParamField { spec, name, path, given, place, suggested, folder, events };
            if spec.can_be_off {
                field.switch(ui);
            }
            field.show(ui, ui.id().with(format!("{}/{path}", self.id)));
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
        let Some(choice) = spec.choice() else { return };
        let (id, nested) = given.and_then(chosen).unwrap_or((choice.default, None));
        let entry = choice.list.find(id).filter(|entry| !entry.params.is_empty());
        let Some(entry) = entry else { return };
        ui.indent((self.id, path), |ui| {
            for spec in entry.params {
                let path = format!("{path}.{}", spec.name);
                let given = nested.and_then(|params| params.get(spec.name));
                self.row(ui, spec, &path, given, events);
            }
        });
    }
}

/// `target_faces` as a person reads it.
pub fn name_of(spec: &ParamSpec) -> String {
    spec.name.replace('_', " ")
}

fn doc_of(spec: &ParamSpec) -> String {
    let unit = if spec.unit.is_empty() { String::new() } else { format!("\nUnit: {}", spec.unit) };
    format!("{}{unit}\nIn maps: {}", spec.doc, spec.name)
}

/// What a field says of a parameter that is off.
fn is_off(spec: &ParamSpec, given: Option<&Json>) -> bool {
    given.map_or(spec.is_off_by_default(), Json::is_null)
}

/// A parameter's value in a few characters, as a node shows it.
pub fn value_text(spec: &ParamSpec, given: Option<&Json>) -> String {
    if is_off(spec, given) {
        return OFF.to_owned();
    }
    let Some(value) = given.cloned().or_else(|| spec.default_json()) else { return String::new() };
    match &value {
        value if let Some(summary) = spec.summary(value) => summary,
        Json::Bool(flag) => if *flag { "yes" } else { "no" }.to_owned(),
        Json::String(text) => text.clone(),
        Json::Number(number) => match (number.as_i64(), number.as_f64()) {
            (None, Some(number)) => mve_core::brief(number),
            _ => number.to_string(),
        },
        // What does not fit its declaration is shown as it stands.
        other => other.to_string(),
    }
}

/// The values of a parameter, one a round, where a loop sets it.
pub fn each_text(repeat: &Repeat, param: &str) -> Option<String> {
    let value = repeat.each.as_ref()?.get(param)?;
    Some(match value {
        Json::Array(values) => values.iter().map(short).collect::<Vec<_>>().join(", "),
        other => short(other),
    })
}

/// How often a node runs, in a word: as many times, at most as many until a number says so, or once
/// for each of some values.
pub fn rounds_text(repeat: &Repeat) -> String {
    let lists = repeat.each.iter().flat_map(|each| each.values());
    let listed = lists.filter_map(Json::as_array).map(|list| list.len() as u32).next();
    match (repeat.times.or(listed), &repeat.until) {
        (Some(times), None) => format!("{times}\u{d7}"),
        (Some(times), Some(_)) => format!("\u{2264}{times}\u{d7}"),
        (None, _) => "each \u{d7}".to_owned(),
    }
}

fn short(value: &Json) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use mve_core::{Expression, Param, Points, Selection, SelectionDomain};
    use serde_json::json;

    use super::*;

    #[test]
    fn a_node_shows_values_in_a_few_characters() {
        let text = |spec: ParamSpec, given: Json| value_text(&spec, Some(&given));
        let number = Param::<f64>::number("x", "", 0.5).spec();
        assert_eq!(value_text(&number, None), "0.5");
        assert_eq!(text(number, json!(0.123_456_789)), "0.12346");
        let off = Param::<Option<i64>>::maybe_integer("n", "", None).spec();
        assert_eq!((value_text(&off, None), text(off, json!(3))), (OFF.to_owned(), "3".to_owned()));
        assert_eq!(text(Param::flag("f", "", false).spec(), json!(true)), "yes");
        let file = Param::input_file("p", "", &[]).spec();
        assert_eq!(
            (value_text(&file, None), text(file, json!("a/b.obj"))),
            ("".into(), "b.obj".into())
        );
        let points = Param::<Points>::points("p", "", &[]).spec();
        assert_eq!(value_text(&points, None), "no points");
        let faces = Param::<Selection>::selection("s", "", SelectionDomain::Faces, "mesh").spec();
        assert_eq!(text(faces, json!([3, [10, 20]])), "12 faces");
        assert_eq!(text(faces, json!([3, 1])), "[3,1]"); // as it stands
        let formula = Param::<Expression>::expression("e", "", "x", &[("x", "")]).spec();
        assert_eq!(text(formula, json!("x ^ 2")), "x ^ 2");
    }
}
