//! Boxes over the window: opening and saving, keys, questions before something is lost.

use std::path::PathBuf;

use eframe::egui::{self, Key, Modal, RichText, ScrollArea, TextEdit, Ui};
use mve_core::Map;

use super::files::{is_same, typed_path};
use super::pictures::PictureForm;
use super::{Command, Editor, Wish};
use crate::canvas::SHORTCUTS;
use crate::document::Recovered;
use crate::programs::in_words;
use crate::views::VIEW_KEYS;

/// Keys that hold in the whole window; canvas and views have their own.
const WINDOW_KEYS: &[(&str, &str)] = &[
    ("F5, Ctrl + Enter", "run the map"),
    ("Shift + Esc", "stop the run"),
    ("Ctrl + Z", "undo"),
    ("Ctrl + Shift + Z, Ctrl + Y", "redo"),
    ("Ctrl + N, O, S, W", "new, open, save, close a map"),
    ("Ctrl + Shift + S", "save as"),
    ("Ctrl + F", "find a node by its name or module"),
    ("Ctrl + Tab", "next map"),
    ("Ctrl + Q", "quit"),
    ("Ctrl + plus, minus, 0", "larger, smaller, the size that the system asks for"),
    ("F1", "this list"),
];

/// What the box that is open is about.
#[derive(Default)]
enum Content {
    #[default]
    Nothing,
    /// Path so far.
    OpenMap(String),
    SaveMap(String),
    /// Another file is there; to be replaced?
    SaveOver(PathBuf),
    Picture(PictureForm),
    /// Letters so far.
    Find(String),
    Shortcuts,
    CloseMap(u64),
    Replace(u64),
    Quit,
}

/// The boxes over the window.
#[derive(Default)]
pub struct Boxes {
    open: Content,
    recovered: Vec<Recovered>,
    /// Of these, the one that a hand wants to discard, until it says so again.
    discarding: Option<usize>,
}

impl Boxes {
    pub(super) fn open_map(&mut self) {
        self.open = Content::OpenMap(String::new());
    }

    pub(super) fn save_map(&mut self, path: String) {
        self.open = Content::SaveMap(path);
    }

    pub(super) fn find_node(&mut self) {
        self.open = Content::Find(String::new());
    }

    pub(super) fn take_picture(&mut self) {
        self.open = Content::Picture(PictureForm::default());
    }

    pub(super) fn show_shortcuts(&mut self) {
        self.open = Content::Shortcuts;
    }

    pub(super) fn ask_to_close(&mut self, id: u64) {
        self.open = Content::CloseMap(id);
    }

    pub(super) fn ask_to_replace(&mut self, id: u64) {
        self.open = Content::Replace(id);
    }

    pub(super) fn ask_to_quit(&mut self) {
        self.open = Content::Quit;
    }

    pub(super) fn offer_recovered(&mut self, found: Vec<Recovered>) {
        self.recovered = found;
    }

    pub(super) fn close_open(&mut self) {
        self.open = Content::Nothing;
    }

    pub(super) fn close_save(&mut self) {
        self.open = Content::Nothing;
    }
}

impl Editor {
    pub(super) fn boxes(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        if !self.boxes.recovered.is_empty() {
            self.recovered_box(ui);
            return;
        }
        let open = std::mem::take(&mut self.boxes.open);
        let stays = match open {
            Content::Nothing => Content::Nothing,
            Content::OpenMap(path) => self.open_box(ui, path, wishes),
            Content::SaveMap(path) => self.save_box(ui, path),
            Content::SaveOver(path) => self.save_over_box(ui, path),
            Content::Picture(form) => {
                self.picture_box(ui, form).map_or(Content::Nothing, Content::Picture)
            }
            Content::Find(letters) => {
                self.find_box(ui, letters, wishes).map_or(Content::Nothing, Content::Find)
            }
            Content::Shortcuts => shortcuts_box(ui),
            Content::CloseMap(id) => self.close_box(ui, id),
            Content::Replace(id) => self.replace_box(ui, id),
            Content::Quit => self.quit_box(ui),
        };
        // What the box was asked for may have opened another.
        if matches!(self.boxes.open, Content::Nothing) {
            self.boxes.open = stays;
        }
    }

