//! The titles of fields that color a mesh beside them, so that they can be unpinned.

use eframe::egui;
use mve_core::Value;
use mve_modules::data::Field;

use super::field::colors_a_mesh;
use super::heading::heading;
use super::{PanelPlace, Pinned, ValueView, ViewInput, ViewerAction};

/// The view of fields that are seen on a mesh.
#[derive(Default)]
pub struct FieldTitlesView;

impl ValueView for FieldTitlesView {
    fn place(&self) -> PanelPlace {
        PanelPlace::Strip
    }

    fn takes(&self, value: &Value, all: &[Pinned]) -> bool {
        value.get::<Field>().is_some_and(|field| colors_a_mesh(&field, all))
    }

    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction> {
        let mut actions = Vec::new();
        ui.horizontal_wrapped(|ui| {
            for &(place, pinned) in &shown.values {
                if heading(ui, &pinned.title) {
                    actions.push(ViewerAction::Unpin(place));
                }
                // Its mesh is new already, and it is on its way: nothing jumps meanwhile.
                let field = pinned.value.as_ref().and_then(Value::get::<Field>);
                if field.is_some_and(|field| !colors_a_mesh(&field, shown.all)) {
                    ui.weak("from an earlier run");
                }
            }
        });
        actions
    }
}
