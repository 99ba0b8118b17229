//! The window as a whole: open maps, menus, panels, and what is asked of them.

mod act;
mod boxes;
mod console;
mod dialogs;
mod files;
mod inspector;
mod session;
mod settings;
mod top;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, CentralPanel, Panel, RichText, Ui};
use eframe::egui_wgpu::RenderState;
use mve_core::{MapError, Registry};

use crate::canvas::{Action, Scene};
use crate::catalog::Catalog;
use crate::document::{Document, Recovery};
use crate::programs;
use crate::runner::{Part, Shared};

pub use session::Session;
pub use settings::{Settings, Theme};

/// The map that a first start shows.
const EXAMPLE: &str = include_str!("../../../../maps/simplify_and_measure.json");

/// Bytes of values that the window keeps for the next run.
const CACHE: usize = 2 << 30;

/// How long a message stays.
const TOAST: Duration = Duration::from_secs(6);

/// How often files on disk are looked at, and the map is saved for the case of a crash.
const LOOK_AT_FILES: Duration = Duration::from_secs(2);

/// The panels below the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lower {
    Console,
    Values,
    Program,
}

/// Which of canvas and viewer have the middle of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Middle {
    Both,
    Canvas,
    Viewer,
}

/// What a part of the window asks of the whole.
pub enum Wish {
    /// Something that the canvas also asks.
    Canvas(Action),
    /// To select a node and move it into view.
    ShowNode(String),
    /// Something of the program panel.
    Program(programs::Action),
    /// A command of a menu or a key.
    Command(Command),
}

/// What menus and keys ask for.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// An empty map.
    New,
    /// The box in which a map is opened.
    Open,
    /// This map.
    OpenPath(PathBuf),
    /// The example.
    Example,
    /// To the map's file.
    Save,
    /// To another file.
    SaveAs,
    /// The map of this place among the tabs.
    Close(usize),
    /// The whole window.
    Quit,
    /// One edit back.
    Undo,
    /// One edit forward again.
    Redo,
    /// Run all.
    Run,
    /// Stop the run.
    Stop,
    /// The list of keys.
    Shortcuts,
    /// Copy the selection.
    Copy,
    /// Cut the selection.
    Cut,
    /// Paste what is on the clipboard.
    Paste,
}

/// The window.
pub struct Editor {
    shared: Arc<Shared>,
    catalog: Catalog,
    sessions: Vec<Session>,
    active: usize,
    /// What it remembers.
    pub settings: Settings,
    dialogs: dialogs::Dialogs,
    console: console::Console,
    lower: Lower,
    is_lower_open: bool,
    middle: Middle,
    toasts: Vec<(Instant, String)>,
    boxes: boxes::Boxes,
    recovery: Option<Recovery>,
    looked_at_files: Instant,
    render: Option<RenderState>,
    window_title: String,
    /// Whether the window may close without a further question.
    may_close: bool,
}

/// How a window begins.
#[derive(Default)]
pub struct Start {
    /// What was remembered.
    pub settings: Settings,
    /// Maps to open.
    pub maps: Vec<PathBuf>,
    /// Where maps are kept for the case of a crash; none keeps nothing.
    pub recovery: Option<PathBuf>,
    /// What draws meshes; without it they cannot be shown.
    pub render: Option<RenderState>,
    /// Where savers write; none is where `mve run` writes.
    pub output_folder: Option<PathBuf>,
    /// Whether the example is shown where no map is named.
    pub has_example: bool,
}

impl Editor {
    /// A window over some modules.
    pub fn new(ctx: &egui::Context, registry: Registry, start: Start) -> Self {
        let waker = ctx.clone();
        let shared = Shared::new(
            registry,
            CACHE,
            Box::new(move || waker.request_repaint()),
            start.output_folder,
        );
        start.settings.apply(ctx);
        let catalog = Catalog::new(&shared.registry);
        let mut toasts = Vec::new();
        let recovery = start.recovery.and_then(|folder| match Recovery::new(&folder) {
            Ok(recovery) => Some(recovery),
            Err(error) => {
                let folder = folder.display();
                let text =
                    format!("{folder}: maps cannot be kept for the case of a crash: {error}");
                toasts.push((Instant::now(), text));
                None
            }
        });
        let mut editor = Self {
            shared,
            catalog,
            sessions: Vec::new(),
            active: 0,
            settings: start.settings,
            dialogs: dialogs::Dialogs::default(),
            console: console::Console::default(),
            lower: Lower::Console,
            is_lower_open: false,
            middle: Middle::Both,
            toasts,
            boxes: boxes::Boxes::default(),
            recovery,
            looked_at_files: Instant::now(),
            render: start.render,
            window_title: String::new(),
            may_close: false,
        };
        start.maps.iter().for_each(|path| editor.open(path));
        if editor.sessions.is_empty() {
            let first = if start.has_example { Document::from_text(EXAMPLE).ok() } else { None };
            editor.add(first.unwrap_or_default());
        }
        editor.find_recovered();
        editor
    }

