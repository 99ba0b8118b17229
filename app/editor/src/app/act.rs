//! Does what parts of the window ask for.

use eframe::egui::{self, ViewportCommand};
use mve_core::NodeMode;
use serde_json::Value as Json;

use super::commands::{CommandQuestion, WaitingRun};
use super::dialogs::Purpose;
use super::{Command, EXAMPLE, Editor, Lower, Wish};
use crate::canvas::Action;
use crate::document::{Clip, Document, Edit, Item};
use crate::forms::FormEvent;
use crate::programs::ProgramAction;
use crate::runner::Part;

/// How far below the original a duplicate comes to stand, in units of the canvas.
const BELOW: f64 = 40.0;

impl Editor {
    /// Does what was asked for; what cannot be done is said.
    pub(super) fn carry_out(&mut self, ctx: &egui::Context, wish: Wish) {
        match wish {
            Wish::Canvas(action) => self.act(ctx, action),
            Wish::ShowNode(node) => {
                let session = self.session_mut();
                session.canvas.show_node(&node);
                session.document.select([Item::Node(node)]);
            }
            Wish::Program(action) => self.act_on_program(ctx, action),
            Wish::Command(command) => self.command(ctx, command),
            Wish::Say(text) => self.toast(text),
        }
    }

    fn act(&mut self, ctx: &egui::Context, action: Action) {
        match action {
            Action::Edit(edits) => {
                for edit in &edits {
                    if let Edit::SetMode { nodes, mode } = edit {
                        let what = match mode {
                            NodeMode::Active => "neither muted nor bypassed",
                            NodeMode::Muted => "muted, does not run",
                            NodeMode::Bypassed => "bypassed, passes the input through",
                        };
                        self.toast(format!("{}: {what} (Ctrl+Z undoes it)", nodes.join(", ")));
                    }
                }
                self.edit(&edits);
            }
            Action::Select(items) => self.session_mut().document.select(items),
            Action::Run(part) => self.run(part),
            Action::Pin(port) => self.session_mut().toggle_pin(port),
            Action::Form(node, event) => self.form(node, event),
            Action::Copy => self.copy(ctx),
            Action::Cut => {
                self.copy(ctx);
                let items = self.session().document.selection().iter().cloned().collect();
                self.edit(&[Edit::Remove(items)]);
            }
            Action::Paste(text, at) => match Clip::parse(&text).filter(|clip| !clip.is_empty()) {
                Some(clip) => self.edit(&[Edit::Paste { clip, at }]),
                None => self.toast("What is on the clipboard is no part of a map."),
            },
            Action::RequestPaste => ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
            Action::Duplicate => self.duplicate(),
            Action::Vary(node, param) => self.vary(&node, &param),
            Action::OpenMap(node) => self.open_map_of(&node),
        }
    }

    /// Changes the map; new items are selected.
    pub(super) fn edit(&mut self, edits: &[Edit]) {
        let Self { sessions, active, .. } = self;
        let session = &mut sessions[*active];
        session.canvas.sizes().for_each(|(name, size)| session.document.set_size(name, size));
        match session.document.apply(edits, session.runner.registry()) {
            Ok(applied) => {
                if edits.iter().any(|edit| matches!(edit, Edit::Arrange { .. })) {
                    session.canvas.fit();
                }
                applied.renamed.iter().for_each(|(from, to)| session.rename(from, to));
                let is_drawn = |item: &Item| !matches!(item, Item::Link(_));
                let new: Vec<Item> = applied.new_items.into_iter().filter(is_drawn).collect();
                if !new.is_empty() {
                    session.document.select(new);
                }
                session.prune_pins();
            }
            Err(error) => self.toast(error.to_string()),
        }
    }

    fn form(&mut self, node: String, event: FormEvent) {
        match event {
            FormEvent::NotUnderstood(text) => self.toast(text),
            FormEvent::Set { path, value } => self.edit(&[Edit::SetParam { node, path, value }]),
            FormEvent::Browse { path, extensions } => {
                let session = &self.sessions[self.active];
                let purpose = Purpose::Param(session.document.id(), node, path);
                self.dialogs.ask(purpose, extensions, session.folder(), &self.shared);
            }
        }
    }

    fn copy(&mut self, ctx: &egui::Context) {
        let document = &self.session().document;
        let items: Vec<Item> = document.selection().iter().cloned().collect();
        let clip = Clip::copy(document, &items);
        if !clip.is_empty() {
            ctx.copy_text(clip.to_text());
        }
    }

