//! Fields that edit one value of a parameter, drawn from its declaration.

use eframe::egui::{self, ComboBox, DragValue, Id, TextEdit, Ui};
use mve_core::{Kind, ParamSpec, brief_value};
use serde_json::Value as Json;

use crate::programs::setup::declare::{Declared, chosen_id, default_of, some_number, with_nested};
use crate::programs::widgets::{named, small_button};

/// Width of a field, in points.
pub const FIELD_WIDTH: f32 = 128.0;

/// Shows the field of a value; what it was changed to. `name` is what a screen reader says, `id`
/// tells the field from others.
pub fn field(ui: &mut Ui, id: Id, name: &str, declared: &Declared, value: &Json) -> Option<Json> {
    if let Some(spec) = declared.spec().filter(|spec| spec.can_be_off) {
        let mut is_on = !value.is_null();
        let switch = named(ui.checkbox(&mut is_on, ""), &format!("{name} is on"));
        if switch.on_hover_text("whether it is on").changed() {
            return Some(if is_on { some_number(spec) } else { Json::Null });
        }
        if value.is_null() {
            ui.weak("off");
            return None;
        }
    }
    if !declared.options().is_empty() && chosen_id(value).is_some() {
        return options(ui, id, name, declared, value);
    }
    let Some(spec) = declared.spec() else { return raw(ui, id, name, value) };
    match (spec.kind, value) {
        (Kind::Flag { .. }, Json::Bool(flag)) => {
            let mut changed = *flag;
            let response = ui.checkbox(&mut changed, if *flag { "yes" } else { "no" });
            named(response, name).changed().then(|| Json::from(changed))
        }
        (Kind::Integer { hard, .. }, Json::Number(number)) if number.is_i64() => {
            let speed = (number.as_f64().unwrap_or_default().abs() / 100.0).max(0.05);
            let mut changed = number.as_i64().unwrap_or_default();
            let before = changed;
            let drag = DragValue::new(&mut changed).range(hard.0..=hard.1).speed(speed);
            add_number(ui, drag, name, spec);
            (changed != before).then(|| Json::from(changed))
        }
        (Kind::Number { hard, .. }, Json::Number(number)) => {
            let before = number.as_f64().unwrap_or_default();
            let mut changed = before;
            let drag = DragValue::new(&mut changed).range(hard.0..=hard.1);
            let drag = drag.speed((before.abs() / 100.0).max(1e-3)).max_decimals(12);
            add_number(ui, drag, name, spec);
            (changed.to_bits() != before.to_bits() && changed.is_finite())
                .then(|| Json::from(changed))
        }
        (Kind::Seed { .. }, Json::Number(number)) if number.is_u64() => {
            let mut changed = number.as_u64().unwrap_or_default();
            let before = changed;
            let drag = DragValue::new(&mut changed).range(0..=u64::from(u32::MAX));
            add_number(ui, drag, name, spec);
            (changed != before).then(|| Json::from(changed))
        }
        (
            Kind::Text { .. } | Kind::InputFile { .. } | Kind::OutputFile { .. },
            Json::String(text),
        ) => line(ui, id, name, text).map(Json::from),
        _ => raw(ui, id, name, value),
    }
}

fn add_number(ui: &mut Ui, drag: DragValue, name: &str, spec: &ParamSpec) {
    let suffix = if spec.unit.is_empty() { String::new() } else { format!(" {}", spec.unit) };
    // What a file says outside of the range stays until a person changes it; the check tells.
    let drag = drag.clamp_existing_to_range(false).suffix(suffix);
    named(ui.add(drag), name).on_hover_text("drag, or click to type");
}

/// The entry that a value names, out of a list.
fn options(ui: &mut Ui, id: Id, name: &str, declared: &Declared, value: &Json) -> Option<Json> {
    let current = chosen_id(value).unwrap_or_default();
    let mut chosen = None;
    let text = brief_value(value);
    let combo = ComboBox::from_id_salt(id).selected_text(&text).width(FIELD_WIDTH).truncate();
    let shown = combo.show_ui(ui, |ui| {
        for option in declared.options() {
            let label = ui.selectable_label(option.id == current, option.id);
            if label.on_hover_text(option.summary).clicked() && option.id != current {
                chosen = Some(Json::from(option.id));
            }
        }
    });
    named(shown.response, &format!("{name}: {current}")).on_hover_text(&text);
    chosen
}

/// A line of text, which counts once the field is left or Enter is pressed.
fn line(ui: &mut Ui, id: Id, name: &str, text: &str) -> Option<String> {
    let draft = ui.data(|data| data.get_temp::<String>(id));
    let mut draft = draft.unwrap_or_else(|| text.to_owned());
    let edit = TextEdit::singleline(&mut draft).id(id).desired_width(FIELD_WIDTH);
    let response = named(ui.add(edit), name).on_hover_text(text);
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, draft));
        return None;
    }
    ui.data_mut(|data| data.remove::<String>(id));
    (response.lost_focus() && draft != text).then_some(draft)
}

/// A value that no declaration fits, as JSON.
fn raw(ui: &mut Ui, id: Id, name: &str, value: &Json) -> Option<Json> {
    let text = line(ui, id, name, &value.to_string())?;
    // What is no JSON is meant as a text.
    Some(serde_json::from_str(&text).unwrap_or(Json::String(text)))
}

/// The parameters of the entry that a value names, a row each; what the value was changed to.
pub fn nested(ui: &mut Ui, id: Id, name: &str, declared: &Declared, value: &Json) -> Option<Json> {
    let given = chosen_id(value).and_then(|chosen| value.get(chosen));
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
                let set = field(ui, own_id, &own_name, &own, &current);
                let is_deep = !own.nested(&current).is_empty();
                let deep = is_deep
                    .then(|| nested(ui, own_id.with("nested"), &own_name, &own, &current))
                    .flatten();
                if let Some(set) = set.or(deep) {
                    changed = Some(with_nested(value, spec.name, Some(set)));
                }
            });
            let reset = format!("{own_name}: back to the default");
            if said.is_some() && small_button(ui, "\u{27f2}", &reset).clicked() {
                changed = Some(with_nested(value, spec.name, None));
            }
            ui.end_row();
        }
    });
    changed
}
