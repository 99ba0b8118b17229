//! A hand at the window: it knows things by their accessible names, and nothing else.

mod wait;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use eframe::egui::{self, Key, Modifiers, Pos2, Vec2};
use eframe::egui_wgpu::RenderState;
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, SnapshotOptions};
use mve_core::Map;
use mve_editor::app::{Editor, Session, Settings, Start};

/// How long a run of a test may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// A file that was dropped.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// What a window is opened on.
enum Maps {
    /// Files; none for an empty map.
    Files(Vec<PathBuf>),
    /// The map that a first start shows.
    Example,
}

/// A hand at a window without a display.
pub struct Hand {
    harness: Harness<'static, Option<Editor>>,
    output_folder: PathBuf,
}

impl Hand {
    /// A window on an empty map, whose savers write below `folder`.
    pub fn new(folder: &Path) -> Self {
        Self::with(folder, Vec::new())
    }

    /// A window on a map's file.
    pub fn with_map(folder: &Path, map: &Path) -> Self {
        Self::with(folder, vec![map.to_owned()])
    }

    /// A window on a map in a file of its own.
    pub fn with_text(folder: &Path, map: &str) -> Self {
        let path = folder.join("map.json");
        std::fs::write(&path, map).expect("the folder takes files");
        Self::with_map(folder, &path)
    }

    /// The same, once the map has run.
    pub fn with_run(folder: &Path, map: &str) -> Self {
        let mut hand = Self::with_text(folder, map);
        hand.press(Key::F5);
        hand.wait_until_up_to_date();
        hand
    }

    /// A window of some size on the example, drawn by a certain rasterizer.
    pub fn with_example(folder: &Path, render: RenderState, size: Vec2) -> Self {
        Self::drawn_by(render, folder, Maps::Example, size)
    }

    /// A window on maps and on files that modules read.
    pub fn with_files(folder: &Path, files: Vec<PathBuf>) -> Self {
        Self::with(folder, files)
    }

    fn with(folder: &Path, maps: Vec<PathBuf>) -> Self {
        let setup = egui_kittest::wgpu::default_wgpu_setup();
        let render = egui_kittest::wgpu::create_render_state(
            setup,
            eframe::egui_wgpu::RendererOptions::PREDICTABLE,
        );
        Self::drawn_by(render, folder, Maps::Files(maps), Vec2::new(1500.0, 950.0))
    }

    fn drawn_by(render: RenderState, folder: &Path, maps: Maps, size: Vec2) -> Self {
        let output_folder = folder.join("out");
        let out = output_folder.clone();
        let renderer = egui_kittest::wgpu::WgpuTestRenderer::from_render_state(render.clone());
        let draw = move |ui: &mut egui::Ui, editor: &mut Option<Editor>| {
            let start = || Start {
                settings: Settings { has_seen_hint: true, ..Settings::default() },
                output_folder: Some(out.clone()),
                files: match &maps {
                    Maps::Files(maps) => maps.clone(),
                    Maps::Example => Vec::new(),
                },
                has_example: matches!(maps, Maps::Example),
                render: Some(render.clone()),
                ..Start::default()
            };
            let new = || Editor::new(ui.ctx(), wait::registry(), start());
            editor.get_or_insert_with(new).show(ui);
        };
        let harness =
            // Frames as short as those of a screen, for what a hand does twice within a moment.
            Harness::builder()
                .with_size(size)
                .with_step_dt(1.0 / 30.0)
                .renderer(renderer)
                .build_ui_state(draw, None);
        Self { harness, output_folder }
    }

    /// The window.
    pub fn editor(&self) -> &Editor {
        self.harness.state().as_ref().expect("the first frame makes it")
    }

    /// The map that is shown.
    pub fn map(&self) -> Arc<Map> {
        Arc::clone(self.editor().session().document.map())
    }

    /// Where savers write.
    pub fn output_folder(&self) -> &Path {
        &self.output_folder
    }

    /// Draws a few frames.
    pub fn step(&mut self) {
        self.harness.run_steps(3);
    }

