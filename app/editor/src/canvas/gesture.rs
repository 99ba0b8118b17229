//! What a drag on the canvas does, from its first to its last frame.

use eframe::egui::{self, Pos2, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo, WidgetType};
use mve_core::{Link, PortRef};

use super::camera::{pos, rect_of};
use super::insert::Insertion;
use super::menu::{self, TextEntry};
use super::paint::{Brush, FrameMark};
use super::shape::Port;
use super::{Action, Canvas, Scene};
use crate::document::{CanvasFrame, Edit, Item, fits};

/// The grid that nodes come to rest on, in units of the canvas.
const GRID: f64 = 10.0;
/// Size of the corner by which a frame is resized.
const CORNER: f32 = 14.0;

/// The end that a link under way already has.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// It comes from this output and looks for an input.
    From(PortRef),
    /// It goes to this input and looks for an output.
    To(PortRef),
}

/// A drag under way.
#[derive(Debug, Default)]
pub enum Gesture {
    /// None.
    #[default]
    Idle,
    /// A box around what is to be selected, from this point of the canvas.
    Select(Pos2),
    /// Items move; their places before, and how far they have come.
    Move { items: Vec<(Item, [f64; 2])>, by: Vec2 },
    /// A link looks for its other end. `was` is the link that was taken off its input.
    Link { end: End, was: Option<Link> },
    /// A frame gets another size.
    Resize { frame: String, size: [f64; 2], by: Vec2 },
}

impl Gesture {
    /// A link from an output; from an input that has a link, that link is taken off.
    pub fn start_link(at: &PortRef, is_output: bool, scene: &Scene) -> Self {
        if is_output {
            return Self::Link { end: End::From(at.clone()), was: None };
        }
        match scene.document.map().links.iter().find(|link| link.to == *at) {
            Some(link) => Self::Link { end: End::From(link.from.clone()), was: Some(link.clone()) },
            None => Self::Link { end: End::To(at.clone()), was: None },
        }
    }

    /// Whether a link is in the hand, and so not drawn where the map has it.
    pub fn holds(&self, link: &Link) -> bool {
        matches!(self, Self::Link { was: Some(was), .. } if was == link)
    }

    /// How far an item is from where the document has it.
    pub fn shift(&self, item: &Item) -> Vec2 {
        match self {
            Self::Move { items, by } if items.iter().any(|(moved, _)| moved == item) => *by,
            _ => Vec2::ZERO,
        }
    }

    /// The same for a node.
    pub fn shift_of_node(&self, node: &str) -> Vec2 {
        let is_it = |item: &Item| matches!(item, Item::Node(name) if name == node);
        match self {
            Self::Move { items, by } if items.iter().any(|(moved, _)| is_it(moved)) => *by,
            _ => Vec2::ZERO,
        }
    }

    /// Whether the link under way cannot end at a port.
    pub fn refuses(&self, port: &Port, scene: &Scene) -> bool {
        let Self::Link { end, .. } = self else { return false };
        let link = link_to(end, &port.at);
        if end.port() == &port.at {
            return false;
        }
        fits(scene.document.map(), scene.registry, &link).is_err()
    }
}

impl End {
    /// The port that it has.
    pub fn port(&self) -> &PortRef {
        match self {
            Self::From(port) | Self::To(port) => port,
        }
    }
}

/// The link between an end and a port.
pub fn link_to(end: &End, port: &PortRef) -> Link {
    match end {
        End::From(from) => Link { from: from.clone(), to: port.clone() },
        End::To(to) => Link { from: port.clone(), to: to.clone() },
    }
}

impl Canvas {
    /// Selects what was clicked, alone or with what is selected already.
    pub(super) fn click_item(
        &self,
        ui: &Ui,
        item: &Item,
        is_for_menu: bool,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) {
        let selection = scene.document.selection();
        let adds = ui.input(|input| input.modifiers.shift || input.modifiers.command);
        if is_for_menu && selection.contains(item) {
            return;
        }
        let chosen = match (adds, selection.contains(item)) {
            (true, true) => selection.iter().filter(|other| *other != item).cloned().collect(),
            (true, false) => selection.iter().chain([item]).cloned().collect(),
            _ => vec![item.clone()],
        };
        actions.push(Action::Select(chosen));
    }

