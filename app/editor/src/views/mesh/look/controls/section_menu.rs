//! The menu of the plane that cuts meshes, and its slider.

use eframe::egui;
use glam::DVec3;

use super::{Offers, menu};
use crate::views::camera::Camera;
use crate::views::make_room;
use crate::views::mesh::look::settings::MeshSettings;
use crate::views::mesh::section::Section;
use crate::views::number::number_text;

/// The menu, and the slider while something is cut.
pub fn section_controls(
    ui: &mut egui::Ui,
    settings: &mut MeshSettings,
    camera: &Camera,
    offers: &Offers,
) {
    let section = &mut settings.section;
    let shown = menu(ui, "Section", |ui| section_menu(ui, section, camera, offers));
    shown.on_hover_text("Cut the meshes by a plane (X)");
    let Some((bounds, plane)) = offers.bounds.and_then(|all| Some((all, section.plane(&all)?)))
    else {
        return;
    };
    make_room(ui, 290.0);
    ui.label("Plane at");
    let [low, high] = section.range(&bounds);
    let mut offset = plane.offset;
    // A plane that a kept view puts elsewhere stays there until a hand moves it.
    let slider = egui::Slider::new(&mut offset, low..=high).show_value(false).smart_aim(false);
    let slider = ui.add(slider.clamping(egui::SliderClamping::Edits));
    let tip = "Where the plane is along its normal: Alt + drag, or [ and ], move it too";
    let field = egui::DragValue::new(&mut offset).speed((high - low) / 200.0).range(low..=high);
    let field = field.clamp_existing_to_range(false).update_while_editing(false);
    let field = ui.add(field.custom_formatter(|number, _| number_text(number)));
    for (response, name) in [(&slider, "slider of the plane"), (&field, "offset of the plane")] {
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
    }
    let is_moved = slider.on_hover_text(tip).changed() | field.on_hover_text(tip).changed();
    if is_moved && offset.is_finite() {
        section.offset = Some(offset);
    }
    if ui.button("Flip").on_hover_text("Cut the other side away (F)").clicked() {
        section.flip();
    }
}

fn section_menu(ui: &mut egui::Ui, section: &mut Section, camera: &Camera, offers: &Offers) {
    let mut is_on = section.is_on;
    if ui.checkbox(&mut is_on, "Cut by a plane").on_hover_text("X does the same").changed() {
        section.toggle(camera);
    }
    ui.separator();
    ui.label("Across");
    let axes = [(DVec3::X, "x axis"), (DVec3::Y, "y axis"), (DVec3::Z, "z axis")];
    for (axis, label) in axes {
        if ui.radio(section.is_across(axis), label).clicked() {
            section.is_on = true;
            // It faces the viewer, so that the cut is seen.
            let is_away = camera.axes().back.dot(axis) < 0.0;
            section.face(if is_away { -axis } else { axis });
        }
    }
    let back = camera.axes().back;
    let is_as_seen = section.normal.dot(back) > 1.0 - 1e-9;
    let button = ui.radio(is_as_seen, "the direction of view");
    if button.on_hover_text("Parallel to the screen, as it is now").clicked() {
        section.is_on = true;
        section.face(back);
    }
    ui.separator();
    if offers.titles.len() > 1 {
        ui.checkbox(&mut section.has_all_outlines, "Outlines of all in each picture")
            .on_hover_text("One over the other, so that two meshes are compared along the cut");
    }
    if ui.button("Through the middle").clicked() {
        section.offset = None;
    }
}