    /// A picture of the window.
    pub fn picture(&mut self) -> image::RgbaImage {
        self.harness.render().expect("there is a rasterizer")
    }

    /// Compares the window with the picture of this name.
    pub fn snapshot(&mut self, name: &str, options: &SnapshotOptions) {
        self.harness.snapshot_options(name, options);
    }

    /// Lets a file fall on the window.
    pub fn drop_file(&mut self, path: &Path) {
        let file = Arc::new(Dropped(path.to_owned()));
        self.harness.input_mut().dropped_files.push(file);
        self.step();
    }

    /// Hands an event to the window.
    pub fn event(&mut self, event: egui::Event) {
        self.harness.event(event);
    }

    /// Draws one frame.
    pub fn step_once(&mut self) {
        self.harness.step();
    }

    fn editor_mut(&mut self) -> &mut Editor {
        self.harness.state_mut().as_mut().expect("the first frame makes it")
    }

    /// Shows the value of an output.
    pub fn pin(&mut self, node: &str, port: &str) {
        let port = mve_core::PortRef { node: node.to_owned(), port: port.to_owned() };
        self.editor_mut().session_mut().pinned.insert(port);
        self.step();
    }

    /// Changes the map as its text would.
    pub fn edit(&mut self, edits: &[mve_editor::document::Edit]) {
        let Session { document, runner, .. } = self.editor_mut().session_mut();
        document.apply(edits, runner.registry()).expect("it can be done");
        self.step();
    }

    /// Shows no values.
    pub fn unpin_all(&mut self) {
        self.editor_mut().session_mut().pinned.clear();
        self.step();
    }

    /// Draws frames until meshes are prepared and drawn.
    pub fn wait_for_the_views(&mut self) {
        self.wait(|session| !session.viewer.is_busy());
    }

    /// Draws frames until the pictures on nodes are made.
    pub fn wait_for_the_pictures(&mut self) {
        self.wait(|session| !session.canvas.is_busy());
    }

    /// Draws frames until the program has come to its end.
    pub fn wait_for_the_program(&mut self) {
        self.wait(|session| !session.programs.is_running());
    }

