//! Numbers, flags, texts, and values of types that have no view of their own.

use eframe::egui::{self, Rect, vec2};
use mve_core::{Scalar, Value};

use super::number::number_text;

/// Letters of a text that are shown at most; the rest can be copied.
const LONGEST_TEXT: usize = 20_000;

/// Shows a value that fits a cell, large; whether it is to be unpinned.
pub fn show_scalar(ui: &mut egui::Ui, title: &str, scalar: &Scalar) -> bool {
    let mut is_unpinned = false;
    egui::Frame::group(ui.style()).show(ui, |ui| {
        ui.vertical(|ui| {
            is_unpinned = heading(ui, title);
            match scalar {
                Scalar::Number(number) => {
                    let text = egui::RichText::new(number_text(*number)).size(26.0);
                    ui.label(text).on_hover_text(number.to_string());
                }
                Scalar::Flag(flag) => {
                    ui.label(egui::RichText::new(flag.to_string()).size(26.0));
                }
                Scalar::Text(text) => show_text(ui, title, text),
            }
        });
    });
    is_unpinned
}

fn show_text(ui: &mut egui::Ui, title: &str, text: &str) {
    let is_short = text.len() < 60 && !text.contains('\n');
    if is_short {
        ui.label(egui::RichText::new(text).size(20.0));
        return;
    }
    if ui.button("Copy").on_hover_text("Copy the whole text").clicked() {
        ui.ctx().copy_text(text.to_owned());
    }
    let end = text.char_indices().nth(LONGEST_TEXT).map_or(text.len(), |(at, _)| at);
    egui::ScrollArea::vertical().id_salt(("text", title)).max_height(240.0).show(ui, |ui| {
        ui.monospace(&text[..end]);
        if end < text.len() {
            ui.weak("… copy to see the rest");
        }
    });
}

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
