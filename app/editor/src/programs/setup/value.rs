//! Fields that edit one value of a parameter, drawn from its declaration.

use eframe::egui::{self, Id, Ui};
use mve_core::{ParamSpec, brief_value, chosen, with_param};
use serde_json::Value as Json;

use crate::forms::{CELL_WIDTH, FieldPlace, FormEvent, ParamField, halves, line, pick};
use crate::programs::setup::declare::{Declared, default_of};
use crate::programs::widgets::{named, small_button};

/// Shows the field of a value; what it was changed to. `name` is what a screen reader says, `id`
/// tells the field from others; `counts` is what there is in the inputs of the node.
pub fn field(
    ui: &mut Ui,
    id: Id,
    name: &str,
    (declared, counts): (&Declared, &[(&str, usize)]),
    value: &Json,
) -> Option<Json> {
    if let Some(spec) = declared.spec().filter(|spec| spec.can_be_off) {
        let mut is_on = !value.is_null();
        let switch = named(ui.checkbox(&mut is_on, ""), &format!("{name} is on"));
        if switch.on_hover_text("whether it is on").changed() {
            let value = halves(spec, counts, 1).pop().or_else(|| spec.value_when_on());
            return Some(value.filter(|_| is_on).unwrap_or_default());
        }
        if value.is_null() {
            ui.weak("off");
            return None;
        }
    }
    let Some(spec) = declared.spec() else { return unknown(ui, id, name, declared, value) };
    if !is_drawn(spec, value) {
        return raw(ui, id, name, value);
    }
    let mut events = Vec::new();
    let mut edited = ParamField {
        spec,
        name: name.to_owned(),
        path: "",
        given: Some(value),
        place: FieldPlace::Cell,
        suggested: halves(spec, counts, 1).pop(),
        folder: None,
        events: &mut events,
    };
    edited.show(ui, id);
    events.into_iter().find_map(|event| match event {
        FormEvent::Set { value, .. } => value,
        _ => None,
    })
}

/// Whether the field of a parameter can show a value; else it is shown as it stands.
fn is_drawn(spec: &ParamSpec, value: &Json) -> bool {
    let is_number = |whole: bool| if whole { value.is_i64() } else { value.is_number() };
    spec.read(value).is_ok()
        || spec.range().is_some_and(|range| is_number(range.is_whole))
        || (value.is_string() && (spec.is_text() || spec.default_json().is_none()))
        || (!spec.options().is_empty() && chosen(value).is_some())
}

/// What is not the value of a parameter: a module out of the list of them, or any JSON.
fn unknown(ui: &mut Ui, id: Id, name: &str, declared: &Declared, value: &Json) -> Option<Json> {
    let options = declared.options();
    let Some((current, _)) = chosen(value).filter(|_| !options.is_empty()) else {
        return raw(ui, id, name, value);
    };
    let text = brief_value(value);
    let picked = pick(ui, id, name, (current, &text, CELL_WIDTH), &options);
    picked.filter(|id| *id != current).map(Json::from)
}

/// A value that no declaration fits, as JSON.
fn raw(ui: &mut Ui, id: Id, name: &str, value: &Json) -> Option<Json> {
    let text = line(ui, id, name, &value.to_string(), ("", CELL_WIDTH)).0?;
    // What is no JSON is meant as a text.
    Some(serde_json::from_str(&text).unwrap_or(Json::String(text)))
}

/// The parameters of the entry that a value names, a row each; what the value was changed to.
pub fn nested(ui: &mut Ui, id: Id, name: &str, declared: &Declared, value: &Json) -> Option<Json> {
    let given = chosen(value).and_then(|(_, params)| params);
    let mut changed = None;
    egui::Grid::new(id).num_columns(3).show(ui, |ui| {
        for spec in declared.nested(value) {
            let said = given.and_then(|given| given.get(spec.name));
            let current = said.cloned().unwrap_or_else(|| default_of(spec));
            let text = spec.name.replace('_', " ");
            let text = if said.is_some() { text.into() } else { egui::RichText::new(text).weak() };
            ui.label(text).on_hover_text(spec.doc);
            let (own_id, own_name) = (id.with(spec.name), format!("{name} {}", spec.name));
            ui.horizontal(|ui| {
                let own = Declared::Param(*spec);
                let set = field(ui, own_id, &own_name, (&own, &[]), &current);
                let is_deep = !own.nested(&current).is_empty();
                let deep = is_deep
                    .then(|| nested(ui, own_id.with("nested"), &own_name, &own, &current))
                    .flatten();
                if let Some(set) = set.or(deep) {
                    changed = Some(with_param(value, spec.name, Some(set)));
                }
            });
            let reset = format!("{own_name}: back to the default");
            if said.is_some() && small_button(ui, "\u{27f2}", &reset).clicked() {
                changed = Some(with_param(value, spec.name, None));
            }
            ui.end_row();
        }
    });
    changed
}