    fn wait(&mut self, is_done: impl Fn(&Session) -> bool) {
        let start = Instant::now();
        loop {
            self.step();
            if is_done(self.editor().session()) {
                return;
            }
            assert!(start.elapsed() < PATIENCE, "it takes too long");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Clicks what has this name.
    pub fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.step();
    }

    /// Whether something has a name that begins so.
    pub fn sees_beginning(&self, beginning: &str) -> bool {
        let begins = |node: &egui_kittest::kittest::AccessKitNode| {
            [node.label(), node.value()]
                .into_iter()
                .flatten()
                .any(|text| text.starts_with(beginning))
        };
        self.harness.query_all_by(begins).next().is_some()
    }

    /// Clicks what has a name that begins so.
    pub fn click_beginning(&mut self, beginning: &str) {
        self.node_beginning(beginning).click();
        self.step();
    }

    /// The whole name of what has one that begins so.
    pub fn name_beginning(&self, beginning: &str) -> String {
        self.node_beginning(beginning).accesskit_node().label().unwrap_or_default()
    }

    fn node_beginning<'a>(&'a self, beginning: &'a str) -> egui_kittest::Node<'a> {
        let begins = move |node: &egui_kittest::kittest::AccessKitNode| {
            node.label().is_some_and(|label| label.starts_with(beginning))
        };
        self.harness.get_by(begins)
    }

    /// The names that begin so, from the top of the window to its bottom.
    pub fn names_beginning(&self, beginning: &str) -> Vec<String> {
        let begins = |node: &egui_kittest::kittest::AccessKitNode| {
            node.label().is_some_and(|label| label.starts_with(beginning))
        };
        let found = self.harness.query_all_by(begins);
        let label = |node: egui_kittest::Node| node.accesskit_node().label().unwrap_or_default();
        let mut found: Vec<_> = found.map(|node| (node.rect().top(), label(node))).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, label)| label).collect()
    }

    /// Clicks what has this name, and waits for what it puts on the clipboard.
    pub fn click_to_copy(&mut self, name: &str) -> String {
        self.harness.get_by_label(name).click();
        self.wait_for_the_clipboard()
    }

    /// Draws frames until something is put on the clipboard; what that is.
    pub fn wait_for_the_clipboard(&mut self) -> String {
        let start = Instant::now();
        loop {
            let commands = &self.harness.output().platform_output.commands;
            let copied = commands.iter().find_map(|command| match command {
                egui::OutputCommand::CopyText(text) => Some(text.clone()),
                _ => None,
            });
            if let Some(text) = copied {
                return text;
            }
            assert!(start.elapsed() < PATIENCE, "nothing is copied");
            std::thread::sleep(Duration::from_millis(1));
            self.harness.step();
        }
    }

    /// Clicks the last of the things that have this name.
    pub fn click_last(&mut self, name: &str) {
        let last = self.harness.query_all_by_label(name).last();
        last.expect("something has the name").click();
        self.step();
    }

    /// Whether something has this name.
    pub fn sees(&self, name: &str) -> bool {
        self.harness.query_all_by_label(name).next().is_some()
    }

    /// What a screen reader adds to this name.
    pub fn description(&self, name: &str) -> String {
        let node = self.harness.get_by_label(name);
        node.accesskit_node().description().unwrap_or_default()
    }

    /// The height in points of what has a name that begins so.
    pub fn height_of(&self, beginning: &str) -> f32 {
        let begins = |node: &egui_kittest::kittest::AccessKitNode| {
            node.label().is_some_and(|label| label.starts_with(beginning))
        };
        self.harness.get_by(begins).rect().height()
    }

    /// After what time the window at rest wants to be drawn again.
    pub fn next_frame_wanted(&self) -> Duration {
        self.harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay
    }

    /// Presses a key.
    pub fn press(&mut self, key: Key) {
        self.press_with(Modifiers::NONE, key);
    }

    /// Presses a key with others held.
    pub fn press_with(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.step();
    }

    /// Adds a module by its search.
    pub fn add(&mut self, module: &str) {
        self.click("+ Module");
        let field = self.harness.get_by_role_and_label(Role::TextInput, "search modules");
        field.type_text(module);
        self.step();
        self.press(Key::Enter);
    }

    /// Types into a field and leaves it.
    pub fn type_into(&mut self, name: &str, text: &str) {
        // What the check of the map finds stands above the field, and moves it.
        self.problems();
        self.harness.get_by_role_and_label(Role::TextInput, name).click();
        self.step();
        self.harness.get_by_role_and_label(Role::TextInput, name).type_text(text);
        self.step();
        self.press(Key::Enter);
    }

    /// Types into what has the focus.
    pub fn type_text(&mut self, text: &str) {
        self.event(egui::Event::Text(text.to_owned()));
        self.step();
    }

    /// Types into a field in place of what it holds.
    pub fn replace_text(&mut self, name: &str, text: &str) {
        self.harness.get_by_role_and_label(Role::TextInput, name).click();
        self.step();
        self.press_with(Modifiers::COMMAND, Key::A);
        self.type_text(text);
    }

    /// Clicks a field of a number, to type.
    pub fn click_number(&mut self, name: &str) {
        self.harness.get_by_role_and_label(Role::SpinButton, name).click();
        self.step();
    }

    /// Types into a field of a number, in place of what it shows, and leaves it.
    pub fn type_number(&mut self, name: &str, text: &str) {
        self.problems();
        self.click_number(name);
        self.press_with(Modifiers::COMMAND, Key::A);
        self.type_text(text);
        self.press(Key::Enter);
    }

    /// Types into the last of the fields of a number that have this name.
    pub fn type_last_number(&mut self, name: &str, text: &str) {
        let last = self.harness.query_all_by_role_and_label(Role::SpinButton, name).last();
        last.expect("a field has the name").click();
        self.step();
        self.press_with(Modifiers::COMMAND, Key::A);
        self.type_text(text);
        self.press(Key::Enter);
    }

    /// Moves the pointer to a place within what has this name: shares of its width and height.
    pub fn point_within(&mut self, name: &str, x: f32, y: f32) -> Pos2 {
        let at = self.harness.get_by_label(name).rect().lerp_inside(Vec2::new(x, y));
        self.harness.hover_at(at);
        self.step();
        at
    }

    /// Clicks a place within what has this name.
    pub fn click_at(&mut self, name: &str, x: f32, y: f32) {
        let at = self.point_within(name, x, y);
        self.harness.drag_at(at);
        self.step();
        self.harness.drop_at(at);
        self.step();
    }

    /// Clicks twice what has this name.
    pub fn double_click(&mut self, name: &str) {
        let at = self.place_of(name);
        self.harness.hover_at(at);
        // So long that clicks before do not count along.
        self.harness.run_steps(30);
        for _ in 0..2 {
            self.harness.drag_at(at);
            self.harness.step();
            self.harness.drop_at(at);
            self.harness.step();
        }
        self.step();
    }

    /// Drags what has this name by its upper edge.
    pub fn drag_held(&mut self, name: &str, by: Vec2) {
        let rect = self.harness.get_by_label(name).rect();
        let from = rect.center_top() + Vec2::new(0.0, 6.0);
        self.drag(from, from + by);
    }

    /// Drags from one thing to another.
    pub fn link(&mut self, from: &str, to: &str) {
        let (from, to) = (self.place_of(from), self.place_of(to));
        self.drag(from, to);
    }

    /// The middle of what has this name.
    pub fn place_of(&self, name: &str) -> Pos2 {
        self.harness.get_by_label(name).rect().center()
    }

    /// Moves the pointer to the edge of what has this name, where nothing else lies.
    pub fn point_at(&mut self, name: &str) {
        let at = self.harness.get_by_label(name).rect().left_bottom() + Vec2::new(6.0, -6.0);
        self.harness.hover_at(at);
        self.step();
    }

    /// Drags from one point of the window to another.
    pub fn drag(&mut self, from: Pos2, to: Pos2) {
        self.harness.hover_at(from);
        self.step();
        self.harness.drag_at(from);
        self.step();
        self.harness.hover_at(from + (to - from) * 0.5);
        self.step();
        self.harness.hover_at(to);
        self.step();
        self.harness.drop_at(to);
        self.step();
    }

    /// Draws frames until a node works.
    pub fn wait_until_it_works(&mut self, node: &str) {
        self.wait(|session| {
            let progress = session.runner.progress();
            progress.and_then(|at| at.working).is_some_and(|(working, _)| working == node)
        });
    }

    /// Draws frames until all outputs are those of the map as it stands.
    pub fn wait_until_up_to_date(&mut self) {
        self.wait(|session| {
            let is_checked = session.runner.checked().revision == session.document.revision();
            is_checked && !session.runner.is_running() && session.has_changes_to_run().is_none()
        });
    }

    /// Draws frames until an output is no longer that of the map and its files.
    pub fn wait_until_something_is_to_be_run(&mut self) {
        self.wait(|session| session.has_changes_to_run().is_some());
    }

    /// The value of an output.
    pub fn value<T: mve_core::Data>(&self, node: &str, port: &str) -> Arc<T> {
        let value = self.editor().session().runner.value(node, port);
        value.and_then(|value| value.get::<T>()).expect("it has run")
    }

    /// Draws frames until the run has come to its end.
    pub fn wait_for_the_run(&mut self) {
        self.wait(|session| !session.runner.is_running());
    }

    /// What is wrong with the map, once it has been checked.
    pub fn problems(&mut self) -> Vec<String> {
        self.wait(|session| session.runner.checked().revision == session.document.revision());
        self.editor().session().runner.problems().iter().map(ToString::to_string).collect()
    }
}
