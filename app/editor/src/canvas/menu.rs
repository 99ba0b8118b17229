//! Context menus of the canvas, and the field in which things get another name.

use eframe::egui::{self, Area, Frame, Id, Key, Order, TextEdit, Ui};
use mve_core::{Link, NodeMode, PortRef};

use super::camera::pos;
use super::{Action, Canvas, Scene, node_of, toggled};
use crate::document::{Alignment, Edit, Item};
use crate::forms::select_all;
use crate::runner::Part;

/// An item that gets another name or text.
pub struct TextEntry {
    item: Item,
    /// The text so far.
    text: String,
    /// Whether its field is still to be shown.
    is_new: bool,
}

impl TextEntry {
    /// Begins with the text that the item has.
    pub fn new(item: Item, text: &str) -> Self {
        Self { item, text: text.to_owned(), is_new: true }
    }
}

/// The menu of a node; it is about all selected nodes.
pub fn of_node(
    ui: &mut Ui,
    name: &str,
    scene: &Scene,
    actions: &mut Vec<Action>,
    renaming: &mut Option<TextEntry>,
) {
    let selection = scene.document.selection();
    let mut nodes: Vec<String> = selection.iter().filter_map(node_of).map(str::to_owned).collect();
    if !nodes.iter().any(|node| node == name) {
        nodes = vec![name.to_owned()];
    }
    if item(ui, "Run up to here", "Shift+F5") {
        actions.push(Action::Run(Part::UpTo(nodes.clone())));
    }
    let module = scene.document.map().nodes.get(name).and_then(|n| scene.registry.of(n));
    if let Some(info) = module.filter(|info| !info.module.outputs.is_empty()) {
        ui.menu_button("Look at", |ui| {
            for output in info.module.outputs {
                if ui.button(output.name).on_hover_text(output.doc).clicked() {
                    let port = PortRef { node: name.to_owned(), port: output.name.to_owned() };
                    actions.push(Action::Pin(port));
                }
            }
        });
    }
    ui.separator();
    if item(ui, "Rename", "F2") {
        *renaming = Some(TextEntry::new(Item::Node(name.to_owned()), name));
    }
    for (label, keys, mode) in [("Mute", "M", NodeMode::Muted), ("Bypass", "B", NodeMode::Bypassed)]
    {
        if item(ui, label, keys) {
            let mode = toggled(scene, &nodes, mode);
            actions.push(Action::Edit(vec![Edit::SetMode { nodes: nodes.clone(), mode }]));
        }
    }
    if item(ui, "Collapse", "H") {
        let is_collapsed = !scene.document.extras().collapsed.contains(name);
        let nodes = nodes.clone();
        actions.push(Action::Edit(vec![Edit::SetCollapsed { nodes, is_collapsed }]));
    }
    if item(ui, "Picture", "P") {
        let is_pictured = !scene.document.extras().pictured.contains(name);
        let nodes = nodes.clone();
        actions.push(Action::Edit(vec![Edit::SetPictured { nodes, is_pictured }]));
    }
    if nodes.len() > 1 {
        ui.menu_button("Align", |ui| align_menu(ui, &nodes, actions));
    }
    if item(ui, "Arrange", "L") {
        let nodes = if nodes.len() > 1 { nodes.clone() } else { Vec::new() };
        actions.push(Action::Edit(vec![Edit::Arrange { nodes }]));
    }
    ui.separator();
    map_menu(ui, name, &nodes, scene, actions);
    ui.separator();
    clipboard_menu(ui, actions);
    if item(ui, "Duplicate", "Ctrl+D") {
        actions.push(Action::Duplicate);
    }
    if item(ui, "Delete", "Del") {
        let items = nodes.into_iter().map(Item::Node).collect();
        actions.push(Action::Edit(vec![Edit::Remove(items)]));
    }
}

