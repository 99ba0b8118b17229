//! The window as a whole: open maps, menus, panels, and what is asked of them.

mod act;
mod boxes;
mod commands;
mod console;
mod dialogs;
mod files;
mod find;
mod inner;
mod inspector;
mod panels;
mod pictures;
mod repeat;
mod session;
mod settings;
mod top;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::{self, Ui};
use eframe::egui_wgpu::RenderState;
use mve_core::Registry;

use crate::canvas::Action;
use crate::document::{Document, Recovery};
use crate::programs::ProgramAction;
use crate::runner::{PART_OF_ANOTHER, Part, Shared};
use crate::views::Still;

pub use session::{Inside, Session};
pub use settings::{Settings, Theme};

/// The map that a first start shows.
const EXAMPLE: &str = include_str!("../../../../maps/simplify_and_measure.json");

/// Bytes of values that the window keeps for the next run.
const CACHE: usize = 2 << 30;

/// How often files on disk are looked at, and the map is saved for the case of a crash.
const LOOK_AT_FILES: Duration = Duration::from_secs(2);

/// The panels below the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Lower {
    Console,
    Values,
    Sheet,
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
    Program(ProgramAction),
    /// A command of a menu or a key.
    Command(Command),
    /// To read this sentence.
    Say(String),
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
    /// The box in which a picture of the meshes is saved.
    Picture,
    /// The box in which a node is found.
    Find,
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
    /// Pictures in the making, each with its file.
    stills: Vec<(PathBuf, Still)>,
    window_title: String,
    /// Number of the map that the hint for a first start is about.
    hint_for: Option<u64>,
    /// Whether the window may close without a further question.
    may_close: bool,
}

/// How a window begins.
#[derive(Default)]
pub struct Start {
    /// What was remembered.
    pub settings: Settings,
    /// Maps to open, and files that modules read.
    pub files: Vec<PathBuf>,
    /// Whether the files alone are to be seen, without the canvas.
    pub is_view: bool,
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
            stills: Vec::new(),
            window_title: String::new(),
            hint_for: None,
            may_close: false,
        };
        let is_map = |path: &&PathBuf| editor.reader_of(path).is_none();
        let (maps, read): (Vec<_>, Vec<_>) = start.files.iter().partition(is_map);
        maps.into_iter().for_each(|path| editor.open(path));
        if !read.is_empty() {
            editor.add(Document::new());
            let read: Vec<PathBuf> = read.into_iter().cloned().collect();
            editor.take_files(&read);
            if start.is_view {
                editor.middle = Middle::Viewer;
            }
        }
        if editor.sessions.is_empty() {
            let first = if start.has_example { Document::from_text(EXAMPLE).ok() } else { None };
            editor.hint_for = first.as_ref().map(Document::id);
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
        let mut session = Session::new(document, &self.shared);
        let is_taken = |n: &usize| {
            let open = &mut self.sessions.iter();
            open.any(|open| open.document.path().is_none() && open.number == *n)
        };
        session.number = (1..).find(|n| !is_taken(n)).unwrap_or(1);
        self.sessions.push(session);
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
            Err(error) => self.say_not_opened(path, &error),
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
        self.follow_inner_maps();
        let mut wishes = Vec::new();
        let commands = self.keys(ui);
        self.take_dropped(ui.ctx());
        self.take_answers();
        self.look_at_files(ui.ctx());
        self.go_on_with_pictures(ui.ctx());
        self.top(ui, &mut wishes);
        self.status_bar(ui, &mut wishes);
        self.lower(ui, &mut wishes);
        self.right(ui, &mut wishes);
        self.middle(ui, &mut wishes);
        self.hint(ui);
        self.boxes(ui, &mut wishes);
        self.command_box(ui);
        self.show_toasts(ui);
        panels::show_dragged(ui);
        panels::show_hovered(ui);
        self.guard_close(ui.ctx());
        self.name_window(ui.ctx());
        // What was being typed counts before what a key asks for.
        for wish in wishes.into_iter().chain(commands.into_iter().map(Wish::Command)) {
            self.carry_out(ui.ctx(), wish);
        }
        if self.session().runner.is_running() || self.session().programs.is_running() {
            // So that times and bars move; what happens wakes the window by itself.
            ui.ctx().request_repaint_after(Duration::from_millis(100));
        }
    }

    /// Names the map that is shown in the title of the window.
    fn name_window(&mut self, ctx: &egui::Context) {
        let session = self.session();
        let mark = if session.document.is_dirty() { "*" } else { "" };
        let title = format!("{}{mark} - mve", session.title());
        if self.window_title != title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.window_title = title;
        }
    }

    /// Keys that hold everywhere in the window; what they ask for.
    fn keys(&mut self, ui: &mut Ui) -> Vec<Command> {
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
            (ctrl, Key::F, Command::Find),
            (Modifiers::NONE, Key::F1, Command::Shortcuts),
            (Modifiers::SHIFT, Key::Escape, Command::Stop),
        ];
        let mut asked = Vec::new();
        if ui.ctx().memory(|memory| memory.top_modal_layer().is_some()) {
            return asked;
        }
        let is_typing = ui.ctx().text_edit_focused();
        ui.input_mut(|input| {
            for (modifiers, key, command) in commands {
                if input.consume_key(modifiers, key) {
                    asked.push(command);
                }
            }
            if input.consume_key(ctrl, Key::Enter)
                || (!input.modifiers.shift && input.consume_key(Modifiers::NONE, Key::F5))
            {
                asked.push(Command::Run);
            }
            // A field that is being typed in has its own undo.
            if is_typing {
                return;
            }
            if input.consume_key(ctrl_shift, Key::Z) || input.consume_key(ctrl, Key::Y) {
                asked.push(Command::Redo);
            } else if input.consume_key(ctrl, Key::Z) {
                asked.push(Command::Undo);
            }
        });
        if is_typing && !asked.is_empty() {
            // Whoever has the focus takes over what was typed when it loses it.
            ui.ctx().memory_mut(|memory| memory.focused().map(|id| memory.surrender_focus(id)));
        }
        if ui.input_mut(|input| input.consume_key(Modifiers::CTRL, Key::Tab)) {
            self.active = (self.active + 1) % self.sessions.len();
        }
        asked
    }

    /// Runs a part of the map that is shown.
    fn run(&mut self, part: Part) {
        if self.session().is_part() {
            self.toast(PART_OF_ANOTHER);
            return;
        }
        self.session_mut().run(part);
    }
}

impl eframe::App for Editor {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.show(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        let open = self.sessions.iter().filter_map(|session| session.document.path());
        self.settings.open = open.filter_map(|path| std::path::absolute(path).ok()).collect();
        if let Ok(text) = serde_json::to_string(&self.settings) {
            storage.set_string(crate::SETTINGS, text);
        }
    }
}
