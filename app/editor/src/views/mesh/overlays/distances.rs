//! The distances that were measured: a line each, with its length.

use eframe::egui::{self, Color32, FontId, Pos2, Rect, Stroke, vec2};

use super::Overlay;
use crate::views::mesh::scene::{MeshScene, Screen};
use crate::views::mesh::viewpoint::Viewpoint;
use crate::views::number::number_text;

/// The overlay of the lines.
#[derive(Default)]
pub struct Distances;

const LINE: Color32 = Color32::from_rgb(255, 200, 40);
const SHADOW: Color32 = Color32::from_black_alpha(170);

impl Overlay for Distances {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        // Two pictures over each other are one, with the distances of both.
        let is_each_its_own = scene.responses.len() == scene.tiles.len();
        for (at, response) in scene.responses.iter().enumerate() {
            let tiles = if is_each_its_own { &scene.tiles[at..=at] } else { scene.tiles };
            let titles = || tiles.iter().map(|tile| scene.meshes[tile.item].title.as_str());
            let screen = Screen { rect: response.rect };
            let painter = ui.painter_at(screen.rect);
            let Some(Viewpoint { camera, .. }) = scene.viewpoints.get(at) else { continue };
            let place = |point| Some(screen.place(camera.project(point, screen.aspect())?));
            for distance in &scene.settings.distances {
                let [Some(a), Some(b)] = distance.ends.map(place) else { continue };
                if titles().any(|title| distance.is_of(title)) {
                    paint_distance(&painter, [a, b], Some(&number_text(distance.length())));
                } else {
                    // On another mesh: a length there would be one that nobody has measured.
                    painter.line_segment([a, b], Stroke::new(1.0, LINE.gamma_multiply(0.35)));
                }
            }
        }
    }
}

/// Paints one end.
pub fn paint_end(painter: &egui::Painter, at: Pos2) {
    painter.circle(at, 3.5, LINE, Stroke::new(1.0, SHADOW));
}

/// Paints a line with its ends, and its length in words beside its middle.
pub fn paint_distance(painter: &egui::Painter, ends: [Pos2; 2], text: Option<&str>) {
    for (width, color) in [(3.5, SHADOW), (1.5, LINE)] {
        painter.line_segment(ends, Stroke::new(width, color));
    }
    ends.into_iter().for_each(|end| paint_end(painter, end));
    let Some(text) = text else { return };
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.0), LINE);
    let at = ends[0].lerp(ends[1], 0.5) + vec2(-0.5 * galley.size().x, 6.0);
    let ground = Rect::from_min_size(at, galley.size()).expand2(vec2(3.0, 1.0));
    painter.rect_filled(ground, 3.0, SHADOW);
    painter.galley(at, galley, LINE);
}