    fn open_box(&mut self, ui: &mut Ui, mut path: String, wishes: &mut Vec<Wish>) -> Content {
        let mut chosen = None;
        let mut wants_dialog = false;
        let shown = Modal::new("open a map".into()).show(ui.ctx(), |ui| {
            ui.set_width(460.0);
            ui.heading("Open a map or a mesh");
            ui.horizontal(|ui| {
                let field = ui.add(
                    TextEdit::singleline(&mut path)
                        .hint_text("path of a file")
                        .desired_width(320.0),
                );
                ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("path to open"));
                let is_entered =
                    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                if ui.memory(|memory| memory.focused().is_none()) {
                    field.request_focus();
                }
                wants_dialog = ui.button("Browse…").clicked();
                if (ui.button("Open").clicked() || is_entered) && !path.trim().is_empty() {
                    chosen = Some(Command::OpenPath(typed_path(&path)));
                }
            });
            ui.add_space(6.0);
            for recent in &self.settings.recent {
                if ui.link(recent.display().to_string()).clicked() {
                    chosen = Some(Command::OpenPath(recent.clone()));
                }
            }
            ui.add_space(6.0);
            if ui.link("The example: simplify one model and measure what was lost").clicked() {
                chosen = Some(Command::Example);
            }
            ui.weak("A file can also be dropped on the window.");
        });
        if wants_dialog {
            self.ask_for_map();
        }
        if let Some(command) = chosen {
            wishes.push(Wish::Command(command));
            return Content::Nothing;
        }
        if shown.should_close() { Content::Nothing } else { Content::OpenMap(path) }
    }

    fn save_box(&mut self, ui: &mut Ui, mut path: String) -> Content {
        let mut is_done = false;
        let mut wants_dialog = false;
        let shown = Modal::new("save the map".into()).show(ui.ctx(), |ui| {
            ui.set_width(460.0);
            ui.heading("Save the map as");
            ui.horizontal(|ui| {
                let field = ui.add(TextEdit::singleline(&mut path).desired_width(320.0));
                ui.ctx()
                    .accesskit_node_builder(field.id, |node| node.set_label("path of the file"));
                let is_entered =
                    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                if ui.memory(|memory| memory.focused().is_none()) {
                    field.request_focus();
                }
                wants_dialog = ui.button("Browse…").clicked();
                is_done = ui.button("Save").clicked() || is_entered;
            });
            let folder = std::env::current_dir().unwrap_or_default();
            ui.weak(format!("Relative paths are below {}.", folder.display()));
        });
        if wants_dialog {
            self.ask_where_to_save();
        }
        if is_done && !path.trim().is_empty() {
            let mut target = typed_path(&path);
            if target.extension().is_none() {
                target.set_extension("json");
            }
            let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
            if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
                self.toast(format!("There is no folder {}", folder.display()));
                return Content::SaveMap(path);
            }
            let is_own = self.session().document.path().is_some_and(|own| is_same(own, &target));
            if target.exists() && !is_own {
                return Content::SaveOver(target);
            }
            self.save_to(&target);
            return Content::Nothing;
        }
        if shown.should_close() { Content::Nothing } else { Content::SaveMap(path) }
    }

    fn save_over_box(&mut self, ui: &mut Ui, path: PathBuf) -> Content {
        let text = format!("{} is there already. Replace it by this map?", path.display());
        match question(ui, &text, &["Replace the file", "Cancel"]) {
            Some(0) => {
                self.save_to(&path);
                Content::Nothing
            }
            Some(_) => Content::SaveMap(path.display().to_string()),
            None => Content::SaveOver(path),
        }
    }

    fn close_box(&mut self, ui: &mut Ui, id: u64) -> Content {
        let Some(place) = self.place_of(id) else { return Content::Nothing };
        let title = self.sessions[place].title();
        match question(
            ui,
            &format!("Save the changes of {title}?"),
            &["Save", "Close without saving", "Cancel"],
        ) {
            Some(0) => {
                self.save(place);
                // A map without a file asks for one first, and is closed by hand then.
                if !self.sessions[place].document.is_dirty() {
                    self.close_anyway(place);
                }
                Content::Nothing
            }
            Some(1) => {
                self.close_anyway(place);
                Content::Nothing
            }
            Some(_) => Content::Nothing,
            None => Content::CloseMap(id),
        }
    }

    fn replace_box(&mut self, ui: &mut Ui, id: u64) -> Content {
        let Some(place) = self.place_of(id) else { return Content::Nothing };
        let title = self.sessions[place].title();
        let text =
            format!("Another program has changed the file of {title} since it was read here.");
        match question(ui, &text, &["Replace the file", "Cancel"]) {
            Some(0) => {
                self.save_anyway(place);
                Content::Nothing
            }
            Some(_) => Content::Nothing,
            None => Content::Replace(id),
        }
    }

    fn quit_box(&mut self, ui: &mut Ui) -> Content {
        let dirty = self.sessions.iter().filter(|session| session.document.is_dirty());
        let names: Vec<String> = dirty.map(|session| session.title()).collect();
        if names.is_empty() {
            self.quit_anyway(ui.ctx());
            return Content::Nothing;
        }
        let text = format!("There are changes that are not saved: {}.", names.join(", "));
        match question(ui, &text, &["Save all and quit", "Quit without saving", "Cancel"]) {
            Some(0) => {
                for place in 0..self.sessions.len() {
                    if self.sessions[place].document.is_dirty() {
                        self.save(place);
                    }
                }
                Content::Nothing
            }
            Some(1) => {
                self.quit_anyway(ui.ctx());
                Content::Nothing
            }
            Some(_) => Content::Nothing,
            None => Content::Quit,
        }
    }

    /// Says on a first start what is to be seen and what to do.
    pub(super) fn hint(&mut self, ui: &Ui) {
        let is_of_this = self.hint_for == Some(self.session().document.id());
        if self.settings.has_seen_hint || !is_of_this {
            return;
        }
        // Below the nodes, and gone when what it says has been done.
        if self.session().runner.last_run().is_some() {
            self.settings.has_seen_hint = true;
        }
        let area = egui::Area::new("hint".into()).anchor(egui::Align2::LEFT_BOTTOM, [16.0, -40.0]);
        area.show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(330.0);
                ui.strong("An example: simplify one model and measure what was lost");
                ui.label("Press Run. Then click an output, the dots on the right of a node, to look at it.");
                ui.label("Tab adds a module; drag from dot to dot to link. F1 lists all keys.");
                if ui.button("Got it").clicked() {
                    self.settings.has_seen_hint = true;
                }
            });
        });
    }

    /// Offers the maps of a window that ended without being asked to.
    fn recovered_box(&mut self, ui: &mut Ui) {
        if let Some(place) = self.boxes.discarding {
            self.discard_box(ui, place);
            return;
        }
        let mut wanted = None;
        let mut is_later = false;
        let shown = Modal::new("recovered".into()).show(ui.ctx(), |ui| {
            ui.set_width(520.0);
            ui.heading("These maps were not saved when mve ended");
            for (place, recovered) in self.boxes.recovered.iter().enumerate() {
                ui.add_space(6.0);
                ui.horizontal(|ui| {
                    ui.vertical(|ui| {
                        ui.set_width(360.0);
                        describe(ui, recovered);
                    });
                    if ui.button("Recover").on_hover_text("Open it in a tab, unsaved").clicked() {
                        wanted = Some(place);
                    }
                    if ui.button("Discard…").clicked() {
                        self.boxes.discarding = Some(place);
                    }
                });
            }
            ui.add_space(6.0);
            let later =
                ui.button("Later").on_hover_text("They are offered at the next start again");
            is_later = later.clicked();
        });
        if is_later || shown.should_close() {
            self.boxes.recovered.clear();
        }
        let Some(place) = wanted else { return };
        let recovered = self.boxes.recovered.remove(place);
        match recovered.open() {
            Ok(document) => {
                self.add_recovered(document);
                self.forget_recovered(&recovered);
            }
            Err(error) => self.toast(error.to_string()),
        }
    }

    /// Asks once more before a map is gone that stands nowhere else.
    fn discard_box(&mut self, ui: &mut Ui, place: usize) {
        let recovered = self.boxes.recovered.get(place);
        let path = recovered.and_then(|recovered| recovered.path.as_ref());
        let name =
            path.map_or("a map without a file".to_owned(), |path| path.display().to_string());
        let text = format!("Discard what was not saved of {name}? There is no way back.");
        let Some(answer) = question(ui, &text, &["Discard for good", "Keep it"]) else { return };
        self.boxes.discarding = None;
        if answer == 0 && place < self.boxes.recovered.len() {
            let recovered = self.boxes.recovered.remove(place);
            self.forget_recovered(&recovered);
        }
    }

    /// Removes the copy of a map that was opened again, or that nobody wants.
    fn forget_recovered(&mut self, recovered: &Recovered) {
        if let Some(recovery) = &mut self.recovery
            && let Err(error) = recovery.discard(recovered)
        {
            self.toast(error.to_string());
        }
    }
}

