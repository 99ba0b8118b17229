//! Fields and lists with the names that a screen reader says, for forms and tables.

use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::text_edit::TextEditState;
use eframe::egui::{self, ComboBox, Id, Ui};
use mve_core::OptionSpec;

/// A list of names to pick one from; what was picked. Of the one that is there now its id, what is
/// shown, and the width in points.
pub fn pick(
    ui: &mut Ui,
    id: Id,
    name: &str,
    (current, text, width): (&str, &str, f32),
    options: &[OptionSpec],
) -> Option<&'static str> {
    let combo = ComboBox::from_id_salt(id).selected_text(text).width(width).truncate();
    let mut picked = None;
    let shown = combo.show_ui(ui, |ui| {
        for option in options {
            let label = ui.selectable_label(option.id == current, option.id);
            if label.on_hover_text(option.summary).clicked() {
                picked = Some(option.id);
            }
        }
    });
    let selected = format!("{name}: {current}");
    shown
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::ComboBox, true, &selected));
    picked
}

/// A line of text with a hint and a width: what it was changed to once the field is left or Enter
/// is pressed, and what stands in it now.
pub fn line(
    ui: &mut Ui,
    id: Id,
    name: &str,
    written: &str,
    (hint, width): (&str, f32),
) -> (Option<String>, String) {
    let mut text = draft(ui, id, written);
    let field = egui::TextEdit::singleline(&mut text).id(id).hint_text(hint);
    let response = ui.add(field.desired_width(width));
    name_it(&response, name, written.chars().count());
    commit(ui, id, &response, written, text)
}

/// What stands in a field: what is being typed, else what is written.
pub fn draft(ui: &Ui, id: Id, written: &str) -> String {
    ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| written.to_owned())
}

/// Keeps what is being typed; what a field was changed to once it is left or Enter is pressed, and
/// what stands in it now.
pub fn commit(
    ui: &Ui,
    id: Id,
    response: &egui::Response,
    written: &str,
    text: String,
) -> (Option<String>, String) {
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text.clone()));
        return (None, text);
    }
    let is_given_up = ui.input(|input| input.key_pressed(egui::Key::Escape));
    ui.data_mut(|data| data.remove::<String>(id));
    let is_changed = response.lost_focus() && text != written && !is_given_up;
    (is_changed.then(|| text.clone()), text)
}

/// Gives a field of so many letters the name that a screen reader says, and the focus if it is
/// asked for: then all of its text is selected, and what is typed takes its place.
pub fn name_it(response: &egui::Response, name: &str, n_letters: usize) {
    let is_asked = response.ctx.data_mut(|data| data.remove_temp::<bool>(focus_asked()));
    if is_asked.is_some() {
        response.request_focus();
        select_all(response, n_letters);
    }
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// Selects the text of a field of so many letters.
pub fn select_all(field: &egui::Response, n_letters: usize) {
    select(&field.ctx, field.id, CCursorRange::two(CCursor::new(0), CCursor::new(n_letters)));
}

/// Puts the cursor of a field behind its text.
pub fn select_end(context: &egui::Context, field: Id, text: &str) {
    select(context, field, CCursorRange::one(CCursor::new(text.chars().count())));
}

fn select(context: &egui::Context, field: Id, range: CCursorRange) {
    let mut state = TextEditState::default();
    state.cursor.set_char_range(Some(range));
    state.store(context, field);
}

/// Where it is kept that the next field is to get the focus.
pub fn focus_asked() -> Id {
    Id::new("form wants focus")
}
