//! How the parts of the panel stand together.

use eframe::egui::{self, Ui};

use crate::programs::widgets::drop_zone;
use crate::programs::{ProgramAction, ProgramPanel, ProgramScene};

/// Widths from which tables and results stand side by side, in points.
const WIDE: f32 = 760.0;
/// Height from which the plot stands above the table.
const HIGH: f32 = 420.0;

/// What is shown where there is no room for all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PanelTab {
    /// Axes and steps.
    #[default]
    Setup,
    /// The table of results.
    Table,
    /// The plot.
    Plot,
}

impl ProgramPanel {
    /// Shows the panel; what it asks for.
    pub fn show(&mut self, ui: &mut Ui, scene: &ProgramScene) -> Vec<ProgramAction> {
        self.take_in();
        self.keep_checked(scene);
        let mut actions = std::mem::take(&mut self.waiting);
        self.show_bar(ui, scene, &mut actions);
        if self.is_sheet_stale {
            ui.ctx().request_repaint_after(crate::programs::REFRESH);
        }
        ui.separator();
        if self.name(scene.map).is_none() {
            self.show_nothing(ui, scene, &mut actions);
            return actions;
        }
        if ui.available_width() >= WIDE {
            let width = (ui.available_width() * 0.42).clamp(300.0, 460.0);
            let panel = egui::Panel::left(ui.id().with("setup")).default_size(width);
            let panel = panel.min_size(260.0).resizable(true).frame(egui::Frame::new());
            panel.show(ui, |ui| self.show_setup(ui, scene, &mut actions));
            let frame =
                egui::Frame::new().inner_margin(egui::Margin { left: 8, ..Default::default() });
            let rest = egui::CentralPanel::default().frame(frame);
            rest.show(ui, |ui| self.show_results(ui, scene, &mut actions));
        } else {
            self.show_one(ui, scene, &mut actions);
        }
        actions
    }

    /// What stands in a panel without a program.
    fn show_nothing(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        actions: &mut Vec<ProgramAction>,
    ) {
        let frame = egui::Frame::new().inner_margin(16);
        let dropped = drop_zone(ui, frame, |ui| {
            // All of the panel, which else would be too low for the program to come.
            ui.set_min_size(ui.available_size().max(egui::vec2(0.0, 120.0)));
            ui.label("This map has no program.");
            ui.weak(
                "A program runs the map with every combination of some parameters and puts the \
                 results into one table. Press New, or drag a parameter here from a node.",
            );
        });
        if let Some(dragged) = dropped {
            actions.extend(self.vary(&dragged.node, &dragged.param, scene));
        }
    }

    fn show_setup(&mut self, ui: &mut Ui, scene: &ProgramScene, actions: &mut Vec<ProgramAction>) {
        let Some(name) = self.name(scene.map).map(str::to_owned) else { return };
        let Some(spec) = scene.map.programs.get(&name) else { return };
        let scroll = egui::ScrollArea::vertical().id_salt("setup").auto_shrink(false);
        let shown = scroll.show(ui, |ui| self.setup.show(ui, scene, spec, actions));
        if !shown.inner.is_empty() {
            let mut changed = spec.clone();
            shown.inner.into_iter().for_each(|edit| edit.apply(&mut changed));
            if changed != *spec {
                actions.push(ProgramAction::SetProgram { name, spec: Some(changed) });
            }
        }
    }

    fn show_results(
        &mut self,
        ui: &mut Ui,
        scene: &ProgramScene,
        actions: &mut Vec<ProgramAction>,
    ) {
        self.show_failed(ui, actions);
        if ui.available_height() >= HIGH {
            let height = ui.available_height();
            let panel = egui::Panel::top(ui.id().with("plot")).default_size(height * 0.52);
            let panel = panel.min_size(140.0).max_size(height - 140.0).resizable(true);
            panel.frame(egui::Frame::new()).show(ui, |ui| self.show_plot(ui));
            let rest = egui::CentralPanel::default().frame(egui::Frame::new());
            rest.show(ui, |ui| self.show_table(ui, scene, actions));
            return;
        }
        ui.horizontal(|ui| {
            for (view, name) in [(PanelTab::Table, "Table"), (PanelTab::Plot, "Plot")] {
                let is_shown = (self.view == PanelTab::Plot) == (view == PanelTab::Plot);
                if ui.selectable_label(is_shown, name).clicked() {
                    self.view = view;
                }
            }
        });
        match self.view {
            PanelTab::Plot => {
                ui.horizontal(|ui| self.show_selected(ui, scene, actions));
                self.show_plot(ui);
            }
            PanelTab::Table | PanelTab::Setup => self.show_table(ui, scene, actions),
        }
    }

    /// One part at a time.
    fn show_one(&mut self, ui: &mut Ui, scene: &ProgramScene, actions: &mut Vec<ProgramAction>) {
        ui.horizontal(|ui| {
            for (view, name) in
                [(PanelTab::Setup, "Axes"), (PanelTab::Table, "Table"), (PanelTab::Plot, "Plot")]
            {
                ui.selectable_value(&mut self.view, view, name);
            }
        });
        match self.view {
            PanelTab::Setup => self.show_setup(ui, scene, actions),
            PanelTab::Table => {
                self.show_failed(ui, actions);
                self.show_table(ui, scene, actions);
            }
            PanelTab::Plot => {
                ui.horizontal(|ui| self.show_selected(ui, scene, actions));
                self.show_plot(ui);
            }
        }
    }
}
