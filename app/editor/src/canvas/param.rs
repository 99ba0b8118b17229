//! The form of one parameter, opened on the node itself.

use eframe::egui::{self, Area, Frame, Id, Key, Order, Rect, Ui};

use super::{Action, CanvasCamera, Scene};
use crate::forms::{Form, each_text};
use crate::views::counts_of;

/// A parameter's form while it is open.
pub struct OpenParam {
    node: String,
    param: &'static str,
    /// Where on the screen the parameter is drawn.
    field: Rect,
    /// What the canvas showed when it was opened.
    camera: Option<CanvasCamera>,
    is_new: bool,
}

impl OpenParam {
    /// Opens the form below the field of a parameter.
    pub fn new(node: &str, param: &'static str, field: Rect, camera: Option<CanvasCamera>) -> Self {
        Self { node: node.to_owned(), param, field, camera, is_new: true }
    }

    /// Shows the form; whether it is to be closed.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        camera: Option<CanvasCamera>,
        scene: &Scene,
        actions: &mut Vec<Action>,
    ) -> bool {
        let Some(node) = scene.document.map().nodes.get(&self.node) else { return true };
        let Some(info) = scene.registry.of(node) else { return true };
        let Some(spec) = info.module.params.iter().find(|spec| spec.name == self.param) else {
            return true;
        };
        let wants_focus = self.is_new;
        let id = format!("open/{}/{}", self.node, self.param);
        let area =
            Area::new(Id::new(&id)).order(Order::Foreground).fixed_pos(self.field.left_bottom());
        let shown = area.constrain(true).show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(360.0);
                let inputs = scene.runner.inputs(scene.document.map(), &self.node);
                let form = Form {
                    id: &id,
                    given: &node.params,
                    wants_focus,
                    link_of: &|path| {
                        let repeat = node.repeat.as_ref()?;
                        each_text(repeat, path).map(|values| format!("{values}: one a round"))
                    },
                    counts: &inputs.iter().flat_map(counts_of).collect::<Vec<_>>(),
                    folder: &scene.document.folder(),
                };
                let events = form.show(ui, std::slice::from_ref(spec));
                actions
                    .extend(events.into_iter().map(|event| Action::Form(self.node.clone(), event)));
                ui.label(egui::RichText::new(spec.doc).weak().small());
            });
        });
        let is_new = std::mem::take(&mut self.is_new);
        let (escape, enter) =
            ui.input(|input| (input.key_pressed(Key::Escape), input.key_pressed(Key::Enter)));
        let is_elsewhere =
            shown.response.clicked_elsewhere() && !egui::Popup::is_any_open(ui.ctx());
        // The node is no longer where it was.
        let has_moved = camera != self.camera;
        !is_new && (escape || enter || is_elsewhere || has_moved)
    }
}
