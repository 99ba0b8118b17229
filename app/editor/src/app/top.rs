//! Menus, the bar of buttons, the tabs of open maps, and the line at the bottom.

use std::path::PathBuf;

use eframe::egui::{self, Button, Panel, ProgressBar, RichText, Ui};
use mve_modules::data::TriMesh;

use super::commands::ASKS_FIRST;
use super::panels::NARROW;
use super::{Command, Editor, Lower, Middle, Session, Theme, Wish};
use crate::canvas::Action;
use crate::document::{Edit, Item};
use crate::runner::{PART_OF_ANOTHER, RunProgress, seconds_text};

/// A line of a menu that gives a command.
fn entry(ui: &mut Ui, label: &str, keys: &str, is_on: bool) -> bool {
    ui.add_enabled(is_on, Button::new(label).shortcut_text(keys)).clicked()
}

/// A line about trouble, whole on hover; whether it was clicked.
fn trouble(ui: &mut Ui, text: &str) -> bool {
    let color = ui.visuals().error_fg_color;
    let label = egui::Label::new(RichText::new(text).color(color)).truncate();
    ui.add(label.sense(egui::Sense::click())).on_hover_text(text).clicked()
}

/// Where a map without trouble stands.
fn state_text(session: &Session) -> String {
    if session.runner.is_running() {
        return "Running.".to_owned();
    }
    if session.document.map().nodes.is_empty() {
        return "The map is empty: press Tab on the canvas to add a module.".to_owned();
    }
    if session.is_part() {
        return PART_OF_ANOTHER.to_owned();
    }
    if let Some(node) = session.first_stopped() {
        return format!("{node} was stopped before it was done: Run (F5) starts it again.");
    }
    let time = || session.runner.last_run().map(|time| seconds_text(time.as_secs_f64()));
    match (session.has_changes_to_run(), time()) {
        (Some(true), _) => "Up to date, but for files: Run (F5) writes them.".to_owned(),
        (Some(false), _) if session.asks_first() => format!("Ready to run (F5); {ASKS_FIRST}."),
        (Some(false), _) => "Ready to run (F5).".to_owned(),
        (None, Some(time)) => format!("Up to date; the last run took {time}."),
        (None, None) => "Up to date.".to_owned(),
    }
}

/// The node that works, how far it is, and how many are done.
fn progress_text(progress: &RunProgress) -> String {
    let RunProgress { working, n_ended, n_nodes, elapsed } = progress;
    let elapsed = seconds_text(elapsed.as_secs_f64());
    match working {
        Some((node, share)) => {
            let at = (n_ended + 1).min(*n_nodes);
            format!("{node} {:.0} %, {at} of {n_nodes}, {elapsed}", share * 100.0)
        }
        None => elapsed,
    }
}

impl Editor {
    pub(super) fn top(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        // Menus and buttons in one row, where there is room for them.
        let is_narrow = ui.available_width() < 760.0;
        Panel::top("menus").show(ui, |ui| {
            egui::MenuBar::new().ui(ui, |ui| {
                ui.menu_button("File", |ui| self.file_menu(ui, wishes));
                ui.menu_button("Edit", |ui| self.edit_menu(ui, wishes));
                ui.menu_button("View", |ui| self.view_menu(ui));
                ui.menu_button("Run", |ui| self.run_menu(ui, wishes));
                ui.menu_button("Help", |ui| {
                    if entry(ui, "Keys and gestures", "F1", true) {
                        wishes.push(Wish::Command(Command::Shortcuts));
                    }
                    if entry(ui, "Open the example", "", true) {
                        wishes.push(Wish::Command(Command::Example));
                    }
                    ui.separator();
                    ui.weak(format!("mve {}", mve_core::VERSION));
                });
                if !is_narrow {
                    ui.separator();
                    self.buttons(ui, wishes);
                }
            });
            if is_narrow {
                ui.horizontal_wrapped(|ui| self.buttons(ui, wishes));
            }
        });
        Panel::top("tabs").show(ui, |ui| self.tabs(ui, wishes));
    }

    fn file_menu(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let mut command = |ui: &mut Ui, label, keys, is_on, command| {
            if entry(ui, label, keys, is_on) {
                wishes.push(Wish::Command(command));
            }
        };
        command(ui, "New map", "Ctrl+N", true, Command::New);
        command(ui, "Open…", "Ctrl+O", true, Command::Open);
        let recent = ui.menu_button("Open recent", |ui| self.recent(ui));
        command(ui, "Open the example", "", true, Command::Example);
        ui.separator();
        command(ui, "Save", "Ctrl+S", true, Command::Save);
        command(ui, "Save as…", "Ctrl+Shift+S", true, Command::SaveAs);
        let pinned = self.session().pinned_values();
        let mut values = pinned.iter().filter_map(|pinned| pinned.value.as_ref());
        let has_mesh = values.any(|value| value.get::<TriMesh>().is_some());
        command(ui, "Save picture of the meshes…", "", has_mesh, Command::Picture);
        command(ui, "Close map", "Ctrl+W", true, Command::Close(self.active));
        ui.separator();
        command(ui, "Quit", "Ctrl+Q", true, Command::Quit);
        let recent = recent.inner.flatten().map(Command::OpenPath);
        wishes.extend(recent.map(Wish::Command));
    }