/// Which map it is, when it was kept, and what is in it.
fn describe(ui: &mut Ui, recovered: &Recovered) {
    let path = recovered.path.as_ref().map(|path| path.display().to_string());
    let name = path.unwrap_or_else(|| "a map without a file".to_owned());
    ui.add(egui::Label::new(RichText::new(&name).strong()).truncate()).on_hover_text(&name);
    let age = recovered.at.and_then(|at| at.elapsed().ok());
    let age = age.map(|age| format!("kept {} ago", in_words(age)));
    let nodes = Map::parse(&recovered.text).map(|map| match map.nodes.len() {
        0 => "no nodes".to_owned(),
        _ => map.nodes.keys().map(String::as_str).collect::<Vec<_>>().join(", "),
    });
    let parts: Vec<String> = age.into_iter().chain(nodes.ok()).collect();
    ui.add(egui::Label::new(RichText::new(parts.join(": ")).weak()).truncate());
}

/// Asks a question with some answers; Escape is the last of them.
fn question(ui: &mut Ui, text: &str, answers: &[&str]) -> Option<usize> {
    let mut answer = None;
    let shown = Modal::new("question".into()).show(ui.ctx(), |ui| {
        ui.set_width(380.0);
        ui.label(RichText::new(text).strong());
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            for (place, label) in answers.iter().enumerate() {
                if ui.button(*label).clicked() {
                    answer = Some(place);
                }
            }
        });
    });
    if answer.is_none() && shown.should_close() { Some(answers.len() - 1) } else { answer }
}

fn shortcuts_box(ui: &mut Ui) -> Content {
    let shown = Modal::new("keys".into()).show(ui.ctx(), |ui| {
        ui.set_width(520.0);
        ui.heading("Keys and gestures");
        let height = ui.ctx().content_rect().height() - 160.0;
        ScrollArea::vertical().max_height(height.max(120.0)).show(ui, |ui| {
            let parts =
                [("Anywhere", WINDOW_KEYS), ("On the canvas", SHORTCUTS), ("On a mesh", VIEW_KEYS)];
            for (title, keys) in parts {
                ui.add_space(4.0);
                ui.strong(title);
                egui::Grid::new(title).num_columns(2).striped(true).show(ui, |ui| {
                    for (keys, what) in keys {
                        ui.monospace(*keys);
                        ui.label(*what);
                        ui.end_row();
                    }
                });
            }
        });
        ui.button("Close").clicked()
    });
    if shown.inner || shown.should_close() { Content::Nothing } else { Content::Shortcuts }
}