    /// The map that is shown.
    pub fn session(&self) -> &Session {
        &self.sessions[self.active]
    }

    /// The same, to be changed.
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.sessions[self.active]
    }

    fn add(&mut self, document: Document) {
        self.sessions.push(Session::new(document, &self.shared));
        self.active = self.sessions.len() - 1;
    }

    /// Opens a map in a tab of its own, or shows the tab that it is open in.
    pub fn open(&mut self, path: &Path) {
        let same = |session: &Session| {
            session.document.path().is_some_and(|open| files::is_same(open, path))
        };
        if let Some(place) = self.sessions.iter().position(same) {
            self.active = place;
            return;
        }
        match Session::open(path, &self.shared) {
            Ok(session) => {
                self.settings.remember(path);
                self.replace_untouched(session);
            }
            Err(error) => {
                let text = match error {
                    MapError::Io { .. } => error.to_string(),
                    error => format!("{}: {error}", path.display()),
                };
                self.toast(text);
            }
        }
    }

    /// Shows a session, in place of an empty map that nobody has touched.
    fn replace_untouched(&mut self, session: Session) {
        let is_untouched = self.sessions.get(self.active).is_some_and(|old| {
            let document = &old.document;
            document.path().is_none() && !document.is_dirty() && document.map().nodes.is_empty()
        });
        if is_untouched {
            self.sessions[self.active] = session;
        } else {
            self.sessions.push(session);
            self.active = self.sessions.len() - 1;
        }
    }

    fn toast(&mut self, text: impl Into<String>) {
        self.toasts.push((Instant::now(), text.into()));
    }

    /// Draws the window and does what was asked for.
    pub fn show(&mut self, ui: &mut Ui) {
        let runs_on_edit = self.settings.runs_on_edit;
        self.sessions.iter_mut().for_each(|session| session.update(runs_on_edit));
        let mut wishes = Vec::new();
        self.keys(ui, &mut wishes);
        self.take_dropped(ui.ctx());
        self.take_answers();
        self.look_at_files(ui.ctx());
        self.top(ui, &mut wishes);
        self.status_bar(ui, &mut wishes);
        self.lower(ui, &mut wishes);
        self.right(ui, &mut wishes);
        self.middle(ui, &mut wishes);
        self.hint(ui);
        self.boxes(ui, &mut wishes);
        self.show_toasts(ui);
        self.guard_close(ui.ctx());
        self.name_window(ui.ctx());
        for wish in wishes {
            self.grant(ui.ctx(), wish);
        }
        if self.session().runner.is_running() || self.session().programs.is_running() {
            // So that times and bars move; what happens wakes the window by itself.
            ui.ctx().request_repaint_after(Duration::from_millis(100));
        }
    }

    fn lower(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let mut is_open = self.is_lower_open;
        // A program needs more room than the log; each keeps the height that it was given.
        let (name, height) = match self.lower {
            Lower::Program => ("program", 400.0),
            Lower::Console | Lower::Values => ("lower", 230.0),
        };
        let panel = Panel::bottom(name).resizable(true).default_size(height).min_size(90.0);
        panel.show_collapsible(ui, &mut is_open, |ui| {
            let Self { sessions, active, lower, console, shared, .. } = self;
            let session = &mut sessions[*active];
            match lower {
                Lower::Console => console.show(ui, session, wishes),
                Lower::Values => console::values(ui, session, shared, wishes),
                Lower::Program => {
                    let folder = session.folder();
                    let file = session.document.path().map(|path| path.display().to_string());
                    let scene = programs::Scene {
                        map: session.document.map(),
                        folder: &folder,
                        map_file: file.as_deref().unwrap_or(""),
                        registry: &shared.registry,
                        output_folder: &shared.output_folder,
                    };
                    let actions = session.programs.show(ui, &scene);
                    wishes.extend(actions.into_iter().map(Wish::Program));
                }
            }
        });
        self.is_lower_open = is_open;
    }

    fn right(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let panel = Panel::right("inspector").resizable(true).default_size(330.0).min_size(200.0);
        panel.show(ui, |ui| {
            // Long rows scroll; they must not push the canvas aside.
            egui::ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                inspector::show(ui, &self.sessions[self.active], &self.shared, wishes);
            });
        });
    }

    fn middle(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let has_pins = !self.session().pinned.is_empty();
        if self.middle == Middle::Both && has_pins {
            let height = (ui.available_height() * 0.5).max(160.0);
            let panel =
                Panel::bottom("viewer").resizable(true).default_size(height).min_size(120.0);
            panel.show(ui, |ui| self.viewer(ui, wishes));
        }
        if self.middle == Middle::Viewer && has_pins {
            CentralPanel::default().show(ui, |ui| self.viewer(ui, wishes));
            return;
        }
        CentralPanel::no_frame().show(ui, |ui| {
            files::disk_banner(self, ui);
            let Self { sessions, active, shared, catalog, settings, .. } = self;
            let session = &mut sessions[*active];
            let pinned: Vec<_> = session.pinned.iter().cloned().collect();
            let scene = Scene {
                document: &session.document,
                runner: &session.runner,
                registry: &shared.registry,
                catalog,
                settings: &settings.canvas,
                pinned: &pinned,
            };
            let actions = session.canvas.show(ui, &scene);
            wishes.extend(actions.into_iter().map(Wish::Canvas));
        });
    }

    fn viewer(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let render = self.render.clone();
        let session = &mut self.sessions[self.active];
        let pinned = session.pinned_values();
        ui.push_id(session.document.id(), |ui| {
            // All maps of a window are looked at in one way.
            session.viewer.meshes.set_look(&self.settings.meshes);
            let action = session.viewer.show(ui, &pinned, render.as_ref());
            self.settings.meshes = session.viewer.meshes.look();
            if let Some(crate::views::ViewerAction::Unpin(place)) = action
                && let Some(port) = session.pinned.get_index(place)
            {
                wishes.push(Wish::Canvas(Action::Pin(port.clone())));
            }
        });
    }

    fn show_toasts(&mut self, ui: &mut Ui) {
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

    /// Names the map that is shown in the title of the window.
    fn name_window(&mut self, ctx: &egui::Context) {
        let document = &self.session().document;
        let mark = if document.is_dirty() { "*" } else { "" };
        let title = format!("{}{mark} - mve", document.title());
        if self.window_title != title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.window_title = title;
        }
    }

    /// Keys that hold everywhere in the window.
    fn keys(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        use egui::{Key, Modifiers};
        let ctrl = Modifiers::COMMAND;
        let ctrl_shift = Modifiers::COMMAND | Modifiers::SHIFT;
        let commands = [
            (ctrl_shift, Key::S, Command::SaveAs),
            (ctrl, Key::S, Command::Save),
            (ctrl, Key::N, Command::New),
            (ctrl, Key::O, Command::Open),
            (ctrl, Key::W, Command::Close(self.active)),
            (ctrl, Key::Q, Command::Quit),
            (Modifiers::NONE, Key::F1, Command::Shortcuts),
            (Modifiers::SHIFT, Key::Escape, Command::Stop),
        ];
        if ui.ctx().memory(|memory| memory.top_modal_layer().is_some()) {
            return;
        }
        let is_typing = ui.ctx().text_edit_focused();
        ui.input_mut(|input| {
            for (modifiers, key, command) in commands {
                if input.consume_key(modifiers, key) {
                    wishes.push(Wish::Command(command));
                }
            }
            if input.consume_key(ctrl, Key::Enter)
                || (!input.modifiers.shift && input.consume_key(Modifiers::NONE, Key::F5))
            {
                wishes.push(Wish::Command(Command::Run));
            }
            // A field that is being typed in has its own undo.
            if is_typing {
                return;
            }
            if input.consume_key(ctrl_shift, Key::Z) || input.consume_key(ctrl, Key::Y) {
                wishes.push(Wish::Command(Command::Redo));
            } else if input.consume_key(ctrl, Key::Z) {
                wishes.push(Wish::Command(Command::Undo));
            }
        });
        if ui.input_mut(|input| input.consume_key(Modifiers::CTRL, Key::Tab)) {
            self.active = (self.active + 1) % self.sessions.len();
        }
    }

    /// Runs a part of the map that is shown.
    fn run(&mut self, part: Part) {
        self.session_mut().run(part);
    }
}

impl eframe::App for Editor {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.show(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if let Ok(text) = serde_json::to_string(&self.settings) {
            storage.set_string(crate::SETTINGS, text);
        }
    }
}
