//! The directions of the axes, in a corner of the first picture.

use eframe::egui::{self, Align2, Color32, FontId, Rect, Stroke, vec2};
use glam::DVec3;

use super::Overlay;
use crate::views::camera::Camera;
use crate::views::mesh::look::settings::{Switch, SwitchHome};
use crate::views::mesh::scene::MeshScene;

/// The overlay of the axes.
#[derive(Default)]
pub struct Axes;

impl Overlay for Axes {
    fn switch(&self) -> Option<Switch> {
        Some(Switch {
            label: "Axes",
            doc: "The directions of x, y and z in a corner",
            home: SwitchHome::Menu,
            key: None,
            place: |settings| &mut settings.has_axes,
        })
    }

    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        if let (Some(viewpoint), Some(tile)) = (scene.viewpoints.first(), scene.tiles.first()) {
            paint_axes(&ui.painter_at(tile.rect), tile.rect, &viewpoint.camera);
        }
    }
}

/// Paints the directions of the axes into the lower left corner.
fn paint_axes(painter: &egui::Painter, rect: Rect, camera: &Camera) {
    const LENGTH: f32 = 26.0;
    if rect.width() < 4.0 * LENGTH || rect.height() < 4.0 * LENGTH {
        return;
    }
    let middle = rect.left_bottom() + vec2(1.6 * LENGTH, -1.6 * LENGTH);
    let view = camera.axes();
    let mut axes = [
        (DVec3::X, "x", Color32::from_rgb(220, 70, 70)),
        (DVec3::Y, "y", Color32::from_rgb(80, 170, 70)),
        (DVec3::Z, "z", Color32::from_rgb(70, 120, 230)),
    ];
    // From back to front.
    axes.sort_by(|a, b| view.back.dot(a.0).total_cmp(&view.back.dot(b.0)));
    for (axis, name, color) in axes {
        let to = vec2(view.right.dot(axis) as f32, -view.up.dot(axis) as f32);
        let color = if view.back.dot(axis) < -0.05 { color.gamma_multiply(0.6) } else { color };
        painter.line_segment([middle, middle + LENGTH * to], Stroke::new(2.0, color));
        let at = middle + (LENGTH + 8.0) * to;
        painter.text(at, Align2::CENTER_CENTER, name, FontId::proportional(12.0), color);
    }
}
