//! Numbers, flags and texts.

use eframe::egui;
use mve_core::{Scalar, Value};

use super::heading::heading;
use super::number::number_text;
use super::{PanelPlace, Pinned, ValueView, ViewInput, ViewerAction};

/// The view of numbers, flags and texts.
#[derive(Default)]
pub struct ScalarsView;

impl ValueView for ScalarsView {
    fn place(&self) -> PanelPlace {
        PanelPlace::Strip
    }

    fn takes(&self, value: &Value, _all: &[Pinned]) -> bool {
        value.scalar().is_some()
    }

    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction> {
        let mut actions = Vec::new();
        ui.horizontal_wrapped(|ui| {
            for &(place, pinned) in &shown.values {
                let Some(scalar) = pinned.value.as_ref().and_then(Value::scalar) else { continue };
                if show_scalar(ui, &pinned.title, &scalar) {
                    actions.push(ViewerAction::Unpin(place));
                }
            }
        });
        actions
    }
}

/// Letters of a text that are shown at most; the rest can be copied.
const LONGEST_TEXT: usize = 20_000;

/// Shows a value that fits a cell, large; whether it is to be unpinned.
fn show_scalar(ui: &mut egui::Ui, title: &str, scalar: &Scalar) -> bool {
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
