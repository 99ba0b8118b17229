//! Maps on disk: opening, saving, closing, recovery, and files that others change.

use std::path::{Path, PathBuf};
use std::time::Instant;

use eframe::egui::{self, Ui, ViewportCommand};
use mve_core::{MapError, Module, PortRef};
use serde_json::Value as Json;

use super::dialogs::{Answer, Purpose};
use super::session::Session;
use super::{Editor, LOOK_AT_FILES};
use crate::document::{DiskChange, Document, Edit, move_paths, written_path};
use crate::runner::Part;

/// What is said where the system has no file dialogs.
const NO_DIALOG: &str = "No file dialog was found on this system (a desktop portal or zenity is \
                         needed): type the path into the field instead.";

/// How far below each other the modules of files that are opened at once come to stand, in units of
/// the canvas.
const BELOW: f64 = 220.0;

/// Whether two paths name one file.
pub fn is_same(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

impl Session {
    /// A path as the map writes it: relative to its folder where it lies below.
    pub fn written_path(&self, path: &Path) -> String {
        written_path(path, self.document.path().and_then(Path::parent))
    }
}

impl Editor {
    /// Saves a map; one without a file asks for it.
    pub(super) fn save(&mut self, place: usize) {
        if self.sessions[place].document.path().is_none() {
            self.active = place;
            self.save_as();
            return;
        }
        let session = &mut self.sessions[place];
        session.disk_change = session.document.disk_change();
        if session.disk_change == Some(DiskChange::Changed) {
            self.active = place;
            self.boxes.ask_to_replace(self.sessions[place].document.id());
            return;
        }
        self.save_anyway(place);
    }

    /// Saves a map, whatever its file holds now.
    pub(super) fn save_anyway(&mut self, place: usize) {
        let session = &mut self.sessions[place];
        session.disk_change = None;
        let saved = session.document.save();
        self.after_saving(place, saved);
    }

    pub(super) fn save_as(&mut self) {
        let session = &self.sessions[self.active];
        let known = session.document.path().map(|path| path.display().to_string());
        self.boxes.save_map(known.unwrap_or_else(|| "map.json".to_owned()));
    }

    /// Saves the map that is shown to a file.
    pub(super) fn save_to(&mut self, path: &Path) {
        let place = self.active;
        let session = &self.sessions[place];
        let (from, to) = (session.folder(), path.parent().unwrap_or(Path::new("")));
        let edits = match is_same(&from, to) {
            true => Vec::new(),
            false => move_paths(session.document.map(), &self.shared.registry, &from, to),
        };
        if !edits.is_empty() {
            self.edit(&edits);
        }
        let session = &mut self.sessions[place];
        let saved = session.document.save_as(path);
        match (saved.is_ok(), edits.is_empty()) {
            (_, true) => {}
            (true, false) => self.toast("Paths of input files now fit the folder of the map."),
            (false, false) => drop(session.document.undo()),
        }
        if saved.is_err() {
            self.boxes.save_map(path.display().to_string());
        }
        self.after_saving(place, saved);
        self.sessions[place].check_again();
    }

    fn after_saving(&mut self, place: usize, saved: Result<(), mve_core::MapError>) {
        if let Err(error) = saved {
            self.toast(format!("not saved: {error}"));
            return;
        }
        let document = &self.sessions[place].document;
        if let Some(path) = document.path().map(Path::to_owned) {
            self.settings.remember(&path);
        }
        if let Some(recovery) = &mut self.recovery
            && let Err(error) = recovery.forget(document)
        {
            self.toast(format!("the copy kept for a crash stays: {error}"));
        }
    }

    /// Closes a map; one with changes asks first.
    pub(super) fn close(&mut self, place: usize) {
        if self.sessions[place].document.is_dirty() {
            self.active = place;
            self.boxes.ask_to_close(self.sessions[place].document.id());
        } else {
            self.close_anyway(place);
        }
    }

    pub(super) fn close_anyway(&mut self, place: usize) {
        let session = self.sessions.remove(place);
        if let Some(recovery) = &mut self.recovery {
            // A copy that stays is offered at the next start, which does no harm.
            let _ = recovery.forget(&session.document);
        }
        if self.sessions.is_empty() {
            self.add(Document::new());
        }
        self.active = self.active.min(self.sessions.len() - 1);
    }

    /// Keeps the window open while there are changes that nobody has decided on.
    pub(super) fn guard_close(&mut self, ctx: &egui::Context) {
        let is_closing = ctx.input(|input| input.viewport().close_requested());
        let is_dirty = self.sessions.iter().any(|session| session.document.is_dirty());
        if is_closing && is_dirty && !self.may_close {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.boxes.ask_to_quit();
        }
    }

    /// Closes the window, changes and all.
    pub(super) fn quit_anyway(&mut self, ctx: &egui::Context) {
        self.may_close = true;
        for session in &self.sessions {
            if let Some(recovery) = &mut self.recovery {
                // A copy that stays is offered at the next start, which does no harm.
                let _ = recovery.forget(&session.document);
            }
        }
        ctx.send_viewport_cmd(ViewportCommand::Close);
    }

    /// Every few seconds: keeps changed maps for the case of a crash, and looks for files that
    /// somebody else has changed.
    pub(super) fn look_at_files(&mut self, ctx: &egui::Context) {
        // Asked for in every frame: one in between makes the window forget what it was asked.
        let until = LOOK_AT_FILES.saturating_sub(self.looked_at_files.elapsed());
        if !until.is_zero() {
            ctx.request_repaint_after(until);
            return;
        }
        self.looked_at_files = Instant::now();
        ctx.request_repaint_after(LOOK_AT_FILES);
        for session in &mut self.sessions {
            session.disk_change = session.document.disk_change();
            session.check_again();
        }
        let Some(recovery) = &mut self.recovery else { return };
        let kept: Result<Vec<()>, _> =
            self.sessions.iter().map(|session| recovery.autosave(&session.document)).collect();
        if let Err(error) = kept {
            self.recovery = None;
            self.toast(format!("changed maps are no longer kept for a crash: {error}"));
        }
    }

    /// Shows a recovered map, in place of its file where that is open and was not changed.
    pub(super) fn add_recovered(&mut self, document: Document) {
        let is_same_file = |session: &Session| {
            let (old, new) = (session.document.path(), document.path());
            old.zip(new).is_some_and(|(old, new)| is_same(old, new)) && !session.document.is_dirty()
        };
        match self.sessions.iter().position(is_same_file) {
            Some(place) => {
                self.sessions[place] = Session::new(document, &self.shared);
                self.active = place;
            }
            None => self.add(document),
        }
    }

    /// Offers maps that were not saved when the window ended the last time.
    pub(super) fn find_recovered(&mut self) {
        let Some(recovery) = &mut self.recovery else { return };
        match recovery.found() {
            Ok(found) => self.boxes.offer_recovered(found),
            Err(error) => self.toast(format!("maps kept for a crash cannot be read: {error}")),
        }
    }

    /// Maps and meshes that were dropped on the window.
    pub(super) fn take_dropped(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        let dropped: Vec<PathBuf> = dropped.iter().map(|file| file.path().to_owned()).collect();
        self.take_files(&dropped);
    }

    /// Opens maps, and adds a module for each file that one reads, with its value in view.
    pub fn take_files(&mut self, paths: &[PathBuf]) {
        let mut readers = Vec::new();
        for path in paths {
            match self.reader_of(path) {
                Some(reader) => readers.push((path, reader)),
                None => self.open(path),
            }
        }
        let mut names = Vec::new();
        for (path, (module, param)) in readers {
            let session = self.session();
            let name = session.document.free_name(module.id);
            let value = Some(Json::from(session.written_path(path)));
            let [x, y] = session.canvas.free_place();
            let at = [x, y + names.len() as f64 * BELOW];
            let module_id = module.id.to_owned();
            self.edit(&[
                Edit::AddNode { module: module_id, name: Some(name.clone()), at },
                Edit::SetParam { node: name.clone(), path: param.to_owned(), value },
            ]);
            if let Some(output) = module.outputs.first() {
                let port = PortRef { node: name.clone(), port: output.name.to_owned() };
                self.session_mut().pinned.insert(port);
            }
            names.push(name);
        }
        // What runs goes on: it may write files.
        if !names.is_empty() && !self.session().runner.is_running() {
            self.session_mut().run(Part::UpTo(names));
        }
    }

    /// The module with a parameter for input files that have the ending of this one, and the
    /// parameter: of several modules the one for the fewest endings, and of those the first.
    pub(super) fn reader_of(&self, path: &Path) -> Option<(&'static Module, &'static str)> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        // A map, also where a table may be written so.
        if extension == "json" {
            return None;
        }
        let readers = self.shared.registry.modules().iter().filter_map(|info| {
            info.module.params.iter().find_map(|spec| {
                let endings = spec.input_file()?.extensions;
                let reads = endings.contains(&extension.as_str());
                reads.then_some((endings.len(), info.module, spec.name))
            })
        });
        readers.min_by_key(|(n_endings, ..)| *n_endings).map(|(_, module, name)| (module, name))
    }

    /// The endings of the files that modules read.
    fn read_endings(&self) -> Vec<&'static str> {
        let params = self.shared.registry.modules().iter().flat_map(|info| info.module.params);
        let files = params.filter_map(mve_core::ParamSpec::input_file);
        let mut endings: Vec<&str> = files.flat_map(|file| file.extensions).copied().collect();
        endings.sort_unstable();
        endings.dedup();
        endings
    }

    /// Says why a file was not opened: what is no map, by its name, may be no file for mve at all.
    pub(super) fn say_not_opened(&mut self, path: &Path, error: &MapError) {
        let is_map = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        let text = match error {
            MapError::Io { .. } => error.to_string(),
            _ if is_map => format!("{}: {error}", path.display()),
            _ => format!(
                "{}: neither a map nor a file that a module reads ({})",
                path.display(),
                self.read_endings().join(", "),
            ),
        };
        self.toast(text);
    }

    /// Files that were chosen in a dialog.
    pub(super) fn take_answers(&mut self) {
        for (purpose, answer) in self.dialogs.answers() {
            let path = match answer {
                Answer::Chosen(path) => path,
                Answer::NoDialog => {
                    self.toast(NO_DIALOG);
                    continue;
                }
                Answer::NotOpened(path) => {
                    self.toast(format!("No program was found to open {}", path.display()));
                    continue;
                }
            };
            match purpose {
                Purpose::Show(_) => {}
                Purpose::OpenMap => {
                    self.boxes.close_open();
                    self.take_files(&[path]);
                }
                Purpose::SaveMap(id) => {
                    if let Some(place) = self.place_of(id) {
                        self.boxes.close_save();
                        self.active = place;
                        self.save_to(&path);
                    }
                }
                Purpose::Param(id, node, param) => {
                    if let Some(place) = self.place_of(id) {
                        self.active = place;
                        let value = Some(Json::from(self.session().written_path(&path)));
                        self.edit(&[Edit::SetParam { node, path: param, value }]);
                    }
                }
            }
        }
    }

    pub(super) fn place_of(&self, id: u64) -> Option<usize> {
        self.sessions.iter().position(|session| session.document.id() == id)
    }

    /// Opens the dialog of the system for a map.
    pub(super) fn ask_for_map(&mut self) {
        let folder = self.session().folder();
        let endings: Vec<&str> = std::iter::once("json").chain(self.read_endings()).collect();
        self.dialogs.ask(Purpose::OpenMap, &endings, folder, &self.shared);
    }

    /// Opens the dialog of the system for where to save.
    pub(super) fn ask_where_to_save(&mut self) {
        let (id, folder) = (self.session().document.id(), self.session().folder());
        self.dialogs.ask(Purpose::SaveMap(id), &["json"], folder, &self.shared);
    }
}

