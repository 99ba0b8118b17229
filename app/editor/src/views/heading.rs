//! What stands beside a value whatever its type: a title with a button to unpin it, why there is no
//! value, and what a value says of itself where its type has no view.

use eframe::egui::{self, Rect, vec2};
use mve_core::Value;

/// Shows what a value of any type says of itself; whether it is to be unpinned.
pub fn show_summary(ui: &mut egui::Ui, title: &str, value: &Value) -> bool {
    let is_unpinned = heading(ui, title);
    ui.label(value.summary());
    let data_type = value.data_type();
    ui.weak(data_type.id).on_hover_text(data_type.doc);
    is_unpinned
}

/// Shows why there is no value; whether it is to be unpinned.
pub fn show_absence(ui: &mut egui::Ui, title: &str, reason: &str) -> bool {
    let mut is_unpinned = false;
    ui.horizontal_wrapped(|ui| {
        is_unpinned = heading(ui, title);
        ui.weak(reason);
    });
    is_unpinned
}

/// A title with a button to unpin it; whether that was pressed.
pub fn heading(ui: &mut egui::Ui, title: &str) -> bool {
    ui.horizontal(|ui| {
        let is_unpinned = unpin_button(ui, title);
        ui.strong(title);
        is_unpinned
    })
    .inner
}

fn unpin_button(ui: &mut egui::Ui, title: &str) -> bool {
    let button = ui.small_button("×").on_hover_text("Take it out of this view");
    let label = format!("Unpin {title}");
    button.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, &label));
    button.clicked()
}

/// Writes over the upper left corner of a picture, on a ground of its own so that it can be read
/// over anything; whether what has the title is to be unpinned.
pub fn caption(ui: &mut egui::Ui, rect: Rect, text: &str, title: Option<&str>) -> bool {
    let mut child = ui.new_child(egui::UiBuilder::new().max_rect(rect.shrink(4.0)));
    child.set_clip_rect(rect.intersect(ui.clip_rect()));
    let ground = child.visuals().window_fill().gamma_multiply(0.85);
    let frame = egui::Frame::new().fill(ground).corner_radius(3.0).inner_margin(vec2(4.0, 2.0));
    let mut is_unpinned = false;
    frame.show(&mut child, |ui| {
        ui.horizontal_top(|ui| {
            if let Some(title) = title {
                is_unpinned = unpin_button(ui, title);
            }
            let text = egui::RichText::new(text).color(ui.visuals().strong_text_color());
            ui.add(egui::Label::new(text).selectable(false).wrap());
        });
    });
    is_unpinned
}
