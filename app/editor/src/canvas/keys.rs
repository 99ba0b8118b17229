//! Keys that the canvas answers to while the pointer is over it or it has the focus.

use eframe::egui::{Event, Key, Modifiers, Response, Ui};
use mve_core::NodeMode;

use super::{Action, Canvas, Scene, menu, node_of, toggled};
use crate::document::Edit;
use crate::runner::Part;

/// All keys and gestures of the canvas.
pub const SHORTCUTS: &[(&str, &str)] = &[
    ("Tab, double click", "search a module and add it"),
    ("drag a port", "link it; on empty canvas, add a module that fits"),
    ("drag a node onto a wire", "put it between the ends"),
    ("click an output", "look at its value"),
    ("middle drag, Space + drag", "pan"),
    ("wheel, pinch", "zoom"),
    ("drag on empty canvas", "select what the box touches"),
    ("Shift, Ctrl + click", "select one more, or one less"),
    ("F", "show the selection, or all"),
    ("Home", "show all"),
    ("Delete, Backspace", "remove the selection"),
    ("Ctrl + C, X, V", "copy, cut, paste"),
    ("Ctrl + D", "duplicate with the links into it"),
    ("Ctrl + A", "select all"),
    ("F2, double click a title", "rename; edit the text of a note or frame"),
    ("M", "mute: do not run"),
    ("B", "bypass: pass the input through"),
    ("H", "collapse to the title"),
    ("P", "show a picture of what it gives"),
    ("G", "put a frame around the selection"),
    ("Ctrl + G", "make a map of the selected nodes, with one node in their place"),
    ("Enter", "open the map that a node stands for"),
    ("Ctrl + Shift + G", "put the nodes of a map in the place of its node"),
    ("N", "add a note"),
    ("L", "arrange the selection, or all"),
    ("Shift + F5", "run up to the selected nodes"),
    ("double click a wire", "add a point to route it through"),
];

impl Canvas {
    pub(super) fn keys(
        &mut self,
        ui: &mut Ui,
        back: &Response,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) {
        let is_typing = ui.ctx().text_edit_focused();
        let is_covered = ui.ctx().memory(|memory| memory.top_modal_layer().is_some());
        let is_busy = self.search.is_some() || self.renaming.is_some() || self.open_param.is_some();
        // Elsewhere a letter may be meant for a field that is about to get the focus.
        let is_here = back.has_focus() || back.contains_pointer() || self.is_over_node(ui);
        if is_typing || is_covered || is_busy {
            return;
        }
        let place = self.pointer_place(ui);
        let events = ui.input(|input| input.events.clone());
        for event in events {
            match event {
                // Nothing else takes a part of a map.
                Event::Paste(text) => actions.push(Action::Paste(text, place)),
                _ if !is_here => {}
                Event::Copy => actions.push(Action::Copy),
                Event::Cut => actions.push(Action::Cut),
                Event::Key { key, pressed: true, modifiers, .. } => {
                    self.key(ui, key, modifiers, scene, actions);
                }
                _ => {}
            }
        }
    }

    /// Whether the pointer is over the canvas, on what lies on it, and under nothing else.
    fn is_over_node(&self, ui: &Ui) -> bool {
        let pointer = ui.input(|input| input.pointer.hover_pos());
        self.view.zip(pointer).is_some_and(|(view, at)| {
            let is_on_top = ui.ctx().layer_id_at(at).is_none_or(|layer| layer == ui.layer_id());
            view.screen.contains(at) && is_on_top
        })
    }

    /// The point of the canvas below the pointer, or in the middle.
    fn pointer_place(&self, ui: &Ui) -> [f64; 2] {
        let pointer = ui.input(|input| input.pointer.hover_pos());
        let at = self.view.zip(pointer).filter(|(view, at)| view.screen.contains(*at));
        at.map_or(self.free_place(), |(view, at)| {
            let world = view.to_world(at);
            [f64::from(world.x), f64::from(world.y)]
        })
    }

