//! The list of distances that were measured.

use eframe::egui;

use super::{Wishes, menu};
use crate::kept::{KeptEdit, Shelf};
use crate::views::mesh::distance::Distance;
use crate::views::number::number_text;

/// A menu with the list; none without a distance.
pub fn distances_menu(ui: &mut egui::Ui, distances: &[Distance], wishes: &mut Wishes) {
    if distances.is_empty() {
        return;
    }
    let list = |ui: &mut egui::Ui| {
        egui::Grid::new("distances").show(ui, |ui| {
            for distance in distances {
                row(ui, distance, wishes);
                ui.end_row();
            }
        });
        ui.separator();
        if ui.button("Remove all distances").clicked() {
            let remove = |one: &Distance| KeptEdit::Remove {
                shelf: Shelf::Distances,
                name: one.name.clone(),
            };
            wishes.kept.extend(distances.iter().map(remove));
        }
    };
    menu(ui, "Distances", list).on_hover_text("What was measured, in units of the model");
}

fn row(ui: &mut egui::Ui, distance: &Distance, wishes: &mut Wishes) {
    let name = &distance.name;
    ui.label(name);
    ui.label(number_text(distance.length()));
    let copy = ui.small_button("Copy");
    let label = format!("Copy {name}");
    copy.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, &label));
    if copy.on_hover_text("Length and both ends, with tabs between").clicked() {
        ui.ctx().copy_text(distance.to_text());
    }
    let remove = ui.small_button("×");
    let label = format!("Remove {name}");
    remove.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, &label));
    if remove.on_hover_text("Ctrl+Z brings it back").clicked() {
        wishes.kept.push(KeptEdit::Remove { shelf: Shelf::Distances, name: name.clone() });
    }
}