    /// Maps that were open before; the one that was chosen.
    fn recent(&self, ui: &mut Ui) -> Option<PathBuf> {
        if self.settings.recent.is_empty() {
            ui.weak("none yet");
        }
        let is_chosen = |path: &&PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            ui.button(name).on_hover_text(path.display().to_string()).clicked()
        };
        // All are shown, whichever is clicked.
        let chosen: Vec<&PathBuf> = self.settings.recent.iter().filter(is_chosen).collect();
        chosen.first().map(|path| (*path).clone())
    }

    fn edit_menu(&self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let document = &self.session().document;
        let undo = document.undo_label().map(|label| format!("Undo: {label}"));
        let redo = document.redo_label().map(|label| format!("Redo: {label}"));
        if entry(ui, undo.as_deref().unwrap_or("Undo"), "Ctrl+Z", undo.is_some()) {
            wishes.push(Wish::Command(Command::Undo));
        }
        if entry(ui, redo.as_deref().unwrap_or("Redo"), "Ctrl+Shift+Z", redo.is_some()) {
            wishes.push(Wish::Command(Command::Redo));
        }
        ui.separator();
        let has_selection = !document.selection().is_empty();
        if entry(ui, "Cut", "Ctrl+X", has_selection) {
            wishes.push(Wish::Command(Command::Cut));
        }
        if entry(ui, "Copy", "Ctrl+C", has_selection) {
            wishes.push(Wish::Command(Command::Copy));
        }
        if entry(ui, "Paste", "Ctrl+V", true) {
            wishes.push(Wish::Command(Command::Paste));
        }
        if entry(ui, "Duplicate", "Ctrl+D", has_selection) {
            wishes.push(Wish::Canvas(Action::Duplicate));
        }
        let items: Vec<Item> = document.selection().iter().cloned().collect();
        if entry(ui, "Delete", "Del", has_selection) {
            wishes.push(Wish::Canvas(Action::Edit(vec![Edit::Remove(items)])));
        }
        if entry(ui, "Select all", "Ctrl+A", true) {
            wishes.push(Wish::Canvas(Action::Select(document.all_items())));
        }
        if entry(ui, "Find a node…", "Ctrl+F", true) {
            wishes.push(Wish::Command(Command::Find));
        }
        if entry(ui, "Arrange all", "L", true) {
            wishes.push(Wish::Canvas(Action::Edit(vec![Edit::Arrange { nodes: Vec::new() }])));
        }
    }

    fn view_menu(&mut self, ui: &mut Ui) {
        if entry(ui, "Show all", "Home", true) {
            self.session_mut().canvas.fit();
        }
        ui.separator();
        for (middle, label) in [
            (Middle::Both, "Canvas and viewer"),
            (Middle::Canvas, "Canvas alone"),
            (Middle::Viewer, "Viewer alone"),
        ] {
            ui.radio_value(&mut self.middle, middle, label);
        }
        ui.separator();
        let canvas = &mut self.settings.canvas;
        ui.checkbox(&mut canvas.snaps, "Snap to the grid");
        ui.checkbox(&mut canvas.wheel_zooms, "The wheel zooms")
            .on_hover_text("Off: it scrolls, and zooms with the control key.");
        ui.checkbox(&mut canvas.shows_pictures, "Pictures on all nodes")
            .on_hover_text("What each node gives, as a small picture (P for the selected nodes)");
        ui.checkbox(&mut canvas.shows_times, "Show where the time goes")
            .on_hover_text("Colors the title of each node by its part of the seconds: blue for little, red for most.");
        ui.separator();
        let before = self.settings.clone();
        ui.horizontal(|ui| {
            ui.label("Theme");
            for (theme, label) in
                [(Theme::System, "System"), (Theme::Dark, "Dark"), (Theme::Light, "Light")]
            {
                ui.selectable_value(&mut self.settings.theme, theme, label);
            }
        });
        ui.horizontal(|ui| {
            ui.label("Size");
            for scale in [0.8, 1.0, 1.25, 1.5, 2.0] {
                let label = format!("{:.0} %", scale * 100.0);
                ui.selectable_value(&mut self.settings.scale, scale, label);
            }
        });
        if self.settings != before {
            self.settings.apply(ui.ctx());
        }
    }

    fn run_menu(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let is_running = self.session().runner.is_running();
        if entry(ui, "Run", "F5", !self.session().is_part()) {
            wishes.push(Wish::Command(Command::Run));
        }
        if entry(ui, "Stop", "Shift+Esc", is_running) {
            wishes.push(Wish::Command(Command::Stop));
        }
        ui.checkbox(&mut self.settings.runs_on_edit, "Run on edit")
            .on_hover_text("Runs what a change touches at once. Files are written by Run only.");
    }

    fn buttons(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let progress = self.session().runner.progress();
        let (label, hint, command) = match progress {
            Some(_) => ("\u{23f9} Stop", "Stop the run (Shift+Esc)", Command::Stop),
            None => ("\u{25b6} Run", "Run the map (F5)", Command::Run),
        };
        // Of one size, so that the rest of the bar stays where it is.
        let button = Button::new(RichText::new(label).strong()).min_size(egui::vec2(64.0, 0.0));
        let is_on = progress.is_some() || !self.session().is_part();
        let button = ui.add_enabled(is_on, button).on_hover_text(hint);
        if button.on_disabled_hover_text(PART_OF_ANOTHER).clicked() {
            wishes.push(Wish::Command(command));
        }
        ui.checkbox(&mut self.settings.runs_on_edit, "on edit")
            .on_hover_text("Run what a change touches at once. Files are written by Run only.");
        if ui.button("+ Module").on_hover_text("Search a module and add it (Tab)").clicked() {
            self.session_mut().canvas.open_search();
        }
        ui.separator();
        for (lower, label, hint) in [
            (Lower::Program, "Program", "Runs of the map with varied parameters, as a table"),
            (Lower::Values, "Values", "All ports of the selected nodes and their values"),
            (
                Lower::Sheet,
                "Spreadsheet",
                "Vertices, corners and faces of what is shown, as a table",
            ),
            (Lower::Console, "Console", "What modules said"),
        ] {
            let is_shown = self.is_lower_open && self.lower == lower;
            if ui.selectable_label(is_shown, label).on_hover_text(hint).clicked() {
                self.is_lower_open = !is_shown;
                self.lower = lower;
            }
        }
        let has_room = ui.ctx().content_rect().width() >= NARROW;
        ui.add_enabled_ui(has_room, |ui| {
            ui.toggle_value(&mut self.settings.has_inspector, "Inspector")
                .on_hover_text("All about the selected node, beside the canvas")
                .on_disabled_hover_text("The window is too narrow for it");
        });
        if let Some(progress) = progress {
            let share = progress.working.as_ref().map_or(0.0, |(_, share)| *share);
            let bar = ProgressBar::new(share as f32).text(progress_text(&progress));
            ui.add(bar.desired_width(260.0)).on_hover_text("The node that works, and the run");
        }
    }

    fn tabs(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        ui.horizontal_wrapped(|ui| {
            for (place, session) in self.sessions.iter().enumerate() {
                let mark = if session.document.is_dirty() { " •" } else { "" };
                let running = if session.runner.is_running() { "\u{25b6} " } else { "" };
                let label = format!("{running}{}{mark}", session.title());
                let tab = ui.selectable_label(place == self.active, label);
                let path = session.document.path().map(|path| path.display().to_string());
                let tab = tab.on_hover_text(path.unwrap_or_else(|| "not saved yet".to_owned()));
                if tab.clicked() {
                    self.active = place;
                }
                let close = ui.small_button("\u{d7}").on_hover_text("Close this map");
                let name = format!("close {}", session.title());
                close.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::WidgetType::Button, true, &name)
                });
                if close.clicked() || tab.middle_clicked() {
                    wishes.push(Wish::Command(Command::Close(place)));
                }
                ui.separator();
            }
            let new = ui.small_button("+").on_hover_text("New map (Ctrl+N)");
            new.widget_info(|| {
                egui::WidgetInfo::labeled(egui::WidgetType::Button, true, "new map")
            });
            if new.clicked() {
                wishes.push(Wish::Command(Command::New));
            }
        });
    }

    pub(super) fn status_bar(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        Panel::bottom("status").show(ui, |ui| {
            ui.horizontal(|ui| {
                let session = self.session();
                let problems = session.runner.problems();
                let n_errors = problems.iter().filter(|problem| problem.is_error()).count();
                if n_errors > 0 {
                    let first = problems.iter().find(|problem| problem.is_error());
                    let what = if n_errors == 1 {
                        "1 problem".to_owned()
                    } else {
                        format!("{n_errors} problems")
                    };
                    let text = first.map_or(what.clone(), |first| format!("{what}: {first}"));
                    if trouble(ui, &text)
                        && let Some(node) = first.and_then(|first| first.place.node.clone())
                    {
                        wishes.push(Wish::ShowNode(node));
                    }
                } else if let Some((node, error)) = session.first_failure() {
                    if trouble(ui, &format!("{node} failed: {error}")) {
                        wishes.push(Wish::ShowNode(node.to_owned()));
                    }
                } else {
                    let text = state_text(session);
                    let label = ui.weak(&text);
                    label.widget_info(|| {
                        egui::WidgetInfo::labeled(egui::WidgetType::Label, true, &text)
                    });
                }
            });
        });
    }
}
