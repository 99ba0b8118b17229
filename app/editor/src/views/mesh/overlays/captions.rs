//! Name, counts and state of each mesh, written over its picture.

use eframe::egui::{self, Color32, Rect, vec2};

use super::Overlay;
use crate::views::ViewerAction;
use crate::views::heading;
use crate::views::mesh::item::{MeshItem, Undrawable};
use crate::views::mesh::outline::outline_color;
use crate::views::mesh::scene::MeshScene;
use crate::views::mesh::viewpoint::is_each_fitted;
use crate::views::number::{counted, number_text};

/// The overlay of names and counts, each with a button to unpin the mesh.
#[derive(Default)]
pub struct Captions;

impl Overlay for Captions {
    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        let is_each_fitted = is_each_fitted(scene.settings, scene.items);
        for (at, tile) in scene.tiles.iter().enumerate() {
            let mesh = &scene.meshes[tile.item];
            let mut rect = tile.rect;
            if scene.is_overlaid() {
                let middle = rect.center().x;
                if at == 0 { rect.max.x = middle } else { rect.min.x = middle }
            }
            if scene.plane.is_some() {
                // The color of its outline.
                let [r, g, b, _] = outline_color(tile.item).map(|part| (255.0 * part) as u8);
                let mark = Rect::from_min_size(rect.min + vec2(0.0, 5.0), vec2(4.0, 20.0));
                ui.painter_at(rect).rect_filled(mark, 0.0, Color32::from_rgb(r, g, b));
            }
            let text = caption(&mesh.title, &scene.items[tile.item], is_each_fitted);
            if heading::caption(ui, rect, &text, (!scene.is_still).then_some(&*mesh.title)) {
                scene.actions.push(ViewerAction::Unpin(mesh.place));
            }
        }
    }
}

/// Name, counts, and what is going on; what is wrong with textures, in a second line.
fn caption(title: &str, item: &MeshItem, has_own_scale: bool) -> String {
    let mesh = &item.mesh;
    let counts = format!(
        "{title}: {}, {}",
        counted(mesh.faces.len(), "face", "faces"),
        counted(mesh.positions.len(), "vertex", "vertices"),
    );
    let state = match item.prepared().as_deref() {
        _ if item.is_lost() => ", cannot be shown: preparing it failed".to_owned(),
        None => ", preparing…".to_owned(),
        Some(Err(Undrawable::Empty)) => ", nothing to draw".to_owned(),
        Some(Err(Undrawable::TooLarge)) => ", larger than the GPU takes".to_owned(),
        Some(Ok(prepared)) => match prepared.arrays.n_left_out(mesh) {
            0 => String::new(),
            n => format!(", {} not drawn: not finite", counted(n, "face", "faces")),
        },
    };
    let edges = item.edges().map_or(String::new(), |edges| {
        let bad = match edges.n_non_manifold {
            0 => String::new(),
            n => format!(", {}", counted(n, "non-manifold edge", "non-manifold edges")),
        };
        match edges.n_border {
            0 => format!(", closed{bad}"),
            n => format!(", {}{bad}", counted(n, "border edge", "border edges")),
        }
    });
    let size = item.bounds().filter(|_| has_own_scale);
    let size = size.map(|bounds| format!(", diagonal {}", number_text(2.0 * bounds.radius())));
    let texture = item.texture_problem().map_or(String::new(), |problem| format!("\n{problem}"));
    counts + &edges + &size.unwrap_or_default() + &state + &texture
}
