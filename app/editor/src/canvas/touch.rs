//! Makes nodes, their parameters and their ports react to the pointer.

use eframe::egui::{self, Rect, Sense, Ui, WidgetInfo, WidgetType};

use super::gesture::Gesture;
use super::paint::{Brush, NodeState, ROWS_FROM};
use super::shape::{FOOT, ParamRow, Port, ROW, Shape, TITLE};
use super::{Action, Canvas, Scene, menu, param};
use crate::document::Item;
use crate::drag::DraggedParam;
use crate::forms::FormEvent;
use crate::views::brief_text;

/// The menu of a parameter.
fn param_menu(ui: &mut Ui, node: &str, row: &ParamRow, actions: &mut Vec<Action>) {
    let path = row.spec.name;
    if ui.button("Vary in the program").clicked() {
        actions.push(Action::Vary(node.to_owned(), path.to_owned()));
    }
    if row.is_set
        && row.spec.default_setting().is_some()
        && ui.button("Back to the default").clicked()
    {
        let event = FormEvent::Set { path: path.to_owned(), value: None };
        actions.push(Action::Form(node.to_owned(), event));
    }
}

/// Where on the screen the value of a parameter stands.
fn field_of(brush: &Brush, shape: &Shape, row: &ParamRow) -> Rect {
    let top = shape.at + egui::vec2(104.0, row.y + 1.5);
    let field = Rect::from_min_size(top, egui::vec2(shape.size.x - 112.0, ROW - 3.0));
    brush.view.rect_to_screen(field).intersect(brush.view.screen)
}

/// Width and height on the screen of what a hand takes a port by.
fn port_size(brush: &Brush) -> f32 {
    (14.0 * brush.view.camera.zoom).max(8.0)
}

/// Whether a point is on the title of a node or on the line that says its state: what lies between
/// them speaks for itself, and words over it would be in the way.
fn says_what_it_is(brush: &Brush, shape: &Shape, at: egui::Pos2) -> bool {
    let y = brush.view.to_world(at).y - shape.at.y;
    y < TITLE || y > shape.size.y - FOOT
}

