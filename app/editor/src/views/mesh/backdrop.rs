//! What is behind the pictures of meshes.

use eframe::egui::{self, Color32, Rect};

/// A quiet gradient that fits the theme.
pub fn paint_background(painter: &egui::Painter, rect: Rect, is_dark: bool) {
    let (top, bottom) = match is_dark {
        true => (Color32::from_rgb(58, 62, 70), Color32::from_rgb(28, 30, 34)),
        false => (Color32::from_rgb(250, 251, 253), Color32::from_rgb(206, 212, 220)),
    };
    let mut mesh = egui::Mesh::default();
    for (place, color) in [
        (rect.left_top(), top),
        (rect.right_top(), top),
        (rect.right_bottom(), bottom),
        (rect.left_bottom(), bottom),
    ] {
        mesh.colored_vertex(place, color);
    }
    mesh.add_triangle(0, 1, 2);
    mesh.add_triangle(0, 2, 3);
    painter.add(mesh);
}
