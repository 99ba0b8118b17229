//! The line between two meshes of which each is seen on one side of it.

use eframe::egui::{self, Rect, Sense, vec2};

use super::Overlay;
use crate::views::mesh::look::settings::{Arrangement, MeshSettings};
use crate::views::mesh::scene::MeshScene;

/// The overlay of the line, which the pointer moves.
#[derive(Default)]
pub struct WipeLine;

impl Overlay for WipeLine {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        if scene.is_overlaid() && scene.settings.arrangement == Arrangement::Wipe {
            show_line(ui, scene.tiles[0].rect, scene.settings);
        }
    }
}

fn show_line(ui: &egui::Ui, rect: Rect, settings: &mut MeshSettings) {
    let x = rect.left() + settings.balance * rect.width();
    let line = Rect::from_x_y_ranges(x..=x, rect.y_range());
    let id = ui.id().with("wipe line");
    let response = ui.interact(line.expand2(vec2(5.0, 0.0)), id, Sense::drag());
    let label = "Line between the two meshes";
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Slider, true, label));
    if response.dragged() {
        let moved = response.drag_delta().x / rect.width();
        settings.balance = (settings.balance + moved).clamp(0.0, 1.0);
    }
    if response.hovered() || response.dragged() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
    }
    let stroke = egui::Stroke::new(2.0, ui.visuals().text_color());
    ui.painter_at(rect).line_segment([line.center_top(), line.center_bottom()], stroke);
}