    fn duplicate(&mut self) {
        let document = &self.session().document;
        let items: Vec<Item> = document.selection().iter().cloned().collect();
        let clip = Clip::copy_with_links(document, &items);
        let sizes: std::collections::HashMap<_, _> = self.session().canvas.sizes().collect();
        let ends = |item: &Item| {
            let [x, y] = document.position(item)?;
            let [width, height] = match item {
                Item::Node(name) => sizes.get(name.as_str()).copied().unwrap_or_default(),
                Item::Frame(name) => document.extras().frames.get(name)?.size,
                _ => [0.0; 2],
            };
            Some(([x, y], [x + width, y + height]))
        };
        let all = items.iter().filter_map(ends).reduce(|(a, a_end), (b, b_end)| {
            let low = [a[0].min(b[0]), a[1].min(b[1])];
            (low, [a_end[0].max(b_end[0]), a_end[1].max(b_end[1])])
        });
        let Some(([x, y], [right, end])) = all.filter(|_| !clip.is_empty()) else { return };
        let free = self.session().canvas.free_near([x, y], [right - x, end - y]);
        // Without a free place in sight: below the originals, so that it covers nothing of them.
        self.edit(&[Edit::Paste { clip, at: free.unwrap_or([x, end + BELOW]) }]);
        if free.is_none() {
            self.session_mut().canvas.fit_selection();
        }
    }

    fn vary(&mut self, node: &str, param: &str) {
        self.lower = Lower::Program;
        self.is_lower_open = true;
        let Self { sessions, active, shared, .. } = self;
        let session = &mut sessions[*active];
        let (programs, scene) = session.programs(shared);
        let actions = programs.vary(node, param, &scene);
        drop(scene);
        let edits: Vec<Edit> = actions.into_iter().filter_map(edit_of).collect();
        self.edit(&edits);
    }

    fn act_on_program(&mut self, ctx: &egui::Context, action: ProgramAction) {
        match action {
            ProgramAction::LoadStep(params) => {
                let edit = |(node, path, value): (String, String, Json)| Edit::SetParam {
                    node,
                    path,
                    value: Some(value),
                };
                let edits: Vec<Edit> = params.into_iter().map(edit).collect();
                self.edit(&edits);
            }
            ProgramAction::OpenFile(path) => {
                let path = std::path::absolute(&path).unwrap_or(path);
                self.toast(format!("Opening {}", path.display()));
                self.dialogs.open_file(path, &self.shared);
            }
            ProgramAction::RenameProgram { .. } if self.session().programs.has_results() => {
                if let Some(edit) = edit_of(action) {
                    self.edit(&[edit]);
                    self.toast(
                        "The results so far stay in the folder of the old name; \
                         under the new name steps run again.",
                    );
                }
            }
            ProgramAction::AllowCommands(commands, retry) => {
                let run = WaitingRun::Program(retry);
                self.session_mut().question = Some(CommandQuestion { commands, run });
            }
            ProgramAction::ShowNode(node) => self.carry_out(ctx, Wish::ShowNode(node)),
            other => {
                if let Some(edit) = edit_of(other) {
                    self.edit(&[edit]);
                }
            }
        }
    }

    fn command(&mut self, ctx: &egui::Context, command: Command) {
        match command {
            Command::New => self.add(Document::new()),
            Command::Open => self.boxes.open_map(),
            Command::OpenPath(path) => self.take_files(std::slice::from_ref(&path)),
            Command::Example => match Document::from_text(EXAMPLE) {
                Ok(document) => self.add(document),
                Err(error) => self.toast(error.to_string()),
            },
            Command::Save => self.save(self.outermost(self.active)),
            Command::SaveAs => {
                self.active = self.outermost(self.active);
                self.save_as();
            }
            Command::Close(place) => self.close(place),
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Undo => self.move_in_history(Document::undo),
            Command::Redo => self.move_in_history(Document::redo),
            Command::Run => self.run(Part::All),
            Command::Stop => self.session_mut().runner.stop(),
            Command::Picture => self.boxes.take_picture(),
            Command::Find => self.boxes.find_node(),
            Command::Shortcuts => self.boxes.show_shortcuts(),
            Command::Copy => self.act(ctx, Action::Copy),
            Command::Cut => self.act(ctx, Action::Cut),
            Command::Paste => self.act(ctx, Action::RequestPaste),
        }
    }

    /// Goes back or forward in the history.
    fn move_in_history(&mut self, step: fn(&mut Document) -> Option<&str>) {
        let session = &mut self.sessions[self.active];
        step(&mut session.document);
        session.prune_pins();
    }
}

/// What a program panel asks for as an edit of the map.
fn edit_of(action: ProgramAction) -> Option<Edit> {
    match action {
        ProgramAction::SetProgram { name, spec } => Some(Edit::SetProgram { name, spec }),
        ProgramAction::RenameProgram { name, to } => Some(Edit::RenameProgram { name, to }),
        _ => None,
    }
}