/// Says that somebody else has changed the map's file, and asks what to do.
pub fn disk_banner(editor: &mut Editor, ui: &mut Ui) {
    let session = &mut editor.sessions[editor.active];
    let Some(change) = &session.disk_change else { return };
    let what = match change {
        DiskChange::Changed => "The file of this map was changed by another program.",
        DiskChange::Removed => "The file of this map is no longer there.",
    };
    let can_reload = *change == DiskChange::Changed;
    let reload = match session.document.is_dirty() {
        true => "Reload in place of the changes here",
        false => "Reload",
    };
    let mut failed = None;
    egui::Frame::popup(ui.style()).corner_radius(0).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            ui.colored_label(ui.visuals().warn_fg_color, what);
            if can_reload
                && ui.button(reload).on_hover_text("Undo brings back what was here.").clicked()
            {
                failed = session.document.reload().err();
                session.forget_allowed();
                session.disk_change = None;
            }
            if ui.button("Keep what is here").clicked() {
                session.document.keep_mine();
                session.disk_change = None;
            }
        });
    });
    if let Some(error) = failed {
        editor.toast(error.to_string());
    }
}

/// The path that a person typed, with `~` for the home folder.
pub fn typed_path(text: &str) -> PathBuf {
    match (text.trim().strip_prefix("~/"), std::env::var_os("HOME")) {
        (Some(below), Some(home)) => PathBuf::from(home).join(below),
        _ => PathBuf::from(text.trim()),
    }
}
