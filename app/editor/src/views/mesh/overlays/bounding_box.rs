//! The box around a mesh, with its lengths.

use eframe::egui::{Align2, FontId, Pos2, Stroke, Vec2, vec2};

use super::{Depth, Overlay};
use crate::views::camera::Bounds;
use crate::views::mesh::look::settings::{Switch, SwitchHome};
use crate::views::mesh::scene::MeshPicture;
use crate::views::number::number_text;

/// The overlay of the box.
#[derive(Default)]
pub struct BoundingBox;

impl Overlay for BoundingBox {
    fn switch(&self) -> Option<Switch> {
        Some(Switch {
            label: "Box with lengths",
            doc: "The box around each mesh",
            home: SwitchHome::Menu,
            key: None,
            place: |settings| &mut settings.has_box,
        })
    }

    fn paint(&self, layer: Depth, picture: &MeshPicture) {
        if let Some(bounds) = &picture.bounds {
            paint_box(layer, picture, bounds);
        }
    }
}

/// Paints the edges behind what is in the box, or the others, with the lengths.
fn paint_box(layer: Depth, picture: &MeshPicture, bounds: &Bounds) {
    let MeshPicture { painter, screen, camera, line_color: color, .. } = picture;
    let corners = bounds.corners();
    let eye_depth = |i: &usize| -camera.view_of(corners[*i]).z;
    // Of a box that is seen from outside, just the edges at the farthest corner are hidden.
    let Some(farthest) = (0..8).max_by(|a, b| eye_depth(a).total_cmp(&eye_depth(b))) else {
        return;
    };
    let aspect = screen.aspect();
    for axis in 0..3 {
        let mut labeled: Option<(Pos2, f32)> = None;
        let middle_of_box = camera.project(bounds.center(), aspect).map(|at| screen.place(at));
        for from in (0..8usize).filter(|i| i >> axis & 1 == 0) {
            let to = from | 1 << axis;
            let is_behind = from == farthest || to == farthest;
            let ends = [from, to].map(|i| camera.project(corners[i], aspect));
            let [Some(a), Some(b)] = ends.map(|at| at.map(|at| screen.place(at))) else { continue };
            if is_behind == (layer == Depth::Behind) {
                painter.line_segment([a, b], Stroke::new(1.0, *color));
            }
            // The edge that is farthest out has free space beyond it; of two, the lower one.
            let middle = a + 0.5 * (b - a);
            let out = middle_of_box.map_or(Vec2::ZERO, |center| middle - center);
            let score = out.length() + 0.2 * out.y;
            if labeled.is_none_or(|(_, best)| score > best) && (b - a).length() > 24.0 {
                labeled = Some((middle + 14.0 * out.normalized() * vec2(1.8, 1.0), score));
            }
        }
        if let (Some((place, _)), Depth::Ahead, false) = (labeled, layer, picture.is_above) {
            let length = (bounds.high - bounds.low)[axis];
            let text = format!("{} {}", ["x", "y", "z"][axis], number_text(length));
            painter.text(place, Align2::CENTER_CENTER, text, FontId::proportional(12.0), *color);
        }
    }
}