impl Canvas {
    /// Makes a node, its parameters and its ports react.
    pub(super) fn touch_node(
        &mut self,
        ui: &mut Ui,
        brush: &Brush,
        scene: &Scene,
        shape: &Shape,
        state: &NodeState,
        actions: &mut Vec<Action>,
    ) {
        let name = state.name;
        let id = ui.id().with(("node", name));
        let rect = brush.view.rect_to_screen(shape.rect()).intersect(brush.view.screen);
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| {
            let label = format!("node {name}");
            WidgetInfo::selected(WidgetType::Button, true, state.is_selected, label)
        });
        ui.ctx().accesskit_node_builder(id, |node| node.set_description(state.state_text()));
        let item = Item::Node(name.to_owned());
        if response.clicked() || response.secondary_clicked() {
            self.click_item(ui, &item, response.secondary_clicked(), scene, actions);
        }
        if response.double_clicked() {
            self.renaming = Some(menu::TextEntry::new(item.clone(), name));
        }
        if response.drag_started_by(egui::PointerButton::Primary) {
            self.start_drag(ui, brush, scene, shape, &item, actions);
        }
        let is_idle = matches!(self.gesture, Gesture::Idle);
        if is_idle && response.hover_pos().is_some_and(|at| says_what_it_is(brush, shape, at)) {
            let what = shape.summary.unwrap_or("there is no module of this name here");
            let text = format!("{name}: {}\n{what}\n\n{}", shape.module, state.state_text());
            response.clone().on_hover_text_at_pointer(text);
        }
        response.context_menu(|ui| menu::of_node(ui, name, scene, actions, &mut self.renaming));
        if brush.view.camera.zoom < ROWS_FROM {
            return;
        }
        for row in &shape.params {
            self.touch_param(ui, brush, scene, (name, shape), row, actions);
        }
        for port in &shape.inputs {
            self.touch_port(ui, brush, scene, shape, port, false, actions);
        }
        for port in &shape.outputs {
            self.touch_port(ui, brush, scene, shape, port, true, actions);
        }
    }

    /// Begins the drag of what was below the pointer when it was pressed: on a slow frame it has
    /// gone on to something else since.
    fn start_drag(
        &mut self,
        ui: &Ui,
        brush: &Brush,
        scene: &Scene,
        shape: &Shape,
        item: &Item,
        actions: &mut Vec<Action>,
    ) {
        let Some(pressed) = ui.input(|input| input.pointer.press_origin()) else { return };
        if brush.view.camera.zoom >= ROWS_FROM {
            let reach = port_size(brush) / 2.0;
            let sides = [(&shape.inputs, false), (&shape.outputs, true)];
            let ports = sides
                .into_iter()
                .flat_map(|(ports, is_output)| ports.iter().map(move |port| (port, is_output)));
            let distance = |port: &Port| {
                (brush.view.to_screen(shape.at + port.offset) - pressed).abs().max_elem()
            };
            let near = ports.filter(|(port, _)| distance(port) <= reach);
            if let Some((port, is_output)) =
                near.min_by(|(a, _), (b, _)| distance(a).total_cmp(&distance(b)))
            {
                self.gesture = Gesture::start_link(&port.at, is_output, scene);
                return;
            }
            let height = brush.view.to_world(pressed).y - shape.at.y;
            let is_in = |row: &&ParamRow| (row.y..row.y + ROW).contains(&height);
            if let (Some(row), Item::Node(node)) = (shape.params.iter().find(is_in), item) {
                let (node, param) = (node.clone(), row.spec.name.to_owned());
                egui::DragAndDrop::set_payload(ui.ctx(), DraggedParam { node, param });
                return;
            }
        }
        self.start_move(ui, item, scene, actions);
    }

    fn touch_param(
        &mut self,
        ui: &mut Ui,
        brush: &Brush,
        scene: &Scene,
        (node, shape): (&str, &Shape),
        row: &ParamRow,
        actions: &mut Vec<Action>,
    ) {
        let rect = field_of(brush, shape, row);
        let path = row.spec.name;
        // The name beside the field: what it is for, and the same menu.
        let name = Rect::from_min_max(
            egui::pos2(brush.view.to_screen(shape.at).x + rect.height(), rect.top()),
            egui::pos2(rect.left(), rect.bottom()),
        );
        let name = name.intersect(brush.view.screen);
        let name = ui.interact(name, ui.id().with(("name", node, path)), Sense::click_and_drag());
        name.context_menu(|ui| param_menu(ui, node, row, actions));
        if name.clicked() && !row.is_linked {
            self.open_param = Some(param::OpenParam::new(node, path, rect, self.camera));
            actions.push(Action::Select(vec![Item::Node(node.to_owned())]));
        }
        if name.drag_started_by(egui::PointerButton::Primary) {
            let item = Item::Node(node.to_owned());
            self.start_drag(ui, brush, scene, shape, &item, actions);
        }
        name.on_hover_text(row.spec.doc);
        let response =
            ui.interact(rect, ui.id().with(("param", node, path)), Sense::click_and_drag());
        response.widget_info(|| {
            WidgetInfo::labeled(WidgetType::Button, true, format!("{node}.{path}: {}", row.value))
        });
        if response.drag_started_by(egui::PointerButton::Primary) {
            let item = Item::Node(node.to_owned());
            self.start_drag(ui, brush, scene, shape, &item, actions);
        }
        if response.clicked() && !row.is_linked {
            self.open_param = Some(param::OpenParam::new(node, path, rect, self.camera));
            actions.push(Action::Select(vec![Item::Node(node.to_owned())]));
        }
        if response.hovered() {
            let how = if row.is_linked {
                "It takes its value from a link."
            } else {
                "Click to change it; drag it into the program to vary it."
            };
            response.clone().on_hover_text(format!("{}\n{how}", row.spec.doc));
        }
        response.context_menu(|ui| param_menu(ui, node, row, actions));
    }

    #[expect(clippy::too_many_arguments)] // One caller, and all of it is of the moment.
    fn touch_port(
        &mut self,
        ui: &mut Ui,
        brush: &Brush,
        scene: &Scene,
        shape: &Shape,
        port: &Port,
        is_output: bool,
        actions: &mut Vec<Action>,
    ) {
        let at = brush.view.to_screen(shape.at + port.offset);
        let rect = Rect::from_center_size(at, egui::Vec2::splat(port_size(brush)));
        if !brush.view.screen.intersects(rect) {
            return;
        }
        let side = if is_output { "output" } else { "input" };
        let id = ui.id().with((side, &port.at.node, &port.at.port));
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| {
            WidgetInfo::labeled(WidgetType::Button, true, format!("{side} {}", port.at))
        });
        if response.drag_started_by(egui::PointerButton::Primary) {
            let item = Item::Node(port.at.node.clone());
            self.start_drag(ui, brush, scene, shape, &item, actions);
        }
        if response.clicked() && is_output {
            actions.push(Action::Pin(port.at.clone()));
        }
        if response.hovered() && matches!(self.gesture, Gesture::Idle) {
            let what = port.data_type;
            let value = scene.runner.value(&port.at.node, &port.at.port).filter(|_| is_output);
            let value =
                value.map(|value| format!("\n\n{}", brief_text(&value))).unwrap_or_default();
            let links = &scene.document.map().links;
            let need = match links.iter().find(|link| link.to == port.at) {
                Some(link) => format!("linked from {}", link.from),
                None if is_output => "click to look at it, drag to link it".to_owned(),
                None if port.is_required => "must be linked".to_owned(),
                None => "optional".to_owned(),
            };
            let text = format!("{} ({}): {}\n{need}{value}", port.at.port, what.id, port.doc);
            response.on_hover_text(text);
        }
    }
}
