//! Pictures on nodes of what these give.

use eframe::egui::{
    Align2, Color32, Pos2, Rect, Sense, TextureId, Ui, Vec2, WidgetInfo, WidgetType,
};

use mve_core::{NodeMode, PortRef};

use super::Scene;
use super::paint::{Brush, ROWS_FROM, TITLES_FROM};
use super::shape::WIDTH;
use crate::runner::Status;
use crate::views::{Thumbnail, Thumbnails};

impl Brush<'_> {
    /// Whether nodes are large enough for pictures in them.
    pub fn shows_pictures(&self) -> bool {
        self.zoom() >= TITLES_FROM
    }

    /// Draws a picture into the middle of a space of the canvas; one of an earlier run is faint.
    fn picture(&self, space: Rect, picture: TextureId, size: Vec2, is_old: bool) {
        let space = self.view.rect_to_screen(space);
        self.picture_ground(space);
        let factor = (space.width() / size.x).min(space.height() / size.y);
        let rect = Rect::from_center_size(space.center(), size * factor);
        let tint = Color32::WHITE.gamma_multiply(if is_old { 0.4 } else { 1.0 });
        let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        self.painter.image(picture, rect, all, tint);
    }

    /// Says why there is no picture in a space of the canvas.
    fn no_picture(&self, space: Rect, text: &str) {
        let space = self.view.rect_to_screen(space);
        self.picture_ground(space);
        if self.zoom() >= ROWS_FROM {
            let width = WIDTH - 24.0;
            self.line(space.center(), Align2::CENTER_CENTER, text, 10.0, width, self.palette.faint);
        }
    }

    fn picture_ground(&self, space: Rect) {
        self.painter.rect_filled(space, 3.0 * self.zoom(), self.palette.edge.gamma_multiply(0.35));
    }
}

/// Draws the picture of what a node gives into a space of the canvas.
pub fn show_picture(
    thumbnails: &mut Thumbnails,
    ui: &Ui,
    brush: &Brush,
    scene: &Scene,
    (name, space): (&str, Rect),
) {
    let (map, runner) = (scene.document.map(), scene.runner);
    let node = map.nodes.get(name);
    let module = node.and_then(|node| scene.registry.of(node));
    let outputs = module.map_or(&[][..], |info| info.module.outputs);
    let mut text = match node.map(|node| node.mode) {
        Some(NodeMode::Muted) => "is muted",
        Some(NodeMode::Bypassed) => "nothing passes through",
        _ => "not run yet",
    };
    for output in outputs.iter().filter(|output| Thumbnails::are_of(output.data_type)) {
        let port = PortRef { node: name.to_owned(), port: output.name.to_owned() };
        let Some(from) = runner.source(map, &port) else { continue };
        let value = runner.value(&from.node, &from.port);
        let Some((ended, value)) = runner.ended(&from.node).zip(value) else { continue };
        // One that waits for its turn in a run may well be the same again.
        let is_fresh =
            |status| matches!(status, Status::Done(_) | Status::Cached(_) | Status::Waiting);
        let is_old = !is_fresh(runner.status(&from.node));
        match thumbnails.of(ui.ctx(), (ended.record.key, from.port), &value) {
            Thumbnail::Picture(picture) => {
                brush.picture(space, picture.id(), picture.size_vec2(), is_old);
                return name_picture(ui, brush, name, space, "");
            }
            Thumbnail::Awaited => {
                text = "\u{2026}";
                break;
            }
            Thumbnail::Nothing => text = "nothing to be seen",
        }
    }
    brush.no_picture(space, text);
    name_picture(ui, brush, name, space, text);
}

/// Says to a screen reader what there is to be seen of a node.
fn name_picture(ui: &Ui, brush: &Brush, node: &str, space: Rect, text: &str) {
    let space = brush.view.rect_to_screen(space);
    let response = ui.interact(space, ui.id().with(("picture", node)), Sense::hover());
    let text = if text.is_empty() { String::new() } else { format!(": {text}") };
    let label = format!("picture of {node}{text}");
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, &label));
}
