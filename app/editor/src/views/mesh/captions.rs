//! What is written and to be grasped over the pictures of meshes.

use eframe::egui::{self, Rect, Sense, vec2};

use super::item::{Item, Undrawable};
use super::layout::Tile;
use super::settings::{Arrangement, Settings};
use super::view::MeshInput;
use crate::views::number::counted;
use crate::views::values;

/// Names, counts and buttons; the place of a mesh that the user wants to see no longer.
pub fn captions(
    ui: &mut egui::Ui,
    meshes: &[MeshInput],
    tiles: &[Tile],
    items: &[Item],
    settings: &mut Settings,
) -> Option<usize> {
    let is_overlaid = settings.arrangement != Arrangement::SideBySide && tiles.len() == 2;
    let mut unpinned = None;
    for (at, tile) in tiles.iter().enumerate() {
        let title = &meshes[tile.item].title;
        let mut rect = tile.rect;
        if is_overlaid {
            let middle = rect.center().x;
            if at == 0 { rect.max.x = middle } else { rect.min.x = middle }
        }
        let text = caption(title, &items[tile.item]);
        if values::caption(ui, rect, &text, Some(title)) {
            unpinned = Some(tile.item);
        }
    }
    if is_overlaid && settings.arrangement == Arrangement::Wipe {
        wipe_handle(ui, tiles[0].rect, settings);
    }
    unpinned
}

fn wipe_handle(ui: &egui::Ui, rect: Rect, settings: &mut Settings) {
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

/// Name, counts, and what is going on; what is wrong with textures, in a second line.
fn caption(title: &str, item: &Item) -> String {
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
    let texture = item.texture_problem().map_or(String::new(), |problem| format!("\n{problem}"));
    counts + &edges + &state + &texture
}
