//! Values as lines of text, one below the other.
//!
//! Say what is seen of a value, and what its controls change.

use eframe::egui;
use mve_core::{Data, Value};
use mve_modules::data::Measures;

use super::heading::heading;
use super::{PanelPlace, Pinned, ValueView, ViewInput, ViewerAction};

/// What is of the moment: nothing yet.
#[derive(Default)]
pub struct MeasuresView;

impl ValueView for MeasuresView {
    fn place(&self) -> PanelPlace {
        PanelPlace::Column("tables")
    }

    fn takes(&self, value: &Value, _all: &[Pinned]) -> bool {
        value.get::<Measures>().is_some()
    }

    fn show(&mut self, ui: &mut egui::Ui, shown: &ViewInput) -> Vec<ViewerAction> {
        let mut actions = Vec::new();
        for (place, title, value) in shown.of::<Measures>() {
            if heading(ui, title) {
                actions.push(ViewerAction::Unpin(place));
            }
            ui.label(value.summary());
        }
        actions
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use mve_core::Data;
    use mve_modules::data::DATA_TYPES;
    use mve_modules::mesh::fixtures::tetrahedron;

    use super::super::PortState;
    use super::*;

    #[test]
    fn a_value_is_shown_and_can_be_unpinned() {
        let id = Measures::TYPE.id;
        let entry = DATA_TYPES.iter().find(|entry| entry.data_type.id == id).unwrap();
        let value = (entry.sample)(&tetrahedron());
        let summary = value.summary();
        let (title, state) = ("a.value".to_owned(), PortState::Ready);
        let pinned = Pinned { title, value: Some(value), state, mesh: None };
        let show = |ui: &mut egui::Ui, actions: &mut Vec<ViewerAction>| {
            let values = vec![(0, &pinned)];
            let shown = ViewInput { values, all: &[], height: 100.0, render: None, picked: None };
            actions.extend(MeasuresView.show(ui, &shown));
        };
        let mut harness = Harness::new_ui_state(show, Vec::new());
        assert!(harness.query_by_label(&summary).is_some());
        harness.get_by_label("Unpin a.value").click();
        harness.run();
        assert_eq!(*harness.state(), [ViewerAction::Unpin(0)]);
    }
}