    fn key(
        &mut self,
        ui: &mut Ui,
        key: Key,
        modifiers: Modifiers,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) {
        let selection = scene.document.selection();
        let nodes: Vec<String> = selection.iter().filter_map(node_of).map(str::to_owned).collect();
        if modifiers.command {
            actions.extend(with_command(key, modifiers, nodes, scene));
            return;
        }
        match key {
            Key::Tab if modifiers.is_none() => self.search_by_key(ui),
            Key::F => self.fit_selection(),
            Key::Home => self.fit(),
            Key::Delete | Key::Backspace if !selection.is_empty() => {
                actions.push(Action::Edit(vec![Edit::Remove(selection.iter().cloned().collect())]));
            }
            Key::Enter if modifiers.is_none() && nodes.len() == 1 => {
                actions.push(Action::OpenMap(nodes[0].clone()));
            }
            Key::F5 if modifiers.shift && !nodes.is_empty() => {
                actions.push(Action::Run(Part::UpTo(nodes)));
            }
            Key::F2 => {
                let mut items = selection.iter();
                if let (Some(item), None) = (items.next(), items.next()) {
                    self.rename(item, scene);
                }
            }
            Key::M if !nodes.is_empty() => {
                let mode = toggled(scene, &nodes, NodeMode::Muted);
                actions.push(Action::Edit(vec![Edit::SetMode { nodes, mode }]));
            }
            Key::B if !nodes.is_empty() => {
                let mode = toggled(scene, &nodes, NodeMode::Bypassed);
                actions.push(Action::Edit(vec![Edit::SetMode { nodes, mode }]));
            }
            Key::H if !nodes.is_empty() => {
                let collapsed = &scene.document.extras().collapsed;
                let is_collapsed = !nodes.iter().all(|node| collapsed.contains(node));
                actions.push(Action::Edit(vec![Edit::SetCollapsed { nodes, is_collapsed }]));
            }
            Key::P if !nodes.is_empty() => {
                let pictured = &scene.document.extras().pictured;
                let is_pictured = !nodes.iter().all(|node| pictured.contains(node));
                actions.push(Action::Edit(vec![Edit::SetPictured { nodes, is_pictured }]));
            }
            Key::G => self.frame_selection(&nodes, actions),
            Key::N => {
                let at = self.pointer_place(ui);
                self.add_note(at, actions);
            }
            Key::L => {
                let nodes = if nodes.len() > 1 { nodes } else { Vec::new() };
                actions.push(Action::Edit(vec![Edit::Arrange { nodes }]));
            }
            _ => {}
        }
    }

    /// Opens the search below the pointer, or in the middle.
    fn search_by_key(&mut self, ui: &Ui) {
        let pointer = ui.input(|input| input.pointer.hover_pos());
        match pointer.filter(|at| self.view.is_some_and(|view| view.screen.contains(*at))) {
            Some(at) => self.search_at(at, None),
            None => self.open_search(),
        }
    }

    /// Puts a frame around the selected nodes, to be named at once.
    fn frame_selection(&mut self, nodes: &[String], actions: &mut Vec<Action>) {
        let names = nodes.iter().map(String::as_str);
        let Some(bounds) = self.shapes.bounds(names).filter(|_| !nodes.is_empty()) else { return };
        let bounds = bounds.expand(20.0);
        let at = [f64::from(bounds.min.x), f64::from(bounds.min.y) - 20.0];
        let size = [f64::from(bounds.width()), f64::from(bounds.height()) + 20.0];
        let title = "Frame".to_owned();
        actions.push(Action::Edit(vec![Edit::AddFrame { title, at, size }]));
        self.wants_to_write = true;
    }
}

/// What a key with Ctrl asks for.
fn with_command(
    key: Key,
    modifiers: Modifiers,
    nodes: Vec<String>,
    scene: &Scene,
) -> Option<Action> {
    match key {
        Key::G if modifiers.shift => {
            let edits = nodes.into_iter().map(|node| Edit::Unpack { node });
            Some(Action::Edit(edits.collect()))
        }
        Key::G if !nodes.is_empty() => Some(menu::make_map(&nodes)),
        Key::D => Some(Action::Duplicate),
        Key::A => Some(Action::Select(scene.document.all_items())),
        _ => None,
    }
}