/// What makes maps of nodes, and nodes of maps.
fn map_menu(ui: &mut Ui, name: &str, nodes: &[String], scene: &Scene, actions: &mut Vec<Action>) {
    let make = if nodes.len() > 1 { "Make a map of these" } else { "Make a map of it" };
    if item(ui, make, "Ctrl+G") {
        actions.push(make_map(nodes));
    }
    let map = scene.document.map();
    let node = map.nodes.get(name);
    if node.is_some_and(mve_core::Node::is_map) && item(ui, "Open its map", "Enter") {
        actions.push(Action::OpenMap(name.to_owned()));
    }
    let is_of_file = node.is_some_and(|node| map.maps.contains_key(&node.module));
    if is_of_file && item(ui, "Unpack its map", "Ctrl+Shift+G") {
        actions.push(Action::Edit(vec![Edit::Unpack { node: name.to_owned() }]));
    }
}

/// What makes a map of some nodes.
pub fn make_map(nodes: &[String]) -> Action {
    Action::Edit(vec![Edit::MakeMap { nodes: nodes.to_vec(), name: None }])
}

fn align_menu(ui: &mut Ui, nodes: &[String], actions: &mut Vec<Action>) {
    let items: Vec<Item> = nodes.iter().cloned().map(Item::Node).collect();
    for (label, to) in [
        ("Left edges", Alignment::Left),
        ("Centers", Alignment::Center),
        ("Right edges", Alignment::Right),
        ("Tops", Alignment::Top),
        ("Middles", Alignment::Middle),
        ("Bottoms", Alignment::Bottom),
    ] {
        if ui.button(label).clicked() {
            actions.push(Action::Edit(vec![Edit::Align { items: items.clone(), to }]));
        }
    }
}

fn clipboard_menu(ui: &mut Ui, actions: &mut Vec<Action>) {
    if item(ui, "Copy", "Ctrl+C") {
        actions.push(Action::Copy);
    }
    if item(ui, "Cut", "Ctrl+X") {
        actions.push(Action::Cut);
    }
}

/// What the menu of the empty canvas asks for beside actions.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum MenuChoice {
    /// Nothing.
    Nothing,
    /// The search of modules.
    Search,
    /// A note.
    Note,
}

/// The menu of the empty canvas.
pub fn of_canvas(
    ui: &mut Ui,
    at: [f64; 2],
    scene: &Scene,
    actions: &mut Vec<Action>,
) -> MenuChoice {
    let mut choice = MenuChoice::Nothing;
    if item(ui, "Add a module…", "Tab") {
        choice = MenuChoice::Search;
    }
    if item(ui, "Add a note", "N") {
        choice = MenuChoice::Note;
    }
    if item(ui, "Add a frame", "") {
        let (title, size) = ("Frame".to_owned(), [320.0, 240.0]);
        actions.push(Action::Edit(vec![Edit::AddFrame { title, at, size }]));
    }
    if item(ui, "Paste", "Ctrl+V") {
        actions.push(Action::RequestPaste);
    }
    ui.separator();
    if item(ui, "Arrange all", "L") {
        actions.push(Action::Edit(vec![Edit::Arrange { nodes: Vec::new() }]));
    }
    if item(ui, "Select all", "Ctrl+A") {
        actions.push(Action::Select(scene.document.all_items()));
    }
    if item(ui, "Run", "F5") {
        actions.push(Action::Run(Part::All));
    }
    choice
}

/// The menu of a wire.
pub fn of_wire(ui: &mut Ui, link: &Link, at: [f64; 2], actions: &mut Vec<Action>) {
    ui.weak(link.to_string());
    if item(ui, "Look at its value", "") {
        actions.push(Action::Pin(link.from.clone()));
    }
    if item(ui, "Add a point to route it through", "") {
        actions.push(Action::Edit(vec![Edit::AddReroute { link: link.clone(), at }]));
    }
    if item(ui, "Delete", "Del") {
        actions.push(Action::Edit(vec![Edit::Disconnect(link.clone())]));
    }
}

