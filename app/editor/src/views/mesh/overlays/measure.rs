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
use crate::views::mesh::viewpoint::Viewpoint;

/// The overlay of the tool.
#[derive(Default)]
pub struct Measure {
    search: ClickSearch,
    /// The first point, and the mesh that it is on.
    first: Option<(DVec3, String)>,
    /// Whether keys went elsewhere when it was shown last: to a field, a menu or a dialog.
    is_elsewhere: bool,
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
        if self.takes_keys(ui, scene)
            && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape))
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
                    scene.actions.push(ViewerAction::Keep(vec![edit]));
                    None
                }
            };
        }
        self.paint(ui, scene);
    }

    fn rest(&mut self) {
        *self = Self::default();
    }

    fn is_busy(&self) -> bool {
        self.search.is_busy()
    }
}

impl Measure {
    /// Whether keys are meant for it: a picture has the focus, or the pointer while nothing else
    /// has it. What a key closes or leaves has lost the focus when this is asked.
    fn takes_keys(&mut self, ui: &egui::Ui, scene: &MeshScene) -> bool {
        let had_focus = |memory: &egui::Memory, one: &egui::Response| {
            memory.has_focus(one.id) || memory.had_focus_last_frame(one.id)
        };
        let (has_picture, has_other) = ui.memory(|memory| {
            let has_picture = scene.responses.iter().any(|one| had_focus(memory, one));
            let is_covered = memory.top_modal_layer().is_some();
            (has_picture, memory.focused().is_some() && !has_picture || is_covered)
        });
        let is_elsewhere = has_other || egui::Popup::is_any_open(ui.ctx());
        let was_elsewhere = std::mem::replace(&mut self.is_elsewhere, is_elsewhere);
        let is_pointed_at = scene.responses.iter().any(egui::Response::hovered);
        !(is_elsewhere || was_elsewhere) && (has_picture || is_pointed_at)
    }

    fn paint(&self, ui: &mut egui::Ui, scene: &MeshScene) {
        for (response, Viewpoint { camera, .. }) in scene.responses.iter().zip(scene.viewpoints) {
            let screen = Screen { rect: response.rect };
            let painter = ui.painter_at(screen.rect);
            let seen = |point| camera.project(point, screen.aspect());
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
