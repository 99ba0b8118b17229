//! A link under way: where it snaps, why a port does not do, and what it becomes.

use eframe::egui::{self, Pos2, Stroke, Ui};
use mve_core::{Link, PortRef};

use super::gesture::{End, link_to};
use super::paint::Brush;
use super::shape::color_of;
use super::{Action, Canvas, Scene};
use crate::document::{Edit, fits};

/// How near to a port a link's end must come to snap to it, in points of the screen.
const SNAP: f32 = 26.0;

impl Canvas {
    pub(super) fn end_link(
        &mut self,
        brush: &Brush,
        end: End,
        was: Option<Link>,
        pointer: Pos2,
        actions: &mut Vec<Action>,
    ) {
        if !brush.view.screen.contains(pointer) {
            return;
        }
        let Some(port) = self.nearest_port(brush, &end, pointer) else {
            match was {
                Some(link) => actions.push(Action::Edit(vec![Edit::Disconnect(link)])),
                None => self.search_at(pointer, Some(end)),
            }
            return;
        };
        let link = link_to(&end, &port);
        if was.as_ref() == Some(&link) || end.port() == &port {
            return;
        }
        let mut edits: Vec<Edit> = was.map(Edit::Disconnect).into_iter().collect();
        edits.push(Edit::Connect(link));
        actions.push(Action::Edit(edits));
    }

    /// Draws the link under way, and says why the port below the pointer does not do.
    pub(super) fn draw_link(
        &self,
        ui: &Ui,
        brush: &Brush,
        end: &End,
        pointer: Pos2,
        scene: &Scene,
    ) {
        let place = match end {
            End::From(port) => self.shapes.output(port),
            End::To(port) => self.shapes.input(port),
        };
        let Some((at, port)) = place else { return };
        let color = color_of(port.data_type);
        let at = brush.view.to_screen(at);
        let target = self.nearest_port(brush, end, pointer);
        let mut tip = pointer;
        if let Some(target) = target.filter(|target| target != end.port()) {
            let link = link_to(end, &target);
            match fits(scene.document.map(), scene.registry, &link) {
                Ok(()) => {
                    let side = match end {
                        End::From(_) => self.shapes.input(&target),
                        End::To(_) => self.shapes.output(&target),
                    };
                    tip = side.map_or(pointer, |(at, _)| brush.view.to_screen(at));
                    brush.painter.circle_stroke(tip, 9.0, Stroke::new(2.0, brush.palette.selected));
                }
                Err(why) => {
                    let text = egui::RichText::new(why).color(ui.visuals().error_fg_color);
                    egui::Tooltip::always_open(
                        ui.ctx().clone(),
                        ui.layer_id(),
                        ui.id().with("why not"),
                        egui::PopupAnchor::Pointer,
                    )
                    .show(|ui| ui.label(text));
                }
            }
        }
        match end {
            End::From(_) => brush.wire(at, tip, color, 3.0),
            End::To(_) => brush.wire(tip, at, color, 3.0),
        }
    }

    /// The port near the pointer on the side that a link looks for: of those that are near, the
    /// nearest. The body of a node stands for its first port that fits.
    fn nearest_port(&self, brush: &Brush, end: &End, pointer: Pos2) -> Option<PortRef> {
        let mut best: Option<(f32, &PortRef)> = None;
        for shape in self.shapes.nodes.values() {
            let around = brush.view.rect_to_screen(shape.rect()).expand(SNAP);
            if !around.contains(pointer) {
                continue;
            }
            let ports = match end {
                End::From(_) => &shape.inputs,
                End::To(_) => &shape.outputs,
            };
            for port in ports {
                let at = brush.view.to_screen(shape.at + port.offset);
                let distance = (at - pointer).length();
                if distance < SNAP && best.is_none_or(|(least, _)| distance < least) {
                    best = Some((distance, &port.at));
                }
            }
        }
        best.map(|(_, port)| port.clone())
    }
}
