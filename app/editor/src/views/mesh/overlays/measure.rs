//! The tool that measures distances between two points that are clicked.

use eframe::egui::{self, Key, Modifiers, Rect, vec2};
use glam::DVec3;

use super::Overlay;
use super::distances::{paint_distance, paint_end};
use crate::kept::{KeptEdit, Shelf};
use crate::views::ViewerAction;
use crate::views::heading;
use crate::views::mesh::distance::Distance;
use crate::views::mesh::hand::click::ClickSearch;
use crate::views::mesh::look::settings::{Switch, SwitchHome};
use crate::views::mesh::scene::{MeshScene, Screen};

/// The overlay of the tool.
#[derive(Default)]
pub struct Measure {
    search: ClickSearch,
    /// The first point, and the mesh that it is on.
    first: Option<(DVec3, String)>,
    /// The frame in which it was shown last.
    frame: u64,
}

impl Overlay for Measure {
    fn switch(&self) -> Option<Switch> {
        Some(Switch {
            label: "Measure",
            doc: "Click two points: their distance stays, and is listed under Distances (M)",
            home: SwitchHome::Row,
            key: Some(Key::M),
            place: |settings| &mut settings.is_measuring,
        })
    }

    fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        if scene.is_still {
            return;
        }
        let frame = ui.ctx().cumulative_frame_nr();
        if frame > self.frame + 1 {
            // It was switched off in between.
            (self.first, self.search) = (None, ClickSearch::default());
        }
        self.frame = frame;
        if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
            && self.first.take().is_none()
        {
            scene.settings.is_measuring = false;
        }
        let clicked = self.search.take_in(ui, scene);
        let met = clicked.and_then(|clicked| Some((clicked.point, clicked.element?.title)));
        if let Some((point, title)) = met {
            self.first = match self.first.take() {
                None => Some((point, title)),
                Some((first, of)) => {
                    let (shelf, name) = (Shelf::Distances, scene.kept.free_name(Shelf::Distances));
                    let of = (of == title).then_some(of);
                    let content = Distance::content([first, point], of.as_deref());
                    let edit = KeptEdit::Put { shelf, name, content };
                    scene.actions.push(ViewerAction::Keep(edit));
                    None
                }
            };
        }
        self.paint(ui, scene);
    }
}

impl Measure {
    fn paint(&self, ui: &mut egui::Ui, scene: &MeshScene) {
        for response in scene.responses {
            let screen = Screen { rect: response.rect };
            let painter = ui.painter_at(screen.rect);
            let seen = |point| scene.camera.project(point, screen.aspect());
            let from = self.first.as_ref();
            let from = from.and_then(|(point, _)| Some(screen.place(seen(*point)?)));
            if let Some(from) = from {
                paint_end(&painter, from);
                if let Some(to) = response.hover_pos() {
                    paint_distance(&painter, [from, to], None);
                }
            }
            if response.hovered() {
                ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
            }
        }
        let Some(rect) = scene.responses.first().map(|response| response.rect) else { return };
        let hint = match self.first {
            None => "Click the first point. A click near a vertex takes the vertex. Esc ends.",
            Some(_) => "Click the second point. Esc forgets the first.",
        };
        // Beside the axes, at the bottom.
        let strip = Rect::from_min_max(rect.left_bottom() + vec2(86.0, -36.0), rect.right_bottom());
        if strip.is_positive() {
            heading::caption(ui, strip, hint, None);
        }
    }
}