    /// Takes the selection into the hand, or an item that is not part of it alone.
    pub(super) fn start_move(
        &mut self,
        ui: &Ui,
        item: &Item,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) {
        let mut items: Vec<Item> = match scene.document.selection().contains(item) {
            true => scene.document.selection().iter().cloned().collect(),
            false => {
                actions.push(Action::Select(vec![item.clone()]));
                vec![item.clone()]
            }
        };
        let carried: Vec<Item> = items.iter().flat_map(|item| self.inside(item, scene)).collect();
        for item in carried {
            if !items.contains(&item) {
                items.push(item);
            }
        }
        if ui.input(|input| input.modifiers.alt) {
            items.retain(|item| !matches!(item, Item::Frame(_)));
        }
        let place = |item: Item| scene.document.position(&item).map(|at| (item, at));
        let items = items.into_iter().filter_map(place).collect();
        self.gesture = Gesture::Move { items, by: Vec2::ZERO };
    }

    /// What lies within a frame, and so moves with it.
    fn inside(&self, item: &Item, scene: &Scene) -> Vec<Item> {
        let Item::Frame(name) = item else { return Vec::new() };
        let Some(frame) = scene.document.extras().frames.get(name) else { return Vec::new() };
        let rect = rect_of(frame.at, frame.size);
        let nodes = self.shapes.nodes.iter().filter(|(_, shape)| holds(frame, shape.rect()));
        let notes =
            scene.document.extras().notes.iter().filter(|(_, note)| rect.contains(pos(note.at)));
        let nodes = nodes.map(|(name, _)| Item::Node(name.clone()));
        nodes.chain(notes.map(|(name, _)| Item::Note(name.clone()))).collect()
    }

    /// Whether a frame that stays holds a node where that is moved to.
    fn holds_what_is_moved(&self, item: &Item, frame: &CanvasFrame) -> bool {
        let Gesture::Move { items, by } = &self.gesture else { return false };
        let is_moved = |item: &Item| items.iter().any(|(moved, _)| moved == item);
        let held = |(moved, _): &(Item, [f64; 2])| {
            let Item::Node(name) = moved else { return false };
            let shape = self.shapes.nodes.get(name);
            shape.is_some_and(|shape| holds(frame, shape.rect().translate(*by)))
        };
        !is_moved(item) && items.iter().any(held)
    }