/// The menu of a frame, a note or a reroute point.
pub fn of_box(
    ui: &mut Ui,
    boxed: &Item,
    text: &str,
    actions: &mut Vec<Action>,
    renaming: &mut Option<TextEntry>,
) {
    if !matches!(boxed, Item::Reroute(_)) {
        if item(ui, "Edit the text", "F2") {
            *renaming = Some(TextEntry::new(boxed.clone(), text));
        }
        ui.horizontal(|ui| {
            for color in
                [[110, 120, 150], [225, 195, 95], [110, 170, 110], [190, 110, 110], [150, 110, 180]]
            {
                let fill = egui::Color32::from_rgb(color[0], color[1], color[2]);
                if ui.add(egui::Button::new("   ").fill(fill)).clicked() {
                    let edit = Edit::SetColor { item: boxed.clone(), color: Some(color) };
                    actions.push(Action::Edit(vec![edit]));
                }
            }
        });
    }
    if item(ui, "Delete", "Del") {
        actions.push(Action::Edit(vec![Edit::Remove(vec![boxed.clone()])]));
    }
}

/// A line of a menu with its keys.
fn item(ui: &mut Ui, label: &str, keys: &str) -> bool {
    ui.add(egui::Button::new(label).shortcut_text(keys)).clicked()
}

impl Canvas {
    /// Opens the field in which an item gets another text.
    pub(super) fn rename(&mut self, item: &Item, scene: &Scene) {
        let extras = scene.document.extras();
        let text = match item {
            Item::Node(name) => Some(name),
            Item::Frame(name) => extras.frames.get(name).map(|frame| &frame.title),
            Item::Note(name) => extras.notes.get(name).map(|note| &note.text),
            Item::Reroute(_) | Item::Link(_) => None,
        };
        self.renaming = text.map(|text| TextEntry::new(item.clone(), text));
    }

    /// Adds a note, to be written at once.
    pub(super) fn add_note(&mut self, at: [f64; 2], actions: &mut Vec<Action>) {
        actions.push(Action::Edit(vec![Edit::AddNote { text: "A note".to_owned(), at }]));
        self.wants_to_write = true;
    }

    /// The field in which a node, frame or note gets another text.
    pub(super) fn rename_popup(&mut self, ui: &mut Ui, scene: &Scene, actions: &mut Vec<Action>) {
        // What was added in the last frame is what is selected in this one.
        if let Some(new @ (Item::Note(_) | Item::Frame(_))) = scene.document.selection().first()
            && std::mem::take(&mut self.wants_to_write)
        {
            self.rename(new, scene);
        }
        let Some(TextEntry { item, text, is_new }) = &mut self.renaming else { return };
        let extras = scene.document.extras();
        let place = match item {
            Item::Node(name) => self.shapes.nodes.get(name).map(|shape| shape.at),
            Item::Frame(name) => extras.frames.get(name).map(|frame| pos(frame.at)),
            Item::Note(name) => extras.notes.get(name).map(|note| pos(note.at)),
            Item::Reroute(_) | Item::Link(_) => None,
        };
        let (Some(place), Some(view)) = (place, self.view) else {
            self.renaming = None;
            return;
        };
        let is_note = matches!(item, Item::Note(_));
        let is_new = std::mem::take(is_new);
        let area = Area::new(Id::new("rename")).order(Order::Foreground).constrain(true);
        let shown = area.fixed_pos(view.to_screen(place)).show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                let edit = match is_note {
                    true => TextEdit::multiline(text),
                    false => TextEdit::singleline(text),
                };
                let field = ui.add(edit.desired_width(200.0));
                ui.ctx().accesskit_node_builder(field.id, |node| node.set_label("new name"));
                field.request_focus();
                if is_new {
                    select_all(&field, text.chars().count());
                }
            });
        });
        let (enter, escape) =
            ui.input(|input| (input.key_pressed(Key::Enter), input.key_pressed(Key::Escape)));
        // The click that opened the field is none beside it.
        let is_done = (enter && !is_note) || (!is_new && shown.response.clicked_elsewhere());
        if !is_done && !escape {
            return;
        }
        let Some(TextEntry { item, text, .. }) = self.renaming.take() else { return };
        // What was written into a note is not to be lost; undo brings back what was there.
        if escape && !is_note {
            return;
        }
        let edit = match item {
            Item::Node(node) if node != text && !text.is_empty() => Edit::Rename { node, to: text },
            Item::Node(_) => return,
            item => Edit::SetText { item, text },
        };
        actions.push(Action::Edit(vec![edit]));
    }
}
