//! The panels around the canvas, and what floats over them.

use std::time::Duration;

use eframe::egui::{self, CentralPanel, Panel, RichText, Ui};

use super::{Command, Editor, Lower, Middle, Wish, console, files, inspector};
use crate::canvas::{Action, Scene};
use crate::document::Edit;
use crate::drag::DraggedParam;
use crate::views::ViewerAction;

/// Width of the window in points below which the inspector would take the canvas its room.
pub const NARROW: f32 = 560.0;
/// Part of the window that it takes at most.
const INSPECTOR: f32 = 0.4;

/// How long a message stays.
const TOAST: Duration = Duration::from_secs(6);

impl Editor {
    pub(super) fn lower(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let mut is_open = self.is_lower_open;
        // A program needs more room than the log; each keeps the height that it was given.
        let (name, height) = match self.lower {
            Lower::Program => ("program", 400.0),
            Lower::Console | Lower::Values | Lower::Sheet => ("lower", 230.0),
        };
        // Whatever the window's size, some of the canvas stays in sight.
        let most = (ui.available_height() * 0.65).max(90.0);
        let panel = Panel::bottom(self.for_this_size(ui, name)).resizable(true);
        let panel = panel.default_size(height).min_size(90.0).max_size(most);
        panel.show_collapsible(ui, &mut is_open, |ui| {
            let Self { sessions, active, lower, console, shared, .. } = self;
            let session = &mut sessions[*active];
            match lower {
                Lower::Console => console.show(ui, session, wishes),
                Lower::Values => console::values(ui, session, wishes),
                Lower::Sheet => {
                    let pinned = session.pinned_values();
                    session.viewer.show_sheet(ui, &pinned);
                }
                Lower::Program => {
                    let (programs, scene) = session.programs(shared);
                    let actions = programs.show(ui, &scene);
                    wishes.extend(actions.into_iter().map(Wish::Program));
                }
            }
        });
        self.is_lower_open = is_open;
    }

    /// The name under which the height of a panel is remembered: in another room it has another
    /// one, so that a small window does not leave small panels behind.
    fn for_this_size(&self, ui: &Ui, name: &str) -> egui::Id {
        let rooms = (ui.ctx().content_rect().height() / 120.0) as u32;
        egui::Id::new((name, rooms, self.is_lower_open.then_some(self.lower)))
    }

    pub(super) fn right(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let width = ui.available_width();
        if !self.settings.has_inspector || width < NARROW {
            return;
        }
        let panel = Panel::right("inspector").resizable(true).default_size(330.0);
        panel.min_size(200.0).max_size(width * INSPECTOR).show(ui, |ui| {
            // Long rows are cut: they must neither push the canvas aside nor hide the names.
            egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                inspector::show(ui, &self.sessions[self.active], &self.shared, wishes);
            });
        });
    }

    pub(super) fn middle(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let has_pins = !self.session().pinned.is_empty();
        if self.middle == Middle::Both && has_pins {
            let room = ui.available_size();
            // Side by side where there is more width than height, as above a program.
            let (panel, all) = match room.x > 1.6 * room.y {
                true => (Panel::right(self.for_this_size(ui, "viewer beside")), room.x),
                false => (Panel::bottom(self.for_this_size(ui, "viewer")), room.y),
            };
            let panel = panel.resizable(true).default_size(all * 0.5);
            let panel = panel.min_size(all.min(120.0)).max_size(all * 0.7);
            panel.show(ui, |ui| self.viewer(ui, wishes));
        }
        if self.middle == Middle::Viewer && has_pins {
            CentralPanel::default().show(ui, |ui| self.viewer(ui, wishes));
            return;
        }
        CentralPanel::no_frame().show(ui, |ui| {
            files::disk_banner(self, ui);
            let Self { sessions, active, settings, .. } = self;
            let session = &mut sessions[*active];
            let pinned: Vec<_> = session.pinned.iter().cloned().collect();
            let scene = Scene {
                document: &session.document,
                runner: &session.runner,
                registry: session.runner.registry(),
                catalog: &session.catalog,
                settings: &settings.canvas,
                pinned: &pinned,
            };
            let actions = session.canvas.show(ui, &scene);
            wishes.extend(actions.into_iter().map(Wish::Canvas));
        });
    }

    fn viewer(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        // A panel remembers the size of what is in it: that is what a hand gave it, however much
        // there is to be seen.
        let rect = ui.max_rect();
        ui.expand_to_include_rect(rect);
        let ui = &mut ui.new_child(egui::UiBuilder::new().max_rect(rect));
        ui.set_clip_rect(ui.clip_rect().intersect(rect));
        let render = self.render.clone();
        let session = &mut self.sessions[self.active];
        let pinned = session.pinned_values();
        ui.push_id(session.document.id(), |ui| {
            // All maps of a window are looked at in one way.
            session.viewer.meshes.set_look(&self.settings.meshes);
            session.viewer.meshes.set_kept(&session.document.extras().kept);
            let actions = session.viewer.show(ui, &pinned, render.as_ref());
            self.settings.meshes = session.viewer.meshes.look();
            for action in actions {
                match action {
                    ViewerAction::Unpin(place) => {
                        let port = session.pinned.get_index(place).cloned();
                        wishes.extend(port.map(|port| Wish::Canvas(Action::Pin(port))));
                    }
                    ViewerAction::Keep(edits) => {
                        let edits = edits.into_iter().map(Edit::Keep).collect();
                        wishes.push(Wish::Canvas(Action::Edit(edits)));
                    }
                    ViewerAction::Say(text) => wishes.push(Wish::Say(text)),
                    // The viewer has done that.
                    ViewerAction::Pick(_) => {}
                    ViewerAction::TakePicture => wishes.push(Wish::Command(Command::Picture)),
                }
            }
        });
    }

    pub(super) fn show_toasts(&mut self, ui: &mut Ui) {
        self.toasts.retain(|(since, _)| since.elapsed() < TOAST);
        if self.toasts.is_empty() {
            return;
        }
        ui.ctx().request_repaint_after(Duration::from_millis(500));
        let area = egui::Area::new("messages".into()).order(egui::Order::Foreground);
        area.anchor(egui::Align2::CENTER_BOTTOM, [0.0, -36.0]).show(ui.ctx(), |ui| {
            for (_, text) in &self.toasts {
                egui::Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_max_width(560.0);
                    ui.label(RichText::new(text).color(ui.visuals().warn_fg_color));
                });
            }
        });
    }
}

/// Says what becomes of files that are held over the window.
pub fn show_hovered(ui: &Ui) {
    if ui.input(|input| input.raw.hovered_files.is_empty()) {
        return;
    }
    let area = egui::Area::new("hovered".into()).order(egui::Order::Foreground);
    area.anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0]).show(ui.ctx(), |ui| {
        egui::Frame::popup(ui.style()).inner_margin(24).show(ui, |ui| {
            ui.heading("Drop it here: a map is opened, a mesh gets a module that reads it.");
        });
    });
}

/// Names the parameter that is on its way to the program, beside the pointer.
pub fn show_dragged(ui: &Ui) {
    let Some(dragged) = egui::DragAndDrop::payload::<DraggedParam>(ui.ctx()) else {
        return;
    };
    let id = ui.id().with("dragged");
    let anchor = egui::PopupAnchor::Pointer;
    egui::Tooltip::always_open(ui.ctx().clone(), ui.layer_id(), id, anchor)
        .show(|ui| ui.label(format!("{}.{} into the program", dragged.node, dragged.param)));
}