    /// Frames and notes are drawn first: nodes lie over them.
    pub(super) fn frames_and_notes(
        &mut self,
        ui: &mut Ui,
        brush: &Brush,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) {
        let selection = scene.document.selection();
        for (name, frame) in &scene.document.extras().frames {
            let item = Item::Frame(name.clone());
            let mut rect = rect_of(frame.at, frame.size).translate(self.gesture.shift(&item));
            if let Gesture::Resize { frame, by, .. } = &self.gesture
                && frame == name
            {
                rect.max = (rect.max + *by).max(rect.min + Vec2::splat(60.0));
            }
            let mark = match self.holds_what_is_moved(&item, frame) {
                true => FrameMark::Holds,
                false if selection.contains(&item) => FrameMark::Selected,
                false => FrameMark::None,
            };
            brush.frame(frame, rect, mark);
            let title = Rect::from_min_size(rect.min, Vec2::new(rect.width(), 30.0));
            self.touch_box(ui, brush, scene, &item, &frame.title, title, actions);
            let corner = Rect::from_min_max(rect.max - Vec2::splat(CORNER), rect.max);
            let corner = brush.view.rect_to_screen(corner);
            let response = ui.interact(corner, ui.id().with(("corner", name)), Sense::drag());
            response.widget_info(|| {
                WidgetInfo::labeled(
                    WidgetType::Other,
                    true,
                    format!("size of frame {}", frame.title),
                )
            });
            if response.hovered() || response.dragged() {
                ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeNwSe);
            }
            if response.drag_started() {
                let by = Vec2::ZERO;
                self.gesture = Gesture::Resize { frame: name.clone(), size: frame.size, by };
            }
        }
        for (name, note) in &scene.document.extras().notes {
            let item = Item::Note(name.clone());
            let rect = note_rect(note).translate(self.gesture.shift(&item));
            brush.note(note, rect, selection.contains(&item));
            self.touch_box(ui, brush, scene, &item, &note.text, rect, actions);
        }
        for (name, reroute) in &scene.document.extras().reroutes {
            let item = Item::Reroute(name.clone());
            let at = pos(reroute.at) + self.gesture.shift(&item);
            let rect = Rect::from_center_size(at, Vec2::splat(12.0));
            let color = match selection.contains(&item) {
                true => brush.palette.selected,
                false => brush.palette.faint,
            };
            let radius = (4.0 * brush.view.camera.zoom).max(2.0);
            brush.painter.circle_filled(brush.view.to_screen(at), radius, color);
            self.touch_box(ui, brush, scene, &item, &reroute.link.to_string(), rect, actions);
        }
    }

    #[expect(clippy::too_many_arguments)] // The same for frames, notes and reroute points.
    fn touch_box(
        &mut self,
        ui: &mut Ui,
        brush: &Brush,
        scene: &Scene,
        item: &Item,
        text: &str,
        rect: Rect,
        actions: &mut Vec<Action>,
    ) {
        let (kind, name) = match item {
            Item::Frame(name) => ("frame", name),
            Item::Note(name) => ("note", name),
            Item::Reroute(name) => ("reroute", name),
            Item::Node(_) | Item::Link(_) => return,
        };
        let rect = brush.view.rect_to_screen(rect).intersect(brush.view.screen);
        let response = ui.interact(rect, ui.id().with((kind, name)), Sense::click_and_drag());
        response
            .widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("{kind} {text}")));
        if response.clicked() || response.secondary_clicked() {
            self.click_item(ui, item, response.secondary_clicked(), scene, actions);
        }
        if response.double_clicked() && kind != "reroute" {
            self.renaming = Some(TextEntry::new(item.clone(), text));
        }
        if response.drag_started_by(egui::PointerButton::Primary) {
            self.start_move(ui, item, scene, actions);
        }
        response.context_menu(|ui| menu::of_box(ui, item, text, actions, &mut self.renaming));
    }

    /// Clicks and drags that begin on the empty canvas or on a wire.
    pub(super) fn background_gestures(
        &mut self,
        ui: &mut Ui,
        back: &egui::Response,
        brush: &Brush,
        scene: &Scene,
        wire: Option<Link>,
        actions: &mut Vec<Action>,
    ) {
        let pointer = ui.input(|input| input.pointer.interact_pos());
        let world = pointer.map(|at| brush.view.to_world(at)).unwrap_or_default();
        let place = [f64::from(world.x), f64::from(world.y)];
        let space = ui.input(|input| input.key_down(egui::Key::Space));
        if back.clicked() {
            back.request_focus();
            match &wire {
                Some(link) => {
                    self.click_item(ui, &Item::Link(link.clone()), false, scene, actions);
                }
                None => actions.push(Action::Select(Vec::new())),
            }
        }
        if back.double_clicked() {
            match wire.clone() {
                Some(link) => {
                    actions.push(Action::Edit(vec![Edit::AddReroute { link, at: place }]))
                }
                None => self.search_at(pointer.unwrap_or_default(), None),
            }
        }
        if back.drag_started_by(egui::PointerButton::Primary) && !space {
            let from = ui.input(|input| input.pointer.press_origin());
            self.gesture = Gesture::Select(brush.view.to_world(from.unwrap_or_default()));
        }
        if back.secondary_clicked() {
            self.menu_wire = wire;
            self.menu_at = place;
        }
        let (wire, at) = (self.menu_wire.clone(), self.menu_at);
        let mut choice = menu::MenuChoice::Nothing;
        back.context_menu(|ui| match &wire {
            Some(link) => menu::of_wire(ui, link, at, actions),
            None => choice = menu::of_canvas(ui, at, scene, actions),
        });
        match choice {
            menu::MenuChoice::Nothing => {}
            menu::MenuChoice::Search => self.search_at(brush.view.to_screen(pos(at)), None),
            menu::MenuChoice::Note => self.add_note(at, actions),
        }
    }

    /// Carries the drag on, and ends it when the button goes up.
    pub(super) fn finish_gesture(
        &mut self,
        ui: &mut Ui,
        brush: &Brush,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) {
        let (pointer, delta, is_up, escape) = ui.input(|input| {
            let is_up = !input.pointer.primary_down();
            let escape = input.key_pressed(egui::Key::Escape);
            (input.pointer.interact_pos(), input.pointer.delta(), is_up, escape)
        });
        if escape {
            self.gesture = Gesture::Idle;
        }
        let delta = delta / brush.view.camera.zoom;
        if let Gesture::Move { items, by } = &self.gesture
            && let Some(Insertion { ends: [from, to], .. }) =
                self.insertion(brush, scene, items, *by)
        {
            brush.wire(from, to, brush.palette.selected, 4.0);
        }
        match &mut self.gesture {
            Gesture::Move { by, .. } | Gesture::Resize { by, .. } => *by += delta,
            Gesture::Select(from) => {
                let to = brush.view.to_world(pointer.unwrap_or_default());
                let rect = Rect::from_two_pos(*from, to);
                let screen = brush.view.rect_to_screen(rect);
                let color = brush.palette.selected;
                brush.painter.rect_filled(screen, 0.0, color.gamma_multiply(0.1));
                let stroke = Stroke::new(1.0, color);
                brush.painter.rect_stroke(screen, 0.0, stroke, egui::StrokeKind::Inside);
            }
            Gesture::Link { end, .. } => {
                let end = end.clone();
                self.draw_link(ui, brush, &end, pointer.unwrap_or_default(), scene);
            }
            Gesture::Idle => return,
        }
        // What the gesture drew is to go, or to follow the pointer.
        ui.ctx().request_repaint();
        if is_up {
            let gesture = std::mem::take(&mut self.gesture);
            self.end_gesture(ui, brush, gesture, pointer.unwrap_or_default(), scene, actions);
        }
    }

    fn end_gesture(
        &mut self,
        ui: &Ui,
        brush: &Brush,
        gesture: Gesture,
        pointer: Pos2,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) {
        match gesture {
            Gesture::Idle => {}
            Gesture::Select(from) => {
                let rect = Rect::from_two_pos(from, brush.view.to_world(pointer));
                let adds = ui.input(|input| input.modifiers.shift || input.modifiers.command);
                let mut items: Vec<Item> = match adds {
                    true => scene.document.selection().iter().cloned().collect(),
                    false => Vec::new(),
                };
                items.extend(self.within(rect, scene));
                actions.push(Action::Select(items));
            }
            Gesture::Move { items, by } if by != Vec2::ZERO => {
                let inserted = self.insertion(brush, scene, &items, by);
                let snaps = scene.settings.snaps;
                let moved = items.into_iter().map(|(item, at)| {
                    let to = [at[0] + f64::from(by.x), at[1] + f64::from(by.y)];
                    (item, if snaps { to.map(|x| (x / GRID).round() * GRID) } else { to })
                });
                let mut edits = vec![Edit::Move(moved.collect())];
                edits.extend(inserted.into_iter().flat_map(Insertion::edits));
                actions.push(Action::Edit(edits));
            }
            Gesture::Move { .. } => {}
            Gesture::Resize { frame, size, by } => {
                let size = [size[0] + f64::from(by.x), size[1] + f64::from(by.y)];
                let size = size.map(|x| x.max(60.0).round());
                actions.push(Action::Edit(vec![Edit::Resize { frame, size }]));
            }
            Gesture::Link { end, was } => {
                self.end_link(brush, end, was, pointer, actions);
            }
        }
    }

    /// What a box touches.
    fn within(&self, rect: Rect, scene: &Scene) -> Vec<Item> {
        let extras = scene.document.extras();
        let nodes = self.shapes.nodes.iter().filter(|(_, shape)| rect.intersects(shape.rect()));
        let frames =
            extras.frames.iter().filter(|(_, f)| rect.contains_rect(rect_of(f.at, f.size)));
        let notes = extras.notes.iter().filter(|(_, note)| rect.intersects(note_rect(note)));
        let reroutes = extras.reroutes.iter().filter(|(_, r)| rect.contains(pos(r.at)));
        let mut items: Vec<Item> = nodes.map(|(name, _)| Item::Node(name.clone())).collect();
        items.extend(frames.map(|(name, _)| Item::Frame(name.clone())));
        items.extend(notes.map(|(name, _)| Item::Note(name.clone())));
        items.extend(reroutes.map(|(name, _)| Item::Reroute(name.clone())));
        items
    }
}

/// Whether a frame holds a node that is drawn here.
fn holds(frame: &CanvasFrame, node: Rect) -> bool {
    let numbers = |x: f32, y: f32| [f64::from(x), f64::from(y)];
    frame.holds(numbers(node.min.x, node.min.y), numbers(node.width(), node.height()))
}

/// Where a note is; its height follows its text.
fn note_rect(note: &crate::document::Note) -> Rect {
    let n_lines: usize = note.text.lines().map(|line| 1 + line.chars().count() / 34).sum();
    Rect::from_min_size(pos(note.at), Vec2::new(220.0, 20.0 + 16.0 * n_lines.max(1) as f32))
}
